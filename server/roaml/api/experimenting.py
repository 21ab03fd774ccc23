# SPDX-License-Identifier: Apache-2.0
"""Experiments: properties for many values of parameters."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from roaml.api.expanded_chances import expanded_chances
from roaml.api.jani_files import read_jani
from roaml.api.mocked_systems import mock_system
from roaml.api.parametric_mocks import MockTexts, ParametricTree
from roaml.api.systems import LoadedSystem, ModelError, load, values_of_parameters
from roaml.api.verifying import ConstantError, as_target
from roaml.disk import read
from roaml.experiments.enough import Enough, enough_of, together
from roaml.experiments.grid import ExperimentOptions, Grid, ParametricModel
from roaml.experiments.intervals import interval_of, lifted_target
from roaml.experiments.parametric import Chances, constant_chances
from roaml.experiments.points import ExperimentPoint
from roaml.experiments.results import ExperimentResult
from roaml.experiments.sweeps import Setting, Sweep, SweepError, settings_of, sweeps_of
from roaml.jani.constants import with_constants
from roaml.jani.model import Model
from roaml.jani.selection import select
from roaml.mocks.mock import MockError
from roaml.model.kinds import FileKind, kind_of
from roaml.model.parameters import NO_OVERRIDES, Overrides
from roaml.project.settings import Settings
from roaml.record import Record, replace
from roaml.text import decode
from roaml.verification.expectations import Expectation
from roaml.verification.target import VerificationTarget, asking, target_of

if TYPE_CHECKING:
    from concurrent.futures import Executor


class ParametricJani(Record, frozen=True):
    """A JANI model whose constants are the parameters."""

    model: Model
    path: str

    def target(self, setting: Setting) -> VerificationTarget:
        try:
            model = with_constants(self.model, [f"{name}={value}" for name, value in setting])
        except ValueError as error:
            raise ConstantError(str(error)) from None
        return target_of(model, self.path, (self.path,))

    def chances(self, ranges: Mapping[str, tuple[float, float]], fixed: Setting) -> Chances | None:
        return constant_chances(self.target(fixed).model, ranges)


NO_MOCKS = MockTexts()


class ParametricSystem(Record, frozen=True):
    """A system. `overrides` are those of all points, and `mocks` those of leaves without a plugin."""

    path: str
    ros_paths: tuple[str, ...] = ()
    settings: Settings | None = None
    overrides: Overrides = NO_OVERRIDES
    mocks: MockTexts = NO_MOCKS

    def target(self, setting: Setting) -> VerificationTarget:
        return as_target(self._loaded(setting))

    def chances(self, ranges: Mapping[str, tuple[float, float]], fixed: Setting) -> Chances | None:
        if self.mocks.uses():
            return None
        loaded = self._loaded(fixed)
        return expanded_chances(loaded.analysis, loaded.path, ranges)

    def _loaded(self, setting: Setting) -> LoadedSystem:
        overrides = replace(self.overrides, values=(*self.overrides.values, *setting))
        if not self.mocks.has_mocks:
            return load(self.path, self.ros_paths, self.settings, overrides=overrides)
        settings = replace(self.settings or Settings(), overrides=overrides)
        values = values_of_parameters(self.path, self.ros_paths, settings, {}) if self.mocks.uses() else {}
        mocked = mock_system(self.path, self.mocks.mocks(values), self.ros_paths, settings)
        if mocked.missing:
            raise MockError(f"{self.path}: these leaves need mocks: {', '.join(dict.fromkeys(mocked.missing))}")
        return load(self.path, self.ros_paths, self.settings, mocked.texts, overrides)


def experiment(
    path: str,
    sweeps: Mapping[str, Iterable[object]] | Sequence[str],
    properties: Sequence[str] | None = None,
    options: ExperimentOptions | None = None,
    *,
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    overrides: Overrides = NO_OVERRIDES,
    mocks: MockTexts = NO_MOCKS,
    known: Iterable[ExperimentPoint] = (),
    jobs: int = 1,
    executor: Executor | None = None,
    watch: Callable[[ExperimentPoint, int, int], None] | None = None,
) -> ExperimentResult:
    """The values of properties for all combinations of the values of parameters.

    Args:
        path: a system, or a JANI model, whose constants are its parameters.
        sweeps: parameter -> its values; or texts such as `capacity=20:200:20`.
        properties: the names of the properties; all if not given.
        options: how the values are computed.
        ros_paths, settings, overrides: as for `target`.
        mocks: the mocks of a tree without a system, which use the parameters, or of leaves of a system.
        known: points of an earlier run, which are not computed again.
        jobs: the number of processes.
        executor: computes the points instead of processes of this computer.
        watch: called for each point, with the number of known points and of all points.

    Raises:
        SweepError: the values of a parameter are not valid.
        ConstantError: a parameter does not exist, or cannot have one of its values.
        PropertyError: a property does not exist.
        PathError, ModelError, JaniError: the model cannot be read, or has errors.
    """
    grid = grid_of(
        path, sweeps, properties, options, ros_paths=ros_paths, settings=settings, overrides=overrides, mocks=mocks
    )
    points = {(point.setting, point.name): point for point in known}
    keys = grid.keys
    points = {key: points[key] for key in keys if key in points}
    for point in grid.points(points, jobs, executor):
        points[point.setting, point.name] = point
        if watch is not None:
            watch(point, len(points), len(keys))
    return ExperimentResult(path, grid.sweeps, grid.properties, tuple(points[key] for key in keys), grid.options)


def over_intervals(
    path: str,
    values: Mapping[str, str],
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    overrides: Overrides = NO_OVERRIDES,
) -> VerificationTarget:
    """A model whose least and greatest values over all schedulers enclose the values of its properties for all
    parameters in intervals (docs/spec/parameters.md#intervals). Estimates from traces say nothing about them.

    Args:
        path: a system, or a JANI model, whose constants are its parameters.
        values: parameter -> an interval such as `[0.85,0.95]`, or a value.
        ros_paths, settings, overrides: as for `target`.

    Raises:
        IntervalError: an interval is not valid, or no bounds are known.
        ConstantError: a parameter does not exist, or cannot have its value.
        PathError, ModelError, JaniError: the model cannot be read, or has errors.
    """
    given = {name: interval_of(name, value) for name, value in values.items()}
    intervals = tuple(interval for interval in given.values() if interval is not None)
    fixed = tuple((name, values[name]) for name, interval in given.items() if interval is None)
    found = lifted_target(parametric_model(path, ros_paths, settings, overrides), intervals, fixed)
    return found if settings is None else found.expecting(settings.expectations)


def grid_of(
    path: str,
    sweeps: Mapping[str, Iterable[object]] | Sequence[str],
    properties: Sequence[str] | None = None,
    options: ExperimentOptions | None = None,
    *,
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    overrides: Overrides = NO_OVERRIDES,
    mocks: MockTexts = NO_MOCKS,
) -> Grid:
    """The grid of an experiment, before its points are computed. Arguments and errors are those of `experiment`."""
    model = parametric_model(path, ros_paths, settings, overrides, mocks)
    if isinstance(sweeps, Mapping):
        given = tuple(Sweep(name, tuple(map(str, values))) for name, values in sweeps.items())
    else:
        given = _read_sweeps(sweeps, model)
    if any(not sweep.values for sweep in given):
        raise SweepError("a parameter without values has no points")
    first = asking(model.target(tuple((sweep.name, sweep.values[0]) for sweep in given)), properties or ())
    known = first.properties
    names = tuple(p.name for p in (known if properties is None else select(known, properties, "model")))
    computed = options or ExperimentOptions()
    return Grid(model, given, names, computed, first.files, _digest(first.files, computed, overrides, mocks, settings))


def _read_sweeps(texts: Sequence[str], model: ParametricModel) -> tuple[Sweep, ...]:
    """The sweeps in texts. If one is not valid, and names a parameter that a system does not declare, that is the
    error, because its values cannot be mended."""
    try:
        return sweeps_of(texts)
    except SweepError:
        if isinstance(model, ParametricSystem):
            for name, equals, _ in (text.partition("=") for text in texts):
                with suppress(ModelError):  # the value need not suit
                    model.target(((name.strip(), "1"),) if equals and name.strip() else ())
        raise


def _digest(
    files: Sequence[str],
    options: ExperimentOptions,
    overrides: Overrides,
    mocks: MockTexts,
    settings: Settings | None,
) -> str:
    """The digest of the contents of files, of options, and of values from outside of the files."""
    given = () if settings is None else settings.parameters
    digest = hashlib.sha256(repr((options, overrides, mocks, given)).encode())
    for file in filter(os.path.isfile, files):  # the plugins of mocks are not written; the mocks determine them
        with open(file, "rb") as content:
            digest.update(hashlib.sha256(content.read()).digest())
    return digest.hexdigest()


def parametric_model(
    path: str,
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    overrides: Overrides = NO_OVERRIDES,
    mocks: MockTexts = NO_MOCKS,
) -> ParametricModel:
    """A model with parameters. Arguments and errors are those of `target`."""
    if not path.endswith(".jani") and _is_tree(path):
        return ParametricTree(path, mocks, settings or Settings(), overrides.max_time)
    if not path.endswith(".jani"):
        return ParametricSystem(path, tuple(ros_paths), settings, overrides, mocks)
    return ParametricJani(read_jani(path)[0], path)


def _is_tree(path: str) -> bool:
    data = read(path)
    return isinstance(data, bytes) and kind_of(path, decode(path, data).text) is FileKind.TREE


def find_enough(
    grid: Grid,
    parameter: str,
    expectation: Expectation,
    *,
    is_assumed: bool = False,
    jobs: int = 1,
    executor: Executor | None = None,
    watch: Callable[[ExperimentPoint, int, int], None] | None = None,
) -> tuple[tuple[Enough, ...], ExperimentResult]:
    """The values of a parameter for which a property meets an expectation, for each setting of the other parameters;
    and the points that were computed.

    Args:
        grid: the grid, with one property.
        parameter: the parameter. Its values must be numbers.
        is_assumed: whether the property is assumed to be monotone in the parameter. Then few points are computed.
        jobs, executor, watch: as for `experiment`.

    Raises:
        SweepError: the grid has not this parameter with several numbers, or not exactly one property.
    """
    swept = next((sweep for sweep in grid.sweeps if sweep.name == parameter), None)
    if swept is None or swept.numbers is None or len(swept.values) < 2:
        raise SweepError(
            f"to find a value of `{parameter}`, give it a range of numbers, such as `{parameter}=20:200:20`"
        )
    if len(grid.properties) != 1:
        raise SweepError("a value can be found for one property at a time; name it in the expectation")
    name = grid.properties[0]
    computed = together(grid.options, len(grid.settings))
    grid = replace(grid, options=computed)
    expected = expectation.threshold
    points: dict[Setting, ExperimentPoint] = {}

    def keep(each: Iterable[ExperimentPoint]) -> None:
        for point in each:
            points[point.setting] = point
            if watch is not None:
                watch(point, len(points), len(grid.settings))

    if not is_assumed:
        keep(grid.points((), jobs, executor))
    answers = []
    others = [sweep for sweep in grid.sweeps if sweep.name != parameter]
    for rest in settings_of(others):

        def point(value: str, rest: Setting = rest) -> ExperimentPoint:
            known = {**dict(rest), parameter: value}
            setting = tuple((sweep.name, known[sweep.name]) for sweep in grid.sweeps)
            if setting not in points:
                alone = tuple(Sweep(key, (text,)) for key, text in setting)
                keep(replace(grid, sweeps=alone).points())
            return points[setting]

        answers.append(enough_of(swept, rest, point, expected, is_assumed=is_assumed))
    known = tuple(points[setting] for setting in grid.settings if setting in points)
    return tuple(answers), ExperimentResult(grid.files[0], grid.sweeps, (name,), known, computed)

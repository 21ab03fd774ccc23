# SPDX-License-Identifier: Apache-2.0
"""Experiments: properties for many values of parameters."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from roaml.api.jani_files import read_jani
from roaml.api.verifying import ConstantError
from roaml.experiments.grid import ExperimentOptions, Grid
from roaml.experiments.parametric import Chances, constant_chances
from roaml.experiments.points import ExperimentPoint
from roaml.experiments.results import ExperimentResult
from roaml.experiments.sweeps import Setting, Sweep, SweepError, sweeps_of
from roaml.jani.constants import with_constants
from roaml.jani.model import Model
from roaml.jani.selection import select
from roaml.record import Record
from roaml.verification.target import VerificationTarget, target_of

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

    def chances(self, names: Collection[str], fixed: Setting) -> Chances | None:
        return constant_chances(self.target(fixed).model, names)


def experiment(
    path: str,
    sweeps: Mapping[str, Iterable[object]] | Sequence[str],
    properties: Sequence[str] | None = None,
    options: ExperimentOptions | None = None,
    *,
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
    grid = grid_of(path, sweeps, properties, options)
    points = {(point.setting, point.name): point for point in known}
    keys = grid.keys
    points = {key: points[key] for key in keys if key in points}
    for point in grid.points(points, jobs, executor):
        points[point.setting, point.name] = point
        if watch is not None:
            watch(point, len(points), len(keys))
    return ExperimentResult(path, grid.sweeps, grid.properties, tuple(points[key] for key in keys), grid.options)


def grid_of(
    path: str,
    sweeps: Mapping[str, Iterable[object]] | Sequence[str],
    properties: Sequence[str] | None = None,
    options: ExperimentOptions | None = None,
) -> Grid:
    """The grid of an experiment, before its points are computed. Arguments and errors are those of `experiment`."""
    if isinstance(sweeps, Mapping):
        given = tuple(Sweep(name, tuple(map(str, values))) for name, values in sweeps.items())
    else:
        given = sweeps_of(sweeps)
    if any(not sweep.values for sweep in given):
        raise SweepError("a parameter without values has no points")
    subject = subject_of(path)
    target = subject.target(tuple((sweep.name, sweep.values[0]) for sweep in given))
    known = target.properties
    names = tuple(p.name for p in (known if properties is None else select(known, properties, "model")))
    computed = options or ExperimentOptions()
    return Grid(subject, given, names, computed, target.files, _digest(target.files, computed))


def _digest(files: Sequence[str], options: ExperimentOptions) -> str:
    """The digest of the contents of files and of options."""
    digest = hashlib.sha256(repr(options).encode())
    for file in files:
        with open(file, "rb") as content:
            digest.update(hashlib.sha256(content.read()).digest())
    return digest.hexdigest()


def subject_of(path: str) -> ParametricJani:
    model, _ = read_jani(path)
    return ParametricJani(model, path)

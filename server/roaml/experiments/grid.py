# SPDX-License-Identifier: Apache-2.0
"""The values of properties at all points of a grid of settings.

- The value of a point does not depend on the other points, on the number of processes, or on interruptions.
- Where only probabilities depend on the parameters, the states are explored once (`parametric`); all points then have
  the same states with other numbers.
- Estimates of all points use the same random numbers: trace n of one point draws the same numbers as trace n of the
  others. So differences between neighbours are less noisy than the intervals suggest.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import Protocol, TypeAlias

from roaml.experiments.derivatives import NoDerivativeError, derivative
from roaml.experiments.parametric import Chances, ParametricSpace, parametric_program, parametric_space
from roaml.experiments.points import ExperimentPoint, estimated_point, exact_point, unknown_point
from roaml.experiments.sweeps import Setting, Sweep, settings_of
from roaml.explicit.space import StateLimits
from roaml.explicit.values import NoValueError, values_of
from roaml.record import Record, replace
from roaml.smc.batch import interruptible, stop_on_interrupts
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Pool, process_context, starting_workers
from roaml.smc.run import Options
from roaml.verification.exhaustive import UndecidedError, exact_values
from roaml.verification.results import Exact, Refused
from roaml.verification.small import LIMITS, SHARED_LIMITS, attempt
from roaml.verification.target import VerificationTarget, asking
from roaml.verification.verifier import Verifier, checker_of, verifier_of

Key: TypeAlias = tuple[Setting, str]
"""A setting and the name of a property."""


class ParametricModel(Protocol):
    """What an experiment is about: a model with parameters. It can be sent to other processes."""

    def target(self, setting: Setting) -> VerificationTarget:
        """The model with the parameters of a setting.

        Raises:
            ValueError: a parameter does not exist, or cannot have its value; or the model has errors.
        """

    def chances(self, ranges: Mapping[str, tuple[float, float]], fixed: Setting) -> Chances | None:
        """The probabilities of the model that depend on parameters, if nothing else does; otherwise `None`.

        Args:
            ranges: parameter -> its least and its greatest value.
            fixed: the values of the other parameters.
        """


class FixedModel(Record, frozen=True):
    """A model without parameters, whose grid has one setting."""

    fixed: VerificationTarget

    def target(self, _: Setting) -> VerificationTarget:
        return self.fixed

    def chances(self, _: Mapping[str, tuple[float, float]], __: Setting) -> Chances | None:
        return None


class ExperimentOptions(Record, frozen=True):
    """How the values of an experiment are computed.

    Attributes:
        sampling: the options of estimates.
        only_uniform: whether the value under uniform choices is requested, not the minimum or maximum.
        exact: whether exact values are computed where the model is small.
        is_exhaustive: whether only exact values are computed, without limits on states.
        max_transitions: the limit on the transitions of each point; `None` for the limit of `verify`, divided by the
            number of points, but at least `small.LIMITS`.
        max_states: the limit on the states of each point; `None` for that of `verify`.
        has_slopes: whether the derivatives by the parameters with several values are computed.
    """

    sampling: Options = Options()
    only_uniform: bool = False
    exact: bool = True
    is_exhaustive: bool = False
    max_transitions: int | None = None
    max_states: int | None = None
    has_slopes: bool = False

    def limits(self, points: int) -> StateLimits:
        """The limits of the search for one of several points."""
        if self.is_exhaustive:
            return StateLimits() if self.max_states is None else StateLimits(self.max_states)
        shared = max(LIMITS.transitions or 0, (SHARED_LIMITS.transitions or 0) // max(1, points))
        return replace(
            SHARED_LIMITS,
            transitions=self.max_transitions or shared,
            states=self.max_states or SHARED_LIMITS.states,
        )


class Grid(Record, frozen=True):
    """The points of an experiment that are to be computed.

    Attributes:
        properties: the names of the properties.
        files: the files that were read.
        digest: the digest of the files and options, on which the values of points depend.
    """

    model: ParametricModel
    sweeps: tuple[Sweep, ...]
    properties: tuple[str, ...]
    options: ExperimentOptions
    files: tuple[str, ...] = ()
    digest: str = ""

    @property
    def settings(self) -> list[Setting]:
        return settings_of(self.sweeps)

    @property
    def keys(self) -> list[Key]:
        """All points in the order of the results: by setting, then by property."""
        return [(setting, name) for setting in self.settings for name in self.properties]

    def points(
        self, known: Collection[Key] = (), jobs: int = 1, executor: Executor | None = None
    ) -> Iterator[ExperimentPoint]:
        """The points, as they become known.

        Args:
            known: points that are left out because their values are known.
            jobs: the number of processes.
            executor: runs the points instead of processes of this computer.

        Raises:
            ValueError: see `ParametricModel.target`.
        """
        left = [key for key in self.keys if key not in set(known)]
        for name in self.properties:
            settings = [setting for setting, property_ in left if property_ == name]
            space = self._parametric(name, settings)
            if space is not None:
                for point in shared_points(space, settings, self.options):
                    left.remove((point.setting, name))
                    yield point
        by_setting: dict[Setting, list[str]] = {}
        for setting, name in left:
            by_setting.setdefault(setting, []).append(name)
        for point in _computed(self._tasks(by_setting), jobs, executor):
            yield self._without_slopes(point) if self.options.has_slopes else point

    def _tasks(self, names: Mapping[Setting, Sequence[str]]) -> list[_Task]:
        """The tasks for the properties of some settings."""
        limits = self.options.limits(len(self.settings))
        program = None
        if not self.options.exact and not self.options.is_exhaustive and len(names) > 2:
            shared = self._chances()
            if shared is not None:
                program = parametric_program(self.model.target, shared[0], self.properties, *shared[1:])
        tasks = []
        for setting, own in names.items():
            checker = None if program is None else program.at(setting)
            if program is not None and checker is not None:
                target = replace(program.target, source_of=_no_source)
                compiled: _Compiled | None = _Compiled(target, checker)
            else:
                compiled = None
            tasks.append(_Task(self.model, setting, tuple(own), self.options, limits, compiled))
        return tasks

    def _chances(self) -> tuple[Chances, Mapping[str, tuple[float, float]], Setting] | None:
        """The probabilities that depend on the parameters with several values, the ranges of these, and the other
        parameters; `None` if something else depends on them."""
        ranges = {sweep.name: _range(sweep) for sweep in self.sweeps if len(sweep.values) > 1}
        numeric = {name: ends for name, ends in ranges.items() if ends is not None}
        if not numeric or len(numeric) < len(ranges):
            return None
        fixed = tuple((sweep.name, sweep.values[0]) for sweep in self.sweeps if len(sweep.values) == 1)
        chances = self.model.chances(numeric, fixed)
        return None if chances is None else (chances, numeric, fixed)

    def _without_slopes(self, point: ExperimentPoint) -> ExperimentPoint:
        """A point that is computed alone, with the reason why it has no derivatives."""
        if any(len(sweep.values) > 1 for sweep in self.sweeps):
            reason = "more than probabilities depends on the parameters, or a probability is 0 or 1 here"
        else:
            reason = "no parameter has several values; give the one to derive by at least two, such as 0.3,0.31"
        return replace(point, note="; ".join(part for part in (point.note, f"no derivative: {reason}") if part))

    def _parametric(self, name: str, settings: Sequence[Setting]) -> ParametricSpace | None:
        """The states that the points of a property share; `None` if they share none."""
        options = self.options
        if len(settings) < (1 if options.has_slopes else 3) or not (options.exact or options.is_exhaustive):
            return None
        shared = self._chances()
        if shared is None:
            return None
        chances, ranges, fixed = shared
        return parametric_space(self.model.target, chances, name, ranges, fixed, options.limits(1))


def _range(sweep: Sweep) -> tuple[float, float] | None:
    numbers = sweep.numbers
    return None if numbers is None else (min(numbers), max(numbers))


def shared_points(
    space: ParametricSpace, settings: Sequence[Setting], options: ExperimentOptions
) -> Iterator[ExperimentPoint]:
    """The exact points that share the states of a space. Those that do not are left out."""
    question = space.space.compiled_property.question
    can_get_stuck = space.space.can_get_stuck
    work = None if options.is_exhaustive else options.limits(1).work
    for setting in settings:
        if not space.is_at(setting):
            continue
        try:
            values = values_of(space.space, work=work)
        except NoValueError:
            continue
        is_answered = values.uniform is not None or not options.only_uniform or values.minimum == values.maximum
        if values.is_precise and is_answered:
            point = exact_point(
                setting,
                question,
                values,
                states=space.space.states,
                can_get_stuck=can_get_stuck,
                only_uniform=options.only_uniform,
            )
            yield _with_slopes(space, point) if options.has_slopes else point


def _with_slopes(space: ParametricSpace, point: ExperimentPoint) -> ExperimentPoint:
    """The point with the derivatives by the parameters with several values, or with the reason why there are none."""
    try:
        return replace(point, slopes=derivative(space, point.setting, space.names).slopes)
    except NoDerivativeError as error:
        return replace(point, note="; ".join(part for part in (point.note, f"no derivative: {error}") if part))


class _Compiled(Record, frozen=True):
    """A model that is compiled for a setting already."""

    target: VerificationTarget
    checker: ModelChecker


def _no_source(_: str) -> None:
    """The files of the user are not sent to other processes."""


class _Task(Record, frozen=True):
    """The properties of one setting that are computed together.

    Attributes:
        compiled: the compiled model, for estimates; `None` if the model is read, translated and compiled.
    """

    model: ParametricModel
    setting: Setting
    names: tuple[str, ...]
    options: ExperimentOptions
    limits: StateLimits
    compiled: _Compiled | None = None


def _computed(tasks: Sequence[_Task], jobs: int, executor: Executor | None) -> Iterator[ExperimentPoint]:
    if executor is None and (jobs < 2 or len(tasks) < 2):
        for task in tasks:
            yield from _measure(task)
        return
    if executor is not None:
        yield from _distributed(tasks, 2 * max(1, jobs), executor, _measure)
        return
    from concurrent.futures import ProcessPoolExecutor  # noqa: PLC0415 - most experiments need no processes

    with ProcessPoolExecutor(min(jobs, len(tasks)), process_context(), stop_on_interrupts) as own:
        yield from _distributed(tasks, 2 * jobs, own, functools.partial(interruptible, _measure))


def _distributed(
    tasks: Sequence[_Task],
    count: int,
    executor: Executor,
    measure: Callable[[_Task], list[ExperimentPoint]],
) -> Iterator[ExperimentPoint]:
    waiting = iter(tasks)
    running: set[Future[list[ExperimentPoint]]] = set()
    try:
        while True:
            for task in waiting:
                with starting_workers():
                    running.add(executor.submit(measure, task))
                if len(running) == count:
                    break
            if not running:
                return
            done, running = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield from future.result()
    finally:
        for future in running:
            future.cancel()


def _measure(task: _Task) -> list[ExperimentPoint]:
    """The points of one setting."""
    if task.compiled is not None:
        verifier = Verifier(task.compiled.target, task.compiled.checker, task.options.sampling, only_uniform=True)
        points = _estimated(task, verifier, task.names)
        return [points[name] for name in task.names]
    try:
        target = asking(task.model.target(task.setting), task.names)
        checker = checker_of(target, task.names)
    except FaultError as fault:
        return [unknown_point(task.setting, name, fault.message) for name in task.names]
    except ValueError as error:  # the model cannot have these parameters; the other points are not affected
        return [unknown_point(task.setting, name, str(error)) for name in task.names]
    points = {}
    for name, refused in checker.refused.items():
        points[name] = unknown_point(task.setting, name, refused.message)
    limits: dict[str, str] = {}
    for property_ in checker.compiled_properties:
        point = _exact(task, checker, property_)
        if isinstance(point, ExperimentPoint):
            points[property_.question.name] = point
        else:
            limits[property_.question.name] = point
    rest = [name for name in task.names if name not in points]
    if rest:
        verifier = verifier_of(target, rest, task.options.sampling, only_uniform=True)
        estimated = _estimated(task, verifier, rest)
        points |= {name: replace(point, limit=limits.get(name, "")) for name, point in estimated.items()}
    return [points[name] for name in task.names]


def _exact(task: _Task, checker: ModelChecker, property_: CompiledProperty) -> ExperimentPoint | str:
    """The point with exact values; if traces are needed, the name of the limit that ended the search, or ""."""
    options, question = task.options, property_.question
    limit = ""
    try:
        if options.is_exhaustive:
            exact: Exact | None = exact_values(checker, property_, task.limits, only_uniform=options.only_uniform)
        elif options.exact:
            search = attempt(checker, property_, task.limits, only_uniform=options.only_uniform)
            exact, limit = search.exact, search.limit
        else:
            exact = None
    except UndecidedError as error:
        return unknown_point(task.setting, question.name, str(error))
    except FaultError as fault:
        return unknown_point(task.setting, question.name, fault.message)
    if exact is None:
        return limit
    if options.only_uniform and exact.uniform is None:
        reason = "choices were left out, so the value under uniform choices is not known; traces can estimate it"
        return unknown_point(task.setting, question.name, reason) if options.is_exhaustive else limit
    return exact_point(
        task.setting,
        question,
        exact,
        states=exact.states,
        can_get_stuck=exact.can_get_stuck,
        only_uniform=options.only_uniform,
    )


def _estimated(task: _Task, verifier: Verifier, names: Sequence[str]) -> dict[str, ExperimentPoint]:
    """The points of properties with estimates from traces with uniform choices."""
    points = {}
    with Pool(1) as pool:
        for result in verifier.verify_all(pool):
            if result.name not in names:
                continue
            if isinstance(result.outcome, Refused):
                points[result.name] = unknown_point(task.setting, result.name, result.outcome.reason.message)
            elif result.answer is not None:
                stuck = 0 if result.stuck is None else result.stuck.count
                points[result.name] = estimated_point(task.setting, result.answer, stuck)
    for name in names:
        points.setdefault(name, unknown_point(task.setting, name, "no result"))
    return points

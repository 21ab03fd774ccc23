# SPDX-License-Identifier: Apache-2.0
"""The steps that a system takes in simulated runs, for systems with too many states to explore all of them.

First, few runs are simulated: in most right systems, these refute all that a check might find.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from roaml.durations import AT_ONCE
from roaml.interruption import checkpoint
from roaml.jani.model import Model
from roaml.jani.reaction import ReactionError, reacting
from roaml.lower.system import lower
from roaml.project.analysis import Analysis
from roaml.project.exploration import Reached, reached_by, ways_taken, with_reactions
from roaml.project.explored_steps import ExploredWay
from roaml.project.translation import network_of, program_of
from roaml.record import replace
from roaml.smc.batch import TraceProblem
from roaml.smc.end import End
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker
from roaml.smc.program import TRUE
from roaml.smc.record import Recorder, Recording
from roaml.smc.registers import BOOL
from roaml.to_jani import translate
from roaml.views.ends import marks

BATCHES = ((2, 15_000), (20, 15_000), (3, 150_000))
"""The numbers of runs, and the maximum number of their steps. All of them take 0.4 s."""
RUNS_OF_VALUES = 5
"""The number of runs in which values are read."""


class SimulatedFaultError(Exception):
    """A simulated run executes an undefined operation.

    Attributes:
        checker: simulates the run again.
        problem: the operation, and the number of the run.
    """

    def __init__(self, checker: ModelChecker, problem: TraceProblem) -> None:
        super().__init__()
        self.checker = checker
        self.problem = problem


def simulated(analysis: Analysis, path: str, more_time: int = 1) -> Iterator[Reached]:
    """What simulated runs of a system reach, first few runs, then more; first with machines that react at once, then
    with the reaction time of the system.

    Args:
        more_time: how many times the maximum time of the system the runs last.

    Raises:
        SimulatedFaultError: a run executes an undefined operation.
    """
    program = program_of(analysis, path)
    time = program.parameters.max_time
    parameters = replace(program.parameters, max_time=None if time is None else more_time * time)
    model = translate(lower(replace(program, parameters=parameters)), (), ())
    models = [model]
    if model.metadata is not None and model.metadata.clock is not None and model.metadata.reaction_time.is_any:
        try:
            models.insert(0, reacting(model, AT_ONCE))
        except ReactionError:
            return
    for reacting_model in models:
        yield from _runs(reacting_model)


def _runs(model: Model) -> Iterator[Reached]:
    """What growing numbers of runs of a model reach."""
    for checker, taken, runs in _taken(model):
        yield reached_by(model, checker, taken, _ways_of, simulated=runs)


def runs_without_standstill(analysis: Analysis, path: str) -> int:
    """The number of simulated runs of a system in which machines never wait for each other for ever; 0 if they do in
    some run, or if the system cannot be simulated."""
    number = sum(runs for runs, _ in BATCHES)
    for model, _ in with_reactions(translate(network_of(analysis, path), (), ())):
        try:
            checker = ModelChecker(model, (), marks(model))
        except FaultError:
            return 0
        recorder = Recorder(checker, checker.stuck, 0, BATCHES[-1][1])
        for run in range(number):
            recording = Recording(run)
            recorder.rush(recording)
            if recording.verdict == TRUE or recording.problem is not None or recording.end in _STANDSTILLS:
                return 0
            checkpoint()
    return number


_STANDSTILLS = (End.STUCK, End.DEADLOCK)


def _ways_of(model: Model) -> list[ExploredWay] | None:
    """The steps of a model; `None` if an undefined operation is executed."""
    known = None
    try:
        for checker, taken, _ in _taken(model):
            known = checker, taken
    except SimulatedFaultError:
        return None
    return None if known is None else list(ways_taken(*known))


def _taken(model: Model) -> Iterator[tuple[ModelChecker, bytes, int]]:
    """For growing numbers of runs: a model checker, whether each way of an edge is taken, and the number of runs.

    Raises:
        SimulatedFaultError: a run executes an undefined operation.
    """
    try:
        checker = ModelChecker(model, (), marks(model))
    except FaultError:
        return
    taken = bytearray(len(checker.legend.ways))
    first = 0
    for runs, most_steps in BATCHES:
        recorder = Recorder(checker, checker.stuck, 0, most_steps)
        for run in range(first, first + runs):
            recording = Recording(run)
            for _, ways in recorder.taken(recording):
                for _, way in ways:
                    taken[way] = 1
            if recording.problem is not None:
                raise SimulatedFaultError(checker, recording.problem)
            checkpoint()
        first += runs
        yield checker, bytes(taken), first


def seen_values(model: Model, automaton: str, location: str, names: Collection[str]) -> str:
    """The values of variables of an automaton when it is in a location, in simulated runs, as a clause for users; "" if
    none of them is a number or a truth value."""
    checker = ModelChecker(model, (), marks(model))
    instances = checker.legend.layout.instances
    number = next(i for i, instance in enumerate(instances) if instance.automaton.name == automaton)
    variables = [storage for storage in instances[number].own if storage.name in names and not storage.shape]
    recorder = Recorder(checker, checker.stuck, 0, BATCHES[0][1])
    seen: list[set[float]] = [set() for _ in variables]
    for run in range(RUNS_OF_VALUES):
        for values in recorder.follow(Recording(run), variables):
            if recorder.location(number) == location:
                for known, value in zip(seen, values, strict=True):
                    known.add(value)
    return ", ".join(_range(s.name, s.kind, values) for s, values in zip(variables, seen, strict=True) if values)


def _range(name: str, kind: str, values: set[float]) -> str:
    """The range of the values of a variable, as a clause."""
    least, greatest = min(values), max(values)
    if kind == BOOL:
        return f"`{name}` is {'true or false' if greatest > least else 'always true' if least else 'always false'}"
    return f"`{name}` is {least:g}" if least == greatest else f"`{name}` is between {least:g} and {greatest:g}"

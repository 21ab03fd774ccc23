# SPDX-License-Identifier: Apache-2.0
"""A trace that is simulated again step by step, with the edges taken, the changes, and the places in the model from
which they come."""

from __future__ import annotations

import math
from array import array
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import NamedTuple, TypeAlias

from roaml.exhaustive import Vocabulary
from roaml.jani.constants import constant_values
from roaml.jani.model import Automaton, Destination, Edge, System
from roaml.jani.types import Type, element_of, is_text
from roaml.record import Record
from roaml.smc.batch import TraceProblem
from roaml.smc.compile import Legend
from roaml.smc.end import End
from roaml.smc.goal import CompiledProperty
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.names import Storage, read_by, variables_in
from roaml.smc.program import FALSE, FAULTY, TRUE, UNKNOWN
from roaml.smc.registers import BOOL, REAL
from roaml.smc.rounds import Rounds, limits
from roaml.smc.standstill import Standstill

Plain: TypeAlias = "bool | int | float | list[Plain]"
"""A value as the model stores it: an array with unused elements, a string as `StoredText`."""


class StoredText(list[Plain]):
    """The stored bytes of a string: an array whose type is marked as text (`roaml.jani.types.ArrayType`)."""


SHORTEST = -1
"""The number of the shortest possible trace, which is not generated at random."""
SELECTED = -2
"""The number of a trace that is neither generated at random nor necessarily the shortest one."""


class TraceVerdict(Vocabulary):
    """The verdict of a trace on a property, as the results name it."""

    PASSED = "passed"
    FAILED = "failed"
    UNDECIDED = "undecided"
    FAULT = "fault"


VERDICTS = {
    TRUE: TraceVerdict.PASSED,
    FALSE: TraceVerdict.FAILED,
    UNKNOWN: TraceVerdict.UNDECIDED,
    FAULTY: TraceVerdict.FAULT,
}
"""The verdict of the kernel -> the verdict in results."""


class RecordedVariable(NamedTuple):
    """A variable of the model (`instance` is -1) or of an instance."""

    instance: int
    name: str


class AutomatonStep(NamedTuple):
    """The part of one automaton in a step."""

    instance: int
    automaton: str
    source: str
    edge: Edge
    destination: Destination


class VariableChange(NamedTuple):
    variable: RecordedVariable
    before: Plain
    after: Plain


class TraceStep(Record, frozen=True):
    """A step. `number` is 1 for the first one; `action` is `None` if the step has no action."""

    number: int
    action: str | None
    parts: tuple[AutomatonStep, ...]
    changes: tuple[VariableChange, ...]


class Recording(Record):
    """A trace that is simulated again. `verdict` and `end` are set when it is complete, `problem` if it failed."""

    trace: int
    verdict: int = UNKNOWN
    end: End = End.CUT
    problem: TraceProblem | None = None


class StepReader:
    """Reads the last step from a kernel.

    Attributes:
        variables: the variables of the model, then those of each instance, with their registers.
    """

    def __init__(self, kernel: Kernel, legend: Legend) -> None:
        self._kernel = kernel
        self.legend = legend
        layout = legend.layout
        self.variables: list[tuple[RecordedVariable, Storage]] = [
            (RecordedVariable(-1, s.name), s) for s in layout.shared
        ]
        for number, instance in enumerate(layout.instances):
            self.variables += [(RecordedVariable(number, s.name), s) for s in instance.own]
        self._owner_of_int: dict[int, int] = {}
        self._owner_of_real: dict[int, int] = {}
        for position, (_, storage) in enumerate(self.variables):
            size = 1
            for length in storage.shape:
                size *= length
            owner = self._owner_of_real if storage.kind == REAL else self._owner_of_int
            owner.update((register, position) for register in range(storage.base, storage.base + size))
        self.start()

    def start(self) -> None:
        """Make the current state the state before the next step."""
        ints, reals = self._kernel.snapshot()
        self._ints, self._reals = array("q", ints), array("d", reals)

    def read(self, number: int) -> TraceStep:
        """The step from the previous state to the current one. The current state becomes the previous one of the next
        call."""
        _, action = self.legend.vectors[self._kernel.vector]
        parts = tuple(self._part(instance, way) for instance, way in self._kernel.taken())
        return TraceStep(number, action, parts, self._changes())

    def change(self, number: int, action: str | None) -> TraceStep:
        """A step that no automaton has taken, because the user has changed the state."""
        return TraceStep(number, action, (), self._changes())

    def values(self, storages: Sequence[Storage]) -> list[Plain]:
        """The values of the variables in the current state."""
        ints, reals = self._kernel.snapshot()
        return [_value(storage, reals if storage.kind == REAL else ints) for storage in storages]

    def _part(self, instance: int, way: int) -> AutomatonStep:
        edge, destination = self.legend.ways[way]
        automaton = self.legend.layout.instances[instance].automaton
        return AutomatonStep(instance, automaton.name, edge.source, edge, destination)

    def _changes(self) -> tuple[VariableChange, ...]:
        """The variables that differ from the previous state, which becomes the current one. The kernel compares the
        states, because a model may have thousands of variables of which a step changes three."""
        ints, reals = self._kernel.changed(self._ints, self._reals)
        positions = sorted({self._owner_of_int[i] for i in ints} | {self._owner_of_real[i] for i in reals})
        changed = [self.variables[position] for position in positions]
        before = [self._previous(storage) for _, storage in changed]
        for i in ints:
            self._ints[i] = self._kernel.integer(i)
        for i in reals:
            self._reals[i] = self._kernel.real(i)
        return tuple(
            VariableChange(variable, old, self._previous(storage))
            for (variable, storage), old in zip(changed, before, strict=True)
        )

    def _previous(self, storage: Storage) -> Plain:
        """The value of a variable in the state that was read last."""
        return _value(storage, self._reals if storage.kind == REAL else self._ints)

    def standstill(self, system: System) -> Standstill:
        """The current state, as input for the analysis of which automaton waits for which."""
        kernel, legend = self._kernel, self.legend
        instances = legend.layout.instances
        return Standstill(
            tuple(instance.automaton for instance in instances),
            tuple(legend.locations[kernel.location(number)][1] for number in range(len(instances))),
            tuple(tuple(legend.ways[way][0] for way in kernel.open_ways(n)) for n in range(len(instances))),
            system,
        )


class Recorder:
    """Simulates single traces for a property."""

    def __init__(
        self, checker: ModelChecker, property_: CompiledProperty, seed: int, max_steps: int, scheduler: int = 0
    ) -> None:
        compiled = checker.compiled(property_)
        self.legend = checker.legend
        self.system = checker.model.system
        self.constants = constant_values(checker.model)
        self._marks = compiled.program.location_mark
        self.compiled_property = property_
        self.seed = seed
        self.max_steps = max_steps
        self.scheduler = scheduler
        self._kernel = Kernel(compiled.program, compiled.goal)
        self._rounds = Rounds(compiled)
        self._steps = StepReader(self._kernel, checker.legend)

    @property
    def shared(self) -> list[Storage]:
        """The variables of the model."""
        return list(self.legend.layout.shared)

    @property
    def automata(self) -> tuple[Automaton, ...]:
        """The automaton of each instance."""
        return tuple(instance.automaton for instance in self.legend.layout.instances)

    def values(self, storages: Sequence[Storage]) -> list[Plain]:
        """The values of the variables in the current state."""
        return self._steps.values(storages)

    def integer(self, storage: Storage) -> int:
        """The value of a variable with an integer in the current state."""
        return self._kernel.integer(storage.base)

    def location(self, instance: int) -> str:
        """The name of the current location of an instance, by its number."""
        return self.legend.locations[self._kernel.location(instance)][1]

    def initial(self, storages: Sequence[Storage], trace: int) -> list[Plain]:
        """The initial values of the variables in a trace."""
        self._kernel.begin(self.seed, trace, self.scheduler)
        return self.values(storages)

    def rush(self, recording: Recording) -> None:
        """Simulate a trace to its end, without recording its steps."""
        kernel = self._kernel
        verdict = kernel.begin(self.seed, recording.trace, self.scheduler)
        for limit in limits(self.max_steps):
            if verdict == UNKNOWN and kernel.ending() == End.DECIDED:
                verdict = self._checked(kernel.advance(limit), recording)
        self._finish(recording, verdict)

    def walk(self, recording: Recording) -> Iterator[TraceStep]:
        """The steps of a trace. During the iteration, `values` returns the values after each step."""
        for number in self._run(recording):
            if number == 0:
                self._steps.start()
            else:
                yield self._steps.read(number)

    def follow(self, recording: Recording, storages: Sequence[Storage]) -> Iterator[list[float]]:
        """The values of scalar variables at the start of a trace and after each step. It is much faster than `walk`."""
        kernel = self._kernel
        places = [(storage.kind == REAL, storage.base) for storage in storages]
        for _ in self._run(recording):
            yield [kernel.real(base) if is_real else float(kernel.integer(base)) for is_real, base in places]

    def taken(self, recording: Recording) -> Iterator[tuple[int, Sequence[tuple[int, int]]]]:
        """What is taken in each step of a trace: the index of the synchronisation in `Legend.vectors`, and for each
        instance that takes part, its number and the index in `Legend.ways`. It is much faster than `walk`."""
        kernel = self._kernel
        for number in self._run(recording):
            if number > 0:
                yield kernel.vector, kernel.taken()

    def options(self, trace: int, steps: Collection[int]) -> Mapping[int, Mapping[int, int]]:
        """Among how many steps the scheduler chose for each instance: index of a step -> number of an instance -> the
        number of enabled steps in which it takes part. Instances with one step are left out.

        Args:
            steps: the indices of the steps that are considered.
        """
        wanted = frozenset(steps)
        return {i: self._options() for i in self._run(Recording(trace)) if i in wanted}

    def _options(self) -> Mapping[int, int]:
        counts = Counter[int]()
        for vector, _, slots in self._kernel.choices():
            number = math.prod(map(len, slots))
            for slot in self.legend.vectors[vector][0]:
                counts[self.legend.slots[slot].instance] += number
        return {instance: count for instance, count in counts.items() if count > 1}

    def _run(self, recording: Recording) -> Iterator[int]:
        """Simulate a trace: 0 at its start, then the number of each step that was taken."""
        kernel, done = self._kernel, 0
        verdict = kernel.begin(self.seed, recording.trace, self.scheduler)
        checks = frozenset(limits(self.max_steps))
        yield 0
        while verdict == UNKNOWN and done < self.max_steps:
            verdict = kernel.advance(done + 1)
            if verdict == FAULTY or kernel.outcome()[0] == done:
                break
            done += 1
            yield done
            if done in checks:
                verdict = self._checked(verdict, recording)
        self._finish(recording, verdict)

    def steps_and_reward(self) -> tuple[int, float]:
        """The number of steps of the last trace, and its reward."""
        steps, _, reward = self._kernel.outcome()
        return steps, reward

    def _checked(self, verdict: int, recording: Recording) -> int:
        """The verdict after a number of steps at which traces are examined (`rounds`)."""
        if verdict != UNKNOWN or self.scheduler != 0 or self._kernel.ending() != End.DECIDED:
            return verdict
        return self._rounds.check(self._kernel, self.seed, recording.trace)

    def _finish(self, recording: Recording, verdict: int) -> None:
        recording.verdict = verdict
        recording.end = End(self._kernel.ending() or End.CUT) if verdict == UNKNOWN else End(self._kernel.ending())
        if verdict == FAULTY:
            recording.problem = TraceProblem(recording.trace, *self._kernel.problem())

    def standstill(self) -> Standstill:
        """The final state of the last trace, as input for the analysis of which automaton waits for which."""
        return self._steps.standstill(self.system)

    def causes_of(self, end: End) -> list[int]:
        """The instances whose final locations are the reason for which the last trace ended."""
        places = [self._kernel.location(i) for i in range(len(self.legend.layout.instances))]
        return [i for i, place in enumerate(places) if self._marks[place] == end]

    def reads(self, part: AutomatonStep) -> set[RecordedVariable]:
        """The variables on which a part of a step depends."""
        layout = self.legend.layout.instances[part.instance]
        read_names = set() if part.edge.guard is None else variables_in(part.edge.guard.exp, layout.names.functions)
        for assignment in part.destination.assignments:
            read_names |= read_by(assignment, layout.names.functions)
        own = {storage.name for storage in layout.own}
        return {RecordedVariable(part.instance if name in own else -1, name) for name in read_names}


def _value(storage: Storage, cells: Sequence[int] | Sequence[float]) -> Plain:
    return _part_of(cells, storage.base, storage.shape, storage.kind, storage.type)


def _part_of(
    cells: Sequence[int] | Sequence[float], base: int, shape: tuple[int, ...], kind: str, type_: Type
) -> Plain:
    if not shape:
        return bool(cells[base]) if kind == BOOL else cells[base]
    size = 1
    for length in shape[1:]:
        size *= length
    element = element_of(type_)
    parts = [_part_of(cells, base + i * size, shape[1:], kind, element) for i in range(shape[0])]
    return StoredText(parts) if is_text(type_) else parts

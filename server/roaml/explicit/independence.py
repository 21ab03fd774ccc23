# SPDX-License-Identifier: Apache-2.0
"""Which synchronisation vectors of a program depend on one another, and for which goals a search may leave choices out
(docs/spec/reductions.md#independent-steps).

Two vectors are *dependent* if an instance takes part in both, or if one of them writes a variable that the other one
reads or writes. All tables are computed from the model alone; `ample` combines them with a state.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from functools import cached_property

from roaml.explicit.uses import VariableUses, bits
from roaml.record import Record
from roaml.smc.compile import Legend
from roaml.smc.goal import DEADLOCK, NO_DEADLOCK, STUCK
from roaml.smc.network import EdgeStep
from roaml.smc.program import AT_END, Goal, Ints, Program

NEVER, HIDDEN, WRITES = 0, 1, 2
"""Whether a vector may be taken alone: never; always, as far as the goal can see it; if it changes no value."""
MAX_DEPENDENT_VECTORS = 64
"""The maximum number of vectors of other instances that depend on the edges of a location for a reduction there."""


class Independence(Record, frozen=True, eq=False):
    """Tables about a program and a goal. `program` defines groups, slots and vectors.

    Attributes:
        slot_start, slot_vector: the vectors of each slot.
        hidden: for each group, whether a vector may be taken alone because of it: NEVER if more than
            MAX_DEPENDENT_VECTORS vectors of other instances depend on it, WRITES if its edges write a variable that the
            goal reads, and HIDDEN otherwise.
        dependent_start, dependent_vector: for each group that is not NEVER, the vectors of other instances that depend
            on it, or that change the value of a guard that can be undefined and reads what the group writes, or have it
            evaluated.
        guard_start, guard_vector: for each group, the vectors of other instances that write a variable in its guards.
        open_guards: for each slot, whether one of its groups has such vectors.
        own_start, own_slot: the slots of each vector that are in no other vector.
        gates_start, gates: the gates of each vector (`roaml.smc.kernel` defines gates).
        gate_slot_start, gate_slot: the slots of each gate.
        group_place: for each group, its location.
        stirred_start, stirred: for each vector, the variables in guards that it writes; they are numbered apart.
        guarded_start, guarded: for each of these variables, the groups whose guards read it.
        alarm_start, alarm: for each vector, one group of each location of another instance in which a guard that can
            be undefined reads a variable that the vector writes.
        read_start, read: for each group, the variables that its edges read, and those in guards of its location that
            can be undefined.
        written_start, written: for each group, the variables that its edges write.
        variables: the number of variables.
        random_vector: the vectors in whose steps chance may decide between several destinations.
        is_fleeting: whether a state with only one choice need not be a state of the search: the goal does not depend on
            conditions that hold in a state for ever.
    """

    slot_start: Ints
    slot_vector: Ints
    hidden: Ints
    dependent_start: Ints
    dependent_vector: Ints
    guard_start: Ints
    guard_vector: Ints
    open_guards: Ints
    own_start: Ints
    own_slot: Ints
    gates_start: Ints
    gates: Ints
    gate_slot_start: Ints
    gate_slot: Ints
    group_place: Ints
    stirred_start: Ints
    stirred: Ints
    guarded_start: Ints
    guarded: Ints
    alarm_start: Ints
    alarm: Ints
    read_start: Ints
    read: Ints
    written_start: Ints
    written: Ints
    variables: int
    random_vector: Ints
    is_fleeting: bool


def can_be_reduced(program: Program, goal: Goal) -> bool:
    """Whether the minimum and the maximum of a goal stay the same if independent choices are left out
    (docs/spec/reductions.md#goals)."""
    has_rewards = goal.step_reward >= 0 or goal.exit_reward >= 0 or len(goal.sum_register) > 0
    has_bounds = any(bound >= 0 for bound in goal.upper) or any(bound not in (0, AT_END) for bound in goal.lower)
    sides = [*goal.left, *goal.right]
    mixes_deadlocks = any(side in (DEADLOCK, NO_DEADLOCK) for side in sides) and any(side >= 0 for side in sides)
    is_transient = program.settle >= 0 or any(code >= 0 for code in program.location_code)
    is_idle = STUCK in goal.right and _can_idle(program)
    return not (has_rewards or has_bounds or mixes_deadlocks or is_transient or is_idle)


def _can_idle(program: Program) -> bool:
    """Whether a vector may leave the state unchanged: each of its participants has an edge that leads back to its own
    location."""
    staying = set()
    for group, slot in enumerate(program.group_slot):
        first, last = program.edge_start[group], program.edge_start[group + 1]
        ways = range(program.way_start[first], program.way_start[last])
        if any(program.way_move[way] < 0 for way in ways):
            staying.add(slot)
    return any(
        staying.issuperset(program.active_slot[program.active_start[vector] : program.active_start[vector + 1]])
        for vector in range(len(program.active_start) - 1)
    )


class _Group(Record, frozen=True):
    """The variables that the edges of a group use. `fragile` are those in guards that can be undefined."""

    reads: int
    writes: int
    guards: int
    fragile: int


class IndependenceAnalysis:
    """Determines the tables of a program for goals. Sets of vectors are integers, as the sets of variables of
    `uses`."""

    def __init__(self, program: Program, legend: Legend, uses: VariableUses) -> None:
        self.program = program
        self.legend = legend
        self.uses = uses
        reads, writes = [0] * len(legend.slots), [0] * len(legend.slots)
        self.random_vector = _random_vectors(program)
        self.groups: list[_Group] = []
        for location in range(len(legend.locations)):
            for slot in program.group_slot[program.group_start[location] : program.group_start[location + 1]]:
                group = self._group(legend.slots[slot].instance, legend.slots[slot].steps[location])
                self.groups.append(group)
                reads[slot] |= group.reads
                writes[slot] |= group.writes
        self.vectors_of_instance = [0] * program.instances
        self.readers: dict[int, int] = {}
        self.writers: dict[int, int] = {}
        for vector, (slots, _) in enumerate(legend.vectors):
            for slot in slots:
                self.vectors_of_instance[legend.slots[slot].instance] |= 1 << vector
                for users, variables in ((self.readers, reads[slot]), (self.writers, writes[slot])):
                    for variable in bits(variables):
                        users[variable] = users.get(variable, 0) | 1 << vector

    @cached_property
    def _uses_of_groups(self) -> tuple[Ints, Ints, Ints, Ints, Ints, Ints, Ints, Ints, Ints, Ints, Ints]:
        """The attributes of the tables from `group_place` to `written`."""
        program = self.program
        places = array("i")
        reads = list[int]()
        guarded: dict[int, list[int]] = {}
        alarms: list[list[int]] = [[] for _ in self.legend.vectors]
        for location, (instance, _) in enumerate(self.legend.locations):
            fragile = self._fragile(location)
            for number in range(program.group_start[location], program.group_start[location + 1]):
                places.append(location)
                for variable in bits(self.groups[number].guards):
                    if variable in self.writers:
                        guarded.setdefault(variable, []).append(number)
            for number in range(program.group_start[location], program.group_start[location + 1]):
                reads.append(self.groups[number].reads | fragile)
            for vector in bits(_union(self.writers, fragile) & ~self.vectors_of_instance[instance]):
                alarms[vector].append(program.group_start[location])
        stirred: list[list[int]] = [[] for _ in self.legend.vectors]
        for number, variable in enumerate(guarded):
            for vector in bits(self.writers[variable]):
                stirred[vector].append(number)
        return (
            places,
            *_ranges(stirred),
            *_ranges(guarded.values()),
            *_ranges(alarms),
            *_ranges(bits(mask) for mask in reads),
            *_ranges(bits(group.writes) for group in self.groups),
        )

    @cached_property
    def _evaluations(self) -> dict[int, dict[int, int]]:
        """For each variable in guards that can be undefined, and each instance with such guards: the vectors that lead
        to the location of such a guard, or write a variable in one of the guards that can be undefined there. Without
        them, none of these guards is evaluated that was not before, or with new values."""
        program = self.program
        vectors_of_slot = [sum(1 << vector for vector in slot.vectors) for slot in self.legend.slots]
        entering = [0] * len(self.legend.locations)
        for number, slot in enumerate(program.group_slot):
            first, last = program.edge_start[number], program.edge_start[number + 1]
            for way in range(program.way_start[first], program.way_start[last]):
                if program.way_move[way] >= 0:
                    entering[program.way_target[way]] |= vectors_of_slot[slot]
        found: dict[int, dict[int, int]] = {}
        for location, (instance, _) in enumerate(self.legend.locations):
            fragile = self._fragile(location)
            vectors = entering[location] | _union(self.writers, fragile)
            for variable in bits(fragile):
                of_variable = found.setdefault(variable, {})
                of_variable[instance] = of_variable.get(instance, 0) | vectors
        return found

    def _fragile(self, location: int) -> int:
        """The variables in guards of a location that can be undefined."""
        fragile = 0
        for number in range(self.program.group_start[location], self.program.group_start[location + 1]):
            fragile |= self.groups[number].fragile
        return fragile

    def _group(self, instance: int, steps: Iterable[EdgeStep]) -> _Group:
        reads = writes = guards = fragile = 0
        for step in steps:
            if step.guard is not None:
                read = self.uses.read_in(step.guard, instance)
                guards |= read
                if read and self.uses.can_fail(step.guard, instance):
                    fragile |= read
            for way in step.ways:
                if way.probability is None and way.destination.probability is not None:
                    reads |= self.uses.read_in(way.destination.probability.exp, instance)
                for assignment in way.destination.assignments:
                    reads |= self.uses.read_by(assignment, instance)
                    writes |= self.uses.written_by(assignment, instance)
        return _Group(reads | guards, writes, guards, fragile)

    def tables(self, goal: Goal) -> Independence:
        """The tables for a goal that can be reduced."""
        program = self.program
        visible = self.uses.of(
            storage
            for storage in self.legend.layout.storages
            if storage.watch >= 0 and goal.seen_start[storage.watch] < goal.seen_start[storage.watch + 1]
        )
        hidden: list[int] = []
        dependent_lists: list[Iterable[int]] = []
        guard_lists: list[Iterable[int]] = []
        open_guards = [0] * len(self.legend.slots)
        for location, (instance, _) in enumerate(self.legend.locations):
            own = self.vectors_of_instance[instance]
            numbers = range(program.group_start[location], program.group_start[location + 1])
            fragile = self._fragile(location)
            for number in numbers:
                group = self.groups[number]
                dependent = _union(self.writers, group.reads | group.writes | fragile)
                dependent |= _union(self.readers, group.writes)
                for variable in bits(group.writes):
                    for other, vectors in self._evaluations.get(variable, {}).items():
                        dependent |= vectors if other != instance else 0
                dependent &= ~own
                kind = NEVER
                if dependent.bit_count() <= MAX_DEPENDENT_VECTORS:
                    kind = WRITES if group.writes & visible else HIDDEN
                hidden.append(kind)
                dependent_lists.append(bits(dependent) if kind != NEVER else ())
                writers = _union(self.writers, group.guards) & ~own
                guard_lists.append(bits(writers))
                if writers:
                    open_guards[program.group_slot[number]] = 1
        return Independence(
            *_ranges(slot.vectors for slot in self.legend.slots),
            array("i", hidden),
            *_ranges(dependent_lists),
            *_ranges(guard_lists),
            array("i", open_guards),
            *_participants(program),
            *self._uses_of_groups,
            len(self.legend.layout.storages),
            self.random_vector,
            is_fleeting=AT_END not in goal.lower,
        )


def _random_vectors(program: Program) -> Ints:
    """The vectors with a participant that has an edge with several destinations."""
    slots = set()
    for group, slot in enumerate(program.group_slot):
        edges = range(program.edge_start[group], program.edge_start[group + 1])
        if any(program.way_start[edge + 1] - program.way_start[edge] > 1 for edge in edges):
            slots.add(slot)
    vectors = range(len(program.active_start) - 1)
    return array(
        "i",
        [
            v
            for v in vectors
            if not slots.isdisjoint(program.active_slot[program.active_start[v] : program.active_start[v + 1]])
        ],
    )


def _participants(program: Program) -> tuple[Ints, Ints, Ints, Ints, Ints, Ints]:
    """`own_start`, `own_slot`, `gates_start`, `gates`, `gate_slot_start` and `gate_slot`."""
    gates = range(len(program.gate_start) - 1)
    own: list[list[int]] = [[] for _ in program.vector_missing]
    gates_of: list[list[int]] = [[] for _ in program.vector_missing]
    slots_of: list[list[int]] = [[] for _ in gates]
    for slot, number in enumerate(program.slot_vector):
        if number >= 0:
            own[number].append(slot)
        elif number <= -2:
            slots_of[-2 - number].append(slot)
    for gate in gates:
        for vector in program.gate_vector[program.gate_start[gate] : program.gate_start[gate + 1]]:
            gates_of[vector].append(gate)
    return *_ranges(own), *_ranges(gates_of), *_ranges(slots_of)


def _union(vectors: dict[int, int], variables: int) -> int:
    """The vectors that one of the variables has in a dictionary."""
    found = 0
    for variable in bits(variables):
        found |= vectors.get(variable, 0)
    return found


def _ranges(lists: Iterable[Iterable[int]]) -> tuple[Ints, Ints]:
    starts, items = array("i", [0]), array("i")
    for numbers in lists:
        items.extend(numbers)
        starts.append(len(items))
    return starts, items

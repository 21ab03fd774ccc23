# SPDX-License-Identifier: Apache-2.0
"""Which synchronisation vectors of a program depend on one another, and for which goals a search may leave choices out
(docs/spec/reductions.md#independent-steps).

Two vectors are *dependent* if an instance takes part in both, or if one of them writes a variable that the other one
reads or writes. All tables are computed from the model alone; `ample` combines them with a state.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable

from roaml.jani.expressions import Binary, Boolean, Expression, Integer, Name, Real, Unary, walk
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.record import Record
from roaml.smc.compile import Legend
from roaml.smc.goal import DEADLOCK, NO_DEADLOCK, STUCK
from roaml.smc.names import Storage, StorageNames, read_by, variables_in
from roaml.smc.network import EdgeStep, root
from roaml.smc.program import AT_END, Goal, Ints, Program

MAX_DEPENDENT_VECTORS = 64
"""The maximum number of vectors of other instances that depend on the edges of a location for a reduction there."""
_TOTAL = {
    UnaryOperator.NOT,
    BinaryOperator.AND,
    BinaryOperator.OR,
    BinaryOperator.IMPLIES,
    BinaryOperator.EQUAL,
    BinaryOperator.NOT_EQUAL,
    BinaryOperator.LESS,
    BinaryOperator.LESS_EQUAL,
    BinaryOperator.GREATER,
    BinaryOperator.GREATER_EQUAL,
}
"""Operators that are defined for all values."""


class Independence(Record, frozen=True, eq=False):
    """Tables about a program and a goal. `program` defines groups, slots and vectors.

    Attributes:
        slot_start, slot_vector: the vectors of each slot.
        hidden: for each group, whether a vector may be taken alone because of it: none of its edges writes a variable
            that the goal reads, and at most MAX_DEPENDENT_VECTORS vectors of other instances depend on it.
        dependent_start, dependent_vector: for each of these groups, the vectors of other instances that depend on it.
        guard_start, guard_vector: for each group, the vectors of other instances that write a variable in its guards.
        open_guards: for each slot, whether one of its groups has such vectors.
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


def independence_of(program: Program, goal: Goal, legend: Legend) -> Independence:
    """The tables of a program with a goal that can be reduced."""
    return _Analysis(program, goal, legend).tables()


class _Use(Record):
    """The variables that edges read and write, as `id` of their storage."""

    reads: set[int]
    writes: set[int]


class _Analysis:
    def __init__(self, program: Program, goal: Goal, legend: Legend) -> None:
        self.program = program
        self.goal = goal
        self.legend = legend
        self.slot_uses = [_Use(set(), set()) for _ in legend.slots]
        self.groups: list[_Use] = []
        self.guards: list[set[int]] = []
        self.fragile: list[set[int]] = []
        for location in range(len(legend.locations)):
            for group in range(program.group_start[location], program.group_start[location + 1]):
                self._read_group(program.group_slot[group], location)
        self.vectors_of_instance: list[set[int]] = [set() for _ in range(program.instances)]
        self.readers: dict[int, set[int]] = {}
        self.writers: dict[int, set[int]] = {}
        for vector, (slots, _) in enumerate(legend.vectors):
            for slot in slots:
                self.vectors_of_instance[legend.slots[slot].instance].add(vector)
                for variable in self.slot_uses[slot].reads:
                    self.readers.setdefault(variable, set()).add(vector)
                for variable in self.slot_uses[slot].writes:
                    self.writers.setdefault(variable, set()).add(vector)

    def _read_group(self, number: int, location: int) -> None:
        slot = self.legend.slots[number]
        names = self.legend.layout.instances[slot.instance].names
        use, guards, fragile = _Use(set(), set()), set[int](), set[int]()
        for step in slot.steps[location]:
            if step.guard is not None:
                read = set(_variables(variables_in(step.guard, names.functions), names))
                guards |= read
                if not _is_total(step.guard):
                    fragile |= read
            _read_ways(step, names, use)
        use.reads.update(guards)
        self.groups.append(use)
        self.guards.append(guards)
        self.fragile.append(fragile)
        self.slot_uses[number].reads.update(use.reads)
        self.slot_uses[number].writes.update(use.writes)

    def tables(self) -> Independence:
        program, goal = self.program, self.goal
        visible = {
            id(storage)
            for storage in self.legend.layout.storages
            if storage.watch >= 0 and goal.seen_start[storage.watch] < goal.seen_start[storage.watch + 1]
        }
        hidden: list[int] = []
        dependent_lists: list[list[int]] = []
        guard_lists: list[list[int]] = []
        open_guards = [0] * len(self.legend.slots)
        for location, (instance, _) in enumerate(self.legend.locations):
            own = self.vectors_of_instance[instance]
            groups = range(program.group_start[location], program.group_start[location + 1])
            fragile: set[int] = set().union(*(self.fragile[group] for group in groups))
            for group in groups:
                use = self.groups[group]
                dependent = self._union(self.writers, use.reads | use.writes | fragile)
                dependent |= self._union(self.readers, use.writes)
                dependent -= own
                is_hidden = not use.writes & visible and len(dependent) <= MAX_DEPENDENT_VECTORS
                hidden.append(int(is_hidden))
                dependent_lists.append(sorted(dependent) if is_hidden else [])
                guard_lists.append(sorted(self._union(self.writers, self.guards[group]) - own))
                if guard_lists[-1]:
                    open_guards[program.group_slot[group]] = 1
        return Independence(
            *_ranges(slot.vectors for slot in self.legend.slots),
            array("i", hidden),
            *_ranges(dependent_lists),
            *_ranges(guard_lists),
            array("i", open_guards),
            is_fleeting=AT_END not in goal.lower,
        )

    @staticmethod
    def _union(vectors: dict[int, set[int]], variables: Iterable[int]) -> set[int]:
        return set().union(*(vectors.get(variable, ()) for variable in variables))


def _read_ways(step: EdgeStep, names: StorageNames, use: _Use) -> None:
    for way in step.ways:
        if way.probability is None and way.destination.probability is not None:
            chance = way.destination.probability.exp
            use.reads.update(_variables(variables_in(chance, names.functions), names))
        for assignment in way.destination.assignments:
            use.reads.update(_variables(read_by(assignment, names.functions), names))
            use.writes.update(_variables((root(assignment),), names))


def _variables(identifiers: Iterable[str], names: StorageNames) -> Iterable[int]:
    for identifier in identifiers:
        storage = names.values.get(identifier)
        if isinstance(storage, Storage) and not storage.is_constant:
            yield id(storage)


def _is_total(guard: Expression) -> bool:
    """Whether the evaluation of a guard is defined in each state."""
    for node in walk(guard):
        match node:
            case Boolean() | Integer() | Real() | Name():
                continue
            case Unary() | Binary() if node.operator in _TOTAL:
                continue
            case _:
                return False
    return True


def _ranges(lists: Iterable[Iterable[int]]) -> tuple[Ints, Ints]:
    starts, items = array("i", [0]), array("i")
    for numbers in lists:
        items.extend(numbers)
        starts.append(len(items))
    return starts, items

# SPDX-License-Identifier: Apache-2.0
"""Which variables are dead in which locations: their values have no influence on what a goal observes.

The definitions and the proof are in docs/spec/reductions.md#dead-variables. A set of variables is an integer; its bits
are the variables in the order of their registers.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import reduce
from itertools import groupby
from operator import and_, attrgetter
from typing import NamedTuple

from roaml.jani.expressions import (
    ArrayAccess,
    ArrayValue,
    Binary,
    Boolean,
    Conditional,
    Expression,
    Integer,
    Name,
    NamedNumber,
    Real,
    Unary,
    walk,
)
from roaml.jani.model import Assignment, Destination
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.record import Record
from roaml.smc.compile import Legend
from roaml.smc.names import Storage, StorageNames
from roaml.smc.network import EdgeStep, root

_TOTAL = frozenset(
    (
        BinaryOperator.OR,
        BinaryOperator.AND,
        BinaryOperator.IMPLIES,
        BinaryOperator.EQUAL,
        BinaryOperator.NOT_EQUAL,
        BinaryOperator.LESS,
        BinaryOperator.LESS_EQUAL,
        BinaryOperator.GREATER,
        BinaryOperator.GREATER_EQUAL,
        BinaryOperator.MINIMUM,
        BinaryOperator.MAXIMUM,
    )
)
"""The operators that have a value for all operands. Integers are limited to 64 bits, so sums are not among them."""
_ATOMS = (Integer, Boolean, Real, NamedNumber, Name, Conditional, ArrayValue)


class Liveness(Record, frozen=True):
    """The dead variables of a model, for a goal.

    Attributes:
        unobserved: the variables that are dead in all states.
        owned: for each instance, the variables that are dead in some of its locations, whatever the locations of the
            other instances are.
        dead: for each location, the variables of `owned` that are dead there.
    """

    unobserved: int
    owned: list[int]
    dead: list[int]


def liveness_of(legend: Legend, observed: Iterable[str], transient: Iterable[Storage]) -> Liveness:
    """The dead variables of a model.

    Args:
        observed: the names of the variables that the goal reads.
        transient: the transient variables.
    """
    return _Analysis(legend, frozenset(observed), transient).liveness()


def all_live(legend: Legend) -> Liveness:
    """The result if no variable is treated as dead."""
    return Liveness(0, [0] * len(legend.layout.instances), [0] * len(legend.locations))


class _Way(NamedTuple):
    """A destination.

    Attributes:
        always: the variables whose values matter in each step to the destination.
        values: pairs of a variable that is written, and the variables on which its new value depends.
        whole: the variables that are written as a whole.
    """

    target: int
    always: int
    values: list[tuple[int, int]]
    whole: int


class _Edge(NamedTuple):
    """An edge.

    Attributes:
        reads: the variables in the guard.
        kept: the variables that are written by ways that stay in the location; -1 if no way stays there.
    """

    reads: int
    ways: list[_Way]
    kept: int


class _Part(NamedTuple):
    """The contribution of some slots to a step, whichever of their edges are taken; see `_Way` and `_Edge`."""

    always: int
    values: dict[int, int]
    whole: int
    kept: int


class _Analysis:
    def __init__(self, legend: Legend, observed: frozenset[str], transient: Iterable[Storage]) -> None:
        self.legend = legend
        self.reads = legend.reads
        self.instances = legend.layout.instances
        bits = {id(storage): 1 << number for number, storage in enumerate(legend.layout.storages)}
        shared = {storage.name: bits[id(storage)] for storage in legend.layout.shared}
        self.scopes = [
            {**shared, **{storage.name: bits[id(storage)] for storage in instance.own}} for instance in self.instances
        ]
        self.locations: list[list[int]] = [[] for _ in self.instances]
        for location, (number, _) in enumerate(legend.locations):
            self.locations[number].append(location)
        self.slots: list[list[int]] = [[] for _ in self.instances]
        for number, slot in enumerate(legend.slots):
            self.slots[slot.instance].append(number)
        self.location_of = {key: number for number, key in enumerate(legend.locations)}
        self.transient = sum(bits[id(storage)] for storage in transient)
        self.observed = sum(bits[id(storage)] for storage in legend.layout.shared if storage.name in observed)
        self.observed |= self._in_locations()
        self.late = self._late()
        self.written = 0
        self.fragile = [0] * len(self.instances)
        self.edges = [
            {
                location: [self._edge(slot.instance, location, step) for step in steps]
                for location, steps in slot.steps.items()
                if slot.vectors
            }
            for slot in legend.slots
        ]
        self.parts = [_part([edge for several in edges.values() for edge in several]) for edges in self.edges]

    def liveness(self) -> Liveness:
        unobserved = self._unobserved()
        owned = self._owned(unobserved)
        dead = [0] * len(self.legend.locations)
        for instance, variables in enumerate(owned):
            if variables:
                for location, live in self._live(instance, variables).items():
                    dead[location] = variables & ~live
        return Liveness(unobserved, owned, dead)

    # ------------------------------------------------------------ what a step reads and writes

    def _mask(self, names: Iterable[str], instance: int) -> int:
        scope, mask = self.scopes[instance], 0
        for name in names:
            mask |= scope.get(name, 0)
        return mask

    def _in_locations(self) -> int:
        """The variables on which the values of transient variables in locations depend."""
        mask = 0
        for number, instance in enumerate(self.instances):
            for location in instance.automaton.locations:
                for value in location.transient_values:
                    mask |= self._mask(self.reads.names_in(value.value, instance.names), number)
                    if isinstance(value.target, ArrayAccess):
                        mask |= self._mask(self.reads.names_in(value.target, instance.names), number)
        return mask

    def _late(self) -> int:
        """The variables that assignments read after other assignments of the same step may have written them."""
        ways = [
            (slot.instance, way.destination)
            for slot in self.legend.slots
            for steps in slot.steps.values()
            for step in steps
            for way in step.ways
        ]
        indices = {assignment.index for _, destination in ways for assignment in destination.assignments}
        if len(indices) < 2:
            return 0
        first, mask = min(indices), 0
        for number, destination in ways:
            for assignment in destination.assignments:
                if assignment.index > first:
                    mask |= self._mask(self.reads.by(assignment, self.instances[number].names), number)
        return mask

    def _edge(self, number: int, source: int, step: EdgeStep) -> _Edge:
        names = self.instances[number].names
        reads, kept, ways = 0, -1, []
        if step.guard is not None:
            reads = self._mask(self.reads.names_in(step.guard, names), number)
            if reads and _can_fail(step.guard, names):
                self.fragile[number] |= reads
        for weighted in step.ways:
            destination = weighted.destination
            if weighted.probability is None and destination.probability is not None:
                reads |= self._mask(self.reads.names_in(destination.probability.exp, names), number)
            target = self.location_of[number, destination.location]
            way, written = self._way(number, target, destination)
            self.written |= written
            if target == source:
                kept = max(kept, 0) | written & ~self.transient
            ways.append(way)
        return _Edge(reads, ways, kept)

    def _way(self, number: int, target: int, destination: Destination) -> tuple[_Way, int]:
        """A destination, and all variables that it writes."""
        scope, names = self.scopes[number], self.instances[number].names
        always, whole, written = 0, 0, 0
        values: list[tuple[int, int]] = []
        for _, group in groupby(sorted(destination.assignments, key=_INDEX), _INDEX):
            replaced = whole
            for assignment in group:
                variable = scope[root(assignment)]
                written |= variable
                if isinstance(assignment.target, Name):
                    whole |= variable
                read = self._mask(self.reads.by(assignment, names), number) & ~replaced
                if not read:
                    continue
                if variable & (self.observed | self.late) or _assignment_can_fail(assignment, names):
                    always |= read
                elif not variable & self.transient:
                    values.append((variable, read))
        return _Way(target, always, values, whole), written

    # ------------------------------------------------------------ slicing

    def _unobserved(self) -> int:
        """The variables that influence neither the goal nor any guard or probability."""
        values: dict[int, int] = {}
        needed = self.observed | self.transient
        for part in self.parts:
            needed |= part.always
            for variable, read in part.values.items():
                values[variable] = values.get(variable, 0) | read
        for slots, _ in self.legend.vectors:
            kept = [self.parts[number].kept for number in slots]
            if min(kept) >= 0:
                for mask in kept:
                    needed |= mask
        is_growing = True
        while is_growing:
            is_growing = False
            for variable, read in values.items():
                if variable & needed and read & ~needed:
                    needed |= read
                    is_growing = True
        return self.written & ~needed

    def _owned(self, unobserved: int) -> list[int]:
        """For each instance, the variables that are read only in steps in which it takes part."""
        candidates = self.written & ~(unobserved | self.observed | self.transient)
        owners: dict[int, int] = {}
        for slots, _ in self.legend.vectors:
            taking_part = 0
            for number in slots:
                taking_part |= 1 << self.legend.slots[number].instance
            for variable in bits(self._read(slots, unobserved) & candidates):
                owners[variable] = owners.get(variable, -1) & taking_part
        for instance, fragile in enumerate(self.fragile):
            for variable in bits(fragile & candidates):
                owners[variable] = owners.get(variable, -1) & 1 << instance
        owned = [0] * len(self.instances)
        for variable, instances in owners.items():
            for instance in bits(instances):
                owned[instance] |= 1 << variable
        return owned

    def _read(self, slots: list[int], unobserved: int) -> int:
        """The variables that may be read in the steps of a vector."""
        part = _joined([self.parts[number] for number in slots])
        mask = part.always | max(part.kept, 0)
        for variable, read in part.values.items():
            if not variable & unobserved:
                mask |= read
        return mask

    # ------------------------------------------------------------ data flow

    def _live(self, instance: int, owned: int) -> dict[int, int]:
        """For each location of an instance, those of its variables that are live there."""
        steps: dict[int, list[tuple[_Edge, list[_Part]]]] = {}
        for number in self.slots[instance]:
            others = [
                _joined([self.parts[other] for other in self.legend.vectors[vector][0] if other != number])
                for vector in self.legend.slots[number].vectors
            ]
            for location, edges in self.edges[number].items():
                steps.setdefault(location, []).extend((edge, others) for edge in edges)
        live = dict.fromkeys(self.locations[instance], 0)
        is_growing = True
        while is_growing:
            is_growing = False
            for location in reversed(live):
                before = live[location]
                for edge, others in steps.get(location, ()):
                    for other in others:
                        before |= self._before(edge, other, live, owned)
                before &= owned
                if before != live[location]:
                    live[location] = before
                    is_growing = True
        return live

    def _before(self, edge: _Edge, other: _Part, live: dict[int, int], owned: int) -> int:
        """The variables that are live before a step of `edge` with `other`, given those that are live afterwards."""
        mask = edge.reads | other.always
        if edge.kept >= 0 and other.kept >= 0:
            mask |= edge.kept | other.kept
        for way in edge.ways:
            after = live[way.target]
            mask |= way.always | after & ~(way.whole | other.whole)
            dead = owned & ~after
            for variable, read in way.values:
                if not variable & dead:
                    mask |= read
            for variable, read in other.values.items():
                if not variable & dead:
                    mask |= read
        return mask


_INDEX = attrgetter("index")


def _part(edges: list[_Edge]) -> _Part:
    """One of several edges, whichever it is."""
    ways = [way for edge in edges for way in edge.ways]
    always, kept = 0, -1
    values: dict[int, int] = {}
    for edge in edges:
        always |= edge.reads
        if edge.kept >= 0:
            kept = max(kept, 0) | edge.kept
    for way in ways:
        always |= way.always
        for variable, read in way.values:
            values[variable] = values.get(variable, 0) | read
    return _Part(always, values, reduce(and_, (way.whole for way in ways)) if ways else 0, kept)


def _joined(parts: list[_Part]) -> _Part:
    """All of several parts, at the same time."""
    if len(parts) == 1:
        return parts[0]
    always, whole, kept = 0, 0, 0
    values: dict[int, int] = {}
    for part in parts:
        always |= part.always
        whole |= part.whole
        kept = kept | part.kept if kept >= 0 and part.kept >= 0 else -1
        for variable, read in part.values.items():
            values[variable] = values.get(variable, 0) | read
    return _Part(always, values, whole, kept)


def bits(mask: int) -> Iterator[int]:
    """The numbers of the elements of a set, in ascending order."""
    while mask:
        bit = mask & -mask
        yield bit.bit_length() - 1
        mask ^= bit


def _assignment_can_fail(assignment: Assignment, names: StorageNames) -> bool:
    """Whether an assignment is an undefined operation in some states."""
    meaning = names.values[root(assignment)]
    assert isinstance(meaning, Storage)
    if meaning.bounds != (None, None):
        return True
    return _can_fail(assignment.value, names) or _can_fail(assignment.target, names)


def _can_fail(expression: Expression, names: StorageNames) -> bool:
    """Whether an expression has no value in some states. In doubt, it can fail."""
    for node in walk(expression):
        match node:
            case Unary(UnaryOperator.NOT):
                pass
            case Binary(operator) if operator in _TOTAL:
                pass
            case ArrayAccess(Name(name), Integer(index)):
                meaning = names.values.get(name)
                if not isinstance(meaning, Storage) or not meaning.shape or not 0 <= index < meaning.shape[0]:
                    return True
            case _ if not isinstance(node, _ATOMS):
                return True
    return False

# SPDX-License-Identifier: Apache-2.0
"""Which variables are dead in which locations: their values have no influence on what a goal observes.

The definitions and the proof are in docs/spec/reductions.md#dead-variables. Sets of variables are those of `uses`.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce
from itertools import accumulate, groupby
from operator import attrgetter
from typing import NamedTuple

from roaml.explicit.uses import VariableUses, bits
from roaml.jani.expressions import ArrayAccess, Name
from roaml.jani.model import Assignment, Destination
from roaml.record import Record
from roaml.smc.compile import Legend
from roaml.smc.names import Storage
from roaml.smc.network import EdgeStep


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


def all_live(legend: Legend) -> Liveness:
    """The result if no variable is treated as dead."""
    return Liveness(0, [0] * len(legend.layout.instances), [0] * len(legend.locations))


class _Way(Record, frozen=True):
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


class _Edge(Record, frozen=True):
    """An edge.

    Attributes:
        reads: the variables in the guard.
        kept: the variables that are written by ways that stay in the location; -1 if no way stays there.
    """

    reads: int
    ways: list[_Way]
    kept: int


class _Part(Record, frozen=True):
    """The contribution of some slots to a step, whichever of their edges are taken; see `_Way` and `_Edge`."""

    always: int
    values: dict[int, int]
    whole: int
    kept: int


class LivenessAnalysis:
    """Determines the dead variables of a model for goals.

    Args:
        transient: the transient variables.
        seen: the transient variables that the goals read.
    """

    def __init__(self, legend: Legend, uses: VariableUses, transient: Iterable[Storage], seen: int) -> None:
        self.legend = legend
        self.uses = uses
        self.instances = legend.layout.instances
        self.locations: list[list[int]] = [[] for _ in self.instances]
        for location, (number, _) in enumerate(legend.locations):
            self.locations[number].append(location)
        self.slots: list[list[int]] = [[] for _ in self.instances]
        for number, slot in enumerate(legend.slots):
            self.slots[slot.instance].append(number)
        self.location_of = {key: number for number, key in enumerate(legend.locations)}
        self.transient = self.uses.of(transient)
        self.in_locations = self._in_locations()
        self.always_read = seen | self.in_locations
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
        self.others: dict[int, dict[int, _Part]] = {}

    def liveness(self, observed: int) -> Liveness:
        """The dead variables for a goal that reads the variables `observed`."""
        observed |= self.in_locations
        unobserved = self._unobserved(observed)
        owned = self._owned(observed, unobserved)
        dead = [0] * len(self.legend.locations)
        for instance, variables in enumerate(owned):
            if variables:
                for location, live in self._live(instance, variables).items():
                    dead[location] = variables & ~live
        return Liveness(unobserved, owned, dead)

    # ------------------------------------------------------------ what a step reads and writes

    def _in_locations(self) -> int:
        """The variables on which the values of transient variables in locations depend."""
        mask = 0
        for number, instance in enumerate(self.instances):
            for location in instance.automaton.locations:
                for value in location.transient_values:
                    mask |= self.uses.read_in(value.value, number)
                    if isinstance(value.target, ArrayAccess):
                        mask |= self.uses.read_in(value.target, number)
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
                    mask |= self.uses.read_by(assignment, number)
        return mask

    def _edge(self, number: int, source: int, step: EdgeStep) -> _Edge:
        reads, kept, ways = 0, -1, []
        if step.guard is not None:
            reads = self.uses.read_in(step.guard, number)
            if reads and self.uses.can_fail(step.guard, number):
                self.fragile[number] |= reads
        for weighted in step.ways:
            destination = weighted.destination
            if weighted.probability is None and destination.probability is not None:
                reads |= self.uses.read_in(destination.probability.exp, number)
            target = self.location_of[number, destination.location]
            way, written = self._way(number, target, destination)
            self.written |= written
            if target == source:
                kept = max(kept, 0) | written & ~self.transient
            ways.append(way)
        return _Edge(reads, ways, kept)

    def _way(self, number: int, target: int, destination: Destination) -> tuple[_Way, int]:
        """A destination, and all variables that it writes."""
        always, whole, written = 0, 0, 0
        values: list[tuple[int, int]] = []
        assignments = destination.assignments
        groups: Iterable[tuple[int, Iterable[Assignment]]] = ((0, assignments),)
        if len(assignments) > 1:
            groups = groupby(sorted(assignments, key=_INDEX), _INDEX)
        for _, group in groups:
            replaced = whole
            for assignment in group:
                variable = self.uses.written_by(assignment, number)
                written |= variable
                if isinstance(assignment.target, Name):
                    whole |= variable
                read = self.uses.read_by(assignment, number) & ~replaced
                if not read:
                    continue
                if variable & (self.always_read | self.late) or self.uses.can_assignment_fail(assignment, number):
                    always |= read
                elif not variable & self.transient:
                    values.append((variable, read))
        return _Way(target, always, values, whole), written

    # ------------------------------------------------------------ slicing

    def _unobserved(self, observed: int) -> int:
        """The variables that influence neither the goal nor any guard or probability."""
        values: dict[int, int] = {}
        needed = observed | self.transient
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

    def _owned(self, observed: int, unobserved: int) -> list[int]:
        """For each instance, the variables that are read only in steps in which it takes part."""
        candidates = self.written & ~(unobserved | observed | self.transient)
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
        part = reduce(_together, (self.parts[number] for number in slots))
        mask = part.always | max(part.kept, 0)
        for variable, read in part.values.items():
            if not variable & unobserved:
                mask |= read
        return mask

    # ------------------------------------------------------------ data flow

    def _others(self, vector: int) -> dict[int, _Part]:
        """For each slot of a vector, the contribution of all other slots."""
        others = self.others.get(vector)
        if others is None:
            slots = self.legend.vectors[vector][0]
            parts = [self.parts[number] for number in slots]
            if len(slots) == 2:
                others = {slots[0]: parts[1], slots[1]: parts[0]}
                self.others[vector] = others
                return others
            before = accumulate(parts[:-1], _together, initial=_NOTHING)
            after = [*accumulate(parts[:0:-1], _together, initial=_NOTHING)][::-1]
            others = dict(zip(slots, map(_together, before, after), strict=True))
            self.others[vector] = others
        return others

    def _live(self, instance: int, owned: int) -> dict[int, int]:
        """For each location of an instance, those of its variables that are live there."""
        live = dict.fromkeys(self.locations[instance], 0)
        flows: dict[int, dict[_Flow, None]] = {location: {} for location in live}
        for number in self.slots[instance]:
            others = {_owned_part(self._others(vector)[number], owned) for vector in self.legend.slots[number].vectors}
            for location, edges in self.edges[number].items():
                for edge in edges:
                    reads = edge.reads
                    copies = []
                    for way in edge.ways:
                        read_by_way, copied = _split(way.values, owned)
                        reads |= way.always | read_by_way
                        copies.append((way.target, owned & ~way.whole, copied))
                    for other in others:
                        read = reads | other.always
                        if edge.kept >= 0 and other.kept >= 0:
                            read |= edge.kept | other.kept
                        live[location] |= read & owned
                        for target, keeps, copied in copies:
                            flows[location][_Flow(target, keeps & ~other.whole, copied + other.copied)] = None
        is_growing = True
        while is_growing:
            is_growing = False
            for location in reversed(live):
                before = live[location]
                for target, keeps, copied in flows[location]:
                    after = live[target]
                    before |= after & keeps
                    for variable, read in copied:
                        if variable & after:
                            before |= read
                if before != live[location]:
                    live[location] = before
                    is_growing = True
        return live


class _Flow(NamedTuple):
    """The variables of an instance that are live before a step because they are live after it.

    Attributes:
        keeps: the variables that may keep their values.
        copied: pairs of a variable that is written, and the variables on which its new value depends.
    """

    target: int
    keeps: int
    copied: tuple[tuple[int, int], ...]


class _OwnedPart(Record, frozen=True):
    """A part, restricted to the variables of an instance. `always` contains those on which other variables depend;
    `copied` is as in `_Flow`."""

    always: int
    copied: tuple[tuple[int, int], ...]
    whole: int
    kept: int


def _owned_part(part: _Part, owned: int) -> _OwnedPart:
    read, copied = _split(part.values.items(), owned) if part.values else (0, ())
    return _OwnedPart(
        (part.always | read) & owned, copied, part.whole & owned, part.kept & owned if part.kept >= 0 else -1
    )


def _split(values: Iterable[tuple[int, int]], owned: int) -> tuple[int, tuple[tuple[int, int], ...]]:
    """Of pairs of a variable that is written and of what its new value depends on: the `owned` variables on which the
    other ones depend, and the pairs of two of the `owned` ones."""
    always = 0
    copied: tuple[tuple[int, int], ...] = ()
    for variable, read in values:
        if not read & owned:
            continue
        if variable & owned:
            copied += ((variable, read & owned),)
        else:
            always |= read
    return always, copied


_INDEX = attrgetter("index")


def _part(edges: list[_Edge]) -> _Part:
    """One of several edges, whichever it is."""
    always, whole, kept = 0, -1, -1
    values: dict[int, int] = {}
    for edge in edges:
        always |= edge.reads
        if edge.kept >= 0:
            kept = max(kept, 0) | edge.kept
        for way in edge.ways:
            always |= way.always
            whole &= way.whole
            for variable, read in way.values:
                values[variable] = values.get(variable, 0) | read
    return _Part(always, values, max(whole, 0), kept)


def _together(one: _Part, other: _Part) -> _Part:
    """Both parts at the same time."""
    if one is _NOTHING:
        return other
    if other is _NOTHING:
        return one
    values = other.values or one.values
    if one.values and other.values:
        values = {**one.values, **values}
        for variable in one.values.keys() & other.values.keys():
            values[variable] |= one.values[variable]
    kept = one.kept | other.kept if one.kept >= 0 and other.kept >= 0 else -1
    return _Part(one.always | other.always, values, one.whole | other.whole, kept)


_NOTHING = _Part(0, {}, 0, 0)

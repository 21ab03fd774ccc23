# SPDX-License-Identifier: Apache-2.0
"""Finds choices that suffice in a state: a persistent set of synchronisation vectors
(docs/spec/reductions.md#frozen-instances, which contains the proof).

- Plain Python; Cython compiles it with the types in `ample.pxd`.
- Beginning with the participants of a vector α, instances are collected that are *frozen*: none of them can make a step
  before α is taken. An instance is frozen if each vector in which it can take part at its location waits for a frozen
  instance; if a vector waits only for other instances, one of them is added.
- α may be taken alone if all participants are frozen, and if each vector that depends on α has a frozen participant.
- α may also be taken alone if no vector that depends on it can be reached without it, as far as the locations show that
  each instance can reach on its own.
- A vector may be taken alone *early* although participants that it leaves unchanged are not frozen, if no trace ends
  before it is taken, which the search checks.
- Several vectors suffice together if what was said about α is true of all of them, and if chance decides nothing before
  one of them is taken.
- The result depends only on the state, not on the order in which states are visited.
"""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from roaml.explicit.independence import Independence
    from roaml.smc.kernel import Kernel

NEVER, HIDDEN, WRITES = 0, 1, 2
"""The values of `Independence.hidden`."""
SEVERAL = -2
"""The vector with which an instance is busy that takes part in several enabled vectors."""


def compiled() -> bool:
    """Whether this module is the compiled extension."""
    return not __file__.endswith(".py")


class AmpleSets:
    """Finds vectors that may be taken alone in the current state of a kernel.

    Args:
        kernel: the kernel of a search.
        tables: the tables for its program and goal.
        looks_ahead: whether `find_unreached` is used.
    """

    def __init__(self, kernel: Any, tables: Independence, looks_ahead: bool) -> None:
        self.kernel: Kernel = kernel
        self.slot_start = tables.slot_start
        self.slot_vector = tables.slot_vector
        self.hidden = tables.hidden
        self.dependent_start = tables.dependent_start
        self.dependent_vector = tables.dependent_vector
        self.guard_start = tables.guard_start
        self.guard_vector = tables.guard_vector
        self.open_guards = tables.open_guards
        self.is_fleeting = 1 if tables.is_fleeting else 0
        self.looks_ahead = 1 if looks_ahead else 0
        self.runs = 0
        self.frozen = array("q", [0] * self.kernel.instances)
        self.frozen_at = array("i", [0] * self.kernel.instances)
        self.count = 0
        self.handled = 0
        self.waits = array("q", [0] * (len(self.kernel.enabled) + 1))
        self.own_start = tables.own_start
        self.own_slot = tables.own_slot
        self.gates_start = tables.gates_start
        self.gates = tables.gates
        self.gate_slot_start = tables.gate_slot_start
        self.gate_slot = tables.gate_slot
        self.listed = array("q", [0] * len(tables.gate_slot_start))
        self.list_end = array("i", [0] * len(tables.gate_slot_start))
        self.list_slot = array("i", [0] * (len(tables.gate_slot) + 1))
        self.searches = 0
        self.alone = -1
        self.busy = array("q", [0] * self.kernel.instances)
        self.busy_with = array("i", [0] * self.kernel.instances)
        self.kind_at = array("q", [0] * (len(self.kernel.enabled) + 1))
        self.kind_of = array("i", [0] * (len(self.kernel.enabled) + 1))
        self.chosen = -1
        self.chosen_rank = 0
        self.writes_seen = 0
        self.candidates = array("i", [0] * (len(self.kernel.enabled) + 1))
        self._prepare_reached(tables)
        self.random_vector = tables.random_vector
        self.is_early = 0
        self.takes_several = 0
        self.members = array("i", [0] * (len(self.kernel.enabled) + 1))
        self.member_count = 0
        self.smallest = array("i", [0] * (len(self.kernel.enabled) + 1))

    def _prepare_reached(self, tables: Independence) -> None:
        """Set the attributes for what can be reached without a vector."""
        self.group_place = tables.group_place
        self.stirred_start = tables.stirred_start
        self.stirred = tables.stirred
        self.guarded_start = tables.guarded_start
        self.guarded = tables.guarded
        self.alarm_start = tables.alarm_start
        self.alarm = tables.alarm
        self.read_start = tables.read_start
        self.read = tables.read
        self.written_start = tables.written_start
        self.written = tables.written
        self.is_read = array("q", [0] * (tables.variables + 1))
        self.is_written = array("q", [0] * (tables.variables + 1))
        vectors = len(self.kernel.enabled) + 1
        gates = len(tables.gate_slot_start)
        slots = len(self.kernel.slot_instance)
        locations = len(self.kernel.location_mark)
        self.marked = array("q", [0] * self.kernel.instances)
        self.possible = array("q", [0] * vectors)
        self.possible_at = array("i", [0] * vectors)
        self.possible_count = 0
        self.counted = array("q", [0] * vectors)
        self.missing = array("i", [0] * vectors)
        self.gate_counted = array("q", [0] * gates)
        self.gate_missing = array("i", [0] * gates)
        self.taken = array("q", [0] * slots)
        self.offered = array("q", [0] * slots)
        self.is_stirred = array("q", [0] * len(tables.guarded_start))
        self.is_open = array("q", [0] * (len(tables.group_place) + 1))
        self.forbidden = array("q", [0] * locations)
        self.reached = array("q", [0] * locations)
        self.reached_at = array("i", [0] * locations)
        self.reached_before = array("i", [0] * locations)
        self.reached_count = 0
        self.has_reached = array("q", [0] * self.kernel.instances)
        self.last_reached = array("i", [0] * self.kernel.instances)

    def find(self) -> int:
        """The vector with the smallest number among those that may be taken alone; -1 if there is none. If all of these
        write variables that the goal reads, `writes_seen` is 1: the vector may be taken alone only if no value of them
        changes."""
        count = self.kernel.enabled_count
        self.writes_seen = 0
        if count == 0:
            return -1
        if count == 1 and self.is_fleeting != 0:
            return self.kernel.enabled[0] if self._is_single(self.kernel.enabled[0]) != 0 else -1
        self._prepare()
        for i in range(count):
            vector = self.candidates[i]
            if self._is_single(vector) != 0 and self._kind(vector) == HIDDEN and self._is_alone(vector) != 0:
                return vector
        for i in range(count):
            vector = self.candidates[i]
            if self._is_single(vector) != 0 and self._kind(vector) == WRITES and self._is_alone(vector) != 0:
                self.writes_seen = 1
                return vector
        return -1

    def find_early(self) -> int:
        """After `find` has found none: a vector that may be taken alone if no trace can end before it is taken; -1 if
        there is none."""
        if self.kernel.enabled_count < 2:
            return -1
        vector = -1
        self.is_early = 1
        for i in range(self.kernel.enabled_count):
            vector = self.candidates[i]
            if (
                self._has_tests(vector) != 0
                and vector < self.kernel.first_held
                and self._is_single(vector) != 0
                and self._kind(vector) == HIDDEN
                and self._is_alone(vector) != 0
            ):
                break
            vector = -1
        self.is_early = 0
        return vector

    def find_unreached(self) -> int:
        """After `find` has found none, or one that writes variables that the goal reads: another vector that may be
        taken alone, because no vector that depends on it can be reached without it; -1 if there is none."""
        count = self.kernel.enabled_count
        if self.looks_ahead == 0 or count == 0 or (count == 1 and self.is_fleeting != 0):
            return -1
        if self.kernel.enabled[0] >= self.kernel.first_held:
            return -1
        for i in range(count):
            vector = self.candidates[i]
            if self._is_single(vector) != 0 and self._kind(vector) == HIDDEN and self._is_unreached(vector) != 0:
                return vector
        return -1

    def find_several(self) -> int:
        """The number of the vectors in `smallest`, which suffice in the current state; 0 if all are needed."""
        best = self.kernel.enabled_count
        if best < 3 or self.kernel.enabled[0] >= self.kernel.first_held:
            return 0
        self._prepare()
        self.takes_several = 1
        for i in range(self.kernel.enabled_count):
            if self._suffice(self.candidates[i]) != 0 and self.member_count < best:
                best = self.member_count
                for k in range(best):
                    self.smallest[k] = self.members[k]
        self.takes_several = 0
        return best if best < self.kernel.enabled_count else 0

    def _prepare(self) -> None:
        """Sort the enabled vectors into `candidates`, and mark their participants."""
        for i in range(self.kernel.enabled_count):
            vector = self.kernel.enabled[i]
            k = i
            while k > 0 and self.candidates[k - 1] > vector:
                self.candidates[k] = self.candidates[k - 1]
                k -= 1
            self.candidates[k] = vector
        self.searches += 1
        self._mark_busy()

    def _has_tests(self, vector: int) -> int:
        """Whether a vector has participants that it leaves unchanged in all of their locations."""
        several = self.kernel.all_start[vector + 1] - self.kernel.all_start[vector]
        return 1 if several > self.kernel.active_start[vector + 1] - self.kernel.active_start[vector] else 0

    def _kind(self, vector: int) -> int:
        """NEVER, HIDDEN or WRITES. It is determined once for each state."""
        if self.kind_at[vector] != self.searches:
            self.kind_at[vector] = self.searches
            self.kind_of[vector] = self._kind_here(vector)
        return self.kind_of[vector]

    def _kind_here(self, vector: int) -> int:
        kind = HIDDEN
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            hidden = self.hidden[self._group(self.kernel.all_slot[i])]
            if hidden == NEVER:
                return NEVER
            if hidden == WRITES:
                kind = WRITES
        return kind

    def _mark_busy(self) -> None:
        """Mark the participants of enabled vectors."""
        for i in range(self.kernel.enabled_count):
            vector = self.kernel.enabled[i]
            for k in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
                instance = self.kernel.slot_instance[self.kernel.all_slot[k]]
                self.busy_with[instance] = vector if self.busy[instance] != self.searches else SEVERAL
                self.busy[instance] = self.searches

    def _is_single(self, vector: int) -> int:
        """Whether only one edge of each participant can be taken."""
        for i in range(self.kernel.active_start[vector], self.kernel.active_start[vector + 1]):
            if self.kernel.ready[self.kernel.active_slot[i]] != 1:
                return 0
        return 1

    def _group(self, slot: int) -> int:
        """The group of a slot at the current location of its instance; -1 if there is none."""
        place = self.kernel.place[self.kernel.slot_instance[slot]]
        group = self.kernel.slot_group[slot]  # that of the last location at which there was one
        if self.kernel.group_start[place] <= group < self.kernel.group_start[place + 1]:
            return group if self.kernel.group_slot[group] == slot else -1
        return -1

    def _is_alone(self, vector: int) -> int:
        """Whether an enabled vector may be taken alone."""
        for i in range(self.kernel.active_start[vector], self.kernel.active_start[vector + 1]):
            slot = self.kernel.active_slot[i]
            if self.busy_with[self.kernel.slot_instance[slot]] != vector:
                return 0
        return self._is_closed(vector)

    def _suffice(self, vector: int) -> int:
        """Whether `members` suffice, which an enabled vector requires; chance decides nothing before one of them is
        taken."""
        if self._is_closed(vector) == 0:
            return 0
        for i in range(len(self.random_vector)):
            if self._bar(self.random_vector[i]) == 0:
                return 0
        return self._is_settled()

    def _is_closed(self, vector: int) -> int:
        """Whether an enabled vector suffices together with those that are added to `members`."""
        self.runs += 1
        self.count = 0
        self.handled = 0
        self.member_count = 0
        self.alone = vector
        return 1 if self._add(vector) != 0 and self._is_settled() != 0 else 0

    def _is_settled(self) -> int:
        """Whether each vector of the frozen instances waits, or is a member."""
        while self.handled < self.count:
            place = self.kernel.place[self.frozen_at[self.handled]]
            self.handled += 1
            for group in range(self.kernel.group_start[place], self.kernel.group_start[place + 1]):
                slot = self.kernel.group_slot[group]
                for k in range(self.slot_start[slot], self.slot_start[slot + 1]):
                    if self.waits[self.slot_vector[k]] != self.runs and self._let_wait(self.slot_vector[k]) == 0:
                        return 0
        return 1

    def _add(self, vector: int) -> int:
        """Let an enabled vector be a member, and freeze the participants that it changes, and if it is the first member
        also the others, unless it is taken early; return 0 if that is not possible."""
        if vector != self.alone and self.takes_several == 0:
            return 0
        if self.takes_several != 0 and (
            self._kind(vector) != HIDDEN or self.member_count + 1 == self.kernel.enabled_count
        ):
            return 0
        self.waits[vector] = self.runs
        self.members[self.member_count] = vector
        self.member_count += 1
        for i in range(self.kernel.active_start[vector], self.kernel.active_start[vector + 1]):
            if self._freeze(self.kernel.slot_instance[self.kernel.active_slot[i]]) == 0:
                return 0
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            is_frozen = vector == self.alone and self.is_early == 0
            if is_frozen and self._freeze(self.kernel.slot_instance[self.kernel.all_slot[i]]) == 0:
                return 0
            group = self._group(self.kernel.all_slot[i])
            for k in range(self.dependent_start[group], self.dependent_start[group + 1]):
                if self._bar(self.dependent_vector[k]) == 0:
                    return 0
        return 1

    def _freeze(self, instance: int) -> int:
        """Freeze an instance; return 0 if another enabled vector can move it, which may not be a member."""
        if self.frozen[instance] != self.runs:
            if (
                self.takes_several == 0
                and self.busy[instance] == self.searches
                and self.busy_with[instance] != self.alone
            ):
                return 0
            self.frozen[instance] = self.runs
            self.frozen_at[self.count] = instance
            self.count += 1
        return 1

    def _bar(self, vector: int) -> int:
        """Ensure that a vector is a member, has a frozen participant, or is held until the first member is taken;
        return 0 if that is not possible."""
        if self.waits[vector] == self.runs:
            return 1
        if vector >= self.kernel.first_held:
            return 1 if self.alone < self.kernel.first_held else 0
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            if self.frozen[self.kernel.slot_instance[self.kernel.all_slot[i]]] == self.runs:
                return 1
        if self.kernel.vector_missing[vector] == 0:
            return self._add(vector)
        last = -1
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            slot = self.kernel.all_slot[i]
            if self.kernel.ready[slot] == 0:
                last = self.kernel.slot_instance[slot]
                if self.takes_several == 0 or self.busy[last] != self.searches:
                    break
        return self._freeze(last)

    def _let_wait(self, vector: int) -> int:
        """Ensure that a vector is a member, waits for a frozen instance, or is held until the first member is taken;
        return 0 if that is not possible."""
        if vector >= self.kernel.first_held and self.alone < self.kernel.first_held:
            self.waits[vector] = self.runs
            return 1
        if self.kernel.vector_missing[vector] == 0:
            return self._add(vector)
        self.waits[vector] = self.runs
        self.chosen = -1
        for i in range(self.own_start[vector], self.own_start[vector + 1]):
            slot = self.own_slot[i]
            if self.kernel.ready[slot] == 0 and self._is_stopped(slot) != 0:
                return 1
        for i in range(self.gates_start[vector], self.gates_start[vector + 1]):
            gate = self.gates[i]
            if self.kernel.gate_missing[gate] == 0:
                continue
            if self.listed[gate] != self.searches:
                self._list(gate)
            for k in range(self.gate_slot_start[gate], self.list_end[gate]):
                if self._is_stopped(self.list_slot[k]) != 0:
                    return 1
        if self._freeze(self.kernel.slot_instance[self.chosen]) == 0:
            return 0
        group = self._group(self.chosen)
        if group >= 0:
            for k in range(self.guard_start[group], self.guard_start[group + 1]):
                if self._bar(self.guard_vector[k]) == 0:
                    return 0
        return 1

    def _is_stopped(self, slot: int) -> int:
        """Whether a slot without enabled edges keeps its vectors from being taken, because its instance is frozen.
        Otherwise it may become `chosen`. Slots of instances that no other enabled vector can move are preferred, then
        those without open guards, then the first ones."""
        instance = self.kernel.slot_instance[slot]
        rank = 1 if self.open_guards[slot] != 0 and self._group(slot) >= 0 else 0
        if rank == 0 and self.frozen[instance] == self.runs:
            return 1
        if self.busy[instance] == self.searches and self.busy_with[instance] != self.alone:
            rank += 2
        if self.chosen < 0 or rank < self.chosen_rank or (rank == self.chosen_rank and slot < self.chosen):
            self.chosen = slot
            self.chosen_rank = rank
        return 0

    def _list(self, gate: int) -> None:
        """List the slots of a gate that have no enabled edges."""
        self.listed[gate] = self.searches
        missing = self.kernel.gate_missing[gate]
        at = self.gate_slot_start[gate]
        end = at
        while missing != 0:
            slot = self.gate_slot[at]
            at += 1
            if self.kernel.ready[slot] == 0:
                self.list_slot[end] = slot
                end += 1
                missing -= 1
        self.list_end[gate] = end

    # ------------------------------------------------------------ what can be reached

    def _is_unreached(self, vector: int) -> int:
        """Whether no vector that depends on an enabled vector can be reached without it, if each instance can be in
        each of the locations that it can reach, whatever the locations of the others are."""
        self.runs += 1
        self.alone = vector
        self.possible_count = 0
        self.reached_count = 0
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            self.marked[self.kernel.slot_instance[self.kernel.all_slot[i]]] = self.runs
            group = self._group(self.kernel.all_slot[i])
            for k in range(self.read_start[group], self.read_start[group + 1]):
                self.is_read[self.read[k]] = self.runs
            for k in range(self.written_start[group], self.written_start[group + 1]):
                self.is_written[self.written[k]] = self.runs
        for i in range(self.alarm_start[vector], self.alarm_start[vector + 1]):
            place = self.group_place[self.alarm[i]]
            if self.kernel.place[self.kernel.slot_instance[self.kernel.group_slot[self.alarm[i]]]] == place:
                return 0
            self.forbidden[place] = self.runs
        for i in range(self.kernel.enabled_count):
            other = self.kernel.enabled[i]
            if other != vector and self._add_possible(other) == 0:
                return 0
        followed = 0
        visited = 0
        while True:
            if visited < self.reached_count:
                if self._visit(self.reached_at[visited]) == 0:
                    return 0
                visited += 1
            elif followed < self.possible_count:
                if self._follow(self.possible_at[followed]) == 0:
                    return 0
                followed += 1
            else:
                return 1

    def _add_possible(self, vector: int) -> int:
        """Note that a vector may become possible; return 0 if the vector that would be taken alone depends on it."""
        if self.possible[vector] == self.runs or vector >= self.kernel.first_held:
            return 1
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            if self.marked[self.kernel.slot_instance[self.kernel.all_slot[i]]] == self.runs:
                return 0
        self.possible[vector] = self.runs
        self.possible_at[self.possible_count] = vector
        self.possible_count += 1
        return 1

    def _follow(self, vector: int) -> int:
        """Note the effects of a vector; return 0 as `_add_possible`."""
        for i in range(self.stirred_start[vector], self.stirred_start[vector + 1]):
            variable = self.stirred[i]
            if self.is_stirred[variable] == self.runs:
                continue
            self.is_stirred[variable] = self.runs
            for k in range(self.guarded_start[variable], self.guarded_start[variable + 1]):
                group = self.guarded[k]
                if self.is_open[group] == self.runs:
                    continue
                self.is_open[group] = self.runs
                place = self.group_place[group]
                slot = self.kernel.group_slot[group]
                if (
                    self.reached[place] == self.runs or self.kernel.place[self.kernel.slot_instance[slot]] == place
                ) and self._offer(group) == 0:
                    return 0
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            slot = self.kernel.all_slot[i]
            if self.taken[slot] == self.runs:
                continue
            self.taken[slot] = self.runs
            group = self._group(slot)
            if group >= 0 and self._leave(group) == 0:
                return 0
            instance = self.kernel.slot_instance[slot]
            place = self.last_reached[instance] if self.has_reached[instance] == self.runs else -1
            while place >= 0:
                for group in range(self.kernel.group_start[place], self.kernel.group_start[place + 1]):
                    if self.kernel.group_slot[group] == slot and self._leave(group) == 0:
                        return 0
                place = self.reached_before[place]
        return 1

    def _visit(self, place: int) -> int:
        """Note what is possible in a location that an instance can reach; return 0 as `_add_possible`."""
        if self.forbidden[place] == self.runs:
            return 0
        for group in range(self.kernel.group_start[place], self.kernel.group_start[place + 1]):
            if self._offer(group) == 0:
                return 0
        return 1

    def _offer(self, group: int) -> int:
        """Note that a slot has an edge that may become enabled, if a group has one; return 0 as `_add_possible`."""
        slot = self.kernel.group_slot[group]
        if self.taken[slot] == self.runs and self._leave(group) == 0:
            return 0
        if self.kernel.ready[slot] != 0 or self.offered[slot] == self.runs:
            return 1
        edge = self.kernel.edge_start[group]
        while self._is_open(group, edge) == 0:
            edge += 1
            if edge == self.kernel.edge_start[group + 1]:
                return 1
        self.offered[slot] = self.runs
        vector = self.kernel.slot_vector[slot]
        if vector >= 0:
            return self._offer_to(vector)
        gate = -2 - vector
        if gate < 0:
            return 1
        if self.gate_counted[gate] != self.runs:
            self.gate_counted[gate] = self.runs
            self.gate_missing[gate] = self.kernel.gate_missing[gate]
        self.gate_missing[gate] -= 1
        if self.gate_missing[gate] == 0:
            for i in range(self.kernel.gate_start[gate], self.kernel.gate_start[gate + 1]):
                if self._offer_to(self.kernel.gate_vector[i]) == 0:
                    return 0
        return 1

    def _offer_to(self, vector: int) -> int:
        """Note that a slot or gate of a vector may become ready; return 0 as `_add_possible`."""
        if self.counted[vector] != self.runs:
            self.counted[vector] = self.runs
            self.missing[vector] = self.kernel.vector_missing[vector]
        self.missing[vector] -= 1
        return 1 if self.missing[vector] != 0 else self._add_possible(vector)

    def _leave(self, group: int) -> int:
        """Note the locations to which the edges of a group lead that may become enabled; return 0 as
        `_add_possible`."""
        for k in range(self.read_start[group], self.read_start[group + 1]):
            if self.is_written[self.read[k]] == self.runs:
                return 0
        for k in range(self.written_start[group], self.written_start[group + 1]):
            if self.is_written[self.written[k]] == self.runs or self.is_read[self.written[k]] == self.runs:
                return 0
        instance = self.kernel.slot_instance[self.kernel.group_slot[group]]
        for edge in range(self.kernel.edge_start[group], self.kernel.edge_start[group + 1]):
            if self._is_open(group, edge) == 0:
                continue
            for way in range(self.kernel.way_start[edge], self.kernel.way_start[edge + 1]):
                place = self.kernel.way_target[way]
                if self.reached[place] == self.runs or self.kernel.place[instance] == place:
                    continue
                self.reached[place] = self.runs
                self.reached_at[self.reached_count] = place
                self.reached_count += 1
                self.reached_before[place] = (
                    self.last_reached[instance] if self.has_reached[instance] == self.runs else -1
                )
                self.has_reached[instance] = self.runs
                self.last_reached[instance] = place
        return 1

    def _is_open(self, group: int, edge: int) -> int:
        """Whether the guard of an edge may become true: it is true, or a variable that its group reads may change."""
        guard = self.kernel.guard[edge]
        if guard < 0 or self.is_open[group] == self.runs:
            return 1
        holds = self.kernel._is_true(guard)
        if self.kernel.fault != 0:
            self.kernel.fault = 0
            return 1
        return holds

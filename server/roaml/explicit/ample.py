# SPDX-License-Identifier: Apache-2.0
"""Finds choices that suffice in a state: a persistent set of synchronisation vectors
(docs/spec/reductions.md#frozen-instances, which contains the proof).

- Plain Python; Cython compiles it with the types in `ample.pxd`.
- Beginning with the participants of a vector α, instances are collected that are *frozen*: none of them can make a step
  before α is taken. An instance is frozen if each vector in which it can take part at its location waits for a frozen
  instance; if a vector waits only for other instances, one of them is added.
- α may be taken alone if all participants are frozen, and if each vector that depends on α has a frozen participant.
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
    """

    def __init__(self, kernel: Any, tables: Independence) -> None:
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
        self.chosen = -1
        self.chosen_rank = 0
        self.writes_seen = 0
        self.candidates = array("i", [0] * (len(self.kernel.enabled) + 1))
        self.random_vector = tables.random_vector
        self.is_early = 0
        self.takes_several = 0
        self.members = array("i", [0] * (len(self.kernel.enabled) + 1))
        self.member_count = 0
        self.smallest = array("i", [0] * (len(self.kernel.enabled) + 1))

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
            if self._kind(vector) == HIDDEN and self._is_single(vector) != 0 and self._is_alone(vector) != 0:
                return vector
        for i in range(count):
            vector = self.candidates[i]
            if self._kind(vector) == WRITES and self._is_single(vector) != 0 and self._is_alone(vector) != 0:
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
                and self._kind(vector) == HIDDEN
                and self._is_single(vector) != 0
                and self._is_alone(vector) != 0
            ):
                break
            vector = -1
        self.is_early = 0
        return vector

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
        """NEVER, HIDDEN or WRITES."""
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

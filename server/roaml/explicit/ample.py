# SPDX-License-Identifier: Apache-2.0
"""Finds a choice that may be taken alone in a state: a persistent set of one synchronisation vector
(docs/spec/reductions.md#frozen-instances, which contains the proof).

- Plain Python; Cython compiles it with the types in `ample.pxd`.
- Beginning with the participants of a vector α, instances are collected that are *frozen*: none of them can make a step
  before α is taken. An instance is frozen if each vector in which it can take part at its location waits for a frozen
  instance; if a vector waits only for other instances, one of them is added.
- α may be taken alone if all participants are frozen, and if each vector that depends on α has a frozen participant.
- The result depends only on the state, not on the order in which states are visited.
"""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from roaml.explicit.independence import Independence
    from roaml.smc.kernel import Kernel


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
        self.waits = array("q", [0] * (len(self.kernel.enabled) + 1))
        self.candidates = array("i", [0] * (len(self.kernel.enabled) + 1))

    def find(self) -> int:
        """The vector with the smallest number among those that may be taken alone; -1 if there is none."""
        count = self.kernel.enabled_count
        if count == 0:
            return -1
        if count == 1 and self.is_fleeting != 0:
            return self.kernel.enabled[0] if self._is_single(self.kernel.enabled[0]) != 0 else -1
        for i in range(count):
            vector = self.kernel.enabled[i]
            k = i
            while k > 0 and self.candidates[k - 1] > vector:
                self.candidates[k] = self.candidates[k - 1]
                k -= 1
            self.candidates[k] = vector
        for i in range(count):
            vector = self.candidates[i]
            if self._is_single(vector) != 0 and self._is_alone(vector) != 0:
                return vector
        return -1

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
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            if self.hidden[self._group(self.kernel.all_slot[i])] == 0:
                return 0
        self.runs += 1
        self.count = 0
        self.waits[vector] = self.runs
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            self._freeze(self.kernel.slot_instance[self.kernel.all_slot[i]])
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            group = self._group(self.kernel.all_slot[i])
            for k in range(self.dependent_start[group], self.dependent_start[group + 1]):
                if self._bar(self.dependent_vector[k]) == 0:
                    return 0
        at = 0
        while at < self.count:
            place = self.kernel.place[self.frozen_at[at]]
            at += 1
            for group in range(self.kernel.group_start[place], self.kernel.group_start[place + 1]):
                slot = self.kernel.group_slot[group]
                for k in range(self.slot_start[slot], self.slot_start[slot + 1]):
                    if self._let_wait(self.slot_vector[k]) == 0:
                        return 0
        return 1

    def _freeze(self, instance: int) -> None:
        if self.frozen[instance] != self.runs:
            self.frozen[instance] = self.runs
            self.frozen_at[self.count] = instance
            self.count += 1

    def _bar(self, vector: int) -> int:
        """Ensure that a vector has a frozen participant; return 0 if that is not possible."""
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            if self.frozen[self.kernel.slot_instance[self.kernel.all_slot[i]]] == self.runs:
                return 1
        if self.kernel.vector_missing[vector] == 0:
            return 0
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            slot = self.kernel.all_slot[i]
            if self.kernel.ready[slot] == 0:
                self._freeze(self.kernel.slot_instance[slot])
                return 1
        return 0

    def _let_wait(self, vector: int) -> int:
        """Ensure that a vector waits for a frozen instance; return 0 if that is not possible."""
        if self.waits[vector] == self.runs:
            return 1
        if self.kernel.vector_missing[vector] == 0:
            return 0
        chosen = -1
        is_chosen_open = False
        for i in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            slot = self.kernel.all_slot[i]
            if self.kernel.ready[slot] != 0:
                continue
            is_open = self.open_guards[slot] != 0 and self._group(slot) >= 0
            if self.frozen[self.kernel.slot_instance[slot]] == self.runs and not is_open:
                self.waits[vector] = self.runs
                return 1
            if chosen < 0 or (is_chosen_open and not is_open):
                chosen = slot
                is_chosen_open = is_open
        self.waits[vector] = self.runs
        self._freeze(self.kernel.slot_instance[chosen])
        group = self._group(chosen)
        if group >= 0:
            for k in range(self.guard_start[group], self.guard_start[group + 1]):
                if self._bar(self.guard_vector[k]) == 0:
                    return 0
        return 1

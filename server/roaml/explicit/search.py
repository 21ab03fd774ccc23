# SPDX-License-Identifier: Apache-2.0
"""The search through all states of a program, breadth first.

- Plain Python; Cython compiles it with the types in `search.pxd`, like the kernel, whose code computes the successors.
- `smc.packing` packs the states, numbers them and looks them up. After the cells of the kernel, a state has cells for
  the status of each until of the goal, and for the number of steps.
- The choices of a state are a sequence of 32-bit words. A word that is not negative is a choice with one destination.
  Other choices have n destinations, a weight other than 1, or a reward. These choices consist of `-n`, the number of
  its weight, the number of its reward, and for each destination a state and the number of its probability. These
  numbers index `reals`.
- When the choices of a state are computed, the state gets a *label*, which contains the status of the goal there.
- Without `leave_out`, successors *wait* until many can be looked up together: their accesses to the table and the keys
  then overlap, which takes half of the time. The states are numbered in the order in which successors were computed.
- With `leave_out`, choices are left out as `ample` permits, and a state in which only one step is taken, without
  chance, is not stored: the search goes on from its successor (docs/spec/reductions.md). Some of these states are
  remembered, each at an index that follows from its hash, with the stored state to which it leads.
"""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING, Any

from roaml.smc.memory import flat, grown
from roaml.smc.packing import PackedStates

if TYPE_CHECKING:
    from roaml.explicit.ample import AmpleSets
    from roaml.explicit.tables import Tables
    from roaml.smc.kernel import Kernel

UINT32_MASK = 0xFFFFFFFF
UINT64_MASK = 0xFFFFFFFFFFFFFFFF
LEARNED_FROM_STATES = 4096
"""With more states than this, cells get bits for the values that they have in random traces, because packing all states
again is slow."""
SAMPLED_TRACES, SAMPLED_STEPS = 32, 1000
"""The numbers of random traces, and of steps in each, from which the values that cells will have are estimated."""
MAX_COUNTED_STATES = 0x7FFFFFF0
"""The maximum number of states: numbers of states have 31 bits."""
MAX_WAITING = 256
"""The maximum number of successors that are looked up together. The memory that they access fits the cache."""
WAITS = 0x7FFFFFFF
"""The number of a state that waits."""
MAX_PASSED = 1000
"""The maximum number of states in sequence that are not stored, because they may form a cycle."""
MAX_REMEMBERED = 1 << 17
"""The maximum number of states that are remembered although they are not stored."""
MAX_TRIED = 64
"""The maximum number of states that are visited to find out whether a trace can end before a vector is taken."""

FALSE, TRUE, UNKNOWN, FAULTY = 0, 1, 2, 3
TIME, STUCK = 1, 3
"""Reasons why a trace ends (see `end.End`)."""

COMPLETE, PART, STATES, MEMORY, FAULT, CHOICES = 0, 1, 2, 3, 4, 5
"""The status of a search: all states are known; it can be continued; a limit on states or memory was reached; an
undefined operation was executed; one state has too many combinations."""

STATUS, LASTS, FAILS, HOLDS, OPEN, ENDED, GETS_STUCK = 3, 4, 8, 16, 32, 64, 128
"""The bits of a label. STATUS: FALSE, TRUE or UNKNOWN. LASTS and FAILS are about a path that stays in the state for
ever and on which the goal is not decided. LASTS: the goal is true if the lasting condition holds for ever; FAILS: the
goal is true otherwise. HOLDS: the lasting condition, or the right side of a bounded until, holds. OPEN: the time ends
before the goal is decided. ENDED: nothing changes any more; GETS_STUCK: because automata wait for one another."""


def compiled() -> bool:
    """Whether this module is the compiled extension."""
    return not __file__.endswith(".py")


class StateSearch(PackedStates):
    """The states that have been reached, and the choices of those that have been expanded.

    Args:
        kernel: the kernel for the program and the goal.
        tables: the tables for the program.
        steps: the number of steps that the goal distinguishes, 0 if none.
        lower: if positive, the goal is one until with this lower bound, and the solver counts the steps.
        depth: states after this number of steps are not expanded; no limit if negative.
        most_states, most_bytes: the maximum number of states, and the maximum memory in bytes.
        most_choices: the maximum number of combinations of edges and destinations in one state.

    Attributes:
        count: the number of states.
        roots: the initial states; the first `entered` numbers are valid when the search is complete.
        expanded: the number of states whose choices are known; they are the first ones.
        problem: the state whose choices could not be computed; -1 if there is none.
        alone: the number of stored states in which choices were left out.
        passed: the number of steps from states that are not stored, and of steps that were tried. A path that is
            remembered is not followed again.
        circled: the number of these steps on paths that were ended because they may form a cycle.
        is_partial: for each state, whether choices were left out.
        taken: for each way of an edge of the program, whether a step has taken it.
    """

    def __init__(
        self, kernel: Any, tables: Tables, steps: int, lower: int, depth: int, most_states: int, most_bytes: int,
        most_choices: int,
    ) -> None:  # fmt: skip
        self.kernel: Kernel = kernel
        self.leaves = self.kernel.leaves
        super().__init__(kernel, tables.cell_watch, self.leaves + 1)
        self.way_start = tables.way_start
        self.way_cell = tables.way_cell
        self.settled = tables.settled
        self.drop_start = tables.drop_start
        self.drop_cell = tables.drop_cell
        self.owner_start = tables.owner_start
        self.owner_instance = tables.owner_instance
        self.owner_table = tables.owner_table
        self.is_dead = tables.is_dead
        self.counter = self.variables + self.leaves
        self.most_steps = steps
        self.lower_bound = lower
        self.remembers = 1 if self.leaves > 1 or steps > 0 else 0
        self.most_states = min(most_states, MAX_COUNTED_STATES)
        self.most_bytes = most_bytes
        self.most_choices = most_choices
        self.depth = 0
        self.most_depth = depth
        self.layer_end = 1

        self.initial = array("q", [0]) * self.cell_count
        # The ways of a step, and their moves, are different ones.
        written = len(tables.way_cell) + len(tables.drop_cell) + len(tables.settled)
        self.changed = array("i", [0]) * (self.cell_count + written)
        self.has_learned = 0

        ways = len(self.kernel.way_target)
        self.chance = array("d", [0.0] * (ways + 1))
        for edge in range(len(self.kernel.guard)):
            before = 0.0
            for way in range(self.kernel.way_start[edge], self.kernel.way_start[edge + 1]):
                self.chance[way] = self.kernel.way_sum[way] - before
                before = self.kernel.way_sum[way]
        self.taken = flat("B", ways + 1)
        slots = self.kernel.instances + 1
        self.edges = array("i", [0] * (len(self.kernel.guard) + 1))
        self.edge_from = array("i", [0] * (slots + 1))
        self.slots = array("i", [0] * slots)
        self.picks = array("i", [0] * slots)
        self.ways = array("i", [0] * slots)
        self.leaves_out = 0
        self.alone = 0
        self.passed = 0
        self.circled = 0
        self.has_passed = 0
        self.looks_at = 0
        self.is_seen = 0
        self.is_ahead = 0
        self.layout = 0
        self.trail = array("i", [0] * MAX_PASSED)
        self.passed_mask = 0
        self.passed_keys = flat("Q", 1)
        self.passed_to = flat("i", 1)
        self.passed_left = flat("i", 1)
        self.pending = array("i", [0] * (len(self.kernel.enabled) + 1))
        self.combinations = 0.0
        self.tried_value = array("q", [0]) * self.cell_count
        self.tried = array("Q", [0]) * MAX_TRIED
        self.tried_count = 0
        self.avoids_cycles = 1
        self.reached = array("i", [0])

        self.start = flat("q", self.state_room)
        self.parent = flat("i", self.state_room)
        self.label = flat("B", self.state_room)
        self.is_partial = flat("B", self.state_room)
        self.code = flat("i", 256)
        self.code_room = 256
        self.code_end = 0
        self.reals = flat("d", 64)
        self.reals_room = 64
        self.number_of: dict[float, int] = {}
        self.real_count = 0
        self.expanded = 0
        self.problem = -1
        self.status = PART
        self.branches = 0
        self.transitions = 0
        self.is_weighted = 0

        self._number(1.0)
        self.kernel.root(0)
        for leaf in range(self.leaves):
            self.memory[leaf] = UNKNOWN
        if self.kernel.fault != 0:
            self.status = FAULT
        self._start()
        self.initial[:] = self.value
        self._find(-1)
        self.roots = flat("i", 64)
        self.root_room = 64
        self.entered = 1
        self.waiting = 0
        self.waiting_tag = array("Q", [0] * MAX_WAITING)
        self.waiting_entry = array("Q", [0] * MAX_WAITING)
        self.waiting_parent = array("i", [0] * MAX_WAITING)
        self.waiting_code = array("q", [0] * MAX_WAITING)
        self.waiting_keys = array("Q", [0] * (MAX_WAITING * self.words))
        self.peeked = 0

    # ------------------------------------------------------------ public

    def leave_out(self, ample: AmpleSets, avoids_cycles: int) -> None:
        """Leave out choices where `ample` finds vectors that suffice.

        Args:
            avoids_cycles: whether choices are left out only in states from which all choices that are not left out lead
                to states that have not been expanded. Otherwise `has_partial_cycle` must be called in the end.
        """
        self.ample = ample
        self.leaves_out = 1
        self.avoids_cycles = avoids_cycles
        self._forget()

    def has_partial_cycle(self) -> bool:
        """Whether choices have been left out in all states of some cycle. States are removed from the others as soon as
        none that remains leads to them; the states of a cycle remain."""
        incoming = flat("i", self.count + 1)
        free = flat("i", self.count + 1)
        left = 0
        end = 0
        for state in range(self.count):
            if self.is_partial[state] != 0:
                left += 1
                for k in range(self._list_destinations(self.start[state], self.start[state + 1])):
                    incoming[self.reached[k]] += 1
        for state in range(self.count):
            if self.is_partial[state] != 0 and incoming[state] == 0:
                free[end] = state
                end += 1
        at = 0
        while at < end:
            state = free[at]
            at += 1
            for k in range(self._list_destinations(self.start[state], self.start[state + 1])):
                other = self.reached[k]
                incoming[other] -= 1
                if incoming[other] == 0 and self.is_partial[other] != 0:
                    free[end] = other
                    end += 1
        return end < left

    def run(self, states: int) -> int:
        """Expand about `states` further states; return the status of the search."""
        goal = self.expanded + states
        try:
            if self.entered < self.kernel.roots:
                self._enter_roots(states)
                if self.entered < self.kernel.roots:
                    return self.status
            while self.status == PART and self.expanded < goal:
                if self.expanded == self.layer_end:
                    self._find_waiting()
                    if self.expanded == self.count or self.status != PART:
                        break
                if self.count > LEARNED_FROM_STATES and self.has_learned == 0:
                    self.has_learned = 1
                    self._find_waiting()
                    if self.status != PART:
                        break
                    self._learn()
                self._expand(self.expanded)
            self._find_waiting()
            if self.status == PART and self.expanded == self.count:
                self.status = COMPLETE
        except (MemoryError, OSError):
            self.status = MEMORY
        return self.status

    def key(self, state: int) -> list[int]:
        """The values of all cells of a state."""
        return [self._decoded(state, cell) for cell in range(self.cell_count)]

    def number(self, index: int) -> float:
        """The weight, reward or probability at an index of `reals`."""
        value: float = self.reals[index]
        return value

    def parent_of(self, state: int) -> int:
        parent: int = self.parent[state]
        return parent

    def label_of(self, state: int) -> int:
        label: int = self.label[state]
        return label

    def memory_used(self) -> int:
        """The memory in use, in bytes."""
        return self._used()

    def choices_of(self, state: int) -> list[tuple[float, float, list[tuple[float, int]]]]:
        """The choices of a state: weight, expected reward, and destinations with their probabilities."""
        choices = []
        at = self.start[state]
        while at < self.start[state + 1]:
            size = self.code[at]
            if size >= 0:
                choices.append((1.0, 0.0, [(1.0, size)]))
                at += 1
                continue
            weight, reward = self.reals[self.code[at + 1]], self.reals[self.code[at + 2]]
            at += 3
            branches = []
            for _ in range(-size):
                branches.append((self.reals[self.code[at + 1]], self.code[at]))
                at += 2
            choices.append((weight, reward, branches))
        return choices

    def steps_to(self, state: int, successor: int) -> list[tuple[int, list[int], list[int]]] | None:
        """The choices by which `successor` is reached from `state` without another state that is stored; `None` if
        there are none. A choice consists of the vector and, for each slot that has an effect, the number of the edge
        among the enabled edges, and the number of the destination of the edge."""
        self.kernel.fault = 0  # one that ended the search
        self._visit(state)
        self._judged()
        for vector in [self.kernel.enabled[i] for i in range(self.kernel.enabled_count)]:
            count = self._open(vector)
            for j in range(count):
                self.picks[j] = self.edge_from[j]
            while True:
                self._first_ways(count)
                while True:
                    chance = 1.0
                    for j in range(count):
                        chance *= self.chance[self.ways[j]]
                    if chance > 0.0:
                        picks = [self.picks[j] - self.edge_from[j] for j in range(count)]
                        ways = [self.ways[j] - self.kernel.way_start[self.edges[self.picks[j]]] for j in range(count)]
                        passed = self._steps_on(vector, count, state, successor)
                        if passed is not None:
                            return [(vector, picks, ways), *passed]
                    if self._next_ways(count) == 0:
                        break
                if self._next_edges(count) == 0:
                    break
        return None

    def _steps_on(
        self, vector: int, count: int, state: int, successor: int
    ) -> list[tuple[int, list[int], list[int]]] | None:
        """The single steps after the choice in `ways` until `successor` is reached; `None` if it is not reached."""
        self._execute_choice(vector, count)
        self._pack_step()
        self._undo()
        if self.leaves_out == 0:
            return [] if self._known() == successor else None
        steps: list[tuple[int, list[int], list[int]]] = []
        while self._known() != successor:
            if len(steps) == MAX_PASSED or self._pass() == 0:
                self._turn_back()
                self._return(state)
                return None
            steps.append((self.kernel.vector, [0] * self.kernel.parts, [0] * self.kernel.parts))
        self._turn_back()
        return steps

    def fault(self) -> tuple[int, int, int, int, float]:
        """The undefined operation that ended the search; see `Kernel.problem`."""
        problem: tuple[int, int, int, int, float] = self.kernel.problem()
        return problem

    # ------------------------------------------------------------ initial states

    def _enter_roots(self, many: int) -> None:
        """Add about `many` further initial states. All are added before the first state is expanded."""
        most = self.entered + many
        while self.entered < self.kernel.roots and self.entered < most:
            self.kernel.root(self.entered)
            if self.kernel.fault != 0:
                self.status = FAULT
                return
            for cell in range(self.places, self.variables):
                if self._is_dead(cell) != 0:
                    self._set_current(cell, self.initial[cell])
            self._pack_all()
            if self.misfit >= 0:
                self._widen_all()
            state = self._find(-1)
            if state < 0:
                return
            if self.entered == self.root_room:
                self.root_room *= 2
                self.roots = grown(self.roots, self.root_room)
            self.roots[self.entered] = state
            self.entered += 1
        self.kernel.root(0)  # `value` and `now` describe this state.
        self.layer_end = self.count

    # ------------------------------------------------------------ packing

    def _is_dead(self, cell: int) -> int:
        """Whether the value of a variable does not matter in the current locations."""
        for k in range(self.owner_start[cell], self.owner_start[cell + 1]):
            if self.is_dead[self.owner_table[k] + self.kernel.place[self.owner_instance[k]]] != 0:
                return 1
        return 0

    def _pack_step(self) -> None:
        """Put the key of the state after a step into `following`. The kernel has executed the step."""
        self._end_step()
        self._pack_changed()

    def _end_step(self) -> None:
        """Collect the cells that a step of the kernel may have changed. Those that are dead now get their initial
        values, if the step has written them or if they were not dead before it."""
        count = 0
        for j in range(self.kernel.parts):
            way = self.kernel.part_way[j]
            self.changed[count] = self.kernel.slot_instance[self.kernel.part_slot[j]]
            count += 1
            for k in range(self.way_start[way], self.way_start[way + 1]):
                cell = self.way_cell[k]
                if self._is_dead(cell) != 0:
                    self._set_current(cell, self.initial[cell])
                self.changed[count] = cell
                count += 1
            move = self.kernel.way_move[way]
            if move >= 0:
                for k in range(self.drop_start[move], self.drop_start[move + 1]):
                    cell = self.drop_cell[k]
                    self._set_current(cell, self.initial[cell])
                    self.changed[count] = cell
                    count += 1
        for k in range(len(self.settled)):
            self.changed[count] = self.settled[k]
            count += 1
        if self.remembers != 0:
            for cell in range(self.variables, self.cell_count):
                self.changed[count] = cell
                count += 1
        self.changed_count = count

    def _widen_all(self) -> None:
        """Give cells more bits until the current state of the kernel fits, and put its key into `following`. The
        waiting successors are found before; if a limit is reached, this is the status."""
        self._find_waiting()
        if self.status != PART:
            return
        while self.misfit >= 0:
            if self._widen() != 0:
                self._renew_layout()
            self._pack_all()

    def _renew_layout(self) -> None:
        """Pack all states again (`_repack`), and forget all other keys."""
        self._repack()
        self.waiting_keys = array("Q", [0]) * (MAX_WAITING * self.words)
        self._forget()

    def _learn(self) -> None:
        """Give all cells enough bits for the values that they have in some random traces. Meanwhile, `value` contains
        the last value of each cell that has got enough bits, so that only the others are examined."""
        self._keep_layout()
        for trace in range(SAMPLED_TRACES):
            self.kernel.begin(0, trace)
            for _ in range(SAMPLED_STEPS):
                if self.kernel.step() != UNKNOWN:
                    break
                self._list_changed()
                changed = self.changed_count
                self.changed_count = 0
                for i in range(changed):
                    cell = self.changed[i]
                    if self._is_dead(cell) == 0:
                        self._admit(cell)
                        self.changed[self.changed_count] = cell
                        self.changed_count += 1
                self._accept()
        self._renew_layout()
        self.kernel.root(0)
        for cell in range(self.cell_count):
            self.value[cell] = self._decoded(0, cell)
            self._set_current(cell, self.value[cell])
        for i in range(self.words):
            self.now[i] = self.keys[i]

    # ------------------------------------------------------------ the table

    def _find(self, parent: int) -> int:
        """The number of the state with the key `following`, which is added if it has not been reached before. -1 if
        this would exceed the maximum number of states or the maximum memory."""
        return self._stored(self._look_up(), parent)

    def _stored(self, at: int, parent: int) -> int:
        """Do the same as `_find`, with the index `at` of the state in the table."""
        state: int = (self.table[at] & UINT32_MASK) - 1
        if state >= 0:
            return state
        if self.count >= self.most_states:
            self.status = STATES
            return -1
        if self.count + 2 >= self.state_room:
            self._make_room()
            if self.status != PART:
                return -1
        state = self._add(at)
        self.parent[state] = parent
        return state

    def _wait(self, state: int) -> None:
        """Let the successor of `state` with the key `following` wait. Its number will replace the last word of the
        choices."""
        first = self.waiting * self.words
        for i in range(self.words):
            self.waiting_keys[first + i] = self.following[i]
        self.waiting_tag[self.waiting] = self._tag()
        self.waiting_parent[self.waiting] = state
        self.waiting_code[self.waiting] = self.code_end - 1
        self.waiting += 1
        if self.waiting == MAX_WAITING:
            self._find_waiting()

    def _find_waiting(self) -> None:
        """Find the waiting successors, in their order, and write their numbers into the choices. If a limit is reached,
        this is the status, whatever it was before."""
        waiting = self.waiting
        self.waiting = 0
        # The processor executes the accesses of these loops at the same time, because none depends on another one.
        for k in range(waiting):
            self.waiting_entry[k] = self.table[self.waiting_tag[k] >> self.table_shift]
        for k in range(waiting):
            entry = self.waiting_entry[k]
            if entry != 0:
                self.peeked ^= self.keys[((entry & UINT32_MASK) - 1) * self.words]
        status = self.status
        self.status = PART
        for k in range(waiting):
            for i in range(self.words):
                self.following[i] = self.waiting_keys[k * self.words + i]
            self.tag = self.waiting_tag[k]
            state = self._stored(self._index(), self.waiting_parent[k])
            if state < 0:
                return
            self.code[self.waiting_code[k]] = state
        self.status = status

    def _known(self) -> int:
        """The number of the state with the key `following`; -1 if it has not been stored."""
        return self._state_at(self._look_up())

    def _used(self) -> int:
        """The bytes in use. Memory that was reserved but never written is not included."""
        remembered = (self.passed_mask + 1) * (8 * self.words + 8)
        return (
            self.count * (8 * self.words + 14)
            + 8 * (self.table_mask + 1)
            + 4 * self.code_end
            + 8 * self.real_count
            + remembered
        )

    def _make_room(self) -> None:
        # During the copy, the memory exists twice.
        if self._used() + self.count * 8 * self.words > self.most_bytes:
            self.status = MEMORY
            return
        self._grow()
        self.start = grown(self.start, self.state_room)
        self.parent = grown(self.parent, self.state_room)
        self.label = grown(self.label, self.state_room)
        self.is_partial = grown(self.is_partial, self.state_room)
        if self.passed_mask + 1 < MAX_REMEMBERED:
            self._forget()

    def _emit(self, word: int) -> int:
        if self.code_end == self.code_room:
            if self._used() + 4 * self.code_end > self.most_bytes:
                self.status = MEMORY
                return 0
            self.code_room *= 2
            self.code = grown(self.code, self.code_room)
        self.code[self.code_end] = word
        self.code_end += 1
        return 0

    def _number(self, value: float) -> int:
        """The index of a number in `reals`; a new number is added."""
        known = self.number_of.get(value)
        if known is not None:
            return known
        if self.real_count == self.reals_room:
            self.reals_room *= 2
            self.reals = grown(self.reals, self.reals_room)
        index = self.real_count
        self.reals[index] = value
        self.number_of[value] = index
        self.real_count += 1
        return index

    # ------------------------------------------------------------ a state

    def _judged(self) -> int:
        """The label of the current state, without the part that depends on its choices. Afterwards `memory` contains
        the values that the successors inherit."""
        steps = self.value[self.counter]
        label = 0
        lasting = -1
        for leaf in range(self.leaves):
            verdict = self.value[self.variables + leaf]
            if verdict == UNKNOWN:
                lower = self.kernel.lower[leaf]
                if lower < 0:
                    lasting = leaf
                    if self.kernel._holds(self.kernel.right[leaf]) != 0:
                        label |= HOLDS
                elif self.kernel.right[leaf] == -5:
                    pass
                elif self.lower_bound > 0:
                    if self.kernel._holds(self.kernel.right[leaf]) != 0:
                        label |= HOLDS
                    if self.kernel._holds(self.kernel.left[leaf]) == 0:
                        verdict = FALSE
                elif steps >= lower and self.kernel._holds(self.kernel.right[leaf]) != 0:
                    verdict = TRUE
                elif (
                    self.most_steps > 0 and self.kernel.upper[leaf] >= 0 and steps >= self.kernel.upper[leaf]
                ) or self.kernel._holds(self.kernel.left[leaf]) == 0:
                    verdict = FALSE
            self.kernel.verdict[leaf] = verdict
            if self.remembers != 0:
                self.memory[leaf] = verdict
        status = self._combined()
        if self.lower_bound > 0 and status != UNKNOWN:
            status = FALSE
        label |= status
        if status == UNKNOWN:
            for leaf in range(self.leaves):
                if self.kernel.verdict[leaf] == UNKNOWN:
                    self.kernel.verdict[leaf] = FALSE
            if self._combined() == TRUE:
                label |= FAILS
            if lasting >= 0:
                self.kernel.verdict[lasting] = TRUE
                if self._combined() == TRUE:
                    label |= LASTS
            elif label & FAILS != 0:
                label |= LASTS
        if self.most_steps > 0:
            self.memory[self.leaves] = min(steps + 1, self.most_steps)
        return label

    def _combined(self) -> int:
        """The value of the goal's formula, from the verdicts in the kernel."""
        return self.kernel._value(self.kernel.formula_start[0], self.kernel.formula_start[1])

    def _expand(self, state: int) -> None:
        """Determine the label of a state, and compute its choices if the goal is not decided there."""
        if state == self.layer_end:
            self.depth += 1
            self.layer_end = self.count
        self.start[state] = self.code_end
        self._visit(state)
        label = self._judged()
        if self.kernel.fault != 0:
            self.status = FAULT
            self.problem = state
            return
        leads_on = 0
        if label & STATUS == UNKNOWN and (self.most_depth < 0 or self.depth < self.most_depth):
            self.combinations = 0.0
            exit_reward = 0.0
            if self.kernel.exit_reward >= 0:
                self.kernel.reward = 0.0
                self.kernel._add_reward(self.kernel.exit_reward)
                exit_reward = self.kernel.reward
            pending = self.kernel.enabled_count
            for i in range(pending):
                self.pending[i] = self.kernel.enabled[i]
            if self.leaves_out != 0 and self._leave_choices_out(state) != 0:
                pending = 0
                leads_on = 1
            for i in range(pending):
                if self.status == PART:
                    leads_on |= self._take(self.pending[i], state, exit_reward)
            if self.status != PART:
                self.problem = state
                return
            if leads_on == 0:
                label |= ENDED
                label |= self._end()
        elif label & STATUS == UNKNOWN:
            leads_on = 1
        self.label[state] = label
        self.start[state + 1] = self.code_end
        self.expanded = state + 1

    def _take(self, vector: int, state: int, exit_reward: float) -> int:
        """Write the choices of one vector; return whether one of them leads to another state."""
        count = self._open(vector)
        if self.kernel.fault != 0:
            self.status = FAULT
            return 0
        many = 1.0
        for j in range(count):
            most = 0
            for k in range(self.edge_from[j], self.edge_from[j + 1]):
                most += self.kernel.way_start[self.edges[k] + 1] - self.kernel.way_start[self.edges[k]]
            many *= most
        if self.combinations + many > self.most_choices:
            self.status = CHOICES
            return 0
        self.combinations += many
        weight = 1.0
        for k in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
            weight *= self.kernel.ready[self.kernel.all_slot[k]]
        for j in range(count):
            weight /= self.edge_from[j + 1] - self.edge_from[j]
            self.picks[j] = self.edge_from[j]
        leads_on = 0
        while True:
            leads_on |= self._choose(vector, count, state, weight, exit_reward)
            if self.status != PART or self._next_edges(count) == 0:
                return leads_on

    # ------------------------------------------------------------ choices that suffice

    def _leave_choices_out(self, state: int) -> int:
        """Write the choices of some vectors that suffice, if the goal cannot see them. Return whether they were
        written."""
        vector = self._alone()
        many = 1
        self.looks_at = self.ample.writes_seen
        if vector < 0:
            many = self.ample.find_several()
            self.looks_at = 0
        at = self.code_end
        transitions = self.transitions
        self.is_seen = 0
        for i in range(many):
            if self.status == PART:
                self._take(vector if vector >= 0 else self.ample.smallest[i], state, 0.0)
        self.looks_at = 0
        if self.status != PART or many == 0:
            return 0
        if self.is_seen != 0 or self._may_be_taken(at, state) == 0:
            self.code_end = at
            self.transitions = transitions
            self.combinations = 0.0
            return 0
        if many < self.kernel.enabled_count:
            self.is_partial[state] = 1
        self.alone += 1
        return 1

    def _may_be_taken(self, at: int, state: int) -> int:
        """Whether the choices of a state from an index of `code` on all lead to other states, which have greater
        numbers if cycles are avoided."""
        for k in range(self._list_destinations(at, self.code_end)):
            other = self.reached[k]
            if other == state or (other < state and self.avoids_cycles != 0):
                return 0
        return 1

    def _list_destinations(self, at: int, end: int) -> int:
        """Put the states to which the choices in a part of `code` lead into `reached`; return their number."""
        if len(self.reached) < end - at:
            self.reached = array("i", [0]) * (2 * (end - at))
        count = 0
        while at < end:
            branches = -self.code[at]
            if branches <= 0:
                self.reached[count] = self.code[at]
                count += 1
                at += 1
                continue
            at += 3
            for _ in range(branches):
                self.reached[count] = self.code[at]
                count += 1
                at += 2
        return count

    def _alone(self) -> int:
        """The vector that may be taken alone in the current state; -1 if there is none."""
        vector = self.ample.find()
        if vector < 0 or self.ample.writes_seen != 0:
            unreached = self.ample.find_unreached()
            if unreached >= 0:
                self.ample.writes_seen = 0
                vector = unreached
        if vector < 0:
            vector = self.ample.find_early()
            if vector >= 0 and self._may_end_before(vector) != 0:
                vector = -1
        return vector

    def _may_end_before(self, vector: int) -> int:
        """Whether a trace from the current state may end before `vector` is taken, or whether too many states would
        have to be visited to find out."""
        self.tried_value[:] = self.value
        found = -1
        while found < 0:
            found = self._may_end_without(vector)
            for i in range(self.words):
                self.following[i] = 0
            for i in range(self.live_start[self.words]):
                cell = self.live[i]
                self.following[self.word[cell]] |= (
                    (self.tried_value[cell] - self.low[cell]) & UINT64_MASK
                ) << self.shift[cell]
            self._enter()
        if self.remembers != 0:
            self._judged()
        self.ample.writes_seen = 0
        return found

    def _may_end_without(self, vector: int) -> int:
        """The result of `_may_end_before`; -1 if the layout has changed, so that `tried` is not valid."""
        layout = self.layout
        if len(self.tried) != MAX_TRIED * self.words:
            self.tried = array("Q", [0]) * (MAX_TRIED * self.words)
        for i in range(self.words):
            self.tried[i] = self.now[i]
        self.tried_count = 1
        at = 0
        while at < self.tried_count:
            for i in range(self.words):
                self.following[i] = self.tried[at * self.words + i]
            self._enter()
            leads_on = self._goes_on_without(vector)
            if layout != self.layout:
                return -1
            if leads_on == 0:
                return 1
            at += 1
        return 0

    def _goes_on_without(self, vector: int) -> int:
        """Try the steps of the current state except those of `vector`; return whether a trace cannot end here."""
        if self.kernel.fault != 0:
            self.kernel.fault = 0
            return 0
        single = self.ample.find()
        if single == vector:
            return 1  # It remains possible, so no trace ends before it.
        if single >= 0:
            leads_on = self._try(single)
            if leads_on != 0:
                return 1 if leads_on > 0 else 0
        goes_on = 1 if self.kernel.vector_missing[vector] == 0 else 0
        for i in range(self.kernel.enabled_count):
            other = self.kernel.enabled[i]
            if other != vector and other != single:
                leads_on = self._try(other)
                if leads_on < 0:
                    return 0
                goes_on |= leads_on
        return goes_on

    def _try(self, vector: int) -> int:
        """Add the states to which a vector leads to `tried`; return whether one of them is another state, or -1 if the
        vector is too complicated or held, fails, or if there are too many states. A destination whose probability is
        computed may have the probability 0, so that it does not lead on."""
        if vector >= self.kernel.first_held:
            return -1
        count = 0
        ways = 1
        chance = 0
        for i in range(self.kernel.active_start[vector], self.kernel.active_start[vector + 1]):
            slot = self.kernel.active_slot[i]
            if self.kernel.ready[slot] != 1:
                return -1
            edge = self._only_edge(slot)
            self.kernel.part_slot[count] = slot
            self.kernel.part_way[count] = self.kernel.way_start[edge]
            several = self.kernel.way_start[edge + 1] - self.kernel.way_start[edge]
            if several > 1:
                if ways > 1 or self.kernel.way_chance[self.kernel.way_start[edge]] >= 0:
                    return -1
                ways = several
                chance = count
            count += 1
        leads_on = 0
        for _ in range(ways):
            self.kernel.parts = count
            self.kernel.vector = vector
            self.kernel._execute_ways(vector)
            self.passed += 1
            if self.kernel.fault != 0:
                self.kernel.fault = 0
                self._end_step()
                self._undo()
                return -1
            self._pack_step()
            if self.misfit >= 0:
                self._widen_all()
            self._undo()
            for i in range(self.words):
                if self.following[i] != self.now[i]:
                    leads_on = 1
            if self._add_tried() == 0:
                return -1
            self.kernel.part_way[chance] += 1
        return leads_on

    def _add_tried(self) -> int:
        """Add the state with the key `following` to `tried`, unless it is there; return 0 if there are too many."""
        if len(self.tried) != MAX_TRIED * self.words:
            return 1  # The layout has changed; all is tried again.
        for k in range(self.tried_count):
            same = 1
            for i in range(self.words):
                if self.tried[k * self.words + i] != self.following[i]:
                    same = 0
                    break
            if same != 0:
                return 1
        if self.tried_count == MAX_TRIED:
            return 0
        for i in range(self.words):
            self.tried[self.tried_count * self.words + i] = self.following[i]
        self.tried_count += 1
        return 1

    def _end(self) -> int:
        """The bits that are added to the label of a state in which nothing changes any more."""
        reason = self.kernel._reason(0 if self.kernel.enabled_count == 0 else 1)
        added = 0
        if reason == STUCK:
            added = GETS_STUCK
        if reason == TIME:
            for leaf in range(self.leaves):
                if self.kernel.lower[leaf] < 0 and self.kernel._holds(self.kernel.left[leaf]) != 0:
                    added = OPEN
        return added

    def _open(self, vector: int) -> int:
        """Collect the enabled edges of each slot that has an effect, and the probabilities of their ways; return the
        number of these slots."""
        count = 0
        edge_count = 0
        for i in range(self.kernel.active_start[vector], self.kernel.active_start[vector + 1]):
            slot = self.kernel.active_slot[i]
            self.slots[count] = slot
            self.edge_from[count] = edge_count
            count += 1
            group = self.kernel.slot_group[slot]
            first = self.kernel.edge_start[group]
            end = self.kernel.edge_start[group + 1]
            is_single = 1 if end - first == 1 else 0
            at = -1
            if self.kernel.group_index[group] >= 0:
                at = self.kernel._list(self.kernel.group_index[group])
                first = self.kernel.list_start[at]
                end = self.kernel.list_start[at + 1]
            for k in range(first, end):
                edge = k if at < 0 else self.kernel.list_item[k]
                if edge < 0:
                    edge = -1 - edge
                    guard = -1
                else:
                    guard = self.kernel.guard[edge]
                if is_single == 0 and guard >= 0 and self.kernel._execute(guard) == 0:
                    continue
                self.edges[edge_count] = edge
                edge_count += 1
                if self.kernel.way_chance[self.kernel.way_start[edge]] >= 0:
                    self._weigh(edge)
        self.edge_from[count] = edge_count
        return count

    def _weigh(self, edge: int) -> None:
        """Compute the probabilities of the destinations of an edge."""
        first = self.kernel.way_start[edge]
        end = self.kernel.way_start[edge + 1]
        if end - first == 1:
            self.chance[first] = 1.0
            return
        total = 0.0
        for way in range(first, end):
            register = self.kernel._execute(self.kernel.way_chance[way])
            if self.kernel.fault != 0:
                return
            self.chance[way] = self.kernel.reals[register]
            total += self.chance[way]
            if self.chance[way] < 0.0:
                self.kernel._fail(6, self.kernel.way_chance[way])
                return
        if total < 0.999999 or total > 1.000001:
            self.kernel._fail(6, self.kernel.way_chance[first])
            return
        for way in range(first, end):
            self.chance[way] /= total

    def _first_ways(self, count: int) -> None:
        for j in range(count):
            self.ways[j] = self.kernel.way_start[self.edges[self.picks[j]]]

    def _next_ways(self, count: int) -> int:
        """Go to the next combination of destinations; return 0 if there is none."""
        for j in range(count):
            edge = self.edges[self.picks[j]]
            self.ways[j] += 1
            if self.ways[j] < self.kernel.way_start[edge + 1]:
                return 1
            self.ways[j] = self.kernel.way_start[edge]
        return 0

    def _next_edges(self, count: int) -> int:
        """Go to the next combination of edges; return 0 if there is none."""
        for j in range(count):
            self.picks[j] += 1
            if self.picks[j] < self.edge_from[j + 1]:
                return 1
            self.picks[j] = self.edge_from[j]
        return 0

    def _choose(self, vector: int, count: int, state: int, weight: float, exit_reward: float) -> int:
        """Write one choice; return whether it leads to another state."""
        self.branches = 0
        is_plain = 1 if weight == 1.0 and self.kernel.step_reward < 0 and self.kernel.exit_reward < 0 else 0
        for j in range(count):
            edge = self.edges[self.picks[j]]
            if self.kernel.way_start[edge + 1] - self.kernel.way_start[edge] > 1:
                is_plain = 0
        self._first_ways(count)
        if is_plain != 0:
            self.branches = 1
            successor = self._successor(vector, count, state)
            if successor < 0:
                return 0
            self._emit_successor(successor, state)
            self.transitions += 1
            return 1 if successor != state or self.has_passed != 0 else 0
        if weight != 1.0:
            self.is_weighted = 1
        head = self.code_end
        self._emit(0)
        self._emit(self._number(weight))
        self._emit(0)
        reward = exit_reward
        leads_on = 0
        while True:
            chance = 1.0
            for j in range(count):
                chance *= self.chance[self.ways[j]]
            if chance > 0.0:
                self.branches += 1
                successor = self._successor(vector, count, state)
                if successor < 0:
                    return 0
                if successor != state or self.has_passed != 0:
                    leads_on = 1
                if self.kernel.step_reward >= 0:
                    reward += chance * self.kernel.reward
                self._emit_successor(successor, state)
                self._emit(self._number(chance))
                self.transitions += 1
                if self.status != PART:
                    return 0
            if self._next_ways(count) == 0:
                break
        self.code[head] = -self.branches
        self.code[head + 2] = self._number(reward)
        return leads_on

    def _successor(self, vector: int, count: int, state: int) -> int:
        """The number of the state to which the ways in `ways` lead; -1 if there is none; WAITS if `following` is its
        key, which has not been looked up."""
        self._execute_choice(vector, count)
        if self.kernel.fault != 0:
            self.status = FAULT
            return -1
        self._pack_step()
        if self.misfit >= 0:
            self._widen_all()
            if self.status != PART:
                return -1
        self._undo()
        if self.leaves_out != 0:
            return self._pass_on(state)
        for i in range(self.words):
            if self.following[i] != self.now[i]:
                return WAITS
        return state

    def _emit_successor(self, successor: int, state: int) -> None:
        self._emit(successor)
        if successor == WAITS and self.status == PART:
            self._wait(state)

    def _execute_choice(self, vector: int, count: int) -> None:
        for j in range(count):
            self.kernel.part_slot[j] = self.slots[j]
            self.kernel.part_way[j] = self.ways[j]
            self.taken[self.ways[j]] = 1
        self.kernel.parts = count
        self.kernel.reward = 0.0
        self.kernel._execute_ways(vector)
        if self.looks_at != 0 and self.kernel.fault == 0 and self._is_seen() != 0:
            self.is_seen = 1

    def _pass_on(self, state: int) -> int:
        """The number of the first state to be stored on the path of single steps that begins with the key `following`;
        -1 if there is none. Afterwards the kernel is in the state with the number `state` again."""
        self.has_passed = 0
        successor = self._known()
        if successor >= 0:
            return successor
        layout = self.layout
        steps = 0
        left = 0
        at = -1
        has_moved = 0
        while successor < 0 and steps < MAX_PASSED:
            at = self.tag & self.passed_mask
            left = self._recalled(at, MAX_PASSED - steps)
            if left != 0:
                successor = self.passed_to[at]
                break
            self._remember(at)
            has_moved = 1
            if self._pass() == 0:
                break
            self.trail[steps] = at
            steps += 1
            successor = self._known()
        self._turn_back()
        self.passed += steps
        if steps == MAX_PASSED:
            self.circled += steps
        if self.kernel.fault != 0:
            self.status = FAULT
            return -1
        if steps + left != 0:
            self.has_passed = 1
        if successor < 0:
            successor = self._find(state)
        if layout == self.layout and successor >= 0 and steps < MAX_PASSED:
            # If several states of the path have the same index, the last of them is the one that is remembered. If this
            # is the end of the path, which is stored, the number of steps does not matter.
            for i in range(steps):
                self.passed_to[self.trail[i]] = successor
                self.passed_left[self.trail[i]] = steps + left - i
        if has_moved != 0:
            self._return(state)
        return successor

    def _recalled(self, at: int, most: int) -> int:
        """The number of steps from the state with the key `following` to a stored one, if an earlier path contained it,
        and if there are at most `most`; 0 otherwise."""
        left: int = self.passed_left[at]
        if left == 0 or left > most:
            return 0
        first = at * self.words
        for i in range(self.words):
            if self.passed_keys[first + i] != self.following[i]:
                return 0
        return left

    def _remember(self, at: int) -> None:
        """Remember that a path contains the state with the key `following`."""
        first = at * self.words
        for i in range(self.words):
            self.passed_keys[first + i] = self.following[i]
        self.passed_left[at] = 0

    def _forget(self) -> None:
        """Forget the states that were not stored: keys have another layout, or there is room for more states."""
        self.layout += 1
        if self.leaves_out != 0:
            size = min(self.state_room, MAX_REMEMBERED)
            self.passed_mask = size - 1
            self.passed_keys = flat("Q", size * self.words)
            self.passed_to = flat("i", size)
            self.passed_left = flat("i", size)

    def _return(self, state: int) -> None:
        """Go back to a state that is being expanded."""
        self._visit(state)
        if self.remembers != 0:
            self._judged()

    def _pass(self) -> int:
        """Replace the key `following` of a state by that of its successor if only one step is taken there, without
        chance. Return whether the key was replaced. If `is_ahead` is 1, the step has not been undone, because the path
        may go on from there: either `_pass` or `_turn_back` must follow."""
        if self.is_ahead != 0:
            self.is_ahead = 0
            self._go_on()
        else:
            self._enter()
        label = self._judged()
        if label & STATUS != UNKNOWN or self.kernel.fault != 0:
            return 0
        vector = self._alone()
        if vector < 0:
            return 0
        count = 0
        for i in range(self.kernel.active_start[vector], self.kernel.active_start[vector + 1]):
            slot = self.kernel.active_slot[i]
            way = self._only_way(slot)
            if way < 0:
                return 0
            self.kernel.part_slot[count] = slot
            self.kernel.part_way[count] = way
            self.taken[way] = 1
            count += 1
        self.kernel.parts = count
        self.kernel.vector = vector
        self.kernel._execute_ways(vector)
        if self.kernel.fault != 0:
            return 0
        if self.ample.writes_seen != 0 and self._is_seen() != 0:
            self._end_step()
            self._undo()
            return 0
        self._pack_step()
        if self.misfit >= 0:
            self._widen_all()
            self._undo()
        else:
            self.is_ahead = 1
        for i in range(self.words):
            if self.following[i] != self.now[i]:
                return 1
        return 0

    def _turn_back(self) -> None:
        """Undo the last step of a path, unless `_pass` has done so."""
        if self.is_ahead != 0:
            self.is_ahead = 0
            self._undo()

    def _is_seen(self) -> int:
        """Whether the step that the kernel has executed has changed the value of a variable that the goal reads."""
        for j in range(self.kernel.parts):
            way = self.kernel.part_way[j]
            for k in range(self.way_start[way], self.way_start[way + 1]):
                cell = self.way_cell[k]
                watch = self.watch[cell - self.places]
                if (
                    watch >= 0
                    and self.kernel.seen_start[watch] < self.kernel.seen_start[watch + 1]
                    and self._has_changed(cell) != 0
                ):
                    return 1
        return 0

    def _only_way(self, slot: int) -> int:
        """The way of the only enabled edge of a slot; -1 if the edge has several ways."""
        edge = self._only_edge(slot)
        way = self.kernel.way_start[edge]
        return way if self.kernel.way_start[edge + 1] == way + 1 else -1

    def _only_edge(self, slot: int) -> int:
        """The only enabled edge of a slot."""
        place = self.kernel.place[self.kernel.slot_instance[slot]]
        group = self.kernel.group_start[place]
        while self.kernel.group_slot[group] != slot:
            group += 1
        first = self.kernel.edge_start[group]
        end = self.kernel.edge_start[group + 1]
        edge = first
        while end - first > 1 and self.kernel.guard[edge] >= 0 and self.kernel._execute(self.kernel.guard[edge]) == 0:
            edge += 1
        return edge

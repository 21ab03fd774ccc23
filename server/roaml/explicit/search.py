# SPDX-License-Identifier: Apache-2.0
"""The search through all states of a program, breadth first.

- Plain Python; Cython compiles it with the types in `search.pxd`, like the kernel, whose code computes the successors.
- A state is packed into words of 64 bits. A *cell* (see `tables`) gets as many bits as its values so far require: none
  while its value does not change. If a value does not fit, the cell gets more bits, for which all states may have to be
  packed again.
- A hash table with open addressing contains the numbers of the states, each with half of the hash of the state. Its
  upper bits are the index at which the search for the state begins.
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

from roaml.explicit.memory import flat, grown

if TYPE_CHECKING:
    from roaml.explicit.ample import AmpleSets
    from roaml.explicit.tables import Tables
    from roaml.smc.kernel import Kernel

UINT64_MASK = 0xFFFFFFFFFFFFFFFF
HASH_1 = 0x9E3779B97F4A7C15
HASH_2 = 0xBF58476D1CE4E5B9
UINT32_MASK = 0xFFFFFFFF
MAX_INT64 = 0x7FFFFFFFFFFFFFFF
SPARE_BITS_FROM_STATES = 4096
"""With more states than this, cells get more bits than they need, because packing all states again is slow."""
MAX_SPREAD_BITS = 40
"""Cells with more bits than this get no unused ones."""
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


class StateSearch:
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
        passed: the number of steps from states that are not stored. A path that is remembered is not followed again.
        circled: the number of these steps on paths that were ended because they may form a cycle.
    """

    def __init__(
        self, kernel: Any, tables: Tables, steps: int, lower: int, depth: int, most_states: int, most_bytes: int,
        most_choices: int,
    ) -> None:  # fmt: skip
        self.kernel: Kernel = kernel
        self.way_start = tables.way_start
        self.way_cell = tables.way_cell
        self.settled = tables.settled
        self.cell_watch = tables.cell_watch
        self.drop_start = tables.drop_start
        self.drop_cell = tables.drop_cell
        self.owner_start = tables.owner_start
        self.owner_instance = tables.owner_instance
        self.owner_table = tables.owner_table
        self.is_dead = tables.is_dead
        self.places = self.kernel.instances
        self.first_real = self.places + self.kernel.int_count
        self.variables = self.first_real + self.kernel.real_count
        self.leaves = self.kernel.leaves
        self.counter = self.variables + self.leaves
        self.cells = self.counter + 1
        self.most_steps = steps
        self.lower_bound = lower
        self.remembers = 1 if self.leaves > 1 or steps > 0 else 0
        self.most_states = min(most_states, MAX_COUNTED_STATES)
        self.most_bytes = most_bytes
        self.most_choices = most_choices
        self.depth = 0
        self.most_depth = depth
        self.layer_end = 1

        box = array("d", [0.0])
        self.box = box
        self.box_bits = memoryview(box).cast("B").cast("q")
        self.initial = array("q", [0] * self.cells)
        self.low = array("q", [0] * self.cells)
        self.bits = array("i", [0] * self.cells)
        self.mask = array("Q", [0] * self.cells)
        self.word = array("i", [0] * self.cells)
        self.shift = array("i", [0] * self.cells)
        self.live_start = array("i", [0, 0])
        self.live = array("i", [0] * self.cells)
        self.room = array("Q", [0] * self.cells)
        self.old_words = 1
        self.old_mask = array("Q", [0] * self.cells)
        self.old_low = array("q", [0] * self.cells)
        self.old_word = array("i", [0] * self.cells)
        self.old_shift = array("i", [0] * self.cells)
        self.words = 1
        self.value = array("q", [0] * self.cells)
        self.memory = array("q", [0] * (self.leaves + 1))
        self.now = array("Q", [0])
        self.following = array("Q", [0])
        self.misfit = -1
        self.misfit_value = 0
        self.unused = 0
        self.has_learned = 0

        ways = len(self.kernel.way_target)
        self.chance = array("d", [0.0] * (ways + 1))
        for edge in range(len(self.kernel.guard)):
            before = 0.0
            for way in range(self.kernel.way_start[edge], self.kernel.way_start[edge + 1]):
                self.chance[way] = self.kernel.way_sum[way] - before
                before = self.kernel.way_sum[way]
        slots = self.kernel.instances + 1
        self.edges = array("i", [0] * (len(self.kernel.guard) + 1))
        self.edge_from = array("i", [0] * (slots + 1))
        self.slots = array("i", [0] * slots)
        self.picks = array("i", [0] * slots)
        self.ways = array("i", [0] * slots)
        self.moved = array("i", [0] * slots)
        self.leaves_out = 0
        self.alone = 0
        self.passed = 0
        self.circled = 0
        self.has_passed = 0
        self.looks_at = 0
        self.is_seen = 0
        self.layout = 0
        self.trail = array("i", [0] * MAX_PASSED)
        self.passed_mask = 0
        self.passed_keys = flat("Q", 1)
        self.passed_to = flat("i", 1)
        self.passed_left = flat("i", 1)
        self.pending = array("i", [0] * (len(self.kernel.enabled) + 1))

        self.keys = flat("Q", 64)
        self.table_mask = 255
        self.table_shift = 24
        self.tag = 0
        self.table = flat("Q", 256)
        self.start = flat("q", 64)
        self.parent = flat("i", 64)
        self.label = flat("B", 64)
        self.state_room = 64
        self.key_room = 64
        self.code = flat("i", 256)
        self.code_room = 256
        self.code_end = 0
        self.reals = flat("d", 64)
        self.reals_room = 64
        self.number_of: dict[float, int] = {}
        self.real_count = 0
        self.count = 0
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
        for cell in range(self.cells):
            self.initial[cell] = self._current(cell)
            self.low[cell] = self.initial[cell]
            self.value[cell] = self.initial[cell]
        if self.kernel.fault != 0:
            self.status = FAULT
        for cell in range(self.places):
            self._fit(cell, self.low[cell])
        self._lay_out()
        self.now = array("Q", [0] * self.words)
        self.following = array("Q", [0] * self.words)
        for cell in range(self.cells):
            self._pack(cell)
        self.now[:] = self.following
        self.key_room = self.state_room * self.words
        self.keys = flat("Q", self.key_room)
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

    def leave_out(self, ample: AmpleSets) -> None:
        """Leave out choices where `ample` finds a vector that may be taken alone."""
        self.ample = ample
        self.leaves_out = 1
        self._forget()

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
                if self.count > SPARE_BITS_FROM_STATES and self.has_learned == 0:
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
        return [self._decoded(state, cell) for cell in range(self.cells)]

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
        self._pack_parts()
        self._undo_parts()
        if self.leaves_out == 0:
            return [] if self._known() == successor else None
        steps: list[tuple[int, list[int], list[int]]] = []
        while self._known() != successor:
            if len(steps) == MAX_PASSED or self._pass() == 0:
                self._return(state)
                return None
            steps.append((self.kernel.vector, [0] * self.kernel.parts, [0] * self.kernel.parts))
        return steps

    def fault(self) -> tuple[int, int, int, int, float]:
        """The undefined operation that ended the search; see `Kernel.problem`."""
        problem: tuple[int, int, int, int, float] = self.kernel.problem()
        return problem

    def visit(self, state: int) -> None:
        """Restore the kernel to the state with the number `state`."""
        self._visit(state)

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
            for cell in range(self.cells):
                self._pack(cell)
            while self.misfit >= 0:
                self._widen()
                for cell in range(self.cells):
                    self._pack(cell)
            state = self._find(-1)
            if state < 0:
                return
            if self.entered == self.root_room:
                self.root_room *= 2
                self.roots = grown(self.roots, self.root_room)
            self.roots[self.entered] = state
            self.entered += 1
        # The kernel is in the state that `value` and `now` describe.
        self.kernel.root(0)
        for i in range(self.words):
            self.now[i] = self.keys[i]
        self.layer_end = self.count

    # ------------------------------------------------------------ packing

    def _current(self, cell: int) -> int:
        """The value of a cell in the kernel; for a real number, its bit pattern as an integer."""
        value: int
        if cell < self.places:
            value = self.kernel.place[cell]
        elif cell < self.first_real:
            value = self.kernel.ints[cell - self.places]
        elif cell < self.variables:
            self.box[0] = self.kernel.reals[cell - self.first_real]
            value = self.box_bits[0]
        else:
            value = self.memory[cell - self.variables]
        return value

    def _set_current(self, cell: int, value: int) -> None:
        if cell < self.places:
            self.kernel.place[cell] = value
        elif cell < self.first_real:
            self.kernel.ints[cell - self.places] = value
        elif cell < self.variables:
            self.box_bits[0] = value
            self.kernel.reals[cell - self.first_real] = self.box[0]
        else:
            self.memory[cell - self.variables] = value

    def _is_dead(self, cell: int) -> int:
        """Whether the value of a variable does not matter in the current locations."""
        for k in range(self.owner_start[cell], self.owner_start[cell + 1]):
            if self.is_dead[self.owner_table[k] + self.kernel.place[self.owner_instance[k]]] != 0:
                return 1
        return 0

    def _reset_dead(self) -> None:
        """Give the dead cells their initial values that the step of the kernel has written, or that were not dead
        before it."""
        for j in range(self.kernel.parts):
            way = self.kernel.part_way[j]
            for k in range(self.way_start[way], self.way_start[way + 1]):
                if self._is_dead(self.way_cell[k]) != 0:
                    self._set_current(self.way_cell[k], self.initial[self.way_cell[k]])
            move = self.kernel.way_move[way]
            if move >= 0:
                for k in range(self.drop_start[move], self.drop_start[move + 1]):
                    self._set_current(self.drop_cell[k], self.initial[self.drop_cell[k]])

    def _pack(self, cell: int) -> None:
        """Put the current value of a cell into `following`. If the value does not fit, store the cell in `misfit`."""
        value = self._current(cell)
        code = (value - self.low[cell]) & UINT64_MASK
        if code > self.mask[cell]:
            self.misfit = cell
            self.misfit_value = value
            return
        if self.mask[cell] == 0:
            return
        at = self.word[cell]
        shift = self.shift[cell]
        self.following[at] = (self.following[at] & (UINT64_MASK ^ (self.mask[cell] << shift))) | (code << shift)

    def _decoded(self, state: int, cell: int) -> int:
        code = (self.keys[state * self.words + self.word[cell]] >> self.shift[cell]) & self.mask[cell]
        return self._signed((code + self.low[cell]) & UINT64_MASK)

    def _signed(self, value: int) -> int:
        return value - UINT64_MASK - 1 if value > MAX_INT64 else value

    def _widen(self) -> None:
        """Give the cell `misfit` enough bits for `misfit_value`. All states are packed again, unless the cell had no
        bits and finds unused ones."""
        cell = self.misfit
        self.misfit = -1
        self._keep_layout()
        self._fit(cell, self.misfit_value)
        # The code of a cell that has not changed so far is 0 in all states, wherever its bits are.
        if self.old_mask[cell] != 0 or self.low[cell] != self.old_low[cell] or self._squeeze_in(cell) == 0:
            self._repack()

    def _squeeze_in(self, cell: int) -> int:
        """Find unused bits for a cell that has none; return whether there are any."""
        for at in range(self.words):
            used = 0
            for i in range(self.live_start[at], self.live_start[at + 1]):
                used += self.bits[self.live[i]]
            if used + self.bits[cell] <= 64:
                i = self.live_start[self.words]
                while i > self.live_start[at + 1]:
                    self.live[i] = self.live[i - 1]
                    i -= 1
                self.live[i] = cell
                for k in range(at + 1, self.words + 1):
                    self.live_start[k] += 1
                self.word[cell] = at
                self.shift[cell] = used
                self.mask[cell] = self.room[cell]
                return 1
        return 0

    def _learn(self) -> None:
        """Give all cells enough bits for the values that they have in some random traces."""
        self._keep_layout()
        for trace in range(SAMPLED_TRACES):
            self.kernel.begin(0, trace)
            for _ in range(SAMPLED_STEPS):
                if self.kernel.step() != UNKNOWN:
                    break
                for cell in range(self.variables):
                    value = self._current(cell)
                    if self._is_dead(cell) == 0 and ((value - self.low[cell]) & UINT64_MASK) > self.room[cell]:
                        self._fit(cell, value)
        self._repack()
        self.kernel.root(0)
        for cell in range(self.cells):
            value = self._decoded(0, cell)
            self.value[cell] = value
            self._set_current(cell, value)
        for i in range(self.words):
            self.now[i] = self.keys[i]

    def _keep_layout(self) -> None:
        """Store how the states are currently packed."""
        for i in range(self.cells):
            self.old_mask[i] = self.mask[i]
            self.old_low[i] = self.low[i]
            self.old_word[i] = self.word[i]
            self.old_shift[i] = self.shift[i]
        self.old_words = self.words

    def _fit(self, cell: int, value: int) -> None:
        """Give a cell enough bits for a value."""
        unit = 1
        least = self.low[cell]
        if cell < self.places:
            # The cell of a location gets enough bits for all locations of the instance.
            last = self.kernel.first_location[cell + 1] if cell + 1 < self.places else len(self.kernel.location_mark)
            least = self.kernel.first_location[cell]
            value = last - 1
            self.low[cell] = least
        greatest = least + self.room[cell]
        span = (greatest - value if value < least else value - least) & UINT64_MASK
        bits = 0
        while bits < 62 and span >> bits != 0:
            bits += 1
        if self.count > SPARE_BITS_FROM_STATES:
            bits += 2
        if bits >= 60 or self.first_real <= cell < self.variables:
            self.bits[cell] = 64
            self.room[cell] = UINT64_MASK
            self.low[cell] = 0
        else:
            self.bits[cell] = bits
            self.room[cell] = (unit << bits) - 1
            if value < least:
                self.low[cell] = greatest - ((unit << bits) - 1)

    def _repack(self) -> None:
        """Pack all states again."""
        if self.count > SPARE_BITS_FROM_STATES:
            self._spread()
        self._lay_out()
        self.now = array("Q", [0] * self.words)
        self.following = array("Q", [0] * self.words)
        self.waiting_keys = array("Q", [0] * (MAX_WAITING * self.words))
        old_keys = self.keys
        self.key_room = self.state_room * self.words
        self.keys = flat("Q", self.key_room)
        for state in range(self.count):
            source = state * self.old_words
            target = state * self.words
            for i in range(self.live_start[self.words]):
                cell = self.live[i]
                code = (old_keys[source + self.old_word[cell]] >> self.old_shift[cell]) & self.old_mask[cell]
                code = (code + self.old_low[cell] - self.low[cell]) & UINT64_MASK
                self.keys[target + self.word[cell]] |= code << self.shift[cell]
        self._rehash()
        self._forget()

    def _spread(self) -> None:
        """Give half of the bits that would be unused in the last word to variables, those with most bits first. When
        one counter exceeds its bits, others often do so soon."""
        words = self._words_needed()
        left = self.unused // 2
        for bits in range(MAX_SPREAD_BITS, 1, -1):
            for cell in range(self.places, self.first_real):
                if left == 0:
                    return
                if self.bits[cell] != bits:
                    continue
                self.bits[cell] += 1
                if self._words_needed() > words:
                    self.bits[cell] -= 1
                    continue
                self.room[cell] = 2 * self.room[cell] + 1
                left -= 1

    def _words_needed(self) -> int:
        """The number of words in which all cells fit; `unused` becomes the number of bits that the last one has
        left."""
        words = 1
        used = 0
        for cell in range(self.cells):
            bits = self.bits[cell]
            if used + bits > 64:
                words += 1
                used = 0
            used += bits
        self.unused = 64 - used
        return words

    def _lay_out(self) -> None:
        """Assign a word and a shift to each cell. The bits of a cell are in one word."""
        at = 0
        used = 0
        first = True
        live = 0
        starts = [0]
        for cell in range(self.cells):
            bits = self.bits[cell]
            self.mask[cell] = self.room[cell]
            self.word[cell] = 0
            self.shift[cell] = 0
            if bits == 0:
                continue
            if not first and used + bits > 64:
                at += 1
                used = 0
                starts.append(live)
            first = False
            self.word[cell] = at
            self.shift[cell] = used
            used += bits
            self.live[live] = cell
            live += 1
        starts.append(live)
        self.words = at + 1
        self.live_start = array("i", starts)

    # ------------------------------------------------------------ the table

    def _hash_of(self, at: int) -> int:
        """The hash of the key at an index of `keys`."""
        value = HASH_2
        for i in range(self.words):
            value = ((value ^ self.keys[at + i]) * HASH_1) & UINT64_MASK
            value ^= value >> 32
        return (value * HASH_2) & UINT64_MASK

    def _rehash(self) -> None:
        """Fill the table anew, after the keys of the states have changed."""
        size = self.table_mask + 1
        self.table = flat("Q", size)
        for state in range(self.count):
            tag = self._hash_of(state * self.words) >> 32
            at = tag >> self.table_shift
            while self.table[at] != 0:
                at = (at + 1) & self.table_mask
            self.table[at] = (tag << 32) | (state + 1)

    def _double_table(self) -> None:
        """Double the size of the table. Its entries move in ascending order, so the memory is accessed in order."""
        old_table = self.table
        size = self.table_mask + 1
        self.table = flat("Q", 2 * size)
        self.table_mask = 2 * size - 1
        self.table_shift -= 1
        for i in range(size):
            entry = old_table[i]
            if entry == 0:
                continue
            at = entry >> 32 >> self.table_shift
            while self.table[at] != 0:
                at = (at + 1) & self.table_mask
            self.table[at] = entry

    def _look_up(self) -> int:
        """The index in the table of the state with the key `following`. If this state has not been stored, this is the
        index where it will be, and `tag` is the half of its hash that is stored."""
        self.tag = self._tag()
        return self._index()

    def _tag(self) -> int:
        """The half of the hash of the key `following` that is stored in the table."""
        value = HASH_2
        for i in range(self.words):
            value = ((value ^ self.following[i]) * HASH_1) & UINT64_MASK
            value ^= value >> 32
        return ((value * HASH_2) & UINT64_MASK) >> 32

    def _index(self) -> int:
        """The index in the table for the key `following`, whose hash is in `tag`."""
        tag = self.tag
        at = tag >> self.table_shift
        while True:
            entry = self.table[at]
            if entry == 0:
                break
            if entry >> 32 == tag:
                first = ((entry & UINT32_MASK) - 1) * self.words
                same = 1
                for i in range(self.words):
                    if self.keys[first + i] != self.following[i]:
                        same = 0
                        break
                if same != 0:
                    break
            at = (at + 1) & self.table_mask
        return at

    def _find(self, parent: int) -> int:
        """The number of the state with the key `following`, which is added if it has not been reached before. -1 if
        this would exceed the maximum number of states or the maximum memory."""
        return self._stored(self._look_up(), parent)

    def _stored(self, at: int, parent: int) -> int:
        """Do the same as `_find`, with the index `at` of the state in the table."""
        state: int = (self.table[at] & UINT32_MASK) - 1
        if state >= 0:
            return state
        state = self.count
        if state >= self.most_states:
            self.status = STATES
            return -1
        if state + 2 >= self.state_room or (state + 1) * self.words > self.key_room:
            self._make_room()
            if self.status != PART:
                return -1
        first = state * self.words
        for i in range(self.words):
            self.keys[first + i] = self.following[i]
        self.parent[state] = parent
        self.table[at] = (self.tag << 32) | (state + 1)
        self.count += 1
        if self.count * 8 > self.table_mask * 5:
            self._double_table()
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
        state: int = (self.table[self._look_up()] & UINT32_MASK) - 1
        return state

    def _used(self) -> int:
        """The bytes in use. Memory that was reserved but never written is not included."""
        remembered = (self.passed_mask + 1) * (8 * self.words + 8)
        return (
            self.count * (8 * self.words + 13)
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
        self.state_room *= 2
        self.key_room = self.state_room * self.words
        self.keys = grown(self.keys, self.key_room)
        self.start = grown(self.start, self.state_room)
        self.parent = grown(self.parent, self.state_room)
        self.label = grown(self.label, self.state_room)
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

    def _visit(self, state: int) -> None:
        """Restore the kernel to the state with the number `state`, and update what is enabled. Only cells that differ
        from those of the previous state are examined."""
        first = state * self.words
        for w in range(self.words):
            self.following[w] = self.keys[first + w]
        self._enter()

    def _enter(self) -> None:
        """Do the same as `_visit` for the state with the key `following`."""
        moved = 0
        for w in range(self.words):
            code = self.following[w]
            if code == self.now[w]:
                continue
            self.now[w] = code
            for i in range(self.live_start[w], self.live_start[w + 1]):
                cell = self.live[i]
                value = self._signed((((code >> self.shift[cell]) & self.mask[cell]) + self.low[cell]) & UINT64_MASK)
                if value == self.value[cell]:
                    continue
                if cell < self.places:
                    place = self.value[cell]
                    for group in range(self.kernel.group_start[place], self.kernel.group_start[place + 1]):
                        self.kernel._set_ready(self.kernel.group_slot[group], 0)
                    self.moved[moved] = cell
                    moved += 1
                elif cell < self.variables and self.cell_watch[cell] >= 0:
                    self.kernel._note(self.cell_watch[cell])
                self.value[cell] = value
                self._set_current(cell, value)
        if self.remembers != 0:
            for cell in range(self.variables, self.cells):
                self.memory[cell - self.variables] = self.value[cell]
        for i in range(moved):
            self.kernel._arrive(self.kernel.place[self.moved[i]])
        if self.kernel.note_count != 0:
            self.kernel._look_around()

    def _judged(self) -> int:
        """The label of the current state, without the part that depends on its choices. Afterwards `memory` contains
        the values that the successors inherit."""
        steps = self.memory[self.leaves]
        label = 0
        lasting = -1
        for leaf in range(self.leaves):
            verdict = self.memory[leaf]
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
        if self.most_steps > 0 and steps < self.most_steps:
            self.memory[self.leaves] = steps + 1
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
            combinations = 0.0
            exit_reward = 0.0
            if self.kernel.exit_reward >= 0:
                self.kernel.reward = 0.0
                self.kernel._add_reward(self.kernel.exit_reward)
                exit_reward = self.kernel.reward
            pending = self.kernel.enabled_count
            for i in range(pending):
                self.pending[i] = self.kernel.enabled[i]
            if self.leaves_out != 0:
                vector = self.ample.find()
                if vector >= 0 and self._take_alone(vector, state) != 0:
                    pending = 0
                    leads_on = 1
                if self.status != PART:
                    self.problem = state
                    return
            for i in range(pending):
                vector = self.pending[i]
                count = self._open(vector)
                if self.kernel.fault != 0:
                    self.status = FAULT
                    self.problem = state
                    return
                many = 1.0
                for j in range(count):
                    most = 0
                    for k in range(self.edge_from[j], self.edge_from[j + 1]):
                        most += self.kernel.way_start[self.edges[k] + 1] - self.kernel.way_start[self.edges[k]]
                    many *= most
                if combinations + many > self.most_choices:
                    self.status = CHOICES
                    self.problem = state
                    return
                combinations += many
                weight = 1.0
                for k in range(self.kernel.all_start[vector], self.kernel.all_start[vector + 1]):
                    weight *= self.kernel.ready[self.kernel.all_slot[k]]
                for j in range(count):
                    weight /= self.edge_from[j + 1] - self.edge_from[j]
                    self.picks[j] = self.edge_from[j]
                while True:
                    leads_on |= self._choose(vector, count, state, weight, exit_reward)
                    if self.status != PART:
                        self.problem = state
                        return
                    if self._next_edges(count) == 0:
                        break
            if leads_on == 0:
                label |= ENDED
                label |= self._end()
        elif label & STATUS == UNKNOWN:
            leads_on = 1
        self.label[state] = label
        self.start[state + 1] = self.code_end
        self.expanded = state + 1

    def _take_alone(self, vector: int, state: int) -> int:
        """Write the choices of one vector, if the goal cannot see it, and if all choices lead to states that have not
        been expanded. So each cycle of states contains one whose choices are all known. Return whether the choices were
        written."""
        at = self.code_end
        transitions = self.transitions
        count = self._open(vector)
        if self.kernel.fault != 0:
            self.status = FAULT
            return 0
        for j in range(count):
            self.picks[j] = self.edge_from[j]
        self.is_seen = 0
        self.looks_at = self.ample.writes_seen
        self._choose(vector, count, state, 1.0, 0.0)
        self.looks_at = 0
        if self.status != PART:
            return 0
        may_leave_out = 1 - self.is_seen
        if self.code[at] >= 0:
            if self.code[at] <= state:
                may_leave_out = 0
        else:
            for k in range(-self.code[at]):
                if self.code[at + 3 + 2 * k] <= state:
                    may_leave_out = 0
        if may_leave_out == 0:
            self.code_end = at
            self.transitions = transitions
            return 0
        self.alone += 1
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
        self._pack_parts()
        while self.misfit >= 0:
            self._find_waiting()
            if self.status != PART:
                return -1
            self._widen()
            for i in range(self.words):
                self.now[i] = self.keys[state * self.words + i]
            for cell in range(self.cells):
                self._pack(cell)
        self._undo_parts()
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
        self.kernel.parts = count
        self.kernel.reward = 0.0
        self.kernel._execute_ways(vector)
        if self.looks_at != 0 and self.kernel.fault == 0 and self._is_seen() != 0:
            self.is_seen = 1

    def _pack_parts(self) -> None:
        """Put the key of the state after a step into `following`. The kernel has executed the step."""
        self._reset_dead()
        for i in range(self.words):
            self.following[i] = self.now[i]
        for j in range(self.kernel.parts):
            way = self.kernel.part_way[j]
            self._pack(self.kernel.slot_instance[self.kernel.part_slot[j]])
            for k in range(self.way_start[way], self.way_start[way + 1]):
                self._pack(self.way_cell[k])
            move = self.kernel.way_move[way]
            if move >= 0:
                for k in range(self.drop_start[move], self.drop_start[move + 1]):
                    self._pack(self.drop_cell[k])
        for k in range(len(self.settled)):
            self._pack(self.settled[k])
        if self.remembers != 0:
            for cell in range(self.variables, self.cells):
                self._pack(cell)

    def _undo_parts(self) -> None:
        """Restore the kernel to the state before a step. What is enabled has not been updated after the step."""
        for j in range(self.kernel.parts):
            way = self.kernel.part_way[j]
            cell = self.kernel.slot_instance[self.kernel.part_slot[j]]
            self.kernel.place[cell] = self.value[cell]
            for k in range(self.way_start[way], self.way_start[way + 1]):
                self._set_current(self.way_cell[k], self.value[self.way_cell[k]])
            move = self.kernel.way_move[way]
            if move >= 0:
                for k in range(self.drop_start[move], self.drop_start[move + 1]):
                    self._set_current(self.drop_cell[k], self.value[self.drop_cell[k]])
        for k in range(len(self.settled)):
            self._set_current(self.settled[k], self.value[self.settled[k]])
        for k in range(self.kernel.note_count):
            self.kernel.noted[self.kernel.notes[k]] = 0
        self.kernel.note_count = 0

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
        chance. Return whether the key was replaced."""
        self._enter()
        label = self._judged()
        if label & STATUS != UNKNOWN or self.kernel.fault != 0:
            return 0
        vector = self.ample.find()
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
            count += 1
        self.kernel.parts = count
        self.kernel.vector = vector
        self.kernel._execute_ways(vector)
        if self.kernel.fault != 0:
            return 0
        if self.ample.writes_seen != 0 and self._is_seen() != 0:
            self._undo_parts()
            return 0
        self._pack_parts()
        if self.misfit >= 0:
            while self.misfit >= 0:
                self._widen()
                for cell in range(self.cells):
                    self._pack(cell)
            # The key of the state before the step is not known in the new layout: compare all cells.
            for i in range(self.words):
                self.now[i] = self.following[i] ^ UINT64_MASK
        self._undo_parts()
        for i in range(self.words):
            if self.following[i] != self.now[i]:
                return 1
        return 0

    def _is_seen(self) -> int:
        """Whether the step that the kernel has executed has changed the value of a variable that the goal reads."""
        for j in range(self.kernel.parts):
            way = self.kernel.part_way[j]
            for k in range(self.way_start[way], self.way_start[way + 1]):
                cell = self.way_cell[k]
                watch = self.cell_watch[cell]
                if (
                    watch >= 0
                    and self.kernel.seen_start[watch] < self.kernel.seen_start[watch + 1]
                    and self._current(cell) != self.value[cell]
                ):
                    return 1
        return 0

    def _only_way(self, slot: int) -> int:
        """The way of the only enabled edge of a slot; -1 if the edge has several ways."""
        place = self.kernel.place[self.kernel.slot_instance[slot]]
        group = self.kernel.group_start[place]
        while self.kernel.group_slot[group] != slot:
            group += 1
        first = self.kernel.edge_start[group]
        end = self.kernel.edge_start[group + 1]
        edge = first
        while end - first > 1 and self.kernel.guard[edge] >= 0 and self.kernel._execute(self.kernel.guard[edge]) == 0:
            edge += 1
        way = self.kernel.way_start[edge]
        return way if self.kernel.way_start[edge + 1] == way + 1 else -1

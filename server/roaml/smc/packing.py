# SPDX-License-Identifier: Apache-2.0
"""Numbered states of a kernel, each packed into a few words.

- Plain Python; Cython compiles it with the types in `packing.pxd`, like the kernel.
- A state consists of *cells*: the location of each instance, the integer variables, the real ones, and further cells
  that are not in the kernel.
- A state is packed into words of 64 bits, its *key*. A cell gets as many bits as its values so far require: none while
  its value does not change. The bits of a cell are in one word. If a value does not fit, the cell gets more bits, for
  which all states may have to be packed again.
- A hash table with open addressing contains the numbers of the states, each with half of the hash of the state. Its
  upper bits are the index at which the search for the state begins.
- Calls between extension modules are not inlined, so the methods treat a whole state, or all cells that a step changes.
"""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING, Any

from roaml.smc.memory import flat, grown

if TYPE_CHECKING:
    from roaml.smc.kernel import Kernel
    from roaml.smc.program import Ints

UINT64_MASK = 0xFFFFFFFFFFFFFFFF
UINT32_MASK = 0xFFFFFFFF
MAX_INT64 = 0x7FFFFFFFFFFFFFFF
HASH_1 = 0x9E3779B97F4A7C15
HASH_2 = 0xBF58476D1CE4E5B9
SPARE_BITS_FROM_STATES = 4096
"""With more states than this, cells get more bits than they need, because packing all states again is slow."""
MAX_SPREAD_BITS = 40
"""Cells with more bits than this get no unused ones."""
FIRST_STATES = 64
"""The number of states for which memory is allocated first."""
FIRST_TABLE_BITS = 8
BLOCK = 16
"""The number of variables that are compared at once."""


def compiled() -> bool:
    """Whether this module is the compiled extension."""
    return not __file__.endswith(".py")


class PackedStates:
    """Different states with the numbers 0, 1, ... in the order in which they were added.

    Args:
        kernel: the kernel for the program.
        watch: for each variable, its number among the watched variables, or -1.
        further: the number of cells that are not in the kernel.

    Attributes:
        count: the number of states.
        words: the number of words of a key.
        keys: the keys of the states.
        state_room: the number of states for which there is memory.
        following: the key that is looked up or added.
        value, now: the cells, and the key, of the state in which the kernel was last (`_enter`).
        memory: the current values of the further cells.
        changed: a list of cells for `_pack_changed` and `_undo`. A cell may be in it more than once.
        misfit: a cell whose value does not fit its bits; -1 if there is none.
    """

    def __init__(self, kernel: Any, watch: Ints, further: int) -> None:
        self.kernel: Kernel = kernel
        self.watch = watch
        self.places = self.kernel.instances
        self.first_real = self.places + self.kernel.int_count
        self.variables = self.first_real + self.kernel.real_count
        self.cell_count = self.variables + further
        # Cython wraps the array that it was given, its `base`.
        self.real_bits = memoryview(getattr(self.kernel.reals, "base", self.kernel.reals)).cast("B").cast("q")
        self.memory = array("q", [0]) * (further + 1)
        self.low = array("q", [0]) * self.cell_count
        self.bits = array("i", [0]) * self.cell_count
        self.room = array("Q", [0]) * self.cell_count
        self.mask = array("Q", [0]) * self.cell_count
        self.word = array("i", [0]) * self.cell_count
        self.shift = array("i", [0]) * self.cell_count
        self.live = array("i", [0]) * self.cell_count
        self.live_start = array("i", [0, 0])
        self.words = 1
        self.unused = 0
        self.old_low = array("q", [0]) * self.cell_count
        self.old_mask = array("Q", [0]) * self.cell_count
        self.old_word = array("i", [0]) * self.cell_count
        self.old_shift = array("i", [0]) * self.cell_count
        self.run_cell = array("i", [0]) * self.cell_count
        self.run_mask = array("Q", [0]) * self.cell_count
        self.value = array("q", [0]) * self.cell_count
        self.now = array("Q", [0])
        self.following = array("Q", [0])
        self.changed = array("i", [0]) * self.cell_count
        self.changed_count = 0
        self.moved = array("i", [0]) * (self.places + 1)
        self.misfit = -1
        self.tag = 0
        self.state_room = FIRST_STATES
        self.keys = flat("Q", FIRST_STATES)
        self._clear()

    def _clear(self) -> None:
        """Forget all states."""
        self.count = 0
        self.table_mask = (1 << FIRST_TABLE_BITS) - 1
        self.table_shift = 32 - FIRST_TABLE_BITS
        self.table = flat("Q", 1 << FIRST_TABLE_BITS)

    # ------------------------------------------------------------ the kernel

    def _start(self) -> None:
        """Choose the layout for the current state of the kernel, which gets the key `following`. Only the locations
        have bits, enough for all of an instance."""
        for cell in range(self.cell_count):
            self.value[cell] = _current(self, cell)
            self.low[cell] = self.value[cell]
        for cell in range(self.places):
            last = self.kernel.first_location[cell + 1] if cell + 1 < self.places else len(self.kernel.location_mark)
            self.low[cell] = self.kernel.first_location[cell]
            self._fit(cell, last - 1)
        self._lay_out()
        self._pack_all()

    def _set_current(self, cell: int, value: int) -> None:
        """Change the value of a cell in the kernel, without its effects on what is enabled."""
        _set(self, cell, value)

    def _has_changed(self, cell: int) -> int:
        """Whether the current value of a cell differs from that in `value`."""
        return 1 if _current(self, cell) != self.value[cell] else 0

    def _list_changed(self) -> None:
        """Put the cells of the kernel whose values differ from those in `value` into `changed`."""
        changed = 0
        for cell in range(self.places):
            if self.kernel.place[cell] != self.value[cell]:
                self.changed[changed] = cell
                changed += 1
        first = self.places
        while first < self.first_real:
            end = min(first + BLOCK, self.first_real)
            difference = 0
            for cell in range(first, end):
                difference |= self.kernel.ints[cell - self.places] ^ self.value[cell]
            if difference != 0:
                for cell in range(first, end):
                    if self.kernel.ints[cell - self.places] != self.value[cell]:
                        self.changed[changed] = cell
                        changed += 1
            first = end
        for cell in range(self.first_real, self.variables):
            if self.real_bits[cell - self.first_real] != self.value[cell]:
                self.changed[changed] = cell
                changed += 1
        self.changed_count = changed

    def _pack_changed(self) -> None:
        """Put the key of the current state of the kernel into `following`. It differs from `now` only in the cells in
        `changed`. If a value does not fit, its cell is put into `misfit`; then `_widen` and `_pack_all` must follow."""
        for i in range(self.words):
            self.following[i] = self.now[i]
        for i in range(self.changed_count):
            _pack(self, self.changed[i])

    def _pack_all(self) -> None:
        """Do the same as `_pack_changed` if any cell may differ from `now`."""
        for cell in range(self.cell_count):
            _pack(self, cell)

    def _undo(self) -> None:
        """Restore the kernel to the state in which it was before a step that has changed only the cells in `changed`.
        What is enabled has not been updated after the step."""
        for i in range(self.changed_count):
            _set(self, self.changed[i], self.value[self.changed[i]])
        _forget_notes(self)

    def _go_on(self) -> None:
        """Do the same as `_enter` after a step that leads to the key `following`, and has changed only the cells in
        `changed`, with their new values. What is enabled has not been updated after the step."""
        _forget_notes(self)
        moved = 0
        for i in range(self.changed_count):
            cell = self.changed[i]
            value = _current(self, cell)
            if value != self.value[cell]:
                moved = _replace(self, cell, value, moved)
        for i in range(self.words):
            self.now[i] = self.following[i]
        _update(self, moved)

    def _accept(self) -> None:
        """Let `value` and `now` describe the current state of the kernel. It differs from them only in the cells in
        `changed`, and its key is `following`."""
        for i in range(self.changed_count):
            self.value[self.changed[i]] = _current(self, self.changed[i])
        for i in range(self.words):
            self.now[i] = self.following[i]

    def _visit(self, state: int) -> None:
        """Restore the kernel to the state with the number `state`; see `_enter`."""
        first = state * self.words
        for i in range(self.words):
            self.following[i] = self.keys[first + i]
        self._enter()

    def _enter(self) -> None:
        """Restore the kernel to the state with the key `following`, and update what is enabled. Only cells that differ
        from those of the previous state are examined. Further cells get values in `value` only."""
        moved = 0
        for w in range(self.words):
            code = self.following[w]
            if code == self.now[w]:
                continue
            self.now[w] = code
            for i in range(self.live_start[w], self.live_start[w + 1]):
                cell = self.live[i]
                value = _signed((((code >> self.shift[cell]) & self.mask[cell]) + self.low[cell]) & UINT64_MASK)
                if value == self.value[cell]:
                    continue
                moved = _replace(self, cell, value, moved)
                _set(self, cell, value)
        _update(self, moved)

    def _decoded(self, state: int, cell: int) -> int:
        """The value of a cell in a state."""
        code = (self.keys[state * self.words + self.word[cell]] >> self.shift[cell]) & self.mask[cell]
        return _signed((code + self.low[cell]) & UINT64_MASK)

    # ------------------------------------------------------------ the layout

    def _widen(self) -> int:
        """Give the cell `misfit` enough bits. Return whether this requires a new layout: then all values of the current
        state of the kernel get enough bits, and `_repack` or `_lay_out` must follow."""
        cell = self.misfit
        low = self.low[cell]
        self.misfit = -1
        self._keep_layout()
        self._admit(cell)
        # The code of a cell that has not changed so far is 0 in all states, wherever its bits are.
        if self.mask[cell] == 0 and self.low[cell] == low and self._squeeze_in(cell) != 0:
            return 0
        for other in range(self.cell_count):
            self._admit(other)
        return 1

    def _admit(self, cell: int) -> None:
        """Give a cell enough bits for its current value, from the next layout on."""
        value = _current(self, cell)
        if ((value - self.low[cell]) & UINT64_MASK) > self.room[cell]:
            self._fit(cell, value)

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

    def _keep_layout(self) -> None:
        """Store how the states are currently packed."""
        self.old_low[:] = self.low
        self.old_mask[:] = self.mask
        self.old_word[:] = self.word
        self.old_shift[:] = self.shift

    def _fit(self, cell: int, value: int) -> None:
        """Give a cell enough bits for a value. They are used from the next layout on."""
        unit = 1
        least = self.low[cell]
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
        """Choose a new layout, and pack all states again from the layout that `_keep_layout` has stored."""
        if self.count > SPARE_BITS_FROM_STATES:
            self._spread()
        old_words = self.words
        old_keys = self.keys
        self._lay_out()
        runs = self._list_runs()
        for state in range(self.count):
            source = state * old_words
            target = state * self.words
            for k in range(runs):
                cell = self.run_cell[k]
                code = (old_keys[source + self.old_word[cell]] >> self.old_shift[cell]) & self.run_mask[k]
                code = (code + self.old_low[cell] - self.low[cell]) & UINT64_MASK
                self.keys[target + self.word[cell]] |= code << self.shift[cell]
        self._fill_table()

    def _list_runs(self) -> int:
        """Group the cells whose bits keep their distances within one word, so that they are moved together. Return the
        number of the groups: `run_cell` contains the first cell of each, and `run_mask` the old bits of all."""
        runs = 0
        first = -1
        for i in range(self.live_start[self.words]):
            cell = self.live[i]
            has_moved = self.low[cell] != self.old_low[cell]
            if self.old_mask[cell] == 0 and not has_moved:
                continue  # Its code is 0 in all states.
            if (
                first >= 0
                and not has_moved
                and self.word[cell] == self.word[first]
                and self.old_word[cell] == self.old_word[first]
                and self.shift[cell] - self.shift[first] == self.old_shift[cell] - self.old_shift[first]
            ):
                self.run_mask[runs - 1] |= self.old_mask[cell] << (self.old_shift[cell] - self.old_shift[first])
                continue
            self.run_cell[runs] = cell
            self.run_mask[runs] = self.old_mask[cell]
            runs += 1
            first = -1 if has_moved else cell
        return runs

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
        for cell in range(self.cell_count):
            bits = self.bits[cell]
            if used + bits > 64:
                words += 1
                used = 0
            used += bits
        self.unused = 64 - used
        return words

    def _lay_out(self) -> None:
        """Assign a word and a shift to each cell, allocate memory for keys, and pack `value` into `now`."""
        at = 0
        used = 0
        live = 0
        starts = [0]
        for cell in range(self.cell_count):
            bits = self.bits[cell]
            self.mask[cell] = self.room[cell]
            self.word[cell] = 0
            self.shift[cell] = 0
            if bits == 0:
                continue
            if used + bits > 64:
                at += 1
                used = 0
                starts.append(live)
            self.word[cell] = at
            self.shift[cell] = used
            used += bits
            self.live[live] = cell
            live += 1
        starts.append(live)
        self.words = at + 1
        self.live_start = array("i", starts)
        self.keys = flat("Q", self.state_room * self.words)
        self.now = array("Q", [0]) * self.words
        self.following = array("Q", [0]) * self.words
        for i in range(live):
            cell = self.live[i]
            self.now[self.word[cell]] |= ((self.value[cell] - self.low[cell]) & UINT64_MASK) << self.shift[cell]

    # ------------------------------------------------------------ the table

    def _look_up(self) -> int:
        """The index in the table of the state with the key `following`. If this state is not known, this is the index
        where it will be, and `tag` is the half of its hash that is stored."""
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

    def _state_at(self, at: int) -> int:
        """The number of the state at an index of the table; -1 if there is none."""
        state: int = (self.table[at] & UINT32_MASK) - 1
        return state

    def _add(self, at: int) -> int:
        """Add a state with the key `following`, which is not known, and for which there is memory; return its number.
        `at` and `tag` are the results of `_look_up`."""
        state = self.count
        first = state * self.words
        for i in range(self.words):
            self.keys[first + i] = self.following[i]
        self.table[at] = (self.tag << 32) | (state + 1)
        self.count += 1
        if self.count * 8 > self.table_mask * 5:
            self._double_table()
        return state

    def _grow(self) -> None:
        """Double the number of states for which there is memory."""
        self.state_room *= 2
        self.keys = grown(self.keys, self.state_room * self.words)

    def _fill_table(self) -> None:
        """Fill the table anew, after the keys of the states have changed."""
        self.table = flat("Q", self.table_mask + 1)
        for state in range(self.count):
            first = state * self.words
            for i in range(self.words):
                self.following[i] = self.keys[first + i]
            tag = self._tag()
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


# Functions, because C compilers cannot inline methods of a class that has subclasses.


def _current(states: PackedStates, cell: int) -> int:
    """The current value of a cell; for a real number, its bit pattern as an integer."""
    value: int
    if cell < states.places:
        value = states.kernel.place[cell]
    elif cell < states.first_real:
        value = states.kernel.ints[cell - states.places]
    elif cell < states.variables:
        value = states.real_bits[cell - states.first_real]
    else:
        value = states.memory[cell - states.variables]
    return value


def _set(states: PackedStates, cell: int, value: int) -> None:
    """Change the value of a cell in the kernel. This has no effect for further cells."""
    if cell < states.places:
        states.kernel.place[cell] = value
    elif cell < states.first_real:
        states.kernel.ints[cell - states.places] = value
    elif cell < states.variables:
        states.real_bits[cell - states.first_real] = value


def _pack(states: PackedStates, cell: int) -> None:
    """Put the current value of a cell into `following`. If the value does not fit, put the cell into `misfit`."""
    code = (_current(states, cell) - states.low[cell]) & UINT64_MASK
    if code > states.mask[cell]:
        states.misfit = cell
    elif states.mask[cell] != 0:
        at = states.word[cell]
        shift = states.shift[cell]
        states.following[at] = (states.following[at] & (UINT64_MASK ^ (states.mask[cell] << shift))) | (code << shift)


def _forget_notes(states: PackedStates) -> None:
    """Forget the variables that a step has written."""
    for i in range(states.kernel.note_count):
        states.kernel.noted[states.kernel.notes[i]] = 0
    states.kernel.note_count = 0


def _replace(states: PackedStates, cell: int, value: int, moved: int) -> int:
    """Replace the value of a cell in `value`, and note that what it enables must be updated. Return the number of cells
    in `moved`, which was `moved` before."""
    if cell < states.places:
        place = states.value[cell]
        for group in range(states.kernel.group_start[place], states.kernel.group_start[place + 1]):
            states.kernel._set_ready(states.kernel.group_slot[group], 0)
        states.moved[moved] = cell
        moved += 1
    elif cell < states.variables and states.watch[cell - states.places] >= 0:
        states.kernel._note(states.watch[cell - states.places])
    states.value[cell] = value
    return moved


def _update(states: PackedStates, moved: int) -> None:
    """Update what is enabled, after `moved` instances have moved and variables were noted."""
    for i in range(moved):
        states.kernel._arrive(states.kernel.place[states.moved[i]])
    if states.kernel.note_count != 0:
        states.kernel._look_around()


def _signed(value: int) -> int:
    return value - UINT64_MASK - 1 if value > MAX_INT64 else value

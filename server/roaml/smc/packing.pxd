# SPDX-License-Identifier: Apache-2.0
# The C types of packing.py. This file contains types only: without them the same code runs as plain Python.
# cython: language_level=3

cimport cython
from roaml.smc.kernel cimport Kernel

ctypedef unsigned long long u64
ctypedef long long i64

cdef u64 UINT64_MASK, UINT32_MASK, MAX_INT64, HASH_1, HASH_2
cdef i64 SPARE_BITS_FROM_STATES
cdef int MAX_SPREAD_BITS, FIRST_STATES, FIRST_TABLE_BITS, BLOCK

cdef class PackedStates:
    cdef Kernel kernel
    cdef int[::1] watch
    cdef int places, first_real, variables, cell_count
    cdef i64[::1] real_bits, memory, low, old_low, value
    cdef int[::1] bits, word, shift, live, live_start, old_word, old_shift, run_cell, changed, moved
    cdef u64[::1] room, mask, old_mask, run_mask, now, following, keys, table
    cdef public int words
    cdef int unused, changed_count, misfit, table_shift
    cdef u64 tag, table_mask
    cdef i64 state_room
    cdef public i64 count

    cdef void _clear(self) except *
    @cython.locals(cell=int, last=i64)
    cdef void _start(self) except *
    cdef void _set_current(self, int cell, i64 value) noexcept
    cdef int _has_changed(self, int cell) noexcept
    @cython.locals(changed=int, cell=int, first=int, end=int, difference=i64)
    cdef void _list_changed(self) noexcept
    @cython.locals(i=int)
    cdef void _pack_changed(self) noexcept
    @cython.locals(cell=int)
    cdef void _pack_all(self) noexcept
    @cython.locals(i=int)
    cdef void _undo(self) noexcept
    @cython.locals(i=int)
    cdef void _accept(self) noexcept
    @cython.locals(moved=int, i=int, cell=int, value=i64)
    cdef void _go_on(self) noexcept
    @cython.locals(first=i64, i=int)
    cdef void _visit(self, i64 state) noexcept
    @cython.locals(moved=int, w=int, code=u64, i=int, cell=int, value=i64)
    cdef void _enter(self) noexcept
    @cython.locals(code=u64)
    cdef i64 _decoded(self, i64 state, int cell) noexcept
    @cython.locals(cell=int, low=i64, other=int)
    cdef int _widen(self) except -1
    @cython.locals(value=i64)
    cdef void _admit(self, int cell) noexcept
    @cython.locals(at=int, used=int, i=int, k=int)
    cdef int _squeeze_in(self, int cell) noexcept
    cdef void _keep_layout(self) except *
    @cython.locals(least=i64, greatest=i64, span=u64, bits=int, unit=u64)
    cdef void _fit(self, int cell, i64 value) noexcept
    @cython.locals(
        cell=int, k=int, runs=int, old_words=i64, old_keys=u64[::1], state=i64, source=i64, target=i64, code=u64
    )
    cdef void _repack(self) except *
    @cython.locals(runs=int, first=int, i=int, cell=int, has_moved=bint)
    cdef int _list_runs(self) noexcept
    @cython.locals(words=int, left=int, bits=int, cell=int)
    cdef void _spread(self) except *
    @cython.locals(words=int, used=int, cell=int, bits=int)
    cdef int _words_needed(self) except -1
    @cython.locals(at=int, used=int, live=int, cell=int, bits=int, i=int)
    cdef void _lay_out(self) except *
    cdef u64 _look_up(self) noexcept
    @cython.locals(value=u64, i=int)
    cdef u64 _tag(self) noexcept
    @cython.locals(tag=u64, at=u64, entry=u64, first=i64, i=int, same=int)
    cdef u64 _index(self) noexcept
    @cython.locals(state=i64)
    cdef i64 _state_at(self, u64 at) noexcept
    @cython.locals(state=i64, first=i64, i=int)
    cdef i64 _add(self, u64 at) except -1
    cdef void _grow(self) except *
    @cython.locals(state=i64, first=i64, i=int, tag=u64, at=u64)
    cdef void _fill_table(self) except *
    @cython.locals(old_table=u64[::1], size=u64, i=u64, entry=u64, at=u64)
    cdef void _double_table(self) except *

@cython.locals(value=i64)
cdef i64 _current(PackedStates states, int cell) noexcept
cdef void _set(PackedStates states, int cell, i64 value) noexcept
@cython.locals(code=u64, at=int, shift=int)
cdef void _pack(PackedStates states, int cell) noexcept
@cython.locals(i=int)
cdef void _forget_notes(PackedStates states) noexcept
@cython.locals(place=int, group=int)
cdef int _replace(PackedStates states, int cell, i64 value, int moved) noexcept
@cython.locals(i=int)
cdef void _update(PackedStates states, int moved) noexcept
cdef i64 _signed(u64 value) noexcept

# SPDX-License-Identifier: Apache-2.0
# The C types of search.py. This file contains types only: without them the same code runs as plain Python.
# cython: language_level=3

cimport cython
from roaml.explicit.ample cimport AmpleSets
from roaml.smc.kernel cimport Kernel

ctypedef unsigned long long u64
ctypedef long long i64

cdef u64 UINT64_MASK, HASH_1, HASH_2, UINT32_MASK, MAX_INT64
cdef i64 MAX_COUNTED_STATES, SPARE_BITS_FROM_STATES
cdef int MAX_SPREAD_BITS
cdef int SAMPLED_TRACES, SAMPLED_STEPS, MAX_PASSED, MAX_REMEMBERED, MAX_WAITING, WAITS
cdef int FALSE, TRUE, UNKNOWN, FAULTY
cdef int TIME, STUCK
cdef int COMPLETE, PART, STATES, MEMORY, FAULT, CHOICES
cdef int STATUS, LASTS, FAILS, HOLDS, OPEN, ENDED, GETS_STUCK

@cython.final
cdef class StateSearch:
    cdef Kernel kernel
    cdef int[::1] way_start, way_cell, settled, cell_watch
    cdef int[::1] drop_start, drop_cell, owner_start, owner_instance, owner_table, is_dead
    cdef int places, first_real, variables, leaves, counter, cells
    cdef i64 most_steps, lower_bound
    cdef int remembers
    cdef i64 most_states, most_bytes, most_choices
    cdef public i64 depth
    cdef i64 most_depth, layer_end
    cdef double[::1] box
    cdef i64[::1] box_bits
    cdef i64[::1] initial, low, old_low, value, memory
    cdef int[::1] bits, word, shift, live_start, live, old_word, old_shift
    cdef u64[::1] mask, old_mask, room, now, following
    cdef public int words
    cdef int misfit, has_learned, old_words, unused
    cdef i64 misfit_value
    cdef double[::1] chance
    cdef int[::1] edges, edge_from, slots, picks, ways, moved, pending
    cdef AmpleSets ample
    cdef int leaves_out, has_passed, looks_at, is_seen, layout
    cdef int[::1] trail, passed_to, passed_left
    cdef u64[::1] passed_keys
    cdef u64 passed_mask
    cdef public i64 alone, passed, circled
    cdef public u64[::1] keys
    cdef u64[::1] table
    cdef u64 table_mask, tag
    cdef int table_shift
    cdef public i64[::1] start
    cdef public int[::1] parent, code
    cdef public unsigned char[::1] label
    cdef public double[::1] reals
    cdef i64 state_room, key_room, code_room, reals_room
    cdef public i64 code_end, count, expanded, problem, transitions
    cdef dict number_of
    cdef int real_count
    cdef public int status, is_weighted
    cdef i64 branches
    cdef public int[::1] roots
    cdef i64 root_room
    cdef public u64 entered
    cdef int waiting
    cdef u64[::1] waiting_keys, waiting_tag, waiting_entry
    cdef int[::1] waiting_parent
    cdef i64[::1] waiting_code
    cdef u64 peeked

    @cython.locals(most=u64, cell=int, state=i64, i=int)
    cdef void _enter_roots(self, i64 many) except *
    @cython.locals(value=i64)
    cdef i64 _current(self, int cell) noexcept
    cdef void _set_current(self, int cell, i64 value) noexcept
    @cython.locals(k=int)
    cdef int _is_dead(self, int cell) noexcept
    @cython.locals(j=int, way=int, k=int, move=int)
    cdef void _reset_dead(self) noexcept
    @cython.locals(value=i64, code=u64, at=int, shift=int)
    cdef void _pack(self, int cell) noexcept
    @cython.locals(code=u64)
    cdef i64 _decoded(self, i64 state, int cell) noexcept
    cdef i64 _signed(self, u64 value) noexcept
    @cython.locals(cell=int)
    cdef void _widen(self) except *
    @cython.locals(at=int, used=int, i=int, k=int)
    cdef int _squeeze_in(self, int cell) noexcept
    @cython.locals(trace=int, cell=int, value=i64, i=int)
    cdef void _learn(self) except *
    @cython.locals(i=int)
    cdef void _keep_layout(self) noexcept
    @cython.locals(least=i64, greatest=i64, span=u64, bits=int, unit=u64, last=i64)
    cdef void _fit(self, int cell, i64 value) noexcept
    @cython.locals(cell=int, i=int, old_keys=u64[::1], state=i64, source=i64, target=i64, code=u64)
    cdef void _repack(self) except *
    @cython.locals(words=int, left=int, bits=int, cell=int)
    cdef void _spread(self) except *
    @cython.locals(words=int, used=int, cell=int, bits=int)
    cdef int _words_needed(self) except -1
    @cython.locals(at=int, used=int, live=int, cell=int, bits=int)
    cdef void _lay_out(self) except *
    @cython.locals(value=u64, i=int)
    cdef u64 _hash_of(self, i64 at) noexcept
    @cython.locals(size=u64, state=i64, tag=u64, at=u64)
    cdef void _rehash(self) except *
    @cython.locals(old_table=u64[::1], size=u64, i=u64, entry=u64, at=u64)
    cdef void _double_table(self) except *
    cdef u64 _look_up(self) noexcept
    @cython.locals(value=u64, i=int)
    cdef u64 _tag(self) noexcept
    @cython.locals(tag=u64, at=u64, entry=u64, first=i64, i=int, same=int)
    cdef u64 _index(self) noexcept
    cdef int _find(self, i64 parent) except? -9
    @cython.locals(state=i64, first=i64, i=int)
    cdef int _stored(self, u64 at, i64 parent) except? -9
    @cython.locals(first=int, i=int)
    cdef void _wait(self, i64 state) except *
    @cython.locals(waiting=int, k=int, i=int, entry=u64, status=int, state=i64)
    cdef void _find_waiting(self) except *
    cdef i64 _used(self) noexcept
    cdef void _make_room(self) except *
    cdef int _emit(self, int word) except -1
    cdef int _number(self, double value) except -1
    @cython.locals(state=i64)
    cdef int _known(self) noexcept
    @cython.locals(first=i64, w=int)
    cdef void _visit(self, i64 state) noexcept
    @cython.locals(moved=int, w=int, code=u64, i=int, cell=int, value=i64, place=int, group=int)
    cdef void _enter(self) noexcept
    @cython.locals(steps=i64, label=int, lasting=int, leaf=int, verdict=int, lower=i64, status=int)
    cdef int _judged(self) noexcept
    cdef int _combined(self) noexcept
    @cython.locals(label=int, leads_on=int, combinations=double, many=double, most=int, exit_reward=double, i=int, vector=int, count=int, pending=int,
                   weight=double, k=int, j=int)
    cdef void _expand(self, i64 state) except *
    @cython.locals(at=i64, transitions=i64, count=int, j=int, may_leave_out=int, k=int)
    cdef int _take_alone(self, int vector, i64 state) except? -9
    @cython.locals(reason=int, added=int, leaf=int)
    cdef int _end(self) noexcept
    @cython.locals(count=int, edge_count=int, i=int, slot=int, group=int, first=int, end=int, is_single=int, at=int, k=int, edge=int, guard=int)
    cdef int _open(self, int vector) noexcept
    @cython.locals(first=int, end=int, total=double, way=int, register=int)
    cdef void _weigh(self, int edge) noexcept
    @cython.locals(j=int)
    cdef void _first_ways(self, int count) noexcept
    @cython.locals(j=int, edge=int)
    cdef int _next_ways(self, int count) noexcept
    @cython.locals(j=int)
    cdef int _next_edges(self, int count) noexcept
    @cython.locals(is_plain=int, j=int, edge=int, successor=i64, head=i64, reward=double, leads_on=int, chance=double)
    cdef int _choose(self, int vector, int count, i64 state, double weight, double exit_reward) except? -9
    @cython.locals(j=int, i=int, cell=int, successor=i64)
    cdef int _successor(self, int vector, int count, i64 state) except? -9
    cdef void _emit_successor(self, i64 successor, i64 state) except *
    @cython.locals(j=int)
    cdef void _execute_choice(self, int vector, int count) noexcept
    @cython.locals(i=int, j=int, k=int, way=int, cell=int, move=int)
    cdef void _pack_parts(self) noexcept
    @cython.locals(j=int, k=int, way=int, cell=int, move=int)
    cdef void _undo_parts(self) noexcept
    @cython.locals(successor=i64, layout=int, steps=int, left=int, at=i64, has_moved=int, i=int)
    cdef int _pass_on(self, i64 state) except? -9
    @cython.locals(left=int, first=i64, i=int)
    cdef int _recalled(self, i64 at, int most) noexcept
    @cython.locals(first=i64, i=int)
    cdef void _remember(self, i64 at) noexcept
    @cython.locals(size=i64)
    cdef void _forget(self) except *
    @cython.locals(j=int, way=int, k=int, cell=int, watch=int)
    cdef int _is_seen(self) noexcept
    cdef void _return(self, i64 state) noexcept
    @cython.locals(label=int, vector=int, count=int, i=int, slot=int, way=int, cell=int)
    cdef int _pass(self) except? -9
    @cython.locals(place=int, group=int, first=int, end=int, edge=int, way=int)
    cdef int _only_way(self, int slot) noexcept

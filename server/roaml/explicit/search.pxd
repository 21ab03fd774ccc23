# SPDX-License-Identifier: Apache-2.0
# The C types of search.py. This file contains types only: without them the same code runs as plain Python.
# cython: language_level=3

cimport cython
from roaml.explicit.ample cimport AmpleSets
from roaml.smc.kernel cimport Kernel
from roaml.smc.packing cimport PackedStates

ctypedef unsigned long long u64
ctypedef long long i64

cdef u64 UINT32_MASK, UINT64_MASK
cdef i64 MAX_COUNTED_STATES, LEARNED_FROM_STATES
cdef int SAMPLED_TRACES, SAMPLED_STEPS, MAX_PASSED, MAX_REMEMBERED, MAX_TRIED, MAX_WAITING, WAITS
cdef int FALSE, TRUE, UNKNOWN, FAULTY
cdef int TIME, STUCK
cdef int COMPLETE, PART, STATES, MEMORY, FAULT, CHOICES
cdef int STATUS, LASTS, FAILS, HOLDS, OPEN, ENDED, GETS_STUCK

@cython.final
cdef class StateSearch(PackedStates):
    cdef int[::1] way_start, way_cell, settled
    cdef int[::1] drop_start, drop_cell, owner_start, owner_instance, owner_table, is_dead
    cdef int leaves, counter
    cdef i64 most_steps, lower_bound
    cdef int remembers
    cdef i64 most_states, most_bytes, most_choices
    cdef public i64 depth
    cdef i64 most_depth, layer_end
    cdef i64[::1] initial
    cdef int has_learned
    cdef double[::1] chance
    cdef int[::1] edges, edge_from, slots, picks, ways, pending
    cdef AmpleSets ample
    cdef int leaves_out, has_passed, looks_at, is_seen, is_ahead, layout
    cdef int[::1] trail, passed_to, passed_left
    cdef u64[::1] passed_keys
    cdef u64 passed_mask
    cdef public i64 alone, passed, circled
    cdef public i64[::1] start
    cdef public int[::1] parent, code
    cdef public unsigned char[::1] label
    cdef unsigned char[::1] is_partial
    cdef public unsigned char[::1] taken
    cdef public double[::1] reals
    cdef i64 code_room, reals_room
    cdef public i64 code_end, expanded, problem, transitions
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
    cdef double combinations
    cdef i64[::1] tried_value
    cdef u64[::1] tried
    cdef int tried_count, avoids_cycles
    cdef int[::1] reached

    @cython.locals(incoming=int[::1], free=int[::1], left=i64, end=i64, at=i64, state=i64, other=i64, k=i64)
    cpdef bint has_partial_cycle(self)
    @cython.locals(most=u64, cell=int, state=i64, i=int)
    cdef void _enter_roots(self, i64 many) except *
    @cython.locals(k=int)
    cdef int _is_dead(self, int cell) noexcept
    cdef void _pack_step(self) noexcept
    @cython.locals(count=int, j=int, way=int, k=int, cell=int, move=int)
    cdef void _end_step(self) noexcept
    cdef void _widen_all(self) except *
    cdef void _renew_layout(self) except *
    @cython.locals(trace=int, changed=int, cell=int, i=int, _=int)
    cdef void _learn(self) except *
    cdef int _find(self, i64 parent) except? -9
    @cython.locals(state=i64)
    cdef int _stored(self, u64 at, i64 parent) except? -9
    @cython.locals(first=int, i=int)
    cdef void _wait(self, i64 state) except *
    @cython.locals(waiting=int, k=int, i=int, entry=u64, status=int, state=i64)
    cdef void _find_waiting(self) except *
    cdef i64 _used(self) noexcept
    cdef void _make_room(self) except *
    cdef int _emit(self, int word) except -1
    cdef int _number(self, double value) except -1
    cdef int _known(self) noexcept
    @cython.locals(steps=i64, label=int, lasting=int, leaf=int, verdict=int, lower=i64, status=int)
    cdef int _judged(self) noexcept
    cdef int _combined(self) noexcept
    @cython.locals(label=int, leads_on=int, exit_reward=double, i=int, pending=int)
    cdef void _expand(self, i64 state) except *
    @cython.locals(count=int, many=double, j=int, most=int, k=int, weight=double, leads_on=int)
    cdef int _take(self, int vector, i64 state, double exit_reward) except? -9
    @cython.locals(vector=int, many=int, at=i64, transitions=i64, i=int)
    cdef int _leave_choices_out(self, i64 state) except? -9
    @cython.locals(k=i64, other=i64)
    cdef int _may_be_taken(self, i64 at, i64 state) except? -9
    @cython.locals(count=int, branches=int, _=int)
    cdef int _list_destinations(self, i64 at, i64 end) except? -9
    @cython.locals(vector=int, unreached=int)
    cdef int _alone(self) except? -9
    @cython.locals(found=int, i=int, cell=int)
    cdef int _may_end_before(self, int vector) except? -9
    @cython.locals(layout=int, i=int, at=int, leads_on=int)
    cdef int _may_end_without(self, int vector) except? -9
    @cython.locals(single=int, leads_on=int, goes_on=int, i=int, other=int)
    cdef int _goes_on_without(self, int vector) except? -9
    @cython.locals(count=int, ways=int, chance=int, i=int, slot=int, edge=int, several=int, leads_on=int, _=int)
    cdef int _try(self, int vector) except? -9
    @cython.locals(k=int, same=int, i=int)
    cdef int _add_tried(self) noexcept
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
    @cython.locals(i=int)
    cdef int _successor(self, int vector, int count, i64 state) except? -9
    cdef void _emit_successor(self, i64 successor, i64 state) except *
    @cython.locals(j=int)
    cdef void _execute_choice(self, int vector, int count) noexcept
    @cython.locals(successor=i64, layout=int, steps=int, left=int, at=i64, has_moved=int, i=int)
    cdef int _pass_on(self, i64 state) except? -9
    @cython.locals(left=int, first=i64, i=int)
    cdef int _recalled(self, i64 at, int most) noexcept
    @cython.locals(first=i64, i=int)
    cdef void _remember(self, i64 at) noexcept
    @cython.locals(size=i64)
    cdef void _forget(self) except *
    cdef void _turn_back(self) noexcept
    @cython.locals(j=int, way=int, k=int, cell=int, watch=int)
    cdef int _is_seen(self) noexcept
    cdef void _return(self, i64 state) noexcept
    @cython.locals(label=int, vector=int, count=int, i=int, slot=int, way=int)
    cdef int _pass(self) except? -9
    @cython.locals(edge=int, way=int)
    cdef int _only_way(self, int slot) noexcept
    @cython.locals(place=int, group=int, first=int, end=int, edge=int)
    cdef int _only_edge(self, int slot) noexcept

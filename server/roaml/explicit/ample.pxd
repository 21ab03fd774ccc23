# SPDX-License-Identifier: Apache-2.0
# The C types of ample.py. This file contains types only: without them the same code runs as plain Python.
# cython: language_level=3

cimport cython
from roaml.smc.kernel cimport Kernel

ctypedef long long i64

cdef int NEVER, HIDDEN, WRITES
cdef int SEVERAL

@cython.final
cdef class AmpleSets:
    cdef Kernel kernel
    cdef int[::1] slot_start, slot_vector, hidden, dependent_start, dependent_vector, guard_start, guard_vector
    cdef int[::1] open_guards, frozen_at, candidates, busy_with, kind_of
    cdef int[::1] own_start, own_slot, gates_start, gates, gate_slot_start, gate_slot, list_end, list_slot
    cdef int[::1] random_vector, members, smallest
    cdef int[::1] group_place, stirred_start, stirred, guarded_start, guarded, alarm_start, alarm
    cdef int[::1] read_start, read, written_start, written
    cdef int[::1] possible_at, missing, gate_missing, reached_at, reached_before, last_reached
    cdef i64[::1] marked, is_read, is_written, possible, counted, gate_counted, taken, offered, is_stirred, is_open, reached
    cdef i64[::1] has_reached, forbidden
    cdef int possible_count, reached_count
    cdef int writes_seen, is_fleeting, looks_ahead, count, handled, alone, chosen, chosen_rank
    cdef int is_early, takes_several, member_count
    cdef i64 runs, searches
    cdef i64[::1] frozen, waits, listed, busy, kind_at

    @cython.locals(count=int, i=int, vector=int)
    cpdef int find(self) noexcept
    @cython.locals(i=int, vector=int)
    cpdef int find_early(self) noexcept
    @cython.locals(count=int, i=int, vector=int)
    cpdef int find_unreached(self) noexcept
    @cython.locals(best=int, i=int, k=int)
    cpdef int find_several(self) noexcept
    @cython.locals(i=int, k=int, vector=int)
    cdef void _prepare(self) noexcept
    @cython.locals(several=int)
    cdef int _has_tests(self, int vector) noexcept
    cdef int _kind(self, int vector) noexcept
    @cython.locals(kind=int, i=int, hidden=int)
    cdef int _kind_here(self, int vector) noexcept
    @cython.locals(i=int, vector=int, k=int, instance=int)
    cdef void _mark_busy(self) noexcept
    @cython.locals(i=int)
    cdef int _is_single(self, int vector) noexcept
    @cython.locals(place=int, group=int)
    cdef int _group(self, int slot) noexcept
    @cython.locals(i=int, slot=int)
    cdef int _is_alone(self, int vector) noexcept
    @cython.locals(i=int)
    cdef int _suffice(self, int vector) noexcept
    cdef int _is_closed(self, int vector) noexcept
    @cython.locals(group=int, k=int, place=int, slot=int)
    cdef int _is_settled(self) noexcept
    @cython.locals(i=int, is_frozen=bint, group=int, k=int)
    cdef int _add(self, int vector) noexcept
    cdef int _freeze(self, int instance) noexcept
    @cython.locals(last=int, i=int, slot=int)
    cdef int _bar(self, int vector) noexcept
    @cython.locals(i=int, slot=int, gate=int, group=int, k=int)
    cdef int _let_wait(self, int vector) noexcept
    @cython.locals(rank=int, instance=int)
    cdef int _is_stopped(self, int slot) noexcept
    @cython.locals(missing=int, at=int, end=int, slot=int)
    cdef void _list(self, int gate) noexcept
    @cython.locals(i=int, group=int, k=int, place=int, other=int, followed=int, visited=int)
    cdef int _is_unreached(self, int vector) noexcept
    @cython.locals(i=int)
    cdef int _add_possible(self, int vector) noexcept
    @cython.locals(i=int, variable=int, k=int, group=int, place=int, slot=int, instance=int)
    cdef int _follow(self, int vector) noexcept
    @cython.locals(group=int)
    cdef int _visit(self, int place) noexcept
    @cython.locals(slot=int, edge=int, vector=int, gate=int, i=int)
    cdef int _offer(self, int group) noexcept
    cdef int _offer_to(self, int vector) noexcept
    @cython.locals(k=int, instance=int, edge=int, way=int, place=int)
    cdef int _leave(self, int group) noexcept
    @cython.locals(guard=int, holds=int)
    cdef int _is_open(self, int group, int edge) noexcept

# SPDX-License-Identifier: Apache-2.0
# The C types of solver.py. This file contains types only: without them the same code runs as plain Python.
# cython: language_level=3

cimport cython
from roaml.explicit.elimination cimport SmallProcess

ctypedef long long i64

cdef int MAXIMUM, MINIMUM, MEAN, NOTHING, AS_JUDGED, NEGATED
cdef int FALSE, TRUE, UNKNOWN, STATUS, LASTS, FAILS, HOLDS
cdef double MAX_RELATIVE_ERROR, INFINITE, RELATIVE_TOLERANCE, MIN_TOLERANCE, ROUNDING, MAX_ROUNDED
cdef int MAX_PROOF_STEPS, MAX_DIRECT_STATES
cdef i64 MAX_WORK

@cython.final
cdef class Solver:
    cdef int mode
    cdef int states
    cdef i64[::1] start
    cdef int[::1] code
    cdef double[::1] reals
    cdef unsigned char[::1] label
    cdef public double[::1] low, high
    cdef double[::1] before
    cdef unsigned char[::1] fixed, opened
    cdef int[::1] group, order, spare, set_of, index, lowest, path, work_state, work_left, bound
    cdef i64[::1] work_at
    cdef int[::1] range_first, range_last, end_first, end_last
    cdef int bounds, ends, sets, is_reward, accepts, is_signed, rises, falls, has_before
    cdef i64 work, size
    cdef public i64 most_work
    cdef public int has_ended_early, is_unclear

    @cython.locals(state=int, label=int)
    cpdef tuple bounded(self, int target, i64 lower, i64 upper)
    @cython.locals(state=int, status=int)
    cpdef tuple probability(self, int target, int bits, int accepts)
    @cython.locals(state=int, is_zero=int, first=int, last=int, k=int)
    cpdef list certain(self, list roots)
    @cython.locals(state=int, at=i64, size=int)
    cpdef tuple expected(self)
    cdef void _swap(self) noexcept
    @cython.locals(state=int, changed=int, value=double)
    cdef int _sweep(self, int everywhere) except -1
    cdef void _fix(self, int state, double value) noexcept
    @cython.locals(count=int, state=int)
    cdef int _sort_components(self) except -1
    @cython.locals(first=int, k=int, last=int)
    cdef void _solve(self) except *
    @cython.locals(i=int, counted=int, emitted=int, held=int, root=int, top=int, state=int, at=i64, left=int, end=i64,
                   pushed=int, size=int, to=int)
    cdef void _components(self, int first, int last, int own, int inner, int free) noexcept
    @cython.locals(size=int, k=int)
    cdef int _stays(self, i64 at, int own, int free) noexcept
    @cython.locals(at=i64, size=int)
    cdef int _can_stay(self, int state, int own, int free) noexcept
    @cython.locals(base=int, waiting=int, begin=int, end=int, own=int, i=int, state=int, at=int, k=int)
    cdef void _find_ends(self, int first, int last, int free) noexcept
    @cython.locals(at=i64, size=int, k=int)
    cdef int _has_loop(self, int state) noexcept
    @cython.locals(state=int, own=int, i=int, k=int, leads_to_one=int)
    cdef void _component(self, int first, int last) except *
    @cython.locals(own=int, leaves=int, i=int, state=int, at=i64, size=int, count=int, k=int, to=int)
    cdef int _leads_to_one(self, int first, int last) noexcept
    @cython.locals(i=int, state=int, at=i64, size=int)
    cdef int _is_closed(self, int first, int last, int own) noexcept
    cdef void _stay(self, int first, int last) noexcept
    @cython.locals(label=int, lasts=int, fails=int, holds=int, i=int)
    cdef int _accepted(self, int first, int last) noexcept
    @cython.locals(label=int, wanted=int)
    cdef int _needs_lasting(self, int state) noexcept
    @cython.locals(count=int, k=int, first=int, last=int, accepted=int)
    cdef void _accept_ends(self) except *
    @cython.locals(own=int, middle=int, i=int, state=int, kept=int, k=int, lasting=int)
    cdef int _can_last(self, int first, int last) except -1
    @cython.locals(i=int)
    cdef void _fix_all(self, int first, int last, double value) noexcept
    @cython.locals(i=int)
    cdef void _merge(self, int first, int last) noexcept
    @cython.locals(i=int, state=int, at=i64, size=int, k=int)
    cdef int _meets_infinite(self, int first, int last) noexcept
    @cython.locals(own=int, i=int, reaching=int, grows=int, state=int, removed=int)
    cdef void _keep_finite(self, int first, int last) noexcept
    @cython.locals(at=i64, size=int, count=int, is_safe=int, is_progress=int, k=int, to=int)
    cdef int _advances(self, int state, int own, int reaching) noexcept
    @cython.locals(middle=int, i=int, state=int, k=int)
    cdef void _merge_free(self, int first, int last) noexcept
    @cython.locals(best=double, total=double, weights=double, inside=double, at=i64, size=int, weight=double,
                   value=double, stays=double, outside=int, k=int, to=int, chance=double)
    cdef double _best(self, int state, double[::1] values, int own) noexcept
    @cython.locals(change=double, i=int, own=int, best=double, value=double, before=double, slack=double,
                   distance=double, size=double, relative=double)
    cdef double _step(self, int first, int last, double[::1] values) noexcept
    @cython.locals(gap=double, i=int, state=int, tolerance=double, change=double, is_proven=int, own=int, value=double,
                   k=int, limit=i64, may_solve=int)
    cdef void _iterate(self, int first, int last) except *
    @cython.locals(count=i64)
    cdef i64 _direct_work(self, int first, int last) noexcept
    @cython.locals(i=int, state=int, size=int)
    cdef int _is_chain(self, int first, int last) noexcept
    @cython.locals(process=SmallProcess, error=double, largest=double, i=int, state=int, value=double, size=double)
    cdef int _solve_directly(self, int first, int last, double gap) except -1
    @cython.locals(own=int, states=int, choices=i64, i=int, state=int, process=SmallProcess, group=int, before=int)
    cdef SmallProcess _small_process(self, int first, int last)
    @cython.locals(share=double, at=i64, size=int, weight=double, k=int, chance=double)
    cdef void _add_choices(self, SmallProcess process, int state, int group, int own) noexcept
    cdef void _add_entry(self, SmallProcess process, int to, double chance, int own) noexcept
    @cython.locals(weights=double, at=i64, size=int)
    cdef double _weight(self, int state) noexcept
    @cython.locals(leaves=int, k=int, to=int)
    cdef int _is_useful(self, i64 at, int group) noexcept
    @cython.locals(i=int, own=int, value=double, k=int)
    cdef int _lower_is_proven(self, int first, int last) noexcept
    @cython.locals(merged=int, i=int)
    cdef void _gather(self, int first, int last) except *
    @cython.locals(gap=double, at=i64, size=int, count=int, k=int, to=int, distance=double)
    cdef double _gap(self, int state) noexcept

# SPDX-License-Identifier: Apache-2.0
# The C types of chain.py. This file contains types only: without them the same code runs as plain Python.
# cython: language_level=3

cimport cython

ctypedef long long i64

cdef double ROUNDING, INPUT_ROUNDING, SMALLEST, SPLITTER, LARGEST, FAILED
cdef int MAX_ENTRIES_PER_STATE, BUCKETS

@cython.final
cdef class Chain:
    cdef int states, room, entries, current
    cdef public i64 operations
    cdef public double[::1] leaves, gain, values
    cdef double[::1] leaves_low, gain_low, values_low, sum_high, sum_low, chance, chance_low
    cdef int[::1] row, column, row_length, column_length, place, order, bucket, after, before, cost
    cdef int[::1] source, target, in_row, in_column
    cdef unsigned char[::1] is_gone
    cdef double high, low

    @cython.locals(known=int)
    cpdef int add(self, int state, int target, double chance) except -1
    @cython.locals(error=double, state=int, step=int, cheapest=int, last=int, roundings=int, left=int, at=int, to=int)
    cpdef double solve(self) except? -2
    @cython.locals(count=int, high=double, low=double, before=int, at=int, entry=int, state=int)
    cdef int _eliminate(self, int last) except -2
    @cython.locals(share=double, share_low=double, before=int, at=int, known=int, follows=int, to=int)
    cdef int _replace(self, int state, int last, int entry) except -2
    @cython.locals(count=int, high=double, low=double, at=int, entry=int, to=int)
    cdef int _substitute(self, int state) noexcept
    @cython.locals(entry=int)
    cdef int _link(self, int state, int target, double chance, double low) except -1
    @cython.locals(at=int)
    cdef void _leave_row(self, int state) noexcept
    @cython.locals(cost=int, first=int)
    cdef void _insert(self, int state) noexcept
    @cython.locals(before=int, after=int)
    cdef void _remove(self, int state) noexcept
    @cython.locals(total=double, part=double, rest=double)
    cdef void _add(self, double a, double a_low, double b, double b_low) noexcept
    @cython.locals(product=double, rest=double)
    cdef void _multiply(self, double a, double a_low, double b, double b_low) noexcept
    @cython.locals(part=double, a_high=double, a_low=double, b_high=double, b_low=double)
    cdef double _rest(self, double a, double b) noexcept
    @cython.locals(quotient=double, rest=double, second=double)
    cdef void _divide(self, double a, double a_low, double b, double b_low) noexcept

# SPDX-License-Identifier: Apache-2.0
# The C types of elimination.py. This file contains types only: without them the same code runs as plain Python.
# cython: language_level=3

cimport cython
from roaml.explicit.chain cimport Chain

ctypedef long long i64

cdef int MAXIMUM, MINIMUM, MAX_ROUNDS, MAX_SPARSE_ROUNDS
cdef double INFINITE, MAX_STEPS, IMPROVEMENT, ROUNDING

@cython.final
cdef class SmallProcess:
    cdef public int choices
    cdef int states, entries, counts_steps, has_matrix
    cdef public double relative_error
    cdef int[::1] first_choice, first_entry, target, policy
    cdef public double[::1] leaves, gain, values
    cdef double[::1] chance, steps, sums, matrix

    cpdef void add_entry(self, int target, double chance) noexcept
    cpdef void end_choice(self) noexcept
    cpdef void end_state(self) noexcept

    @cython.locals(state=int, choice=int, entries=int, residual=double, size=double, longest=double, value=double,
                   distance=double, gain=double, steps=double)
    cpdef double solve(self, int mode) except? -1
    @cython.locals(choice=int, error=double)
    cdef int _solve_chain(self) except -1
    @cython.locals(chain=Chain, state=int, choice=int, at=int, error=double)
    cdef double _evaluate_sparsely(self, double[::1] values) except? -2
    @cython.locals(state=int)
    cdef int _iterate(self, double[::1] values, int mode) except -1
    @cython.locals(improved=int, state=int, choice=int, best=double, value=double, gain=double)
    cdef int _improve(self, double[::1] values, int mode) noexcept
    @cython.locals(value=double, at=int)
    cdef double _value(self, int choice, double[::1] values) noexcept
    @cython.locals(best=double, choice=int, value=double)
    cdef double _best(self, int state, double[::1] values, int mode) noexcept
    @cython.locals(count=i64, at=i64, state=i64, choice=int, last=i64, row=i64, total=double, to=i64, share=double,
                   value=double)
    cdef int _evaluate(self, double[::1] values) except -1

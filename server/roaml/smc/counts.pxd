# SPDX-License-Identifier: Apache-2.0
# The C types of counts.py. This file contains types only: without them the same code runs as plain Python.
# cython: language_level=3

cimport cython

ctypedef long long i64

cdef int FALSE, TRUE, UNKNOWN, REJECTED, DECIDED, TIME, CLOSED, IDLE, CELLS, CELLS_PER_VERDICT

@cython.locals(
    verdict_of=cython.p_char, end_of=cython.p_char, activity_of=cython.p_char, steps_of=i64[::1], reward_of=double[::1],
    numbers=i64[::1], shortest=i64[::1], shortest_at=i64[::1], room=i64[::1], size=i64, i=i64, total=i64, length=i64,
    rejected=i64, closed=i64, idle=i64, successes=i64, has_rewards=int, verdict=int, cell=int, activity=int, mean=double,
    squares=double, step=double, least=double, greatest=double, order=list, number=i64
)
cpdef object count(bytes verdicts, bytes ends, object steps, bytes activities, object rewards, i64 first, object kept, int can_be_late)

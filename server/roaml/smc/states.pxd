# SPDX-License-Identifier: Apache-2.0
# The C types of states.py. This file contains types only: without them the same code runs as plain Python.
# cython: language_level=3

cimport cython
from roaml.smc.kernel cimport Kernel
from roaml.smc.packing cimport PackedStates

ctypedef unsigned long long u64
ctypedef long long i64

cdef u64 UINT64_MASK, GOLDEN, MIX_1, MIX_2
cdef i64 MAX_INT64
cdef double TO_UNIT
cdef u64 MAX_DRAWN_COMBINATIONS
cdef int FALSE, TRUE, UNKNOWN, FAULTY, DECIDED, CUT, GOES_ON
cdef int SIZE, STATE, FLAGS, REWARD, HEADER_CELLS, CONDITIONS_A_CELL
cdef int DECIDES, CAN_LEAVE, CANNOT_LEAVE, REASON_SHIFT, NEW, BY_KERNEL
cdef int MAX_ROOTS, MAX_COMPARED, PULSE_TRACES
cdef i64 MEASURED_STEPS, REVIEW_STEPS, PULSE_STEPS, NUMBER_BYTES
cdef double MAX_LOSS_S, MAX_LOSS_SHARE

@cython.final
cdef class TraceBatch(PackedStates):
    cdef object rounds
    cdef i64 max_bytes
    cdef public int is_on
    cdef int leaves, condition_cells, head, has_activities, has_exit, width
    cdef int is_prepared, is_kernel, is_measured, is_full
    cdef double kernel_step_s, started_s, spent_s, earlier_s, earlier_loss_s, first_loss_s
    cdef i64 measured_steps, done_steps, new_steps, next_review, next_bound
    cdef int node, here, most_roots
    cdef i64 age
    cdef u64 drawn
    cdef public object verdicts, ends, activities, steps, rewards
    cdef int[::1] root_node, edge_of_way, node_of, cells
    cdef double[::1] reals
    cdef int cell_room, cell_end, real_room, real_end
    cdef dict number_of

    @cython.locals(
        count=int, i=int, verdicts=cython.uchar[::1], ends=cython.uchar[::1], activities=cython.uchar[::1],
        steps=i64[::1], rewards=double[::1], asked=int[::1], since=i64, trace=i64, status=int, limit=i64, at=i64,
        question=int, key=u64, start=u64, first_limit=i64
    )
    cpdef object run(self, object seed, object first, i64 size, i64 max_steps, object questions, object pulse)
    cpdef object use_nodes(self)
    @cython.locals(root=u64, node=int)
    cdef int _begin(self, u64 seed, u64 trace) except? -9
    @cython.locals(status=int, before=i64)
    cdef int _advance(self, i64 limit) except? -9
    @cython.locals(
        node=int, steps=i64, size=int, drawn=u64, at=int, target=int, is_rolled=int, status=int, flags=int,
    )
    cdef int _walk(self, i64 limit) except? -9
    @cython.locals(z=u64)
    cdef u64 _random(self, u64 number) noexcept
    @cython.locals(count=int, at=int, index=int, sides=int, first=int, unit=double, low=int, high=int, middle=int, _=int)
    cdef int _rolled(self, int dice) noexcept
    @cython.locals(decided=int, steps=i64, i=int, bits=int)
    cdef int _judged(self, int node) noexcept
    @cython.locals(i=int, bits=int, reason=int)
    cdef int _ended(self, int node, int repeats) noexcept
    @cython.locals(age=i64, following=int)
    cdef int _new_step(self, int node, int at, int is_rolled) except? -9
    cdef void _link(self, int node, int at, int is_rolled, int following) except *
    @cython.locals(count=int, combinations=i64, is_computed=int, i=int, edge=int, first=int, ways=int, dice=int, end=int,
                   place=int, index=int, way=int)
    cdef int _dice(self, int node, int at) except? -9
    @cython.locals(total=double, sides=int, first=int, start=int, way=int, register=int)
    cdef int _weigh(self, int edge) except? -9
    @cython.locals(now=double, spent=double)
    cdef void _measure(self) except *
    @cython.locals(now=double, spent=double, total=double, loss=double, pause=double)
    cdef void _review(self) except *
    cdef void _begin_period(self, double now, double spent, i64 steps) noexcept
    cdef void _switch_off(self) except *
    cdef void _leave(self, int node) noexcept
    @cython.locals(status=int)
    cdef int _judged_by_kernel(self) noexcept
    cdef void _go(self, int node) noexcept
    cdef void _update(self) except *
    @cython.locals(kernel=Kernel, edge=int, way=int)
    cdef void _prepare(self) except *
    @cython.locals(i=int)
    cdef void _forget(self) except *
    @cython.locals(at=u64, state=i64, size=int, count=int, node=int, i=int)
    cdef int _here(self) except? -9
    @cython.locals(total=u64)
    cdef int _choice_count(self) noexcept
    @cython.locals(flags=int, i=int, bits=int, register=int)
    cdef void _describe(self, int node, int size) except *
    cdef i64 _used(self) noexcept
    cdef void _reserve(self, int count) except *
    cdef void _append(self, double value) except *
    cdef int _number(self, double value) except? -9

# SPDX-License-Identifier: Apache-2.0
# The C types of kernel.py. This file contains types only: without them the same code runs as plain Python.
# Numbers that are used as indices are i64, because C would have to extend an int, which wraps around, in each access.
# cython: language_level=3

cimport cython

include "kernel_types.pxi"  # the class KernelTables and the codes of instructions; see setup.py

ctypedef unsigned long long u64
ctypedef long long i64

cdef u64 UINT64_MASK, GOLDEN, MIX_1, MIX_2
cdef i64 MAX_INT64, MIN_INT64
cdef double TO_UNIT, MASS_UNIT, MASS_UNIT_INVERSE
cdef u64 MAX_DRAWN_COMBINATIONS
cdef int FALSE, TRUE, UNKNOWN, FAULTY, GOES_ON, ASKED
cdef int DECIDED, TIME, FINISHED, STUCK, QUIET, DEADLOCK, IDLE, ROUND

@cython.final
cdef class Kernel(KernelTables):
    cdef list functions
    cdef list arguments
    cdef i64[::1] ints_0, ints, ints_before
    cdef double[::1] reals_0, reals, reals_before
    cdef int[::1] place_0, place
    cdef int[::1] place_mark
    cdef i64[::1] ints_mark
    cdef double[::1] reals_mark
    cdef public u64 roots
    cdef int[::1] visited, visits
    cdef int[::1] verdict, holds_left, holds_right, stale, stack, asked, known, known_end, known_activity
    cdef i64[::1] known_steps
    cdef i64[::1] value_before
    cdef int visit_count, leaves, questions, status
    cdef int[::1] kept_slot, kept_way
    cdef int sums, lasts, is_plain
    cdef u64 tried
    cdef int[::1] ready, ready_0, slot_group, slot_group_0, gate_missing, gate_missing_0, vector_missing, vector_missing_0
    cdef int[::1] enabled, enabled_0
    cdef int enabled_count, enabled_count_0, plural, plural_0, fault_0
    cdef int[::1] noted, notes, part_slot, part_way
    cdef public int parts, vector
    cdef int update, note_count, moved, must_look, fault, fault_at
    cdef i64 fault_value, fault_size
    cdef double fault_real
    cdef u64 key, drawn, scheduler, choice, tossed, loop_state, loop_drawn
    cdef i64 loop_span, loop_left
    cdef int looped
    cdef int rank, end
    cdef double mass
    cdef public i64 steps
    cdef i64 still
    cdef public double reward
    cdef double added

    @cython.locals(a=i64, i=i64)
    cdef void _prepare(self) noexcept
    @cython.locals(i=i64)
    cdef void _reset(self) noexcept
    @cython.locals(rest=u64, choice=i64, first=i64, end=i64, at=i64, k=i64, cell=i64, slot=i64, a=i64, group=i64, i=i64)
    cdef void _enter(self, u64 number) noexcept
    cpdef void root(self, u64 number) noexcept
    @cython.locals(i=i64)
    cdef void _forget_conditions(self) noexcept
    @cython.locals(i=i64)
    cdef void _reset_goal(self) noexcept
    cdef void _seed(self, u64 seed, u64 trace) noexcept
    cdef u64 _root_number(self) noexcept
    @cython.locals(z=u64)
    cdef u64 _mixed(self, u64 value) noexcept
    cdef u64 _draw(self) noexcept
    @cython.locals(old=i64, vector=i64)
    cdef inline void _set_ready(self, i64 slot, i64 count) noexcept
    @cython.locals(gate=i64, i=i64, vector=i64)
    cdef void _add_to_gate(self, i64 number) noexcept
    @cython.locals(gate=i64, i=i64, vector=i64)
    cdef void _remove_from_gate(self, i64 number) noexcept
    @cython.locals(at=i64)
    cdef void _enable(self, i64 vector) noexcept
    @cython.locals(at=i64, following=i64, moved=i64, held=i64)
    cdef void _disable(self, i64 vector) noexcept
    @cython.locals(group=i64)
    cdef void _arrive(self, i64 location) noexcept
    @cython.locals(count=i64, edge=i64, at=i64, i=i64)
    cdef int _count(self, i64 group) noexcept
    @cython.locals(op=i64, x=i64, y=i64, result=i64)
    cdef int _is_true(self, i64 pc) noexcept
    @cython.locals(at=i64, i=i64, value=i64)
    cdef int _list(self, i64 index) noexcept
    @cython.locals(at=i64, i=i64, value=i64)
    cdef int _list_before(self, i64 index) noexcept
    @cython.locals(variable=i64)
    cdef void _keep_values(self) noexcept
    @cython.locals(total=u64, i=i64)
    cdef u64 _total(self) noexcept
    @cython.locals(weight=u64, i=i64, count=i64)
    cdef u64 _weight(self, i64 vector) noexcept
    @cython.locals(i=i64)
    cdef void _weigh(self, i64 vector) noexcept
    cdef double _share(self, i64 vector, i64 top) noexcept
    @cython.locals(rest=u64, apart=i64, vector=i64, total=u64, weight=u64, i=i64, update=i64)
    cdef void _step(self) noexcept
    @cython.locals(top=i64, i=i64, total=double, aim=double, chosen=i64, share=double)
    cdef int _heavy(self) noexcept
    cdef inline u64 _toss(self) noexcept
    @cython.locals(bias=i64, chosen=i64, chosen_rank=i64, greatest=u64, i=i64, vector=i64, rank=i64, value=u64)
    cdef int _scheduled(self) noexcept
    @cython.locals(i=i64)
    cdef int _takes_part(self, i64 vector, i64 instance) noexcept
    cdef void _notice(self, u64 state) noexcept
    @cython.locals(i=i64)
    cpdef tuple changed(self, i64[::1] ints, double[::1] reals)
    @cython.locals(state=u64, second=u64, third=u64, fourth=u64, i=i64, j=i64, real=double, part=u64)
    cdef u64 _state_hash(self) noexcept
    @cython.locals(i=i64, slot=i64, count=i64, pick=i64, edge=i64, way=i64, parts=i64)
    cdef inline void _take(self, i64 vector, u64 rest, i64 apart) noexcept
    @cython.locals(update=i64)
    cdef inline i64 _fixed(self, i64 vector) noexcept
    @cython.locals(at=i64, end=i64)
    cdef inline void _take_fixed(self, i64 vector, i64 update) noexcept
    @cython.locals(at=i64, i=i64)
    cdef void _list_parts(self, i64 update) noexcept
    @cython.locals(i=i64, slot=i64, edge=i64, update=i64)
    cdef void _take_given(self, i64 vector, list picks, list ways) noexcept
    @cython.locals(i=i64, update=i64, code=i64)
    cdef inline void _apply(self, i64 vector) noexcept
    @cython.locals(at=i64, end=i64, slot=i64, group=i64, count=i64, vector=i64, missing=i64)
    cdef inline void _move(self, i64 update) noexcept
    @cython.locals(i=i64)
    cdef void _execute_ways(self, i64 vector) noexcept
    @cython.locals(group=i64, edge=i64, i=i64)
    cdef int _edge(self, i64 slot, i64 pick) noexcept
    @cython.locals(first=i64, end=i64, unit=double, low=i64, high=i64, middle=i64)
    cdef int _way(self, i64 edge) noexcept
    @cython.locals(first=i64, end=i64, unit=double, total=double, drawn=i64, last=i64, way=i64, register=i64, chance=double)
    cdef int _way_computed(self, i64 edge) noexcept
    @cython.locals(way=i64, before=double)
    cdef list _chances(self, i64 edge)
    @cython.locals(index=i64, following=i64, i=i64, k=i64, way=i64)
    cdef void _execute_phases(self) noexcept
    @cython.locals(i=i64, k=i64, m=i64, variable=i64, instance=i64, at=i64, index=i64, group=i64)
    cdef void _look_around(self) noexcept
    @cython.locals(before=i64, now=i64, i=i64, group=i64)
    cdef void _look_up(self, i64 index) noexcept
    @cython.locals(code=i64)
    cdef void _settle_location(self, i64 instance) noexcept
    @cython.locals(i=i64, k=i64, vector=i64, slot=i64, pick=i64, edge=i64, way=i64)
    cdef int _can_leave(self) noexcept
    @cython.locals(is_open=i64, i=i64, parts=i64, changes=i64, vector=i64)
    cdef int _can_change(self) noexcept
    @cython.locals(slot=i64, pick=i64, edge=i64, way=i64, changes=i64)
    cdef int _changes_from(self, i64 vector, i64 at) noexcept
    cdef int _changes_variables(self, i64 vector) noexcept
    @cython.locals(i=i64)
    cdef void _store(self) noexcept
    @cython.locals(i=i64, changed=i64)
    cdef int _restored(self) noexcept
    @cython.locals(register=i64)
    cdef int _is_possible(self, i64 way) noexcept
    @cython.locals(i=i64)
    cdef int _changes(self, i64 slot, i64 way) noexcept
    @cython.locals(status=i64)
    cdef int _advance(self, i64 limit) noexcept
    @cython.locals(status=i64)
    cdef int _after_step(self) noexcept
    cdef int _finish(self, i64 status) noexcept
    @cython.locals(i=i64, decided=i64)
    cdef int _look(self) noexcept
    cdef int _holds(self, i64 code) noexcept
    cdef int _is_deadlock(self) noexcept
    cdef int _ends(self, i64 repeats) noexcept
    @cython.locals(i=i64)
    cdef int _ends_for(self, i64 reason, i64 repeats) noexcept
    @cython.locals(i=i64)
    cdef int _goes_round(self) noexcept
    cdef int _returns(self, i64 most) noexcept
    @cython.locals(i=i64)
    cdef int _is_marked(self) noexcept
    @cython.locals(reason=i64, i=i64, mark=i64, vector=i64)
    cdef int _reason(self, i64 repeats) noexcept
    @cython.locals(status=i64, is_open=i64, i=i64)
    cdef int _combined(self) noexcept
    cdef int _active(self, i64 code) noexcept
    @cython.locals(i=i64)
    cdef void _drop(self, i64 question) noexcept
    @cython.locals(top=i64, i=i64, item=i64, a=i64, b=i64, decisive=i64)
    cdef int _value(self, i64 start, i64 end) noexcept
    @cython.locals(register=i64)
    cdef void _add_reward(self, i64 code) noexcept
    @cython.locals(i=i64, register=i64, reward=double, total=double)
    cdef void _accumulate(self, int[::1] codes) noexcept
    cdef void _fail(self, i64 fault, i64 at) noexcept
    cdef void _fail_with(self, i64 fault, i64 at, i64 value, i64 size, double real) noexcept
    cdef void _note(self, i64 variable) noexcept
    cdef int _call(self, i64 function, i64 real, i64 target, i64 at) noexcept
    @cython.locals(op=i64, d=i64, a=i64, b=i64, c=i64, x=i64, y=i64, z=i64, at=i64, i=i64, changed=i64)
    cdef i64 _execute(self, i64 pc) noexcept

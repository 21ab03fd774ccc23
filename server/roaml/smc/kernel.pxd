# SPDX-License-Identifier: Apache-2.0
# The C types of kernel.py. This file contains types only: without them the same code runs as plain Python.
# cython: language_level=3

cimport cython

ctypedef unsigned long long u64
ctypedef long long i64

cdef u64 UINT64_MASK, GOLDEN, MIX_1, MIX_2
cdef i64 MAX_INT64, MIN_INT64
cdef double TO_UNIT, MASS_UNIT, MASS_UNIT_INVERSE
cdef u64 MAX_DRAWN_COMBINATIONS
cdef int ORDERS
cdef int FALSE, TRUE, UNKNOWN, FAULTY, GOES_ON, ASKED
cdef int DECIDED, TIME, FINISHED, STUCK, QUIET, DEADLOCK, IDLE, ROUND

@cython.final
cdef class Kernel:
    cdef int[::1] code
    cdef list functions
    cdef list arguments
    cdef i64[::1] ints_0, ints, ints_before
    cdef double[::1] reals_0, reals, reals_before
    cdef int int_count, real_count, instances, settle
    cdef int[::1] place_0, place, first_location
    cdef int[::1] root_start, root_cell, root_first
    cdef i64[::1] root_count, root_int
    cdef int[::1] place_mark
    cdef i64[::1] ints_mark
    cdef double[::1] reals_mark
    cdef double[::1] root_real
    cdef public u64 roots
    cdef int[::1] group_start, group_slot, group_way, edge_start, guard, way_start, way_target, way_code, way_chance, way_move
    cdef double[::1] way_sum
    cdef int[::1] way_update, updates
    cdef int[::1] slot_instance, slot_vector, gate_start, gate_vector
    cdef int[::1] active_start, active_slot, all_start, all_slot, entangled
    cdef int[::1] phase_start, phase_index, phase_read, phase_write
    cdef int[::1] watch_start, watch_instance, watch_table, watched_start, watched_group, watched_index, watch_register
    cdef int[::1] group_index, dimension_start, dimension_register, dimension_watch, dimension_size
    cdef int[::1] first_list, list_start, list_item, visited, visits, location_code, location_mark
    cdef int[::1] seen_start, seen_leaf, left, right, formula, formula_start, leaf_start, activity
    cdef int[::1] verdict, holds_left, holds_right, stale, stack, asked, known, known_end, known_activity
    cdef i64[::1] known_steps
    cdef i64[::1] lower, upper, dimension_low, value_before
    cdef int visit_count, leaves, questions, status, is_bounded, step_reward, exit_reward
    cdef int[::1] sum_register, sum_watch, sum_step, sum_exit, kept_slot, kept_way
    cdef double[::1] sum_limit
    cdef int sums, lasts, is_plain
    cdef u64 tried
    cdef int[::1] ready, ready_0, slot_group, slot_group_0, gate_missing, gate_missing_0, vector_missing, vector_missing_0
    cdef int[::1] enabled, enabled_0
    cdef int enabled_count, enabled_count_0, plural, plural_0, fault_0
    cdef int[::1] noted, notes, part_slot, part_way
    cdef public int parts, vector
    cdef int note_count, moved, must_look, fault, fault_at
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

    @cython.locals(a=int, i=int)
    cdef void _prepare(self) noexcept
    @cython.locals(i=int)
    cdef void _reset(self) noexcept
    @cython.locals(rest=u64, choice=int, first=int, end=int, at=i64, k=int, cell=int, slot=int, a=int, group=int, i=int)
    cdef void _enter(self, u64 number) noexcept
    cpdef void root(self, u64 number) noexcept
    @cython.locals(i=int)
    cdef void _forget_conditions(self) noexcept
    @cython.locals(i=int)
    cdef void _reset_goal(self) noexcept
    cdef void _seed(self, u64 seed, u64 trace) noexcept
    cdef u64 _root_number(self) noexcept
    @cython.locals(z=u64)
    cdef u64 _mixed(self, u64 value) noexcept
    cdef u64 _draw(self) noexcept
    @cython.locals(old=int, vector=int)
    cdef void _set_ready(self, int slot, int count) noexcept
    @cython.locals(gate=int, i=int, vector=int)
    cdef void _add_to_gate(self, int number) noexcept
    @cython.locals(gate=int, i=int, vector=int)
    cdef void _remove_from_gate(self, int number) noexcept
    @cython.locals(at=int)
    cdef void _enable(self, int vector) noexcept
    @cython.locals(at=int, following=int, moved=int)
    cdef void _disable(self, int vector) noexcept
    @cython.locals(group=int)
    cdef void _arrive(self, int location) noexcept
    @cython.locals(count=int, edge=int, at=int, i=int)
    cdef int _count(self, int group) noexcept
    @cython.locals(op=int, x=i64, y=i64, result=int)
    cdef int _is_true(self, int pc) noexcept
    @cython.locals(at=int, i=int, value=i64)
    cdef int _list(self, int index) noexcept
    @cython.locals(at=int, i=int, value=i64)
    cdef int _list_before(self, int index) noexcept
    @cython.locals(variable=int)
    cdef void _keep_values(self) noexcept
    @cython.locals(total=u64, i=int)
    cdef u64 _total(self) noexcept
    @cython.locals(weight=u64, i=int, count=int)
    cdef u64 _weight(self, int vector) noexcept
    @cython.locals(i=int)
    cdef void _weigh(self, int vector) noexcept
    cdef double _share(self, int vector, int top) noexcept
    @cython.locals(rest=u64, apart=int, vector=int, total=u64, weight=u64, i=int)
    cdef void _step(self) noexcept
    @cython.locals(top=int, i=int, total=double, aim=double, chosen=int, share=double)
    cdef int _heavy(self) noexcept
    cdef u64 _toss(self) noexcept
    @cython.locals(bias=int, chosen=int, chosen_rank=int, greatest=u64, i=int, vector=int, rank=int, value=u64)
    cdef int _scheduled(self) noexcept
    @cython.locals(i=int)
    cdef int _takes_part(self, int vector, int instance) noexcept
    cdef void _notice(self, u64 state) noexcept
    @cython.locals(state=u64, i=int)
    cdef u64 _state_hash(self) noexcept
    @cython.locals(i=int, slot=int, count=int, pick=int, edge=int, way=int)
    cdef void _take(self, int vector, u64 rest, int apart) noexcept
    @cython.locals(i=int, slot=int, edge=int)
    cdef void _take_given(self, int vector, list picks, list ways) noexcept
    @cython.locals(i=int, update=int, code=int)
    cdef void _apply(self, int vector) noexcept
    @cython.locals(at=int, end=int, slot=int, group=int, guard=int, count=int, old=int, vector=int, missing=int)
    cdef void _move(self, int update) noexcept
    @cython.locals(i=int)
    cdef void _execute_ways(self, int vector) noexcept
    @cython.locals(group=int, edge=int, i=int)
    cdef int _edge(self, int slot, int pick) noexcept
    @cython.locals(first=int, end=int, unit=double, low=int, high=int, middle=int)
    cdef int _way(self, int edge) noexcept
    @cython.locals(first=int, end=int, unit=double, total=double, drawn=int, last=int, way=int, register=int, chance=double)
    cdef int _way_computed(self, int edge) noexcept
    @cython.locals(way=int, before=double)
    cdef list _chances(self, int edge)
    @cython.locals(index=i64, following=i64, i=int, k=int, way=int)
    cdef void _execute_phases(self) noexcept
    @cython.locals(i=int, k=int, m=int, variable=int, instance=int, at=int, index=int, group=int)
    cdef void _look_around(self) noexcept
    @cython.locals(before=int, now=int, i=int, group=int)
    cdef void _look_up(self, int index) noexcept
    @cython.locals(code=int)
    cdef void _settle_location(self, int instance) noexcept
    @cython.locals(i=int, k=int, vector=int, slot=int, pick=int, edge=int, way=int)
    cdef int _can_leave(self) noexcept
    @cython.locals(is_open=int, i=int, parts=int, changes=int, vector=int)
    cdef int _can_change(self) noexcept
    @cython.locals(slot=int, pick=int, edge=int, way=int, changes=int)
    cdef int _changes_from(self, int vector, int at) noexcept
    cdef int _changes_variables(self, int vector) noexcept
    @cython.locals(i=int)
    cdef void _store(self) noexcept
    @cython.locals(i=int, changed=int)
    cdef int _restored(self) noexcept
    @cython.locals(register=int)
    cdef int _is_possible(self, int way) noexcept
    @cython.locals(i=int)
    cdef int _changes(self, int slot, int way) noexcept
    @cython.locals(status=int)
    cdef int _advance(self, i64 limit) noexcept
    @cython.locals(status=int)
    cdef int _after_step(self) noexcept
    cdef int _finish(self, int status) noexcept
    @cython.locals(i=int, decided=int)
    cdef int _look(self) noexcept
    cdef int _holds(self, int code) noexcept
    cdef int _is_deadlock(self) noexcept
    cdef int _ends(self, int repeats) noexcept
    @cython.locals(i=int)
    cdef int _ends_for(self, int reason, int repeats) noexcept
    @cython.locals(i=int)
    cdef int _goes_round(self) noexcept
    cdef int _returns(self, i64 most) noexcept
    @cython.locals(i=int)
    cdef int _is_marked(self) noexcept
    @cython.locals(reason=int, i=int, mark=int)
    cdef int _reason(self, int repeats) noexcept
    @cython.locals(status=int, is_open=int, i=int)
    cdef int _combined(self) noexcept
    cdef int _active(self, int code) noexcept
    @cython.locals(i=int)
    cdef void _drop(self, int question) noexcept
    @cython.locals(top=int, i=int, item=int, a=int, b=int, decisive=int)
    cdef int _value(self, int start, int end) noexcept
    @cython.locals(register=int)
    cdef void _add_reward(self, int code) noexcept
    @cython.locals(i=int, register=int, reward=double, total=double)
    cdef void _accumulate(self, int[::1] codes) noexcept
    cdef void _fail(self, int fault, int at) noexcept
    cdef void _fail_with(self, int fault, int at, i64 value, i64 size, double real) noexcept
    cdef void _note(self, int variable) noexcept
    cdef int _call(self, int function, int real, int target, int at) noexcept
    @cython.locals(op=int, d=int, a=int, b=int, c=int, x=i64, y=i64, z=i64, at=i64, i=int, changed=int)
    cdef i64 _execute(self, int pc) noexcept

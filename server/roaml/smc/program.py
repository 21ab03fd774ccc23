# SPDX-License-Identifier: Apache-2.0
"""A model and a goal as flat arrays, which the kernel simulates and workers receive.

An *instance* is an automaton as an element of the system. *Locations*, *groups* (the edges of a location for one slot),
*edges* and *ways* (destinations) are numbered across all instances. The range from `x_start[i]` to `x_start[i + 1]`
contains the parts of `i`. Code is given by the index of its first instruction, -1 if there is none.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from typing import TypeAlias

from roaml.jani.operators import Operator
from roaml.record import Record

FALSE, TRUE, UNKNOWN, FAULTY = 0, 1, 2, 3
"""The verdict on a trace. The kernel uses the same numbers. UNKNOWN: the trace can continue; if it has ended, it is
undecided. FAULTY: it has executed an undefined operation."""

AT_END = -1
"""The lower bound of a formula that is decided at the end of a trace; see `Goal`."""

Ints: TypeAlias = "array[int]"
"""Numbers with the type `int` of C; the type code is `i`."""
Longs: TypeAlias = "array[int]"
"""Integers with 64 bits; the type code is `q`."""
Reals: TypeAlias = "array[float]"


class ProgramTables(Record, frozen=True, eq=False):
    """The tables of a compiled model that the kernel reads. `setup.py` takes their C types from these declarations.

    Attributes:
        code: the bytecode.
        int_count, real_count: the numbers of registers that are variables.
        root_start, root_cell: the independent choices between initial values, and the cells that each sets: an
            instance for its location; the number of instances plus a register for an integer variable; for a real one,
            also plus the number of integer variables.
        root_count: the number of combinations of values of each choice.
        root_first, root_int, root_real: the values of the cells: for each choice its combinations, one after the other.
            The values of integer cells are in `root_int`, those of real cells at the same index in `root_real`.
        way_sum: the sum of the probabilities of the ways of an edge up to this way, included.
        way_chance: code that returns the register of the probability of a way, if it depends on the state.
        way_move: the move of a way: the number of its pair of a source and a target location; -1 if both are equal.
        group_way: the way of a group that consists of one edge with one way; -1 for other groups.
        vector_update: the index in `updates` of the step that takes a vector, if each of its slots has one group with
            one way; -2 - s if only slot s may have several groups and takes part in no other vector; -1 for other
            vectors, and for entangled ones.
        group_update: for each group of such a slot s, the index of the step that takes its way and the vector of s; -1
            if the group has several ways, and for other slots.
        way_update: for each way that other vectors take, the index in `updates` of its move; -1 if its source and its
            target are equal.
        updates: steps and moves, one after the other.
            A step contains the ends of its first two parts (indices in `updates`), and its parts: the code of its ways;
            the slots that are left and take part in no other vector than the one that is taken; the move of all of its
            instances; the number of its ways, and its slots with their ways.
            A move contains the ends of its four parts, and these parts: instances with their target locations; slots
            that are left, with their `slot_vector`; slots that are entered and have one edge without a guard, with
            their `slot_vector` and their group; and other slots, with their group and the number of their enabled
            edges, which is encoded as in `updates.UpdateTables`.
        slot_vector: the vector of each slot; -1 if there is none; -2 - g if there are several, where g is the gate of
            the slot (`roaml.smc.kernel` defines gates). gate_vector: the vectors of a gate.
        first_held: the first of the vectors that are enabled only if no vector before it is: the steps of the clock in
            a model that holds them. The number of vectors if there are none.
        active_slot: the slots of a vector that have an effect; all_slot: all slots.
        entangled: whether assignments of several parts of a vector depend on one another.
        phase_index: for ways that take part in entangled vectors, the indices of their assignments, in ascending order.
        phase_read, phase_write: for each of these indices, code that computes the values, and code that assigns them.
        watch_instance: the instances whose guards read a watched variable.
        watch_table: for each of these instances, the index in `watched_start` for its first location.
        watched_group: for each location of these instances, the groups whose guards read the variable, without those
            that are in an index.
        watched_index: for each location of these instances, the index of the other groups, -1 if there is none.
        indexed_register: the registers of each watched variable that are dimensions of an index: the variable, or cells
            of an array.
        group_index: the index of the edges of each group, -1 if there is none.
        dimension_start, first_list, list_start, list_item: the indexes and their lists, see `index.Indexes`.
        dimension_register, dimension_low, dimension_size: the dimensions of the indexes.
        settle: code that resets transient variables; location_code: code that sets their values in a location.
        location_mark: why a trace that stays in a location ends (`end.End`); 0 if unknown.
    """

    code: Ints
    int_count: int
    real_count: int
    instances: int
    root_start: Ints
    root_cell: Ints
    root_count: Longs
    root_first: Ints
    root_int: Longs
    root_real: Reals
    first_location: Ints
    group_start: Ints
    group_slot: Ints
    group_way: Ints
    edge_start: Ints
    guard: Ints
    way_start: Ints
    way_target: Ints
    way_code: Ints
    way_sum: Reals
    way_chance: Ints
    way_move: Ints
    way_update: Ints
    vector_update: Ints
    group_update: Ints
    updates: Ints
    slot_instance: Ints
    slot_vector: Ints
    gate_start: Ints
    gate_vector: Ints
    first_held: int
    active_start: Ints
    active_slot: Ints
    all_start: Ints
    all_slot: Ints
    entangled: Ints
    phase_start: Ints
    phase_index: Ints
    phase_read: Ints
    phase_write: Ints
    watch_start: Ints
    watch_instance: Ints
    watch_table: Ints
    watched_start: Ints
    watched_group: Ints
    watched_index: Ints
    indexed_start: Ints
    indexed_register: Ints
    group_index: Ints
    dimension_start: Ints
    dimension_register: Ints
    dimension_low: Longs
    dimension_size: Ints
    first_list: Ints
    list_start: Ints
    list_item: Ints
    settle: int
    location_code: Ints
    location_mark: Ints


class Program(ProgramTables, frozen=True, eq=False):
    """A compiled model.

    Attributes:
        functions: the operators whose functions the bytecode calls.
        ints, reals: the initial values of all registers: variables, then constants, then intermediate results.
        initial: the location of each instance in the first initial state.
        gate_missing, vector_missing: the number of slots of each gate; for each vector, the number of its slots that
            are in no other vector, plus the number of its gates.
        cell_watch: for each variable register, integers first, the number of its variable among the watched variables,
            or -1.
    """

    functions: list[Operator]
    ints: Longs
    reals: Reals
    initial: Ints
    gate_missing: Ints
    vector_missing: Ints
    cell_watch: Ints


class Goal(Record, frozen=True, eq=False):
    """The questions about a trace: a formula over untils for each question, and rewards. A goal with rewards, or with a
    deadlock in a condition, has one question. The kernel reads all of these tables, like `ProgramTables`.

    Attributes:
        seen_start, seen_leaf: for each watched variable, the untils with a condition that reads it.
        left, right: code for the two sides of each until; -1 is true, -2 false, -3 deadlock, -4 no deadlock; on the
            right side, -5 means that the trace gets stuck.
        lower, upper: the bounds of each until on steps, both inclusive; the upper bound -1 means that there is none. An
            until with the lower bound `AT_END` is decided where the trace ends: it is true if the right side holds
            there; it stays undecided if the time of the model has ended and the left side holds.
        formula: reverse Polish notation: the number of an until, or -1 not, -2 and, -3 or.
        formula_start, leaf_start: the formula and the untils of each question.
        activity: for each question, code that computes its `goal.Activity`; -1 if that is always `TRIGGERED`.
        is_bounded: what the evaluation depends on: 0 changes of variables, 1 also the number of steps, 2 also the
            enabled edges.
        step_reward, exit_reward: code that returns the register of the reward of a step.
        sum_register, sum_watch: the register and the number of each variable that contains an accumulated reward.
        sum_step, sum_exit: code that returns the register of the reward that a step adds to this variable; evaluated
            after or before the assignments of the step.
        sum_limit: the greatest value of this variable; greater sums are not distinguished.
    """

    seen_start: Ints
    seen_leaf: Ints
    left: Ints
    right: Ints
    lower: Longs
    upper: Longs
    formula: Ints
    formula_start: Ints
    leaf_start: Ints
    activity: Ints
    is_bounded: int
    step_reward: int
    exit_reward: int
    sum_register: Ints
    sum_watch: Ints
    sum_step: Ints
    sum_exit: Ints
    sum_limit: Reals


def merged(goals: Sequence[Goal]) -> Goal:
    """One goal with the questions of several goals, in their order."""
    first, *others = goals
    if not others:
        return first
    assert not any(goal.is_bounded > 1 or goal.step_reward >= 0 or goal.exit_reward >= 0 for goal in goals)
    offsets = [sum(len(goal.left) for goal in goals[:i]) for i in range(len(goals))]
    seen_start, seen_leaf = array("i", [0]), array("i")
    for variable in range(len(first.seen_start) - 1):
        for goal, offset in zip(goals, offsets, strict=True):
            part = goal.seen_leaf[goal.seen_start[variable] : goal.seen_start[variable + 1]]
            seen_leaf.extend(leaf + offset for leaf in part)
        seen_start.append(len(seen_leaf))
    formula_start, leaf_start, formula = array("i", [0]), array("i", [0]), array("i")
    for goal, offset in zip(goals, offsets, strict=True):
        formula_start.extend(len(formula) + end for end in goal.formula_start[1:])
        leaf_start.extend(offset + end for end in goal.leaf_start[1:])
        formula.extend(item + offset if item >= 0 else item for item in goal.formula)
    return Goal(
        seen_start=seen_start,
        seen_leaf=seen_leaf,
        left=_joined("i", [goal.left for goal in goals]),
        right=_joined("i", [goal.right for goal in goals]),
        lower=_joined("q", [goal.lower for goal in goals]),
        upper=_joined("q", [goal.upper for goal in goals]),
        formula=formula,
        formula_start=formula_start,
        leaf_start=leaf_start,
        activity=_joined("i", [goal.activity for goal in goals]),
        is_bounded=max(goal.is_bounded for goal in goals),
        step_reward=-1,
        exit_reward=-1,
        sum_register=_joined("i", [goal.sum_register for goal in goals]),
        sum_watch=_joined("i", [goal.sum_watch for goal in goals]),
        sum_step=_joined("i", [goal.sum_step for goal in goals]),
        sum_exit=_joined("i", [goal.sum_exit for goal in goals]),
        sum_limit=array("d", [limit for goal in goals for limit in goal.sum_limit]),
    )


def _joined(kind: str, parts: Iterable[Ints]) -> Ints:
    return array(kind, [item for part in parts for item in part])


class Compiled(Record, frozen=True, eq=False):
    """A program with its goal: all data that a worker needs."""

    program: Program
    goal: Goal

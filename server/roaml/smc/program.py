# SPDX-License-Identifier: Apache-2.0
"""A model and a goal as flat arrays, which the kernel simulates and workers receive.

Numbers: an *instance* is an automaton as an element of the system; *locations*, *groups* (the edges of a location for
one slot), *edges* and *ways* (destinations) are numbered across all instances. `x_start[i]` to `x_start[i + 1]` is the
range of the parts of `i`. Code is given by the index of its first instruction, -1 for none.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from roaml.jani.operators import Operator

FALSE, TRUE, UNKNOWN, FAULTY = 0, 1, 2, 3
"""The verdict on a trace. The kernel has the same numbers; UNKNOWN: it can continue, and is undecided if it does
not."""

AT_END = -1
"""A lower bound; see `Goal`."""

Ints: TypeAlias = "array[int]"
Reals: TypeAlias = "array[float]"


@dataclass(frozen=True, slots=True, eq=False)
class Program:
    """A compiled model.

    Attributes:
        code, functions: the bytecode, and the operators whose functions it calls.
        ints, reals: all registers at first: variables, then constants, then room for intermediate results.
        int_count, real_count: the registers that are variables.
        initial: the first location of each instance.
        way_sum: the sum of the probabilities up to a way; way_chance: code that gives the register of the probability
            where it depends on the state.
        move_slot, move_count: what changes between two locations: so many edges of a slot are enabled; below zero,
            `-1 - group` is to be looked at.
        active_slot: the slots of a vector that do something; all_slot: all of them.
        entangled: whether assignments of several parts of a vector have to do with one another.
        phase_*: for these, the code of each way by the index of its assignments.
        watch_*: where variables are read by guards; watched_*: the groups for each location of an instance.
        settle: code that resets transient variables, location_code: what they are in a location.
        location_mark: why a trace ends that stays in a location (`end.End`), 0 where nothing is known of that.
    """

    code: Ints
    functions: list[Operator]
    ints: Ints
    reals: Reals
    int_count: int
    real_count: int
    instances: int
    initial: Ints
    first_location: Ints
    group_start: Ints
    group_slot: Ints
    edge_start: Ints
    guard: Ints
    way_start: Ints
    way_target: Ints
    way_code: Ints
    way_sum: Reals
    way_chance: Ints
    way_move: Ints
    move_start: Ints
    move_slot: Ints
    move_count: Ints
    slot_instance: Ints
    slot_gate: Ints
    gate_start: Ints
    gate_vector: Ints
    gate_missing: Ints
    vector_missing: Ints
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
    settle: int
    location_code: Ints
    location_mark: Ints
    zero_slots: Ints
    zero_vectors: Ints
    zero_variables: Ints
    zero_instances: Ints


@dataclass(frozen=True, slots=True, eq=False)
class Goal:
    """What is asked about a trace: for each question a formula over untils, and rewards. A goal with rewards, or with a
    deadlock in a condition, has one question.

    Attributes:
        seen_start, seen_leaf: for each watched variable, the untils with a condition that reads it.
        left, right: the two sides of each until: code; -1 is true, -2 false, -3 deadlock, -4 its opposite; on the right
            side, -5 that the trace gets stuck.
        lower, upper: its step bounds, both inclusive; -1 is none. With the lower bound `AT_END`, it is decided where
            the trace ends: it is true if the right side holds there; it stays undecided if the time is over and the
            left side holds.
        formula: reverse Polish notation: the number of an until, or -1 not, -2 and, -3 or.
        formula_start, leaf_start: the formula and the untils of each question.
        activity: code for each question that gives its `goal.Activity`; -1 if that is always `ASKED`.
        zero_steps: a counter for each question.
        is_bounded: 0: only changes of variables matter, 1: the number of steps, too, 2: and what is enabled.
        step_reward, exit_reward: code that gives the register of the reward of a step.
    """

    seen_start: Ints
    seen_leaf: Ints
    left: Ints
    right: Ints
    lower: Ints
    upper: Ints
    formula: Ints
    formula_start: Ints
    leaf_start: Ints
    activity: Ints
    zero_steps: Ints
    is_bounded: int
    step_reward: int
    exit_reward: int


def merged(goals: Sequence[Goal]) -> Goal:
    """One goal with the questions of several, in their order."""
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
        seen_start,
        seen_leaf,
        _joined("i", [goal.left for goal in goals]),
        _joined("i", [goal.right for goal in goals]),
        _joined("q", [goal.lower for goal in goals]),
        _joined("q", [goal.upper for goal in goals]),
        formula,
        formula_start,
        leaf_start,
        _joined("i", [goal.activity for goal in goals]),
        _joined("q", [goal.zero_steps for goal in goals]),
        max(goal.is_bounded for goal in goals),
        -1,
        -1,
    )


def _joined(kind: str, parts: Iterable[Ints]) -> Ints:
    return array(kind, [item for part in parts for item in part])


@dataclass(frozen=True, slots=True, eq=False)
class Compiled:
    """A program with its goal: all data that a worker needs."""

    program: Program
    goal: Goal

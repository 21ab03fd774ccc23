# SPDX-License-Identifier: Apache-2.0
"""Bounds on accumulated rewards, and rewards that are accumulated up to a step: all states, traces, and Storm."""

from __future__ import annotations

import json
from typing import Any

import pytest
import stormpy
from hypothesis import given, settings
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way, ways
from smc_random import conditions, networks

import kept_strategies as st
from roaml.explicit.space import StateLimits, explore
from roaml.explicit.values import GoalValues, values_of
from roaml.smc.fault import FaultError
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.statistics import Bounds
from roaml.verification.exhaustive import exact_values

SHARED = ("x", "y")
TRACES = 60
STORM = 1e-5
"""The distance of Storm's values, which it computes with an accuracy of 1e-6 relative to the value."""


def rewarded(path: Json, reward: Any, accumulate: list[str], **bounds: Any) -> Json:
    return {**path, "reward-bounds": [{"exp": reward, "accumulate": accumulate, "bounds": bounds}]}


def checker_of(written: Json) -> ModelChecker:
    checker = ModelChecker(model(written))
    assert not checker.refused
    return checker


def values(checker: ModelChecker) -> GoalValues | None:
    """The values of the first property; `None` if an undefined operation is executed."""
    space = explore(checker, checker.compiled_properties[0], StateLimits())
    return None if space.problem is not None else values_of(space)


def verdicts(checker: ModelChecker, steps: int = 500) -> list[int]:
    compiled = checker.compiled(checker.compiled_properties[0])
    kernel = Kernel(compiled.program, compiled.goal)
    results = []
    for trace in range(TRACES):
        status = kernel.begin(5, trace)
        results.append(kernel.advance(steps) if status not in (TRUE, FALSE) else status)
    return results


def near(one: Bounds, other: Bounds) -> bool:
    return one.lower <= other.upper + 1e-6 and other.lower <= one.upper + 1e-6


@st.composite
def intervals(draw: st.DrawFn) -> Json:
    interval: Json = {}
    if draw(st.booleans()):
        interval |= {"lower": draw(st.integers(0, 4)), "lower-exclusive": draw(st.booleans())}
    if draw(st.booleans()):
        interval |= {"upper": draw(st.integers(0, 9)), "upper-exclusive": draw(st.booleans())}
    return interval


@given(networks(), st.sampled_from("FGUWR"), conditions(SHARED), conditions(SHARED), intervals(), st.booleans())
@settings(max_examples=100, deadline=None, derandomize=True)
def test_a_reward_of_1_for_each_step_is_a_bound_on_steps(
    written: Json, operator: str, left: Any, right: Any, interval: Json, at_exit: bool
) -> None:
    path = op(operator, right) if operator in "FG" else op(operator, left, right)
    by_steps = {**written, "properties": [{"name": "p", "expression": probability({**path, "step-bounds": interval})}]}
    rewards = rewarded(path, 1, ["exit" if at_exit else "steps"], **interval)
    by_rewards = {**written, "properties": [{"name": "p", "expression": probability(rewards)}]}
    one, other = checker_of(by_steps), checker_of(by_rewards)
    assert verdicts(one) == verdicts(other)
    expected, actual = values(one), values(other)
    assert (expected is None) == (actual is None)
    if expected is not None and actual is not None:
        for name in ("minimum", "maximum", "uniform"):
            assert near(getattr(expected, name), getattr(actual, name)), name


def earned(target: str, share: float | None, reward: str, value: int, **assigned: Any) -> Json:
    total = f"sum_{reward}"
    return way(target, share, **{reward: value, total: op("min", op("+", total, value), 20)}, **assigned)


@st.composite
def chains(draw: st.DrawFn) -> Json:
    """A Markov chain without deadlocks. The steps have rewards, `r` and `q`; the model adds them up in `sum_r` and
    `sum_q`."""
    places = "abcd"[: draw(st.integers(2, 4))]
    rewards = st.integers(0, 3)
    edges = []
    for place in places:
        branches = [
            earned(draw(st.sampled_from(places)), share, "r", draw(rewards), x=draw(st.integers(0, 1)))
            for share in (0.25, 0.75)
        ]
        edges.append(edge(place, *branches, action="go"))
    second = [
        edge("s", earned(draw(st.sampled_from("st")), None, "q", draw(rewards)), action="go"),
        edge("t", earned("s", None, "q", draw(rewards)), action="go"),
    ]
    return document(
        automaton("m", " ".join(places), edges),
        automaton("n", "s t", second),
        variables=[
            *(variable(name) for name in ("x", "sum_r", "sum_q")),
            *(variable(name, "int", 0, True) for name in "rq"),
        ],
        syncs=[["go", "go"]],
        type_="dtmc",
    )


def storm_value(written: Json) -> float:
    parsed, properties = stormpy.parse_jani_model_from_string(json.dumps(written))
    built = stormpy.build_model(parsed, properties)
    result = stormpy.model_checking(built, properties[0], only_initial_states=True)
    return float(result.get_value(built.initial_states[0]))


@given(chains(), st.sampled_from("FG"), st.integers(0, 8), st.integers(0, 8))
@settings(max_examples=100, deadline=None, derandomize=True)
def test_bounds_on_rewards_are_conditions_on_sums(written: Json, operator: str, lower: int, upper: int) -> None:
    path = op(operator, op("=", "x", 1))
    path["reward-bounds"] = [
        {"exp": "r", "accumulate": ["steps"], "bounds": {"upper": upper}},
        {"exp": op("+", "r", "q"), "accumulate": ["steps"], "bounds": {"lower": lower, "lower-exclusive": True}},
    ]
    within = op("∧", op("≤", "sum_r", upper), op(">", op("+", "sum_r", "sum_q"), lower))
    compared = (
        op("F", op("∧", within, op("=", "x", 1))) if operator == "F" else op("G", op("⇒", within, op("=", "x", 1)))
    )
    one, other = (
        checker_of({**written, "properties": [{"name": "p", "expression": probability(formula)}]})
        for formula in (path, compared)
    )
    for first, second in zip(verdicts(one), verdicts(other), strict=True):
        assert second in (first, UNKNOWN)
    actual, expected = values(one), values(other)
    assert actual is not None
    assert expected is not None
    assert near(actual.uniform, expected.uniform)


@given(chains(), st.integers(0, 12))
@settings(max_examples=30, deadline=None, derandomize=True)
def test_rewards_up_to_a_step_are_those_of_storm(written: Json, step: int) -> None:
    expected = {"op": "Emin", "exp": op("+", "r", "q"), "accumulate": ["steps"], "step-instant": step}
    written = {**written, "properties": [{"name": "p", "expression": probability_of(expected)}]}
    actual = values(checker_of(written))
    assert actual is not None
    # Storm rejects rewards that are expressions over several variables, so it adds both.
    parts = [
        storm_value({**written, "properties": [{"name": "p", "expression": probability_of({**expected, "exp": name})}]})
        for name in "rq"
    ]
    assert sum(parts) == pytest.approx(actual.minimum.lower, abs=STORM)


def probability_of(value: Json) -> Json:
    return {"op": "filter", "fun": "values", "values": value, "states": {"op": "initial"}}


def earning(*rewards: int, bounds: Json) -> Json:
    """Automata that stay in one location. In each step, the reward is the sum of what they assign."""
    names = [f"r{number}" for number in range(len(rewards))]
    parts = [
        automaton(f"m{number}", "l", [edge("l", way("l", None, **{name: reward}), action="go")])
        for number, (name, reward) in enumerate(zip(names, rewards, strict=True))
    ]
    total: Any = names[0]
    for name in names[1:]:
        total = op("+", total, name)
    path = rewarded(op("F", True), total, ["steps"], **bounds)
    return document(
        *parts,
        variables=[variable(name, "int", 0, True) for name in names],
        syncs=[["go"] * len(parts)],
        properties={"p": probability(path)},
    )


def test_a_trace_whose_last_step_changes_no_location_ends_where_no_step_is_possible() -> None:
    """The trace has no state after the second step, so F with a greater lower bound is false."""
    count = edge("l", way("l", x=op("+", "x", 1)), guard=op("<", "x", 2))
    path = {**op("F", op("=", "x", 2)), "step-bounds": {"lower": 4}}
    checker = checker_of(
        document(automaton("a", "l", [count]), variables=[variable("x")], properties={"p": probability(path)})
    )
    assert set(verdicts(checker)) == {FALSE}
    exact = values(checker)
    assert exact is not None
    assert exact.uniform == Bounds(0, 0)


@pytest.mark.parametrize(("lower", "fails"), [(1, False), (2, False), (3, True)])
def test_an_example_of_failure_never_reaches_the_condition_within_its_bounds(lower: int, fails: bool) -> None:
    """`x` is 1 after the first and the second step. The states do not count steps, so the path of the search to the end
    is the same for all bounds."""
    edges = [edge("a", way("b", x=1)), edge("b", way("c")), edge("c", way("d", x=0))]
    path = {**op("F", op("=", "x", 1)), "step-bounds": {"lower": lower}}
    goal = {"p": probability(path)}
    checker = checker_of(document(automaton("a", "a b c d", edges), variables=[variable("x")], properties=goal))
    exact = exact_values(checker, checker.compiled_properties[0], StateLimits())
    assert exact.least == exact.greatest == (0 if fails else 1)
    assert (exact.shortest(FALSE) is not None) is fails


def test_ways_that_change_something_only_together_go_on() -> None:
    """Alone, each of the two ways changes nothing: `x` returns to 0, and `y` becomes `x`, which is 0."""
    first = edge("l", ways("l", [("x", 1, 0), ("x", 0, 1)]), action="go")
    second = edge("l", ways("l", [("y", op("max", "y", "x"), 1)]), action="go")
    wait = edge("l", ways("l", []), action="wait")
    checker = checker_of(
        document(
            automaton("a", "l", [first, wait]),
            automaton("b", "l", [second]),
            variables=[variable("x"), variable("y")],
            syncs=[["go", "go"], ["wait", None]],
            properties={"p": probability(op("F", op("=", "y", 1)))},
        )
    )
    assert set(verdicts(checker)) == {TRUE}
    exact = values(checker)
    assert exact is not None
    assert exact.uniform == Bounds(1, 1)


@pytest.mark.parametrize(
    ("rewards", "bounds", "expected"),
    [
        ((1,), {"lower": 3}, TRUE),
        ((2,), {"lower": 3, "upper": 3}, FALSE),
        ((2,), {"lower": 3, "upper": 4}, TRUE),
        ((0,), {"lower": 1}, FALSE),
        ((2, -1), {"lower": 4, "upper": 4}, TRUE),
        ((2, -2), {"lower": 1}, FALSE),
    ],
)
def test_a_trace_whose_steps_change_only_rewards_goes_on(rewards: tuple[int, ...], bounds: Json, expected: int) -> None:
    """The model has one state; it is known only from the whole step whether it has a reward."""
    checker = checker_of(earning(*rewards, bounds=bounds))
    assert set(verdicts(checker)) == {expected}
    exact = values(checker)
    assert exact is not None
    assert exact.minimum == exact.maximum == exact.uniform == Bounds(expected, expected)


def test_rewards_that_change_nothing_else_are_accumulated_up_to_a_step() -> None:
    written = earning(3, bounds={})
    expected = {"op": "Emax", "exp": "r0", "accumulate": ["steps"], "step-instant": 70}
    written["properties"] = [{"name": "p", "expression": probability_of(expected)}]
    checker = checker_of(written)
    exact = values(checker)
    assert exact is not None
    assert exact.minimum == exact.maximum == exact.uniform == Bounds(210, 210)
    compiled = checker.compiled(checker.compiled_properties[0])
    kernel = Kernel(compiled.program, compiled.goal)
    kernel.begin(0, 0)
    assert kernel.advance(1000) == TRUE
    assert kernel.outcome()[::2] == (70, 210.0)


def test_where_no_step_is_possible_no_reward_is_earned() -> None:
    steps = [edge("l", way("m", 0.5), way("n", 0.5)), edge("n", way("n"))]
    expected = {"op": "Emax", "exp": 1, "accumulate": ["steps"], "step-instant": 5}
    checker = checker_of(document(automaton("a", "l m n", steps), properties={"p": probability_of(expected)}))
    exact = values(checker)
    assert exact is not None
    assert exact.uniform == Bounds(3, 3)
    assert set(verdicts(checker)) == {TRUE}


def test_a_negative_reward_is_an_error_at_its_expression() -> None:
    with pytest.raises(FaultError, match="a reward is negative") as raised:
        exact_values(checker := checker_of(earning(-1, bounds={"lower": 3})), checker.compiled_properties[0], LIMITS)
    assert raised.value.origin is not None


LIMITS = StateLimits()


def test_sums_of_one_property_are_no_states_of_another_one() -> None:
    written = earning(1, bounds={"lower": 1000})
    written["properties"] += [{"name": "q", "expression": probability(op("F", False))}]
    checker = checker_of(written)
    counts = [explore(checker, property_, LIMITS).states for property_ in checker.compiled_properties]
    assert counts == [1001, 1]


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        (probability(rewarded(op("F", True), 1, ["time"], upper=3)), "no time passes"),
        (probability(rewarded(op("F", {"op": "deadlock"}), 1, ["steps"], upper=3)), "conditions on variables"),
        (probability_of({"op": "Emin", "exp": 1, "step-instant": 3}), "only rewards that are accumulated"),
        (
            probability_of({"op": "Emin", "exp": 1, "accumulate": ["steps"], "step-instant": 3, "reach": True}),
            "not supported together",
        ),
        (probability_of({"op": "Emin", "exp": 1, "accumulate": ["steps"]}), "until a condition holds"),
        (probability_of({"op": "Emin", "exp": 1, "accumulate": ["steps"], "step-instant": -1}), "negative"),
    ],
)
def test_other_forms_are_refused(expression: Json, message: str) -> None:
    checker = ModelChecker(model(document(automaton("a", "l", [edge("l", "l")]), properties={"p": expression})))
    assert message in checker.refused["p"].message

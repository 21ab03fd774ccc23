# SPDX-License-Identifier: Apache-2.0
"""Exact values are compared with expectations without a tolerance."""

from __future__ import annotations

import math

import pytest
from smc_models import automaton, document, edge, model, op, probability, variable, way

from roaml import api
from roaml.smc.goal import Question
from roaml.smc.statistics import Bounds
from roaml.verification.exhaustive import check_exactly
from roaml.verification.expectations import Expectation, Verdict, holds_exactly, parse
from roaml.verification.results import Exact

MINIMUM = Question("p", "Pmin", False, None, ())


def tossed(rest: float) -> Exact:
    """The exact values of a property that fails with a small probability."""
    goal = {"p": probability(op("F", op("=", "x", 1)))}
    edges = [edge("l", way("m", 1 - rest, x=1), way("n", rest))]
    written = document(automaton("a", "l m n", edges), variables=[variable("x")], properties=goal)
    (result,) = api.verify(model(written), exact_if_small=True)
    assert result.exact is not None
    return result.exact


def verdict(text: str, exact: Exact) -> Verdict:
    return check_exactly(parse(f"p {text}"), exact, MINIMUM)


def exact(lower: float, upper: float) -> Exact:
    bounds = Bounds(lower, upper)
    return Exact(bounds, bounds, bounds, 1)


@pytest.mark.parametrize(("text", "is_met"), [("== 1", False), (">= 1", False), ("< 1", True), ("<= 1", True)])
def test_a_failing_trace_decides_about_1(text: str, is_met: bool) -> None:
    found = verdict(text, tossed(1e-13))
    assert found.is_met is is_met
    assert is_met or found.text == "NOT MET: the value is less than 1, as an example trace shows"


@pytest.mark.parametrize("number", [0.5, 0.4999999, 0.5000001])
def test_one_of_two_opposite_expectations_is_met(number: float) -> None:
    for value in (exact(0.5, 0.5), exact(0.4999997, 0.5000003)):
        met = {relation: verdict(f"{relation} {number}", value).is_met for relation in ("<", "<=", ">", ">=", "==")}
        assert met["<"] is not met[">="]
        assert met[">"] is not met["<="]
        assert met["=="] is (met["<="] and met[">="])


def test_a_difference_of_less_than_a_millionth_counts() -> None:
    assert not verdict("<= 0.9999993", exact(1 - 1e-9, 1 - 1e-9)).is_met
    found = verdict("== 0.5", exact(0.5000001, 0.5000001))
    assert found.text == "NOT MET: the value is 0.5000001"


def test_rounding_is_no_difference() -> None:
    third = exact(0.1 + 0.2, 0.1 + 0.2)
    assert verdict("== 0.3", third).is_met
    assert verdict("<= 0.3", third).is_met
    assert not verdict("> 0.3", third).is_met


def test_wide_bounds_do_not_show_an_equation() -> None:
    assert not verdict("== 0.5", exact(0.4, 0.6)).is_met
    threshold = Expectation("p", parse("p >= 1").threshold).threshold
    assert not holds_exactly(threshold, Bounds(-math.inf, math.inf), math.nan, is_reward=False)
    assert holds_exactly(threshold, Bounds(math.inf, math.inf), math.inf, is_reward=True)

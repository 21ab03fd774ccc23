# SPDX-License-Identifier: Apache-2.0
"""A probability that is almost 1 is not shown as 1."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from smc_models import automaton, document, edge, model, op, probability, variable, way

from as2fm_lsp.verification import exact_report
from roaml import api
from roaml.experiments.points import Schedulers, exact_point
from roaml.explicit.space import StateLimits
from roaml.record import replace
from roaml.smc.goal import Question
from roaml.smc.model import ModelChecker
from roaml.smc.statistics import Bounds
from roaml.verification.exhaustive import check_exactly, exact_values
from roaml.verification.expectations import parse
from roaml.verification.results import Exact, is_same
from roaml.verification.small import choices_of


@pytest.mark.parametrize(
    ("tosses", "shown"),
    [
        (0, "p: = 1 for all"),
        (1, "p: almost 1 (fails with a probability of at most 1e-10) for all"),
        (3, "p: almost 1 (fails with a probability of at most 2e-16) for all"),
    ],
)
def test_a_failing_trace_excludes_1(tosses: int, shown: str) -> None:
    """A trace fails if each of the tosses fails."""
    edges = [edge(f"l{n}", way("m", 1 - 1e-10, x=1), way(f"l{n + 1}", 1e-10)) for n in range(tosses)]
    edges += [] if tosses else [edge("l0", way("m", x=1))]
    goal = {"p": probability(op("F", op("=", "x", 1)))}
    written = document(automaton("a", "l0 l1 l2 l3 m", edges), variables=[variable("x")], properties=goal)
    (result,) = api.verify(model(written), exact_if_small=True)
    assert result.exact is not None
    (first, *_) = exact_report.lines("p", result.exact, 0.0)
    assert first.startswith(shown)


def choice_of(least: float, greatest: float) -> Exact:
    """The exact values of a property with a choice between two probabilities."""
    edges = [edge("l", way("m", share, x=1), way("n", 1 - share)) for share in (least, greatest)]
    goal = {"p": probability(op("F", op("=", "x", 1)))}
    written = document(automaton("a", "l m n", edges), variables=[variable("x")], properties=goal)
    (result,) = api.verify(model(written), exact_if_small=True)
    assert result.exact is not None
    return result.exact


def test_a_failing_trace_of_some_schedulers_excludes_1() -> None:
    exact = choice_of(1 - 1e-10, 1)
    (first, *_) = exact_report.lines("p", exact, 0.0)
    assert first.startswith("p: 1 or almost 1 (fails with a probability of at most 1e-10) for all schedulers, exact")
    (uniform, *_) = exact_report.lines("p", exact, 0.0, only_uniform=True)
    assert uniform == first


def test_close_extremes_are_not_the_same_for_all_schedulers() -> None:
    exact = choice_of(0.9999989, 0.9999998)
    assert not exact.agrees
    assert not choices_of(exact).agreement
    (first, *_) = exact_report.lines("p", exact, 0.0)
    assert first.startswith("p: minimum 0.9999989, maximum 0.9999998, ")


def test_extremes_have_enough_digits_to_differ() -> None:
    exact = choice_of(0.5, 0.5 + 2e-9)
    (first, *_) = exact_report.lines("p", exact, 0.0)
    assert first.startswith("p: minimum 0.5, maximum 0.500000002, ")
    assert exact_report.short(exact, Question("p", "Pmin", False, None, ())).startswith(
        "minimum 0.5, maximum 0.500000002, exact"
    )


def test_a_value_that_is_only_enclosed_is_not_shown_as_equal() -> None:
    exact = replace(choice_of(0.25, 0.25 + 8e-7), uniform=Bounds(0.25, 0.25 + 8e-7))
    (first, *_) = exact_report.lines("p", exact, 0.0)
    assert first.startswith("p: minimum 0.25, maximum 0.2500008, between them under uniform choices, exact")
    (first, *_) = exact_report.lines("p", exact, 0.0, only_uniform=True)
    assert first.startswith("p: between 0.25 and 0.2500008 under uniform choices, the exact minimum and maximum, ")


def test_rounding_is_no_difference() -> None:
    assert is_same(Bounds(0.5, 0.5), Bounds(0.5 + 1e-16, 0.5 + 1e-16))
    assert is_same(Bounds(0.5, 0.5 + 5e-7), Bounds(0.5 + 4e-7, 0.5 + 9e-7))
    assert not is_same(Bounds(0.5, 0.5), Bounds(0.5 + 1e-10, 0.5 + 1e-10))


def test_an_experiment_takes_the_minimum_of_close_values() -> None:
    exact, question = choice_of(0.9999989, 0.9999998), Question("p", "Pmin", False, None, ())
    point = exact_point((), question, exact, states=1, can_get_stuck=False, only_uniform=False)
    assert (point.schedulers, point.value) == (Schedulers.MINIMUM, exact.least)


@st.composite
def edges_of_networks(draw: st.DrawFn) -> list[Any]:
    """Edges between locations, some with rare outcomes. `g` is the goal."""
    places = st.sampled_from([f"l{n}" for n in range(6)] + ["g", "g"])
    chances = st.sampled_from([0.5, 1e-3, 1 - 1e-12, 1e-12])
    edges = []
    for n in range(6):
        for _ in range(draw(st.integers(0, 3))):
            first, second, chance = draw(places), draw(places), draw(chances)
            ways = [way(first, 1)] if first == second else [way(first, chance), way(second, 1 - chance)]
            edges.append((n, [to["location"] for to in ways], edge(f"l{n}", *ways)))
    return edges


def certain_by_sets(edges: list[Any], *, is_maximum: bool) -> bool:
    """Whether the goal is reached with the probability 1 from `l0`, by the sets of the definition: for a maximum, the
    greatest set from which the goal can be reached by choices that do not leave it; for a minimum, no state from which
    a scheduler avoids the goal can be reached."""
    goal, places = "g", {"g", *(f"l{n}" for n in range(6))}
    choices = {place: [to for n, to, _ in edges if f"l{n}" == place] for place in places}
    if is_maximum:
        inside = places
        while True:
            reaching = {goal}
            while more := {
                place
                for place in inside - reaching
                if any(inside.issuperset(to) and reaching & set(to) for to in choices[place])
            }:
                reaching |= more
            if reaching == inside:
                return "l0" in inside
            inside = reaching
    avoiding = places - {goal}
    while wrong := {
        place for place in avoiding if choices[place] and not any(avoiding.issuperset(to) for to in choices[place])
    }:
        avoiding = avoiding - wrong
    reached = {"l0"}
    while more := {to for place in reached - {goal} for ways in choices[place] for to in ways} - reached:
        reached |= more
    return not reached & avoiding


@given(edges_of_networks())
def test_the_graph_decides_whether_a_probability_is_1(edges: list[Any]) -> None:
    goals = {name: probability(op("F", op("=", "x", 1)), name) for name in ("Pmin", "Pmax")}
    written = [entry for _, _, entry in edges]
    for entry in written:
        for to in entry["destinations"]:
            if to["location"] == "g":
                to["assignments"] = [{"ref": "x", "value": 1}]
    places = " ".join([*(f"l{n}" for n in range(6)), "g"])
    read = model(document(automaton("a", places, written), variables=[variable("x")], properties=goals))
    checker = ModelChecker(read)
    for compiled in checker.compiled_properties:
        question = compiled.question
        exact = exact_values(checker, compiled, StateLimits())
        is_maximum = question.name == "Pmax"
        bounds = exact.maximum if is_maximum else exact.minimum
        is_one = certain_by_sets(edges, is_maximum=is_maximum)
        assert (bounds.lower == 1.0) is is_one
        assert (bounds.upper == 1.0) is is_one
        for text, is_met in ((">= 1", is_one), ("< 1", not is_one), ("== 1", is_one)):
            assert check_exactly(parse(f"{question.name} {text}"), exact, question).is_met is is_met


@pytest.mark.parametrize("operator", ["Pmin", "Pmax"])
def test_a_slow_chain_with_choices_that_ends_certainly_is_solved_at_once(operator: str) -> None:
    """Value iteration needs about 1e15 steps."""
    rare = 2.0**-50
    edges = [
        edge("a", way("b", rare), way("a", 1 - rare)),
        edge("b", way("a", 0.5), way("g", 0.5, x=1)),
        edge("b", way("g", x=1)),
    ]
    goal = {"p": probability(op("F", op("=", "x", 1)), operator)}
    checker = ModelChecker(model(document(automaton("m", "a b g", edges), variables=[variable("x")], properties=goal)))
    limits = StateLimits(work=1_000_000)
    exact = exact_values(checker, checker.compiled_properties[0], limits)
    assert (exact.minimum, exact.maximum) == (Bounds(1, 1), Bounds(1, 1))

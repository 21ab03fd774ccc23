# SPDX-License-Identifier: Apache-2.0
"""The meaning of properties on short paths."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from smc_models import Json, answers, automaton, document, edge, model, op, probability, variable, way

from examples import examples
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Pool
from roaml.smc.run import EstimationMethod, Options

A, B = op("=", op("%", "x", 2), 1), op("≥", "x", 2)
"""`a` holds if the first bit of x is set, `b` if the second one is set."""


def path_model(labels: Sequence[int], loop: bool, properties: dict[str, Json]) -> Json:
    """One path: x takes these values in order, and then nothing happens. With `loop`, a step that changes nothing is
    still possible at the end."""
    places = [f"s{i}" for i in range(len(labels))]
    steps = [edge(places[i], way(places[i + 1], x=label)) for i, label in enumerate(labels[1:])]
    if loop:
        steps.append(edge(places[-1], places[-1]))
    variables = [variable("x", initial=labels[0])]
    return document(automaton("a", " ".join(places), steps), variables=variables, properties=properties)


def holds(formula: Json, labels: Sequence[int], loop: bool) -> bool:
    """The definition, evaluated position by position. A loop at the end is longer than all bounds that are used
    here."""
    path = [*labels, *([labels[-1]] * 30 if loop else [])]
    match formula["op"]:
        case "¬":
            return not holds(formula["exp"], labels, loop)
        case "∧":
            return holds(formula["left"], labels, loop) and holds(formula["right"], labels, loop)
        case "∨":
            return holds(formula["left"], labels, loop) or holds(formula["right"], labels, loop)

    def state(condition: Any, value: int) -> bool:
        return value % 2 == 1 if condition is A else value >= 2

    bounds = formula.get("step-bounds", {})
    first, last = bounds.get("lower", 0), bounds.get("upper", len(path))
    left, right = formula.get("left"), formula.get("right", formula.get("exp"))
    place = range(len(path))

    def until(keeps: Any, reaches: Any, first: int, last: int) -> bool:
        return any(reaches(path[i]) and all(keeps(path[k]) for k in range(i)) for i in place if first <= i <= last)

    def always(value: int) -> bool:
        return True

    match formula["op"]:
        case "X":
            return len(path) > 1 and state(right, path[1])
        case "F":
            return until(always, lambda value: state(right, value), first, last)
        case "G":
            return not until(always, lambda value: not state(right, value), first, last)
        case "U":
            return until(lambda value: state(left, value), lambda value: state(right, value), first, last)
        case "R":
            return not until(lambda v: not state(left, v), lambda v: not state(right, v), first, last)
        case _:
            assert formula["op"] == "W"
            stays = not until(always, lambda value: not state(left, value), 0, last)
            return stays or until(lambda value: state(left, value), lambda value: state(right, value), first, last)


BOUNDS = st.fixed_dictionaries({}, optional={"lower": st.integers(0, 8), "upper": st.integers(0, 8)})


def formulas() -> st.SearchStrategy[Json]:
    unary = st.builds(op, st.sampled_from(["F", "G"]), st.sampled_from([A, B]))
    binary = st.builds(op, st.sampled_from(["U", "W", "R"]), st.sampled_from([A, B]), st.sampled_from([A, B]))
    bounded = st.builds(lambda f, b: {**f, "step-bounds": b} if b else f, unary | binary, BOUNDS)
    single = st.one_of(bounded, st.builds(lambda a: op("X", a), st.sampled_from([A, B])))
    both = st.builds(op, st.sampled_from(["∧", "∨"]), single, single)
    return st.one_of(single, both, st.builds(lambda f: op("¬", f), single | both))


@settings(max_examples=examples(400))
@given(formulas(), st.lists(st.integers(0, 3), min_size=1, max_size=6), st.booleans())
def test_path_formulas(formula: Json, labels: list[int], loop: bool) -> None:
    expected = holds(formula, labels, loop)
    answer = answers(path_model(labels, loop, {"p": probability(formula)}))["p"]
    assert (answer.value, answer.tally.undecided) == (float(expected), 0)


def test_exclusive_bounds() -> None:
    for bounds, expected in (
        ({"lower": 2, "lower-exclusive": True}, 0),
        ({"lower": 1, "lower-exclusive": True}, 1),
        ({"upper": 2, "upper-exclusive": True}, 0),
        ({"upper": 3, "upper-exclusive": True}, 1),
    ):
        formula = {**op("F", A), "step-bounds": bounds}
        assert answers(path_model([0, 0, 1, 0], False, {"p": probability(formula)}))["p"].value == expected


def test_deadlock() -> None:
    for loop in (False, True):
        formulas = {
            "ends": probability(op("F", {"op": "deadlock"})),
            "goes on": probability(op("G", op("¬", {"op": "deadlock"}))),
        }
        actual_answers = answers(path_model([0, 1], loop, formulas))
        assert (actual_answers["ends"].value, actual_answers["goes on"].value) == (not loop, loop)


def test_a_trace_that_is_cut_is_undecided() -> None:
    written = document(
        automaton("a", "l m", [edge("l", way("m", x=op("-", "x", 1))), edge("m", "l")]),
        variables=[variable("x")],
        properties={"p": probability(op("F", B))},
    )
    answer = answers(written, 50, max_steps=1000)["p"]
    assert (answer.tally.undecided, answer.value) == (50, 0.5)
    assert tuple(answer.bounds) == (0, 1)
    assert answer.tally.steps == 50_000


def test_an_end_with_steps_that_change_nothing_is_found() -> None:
    """Several automata assign the same values again and again, so nothing can change any more."""
    written = document(
        automaton("a", "l", [edge("l", way("l", x=op("min", 2, op("+", "x", 1))))]),
        automaton("b", "l", [edge("l", "l")]),
        variables=[variable("x")],
        syncs=[],
        properties={"p": probability(op("F", op("=", "x", 3)))},
    )
    answer = answers(written, 20, max_steps=10**9)["p"]
    assert (answer.value, answer.tally.undecided) == (0, 0)


def threshold(operator: str, left: Any, right: Any) -> Json:
    return {"op": "filter", "fun": "∀", "values": op(operator, left, right), "states": {"op": "initial"}}


def test_thresholds() -> None:
    inner = {"op": "Pmin", "exp": op("F", A)}
    for written, relation, number in (
        (threshold("≥", inner, 0.95), "≥", 0.95),
        (threshold("<", inner, op("/", 1, 4)), "<", 0.25),
        (threshold("≤", 0.5, inner), "≥", 0.5),
        (op(">", inner, "c"), ">", 0.75),
    ):
        jani = path_model([0, 1], False, {"p": written})
        jani["constants"] = [{"name": "c", "type": "real", "value": 0.75}]
        (property_,) = ModelChecker(model(jani)).compiled_properties
        assert property_.question.threshold is not None
        assert (property_.question.threshold.relation.symbol, property_.question.threshold.number) == (
            relation,
            number,
        )


def expectation(reward: Any, accumulate: list[str], reach: Any = A) -> Json:
    values = {"op": "Emax", "exp": reward, "accumulate": accumulate, "reach": reach}
    return {"op": "filter", "fun": "values", "values": values, "states": {"op": "initial"}}


def test_rewards_of_steps_and_states() -> None:
    labels = [0, 2, 2, 1]
    properties = {
        "steps": expectation(1, ["steps"]),
        "values after steps": expectation("x", ["steps"]),
        "values of states that are left": expectation("x", ["exit"]),
        "both": expectation("x", ["steps", "exit"]),
    }
    values = {name: answer.value for name, answer in answers(path_model(labels, False, properties), 3).items()}
    assert values == {"steps": 3, "values after steps": 5, "values of states that are left": 4, "both": 9}


def test_rewards_of_transient_variables() -> None:
    """The value that an edge assigns is used for its step only; the value of a location is used for its states."""
    steps = [edge("l", way("m", cost=5)), edge("m", way("n", x=1))]
    walker = automaton("a", "l m n", steps)
    walker["locations"][1]["transient-values"] = [{"ref": "rent", "value": 7}]
    written = document(
        walker,
        variables=[variable("x"), variable("cost", "real", 0, True), variable("rent", "real", 0, True)],
        properties={"cost": expectation("cost", ["steps"]), "rent": expectation("rent", ["exit"])},
    )
    assert {name: answer.value for name, answer in answers(written, 2).items()} == {"cost": 5, "rent": 7}


def test_an_expected_reward_is_infinite_where_the_goal_may_be_missed() -> None:
    written = document(
        automaton("a", "l m n", [edge("l", way("m", 0.5, x=1), way("n", 0.5))]),
        variables=[variable("x")],
        properties={"p": expectation(1, ["steps"])},
    )
    answer = answers(written, 200)["p"]
    assert math.isinf(answer.value)
    assert math.isinf(answer.bounds.upper)


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        (probability(op("X", op("G", A))), "inside another one"),
        (probability({**op("F", A), "time-bounds": {"upper": 3}}), "bounds on time"),
        ({**probability(op("F", A)), "states": A}, "initial states"),
        ({**probability(op("F", A)), "fun": "argmax"}, "`argmax` is not supported"),
        (A, "neither a probability"),
        (expectation(1, ["time"]), "no time passes"),
        ({"op": "Smax", "exp": A}, "neither a probability"),
    ],
)
def test_properties_that_cannot_be_answered(expression: Json, message: str) -> None:
    """Each is rejected for a different reason, and the other properties are still answered."""
    properties = {"before": probability(op("F", A)), "p": expression, "after": probability(op("G", A))}
    checker = ModelChecker(model(path_model([0, 1], False, properties)))
    assert [property_.question.name for property_ in checker.compiled_properties] == ["before", "after"]
    assert checker.names == ("before", "p", "after")
    (refused,) = checker.refused.values()
    assert message in refused.message
    assert "supported are `Pmin` and `Pmax` of F, G, X, U, W and R" in refused.message
    assert refused.code in ("unsupported-property", "ignored-bounds")
    assert refused.origin is not None
    with Pool() as pool:
        options = Options(method=EstimationMethod.FIXED, max_traces=1)
        assert [checker.answer(property_, options, pool).value for property_ in checker.compiled_properties] == [1, 0]

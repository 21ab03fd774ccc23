# SPDX-License-Identifier: Apache-2.0
"""Properties that ask about the same paths or the same reward are answered from one exploration."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from loose_networks import networks
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

from examples import examples
from roaml.explicit import space
from roaml.explicit.space import StateLimits
from roaml.smc.model import ModelChecker
from roaml.verification import exhaustive, small
from roaml.verification.explorations import Explorations, subject_of
from roaml.verification.results import Exact, Undecided
from roaml.verification.target import target_of
from roaml.verification.verifier import Verifier, verifier_of

GOAL = op("F", op("=", "x", 1))


def cost(operator: str, reward: int = 1) -> Json:
    return {"op": operator, "exp": reward, "accumulate": ["steps"], "reach": op("≥", "x", 1)}


PROPERTIES = {
    "least": probability(GOAL),
    "greatest": probability(GOAL, "Pmax"),
    "likely": op("≥", probability(GOAL, "Pmax"), 0.3),
    "never": probability(op("G", op("≠", "x", 1))),
    "soon": probability({**GOAL, "step-bounds": {"upper": 1}}),
    "cheap": cost("Emin"),
    "dear": cost("Emax"),
    "twice": cost("Emax", 2),
}
SUBJECTS = [["least", "greatest", "likely"], ["never"], ["soon"], ["cheap", "dear"], ["twice"]]


def tossing() -> Json:
    edges = [edge("s", way("e", 0.5, x=1), way("e", 0.5, x=2)), edge("s", way("e", x=1))]
    return document(automaton("a", "s e", edges), variables=[variable("x")], properties=PROPERTIES)


def verifier(written: Json, **options: Any) -> Verifier:
    return verifier_of(target_of(model(written), "model.jani", (), lambda _: None), **options)


@pytest.fixture
def explored(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The names of the properties for which states are explored."""
    names: list[str] = []

    def explore(checker: Any, property_: Any, *arguments: Any, **options: Any) -> Any:
        names.append(property_.question.name)
        return space.explore(checker, property_, *arguments, **options)

    monkeypatch.setattr(exhaustive, "explore", explore)
    monkeypatch.setattr(small, "explore", explore)
    return names


def test_properties_with_one_subject() -> None:
    checker = ModelChecker(model(tossing()))
    subjects = [
        [subject_of(checker, p) for p in checker.compiled_properties if p.question.name in of] for of in SUBJECTS
    ]
    assert all(len(set(of)) == 1 for of in subjects)
    assert len({of[0] for of in subjects}) == len(SUBJECTS)


def test_states_are_explored_once_for_each_subject(explored: list[str]) -> None:
    exhaustively = verifier(tossing())
    results = {
        p.question.name: exhaustively.exhaustive(p, StateLimits()) for p in exhaustively.checker.compiled_properties
    }
    assert explored == [names[0] for names in SUBJECTS]
    exact = {name: result.exact for name, result in results.items() if result.exact is not None}
    assert set(exact) == set(PROPERTIES)
    for first, *others in SUBJECTS:
        for other in others:
            assert values_of(exact[other]) == values_of(exact[first])
    assert [verdict.is_met for verdict in results["likely"].verdicts] == [True]
    for name, values in exact.items():
        assert {trace.story(None).property for trace in values.traces} <= {name}
    assert len(exact["greatest"].traces) == 2


def values_of(exact: Exact) -> tuple[object, ...]:
    return exact.minimum, exact.maximum, exact.uniform, exact.states


def test_small_models_are_explored_once_for_each_subject(explored: list[str]) -> None:
    exactly = verifier(tossing(), exact_if_small=True)
    small_values = [exactly._small(p, None) for p in exactly.checker.compiled_properties]
    assert all(small_values)
    assert explored == [names[0] for names in SUBJECTS]


def test_a_limit_is_reached_once_for_each_subject(explored: list[str]) -> None:
    written = tossing()
    written["properties"] = written["properties"][:3]
    exhaustively = verifier(written)
    limits = StateLimits(states=1)
    results = [exhaustively.exhaustive(p, limits) for p in exhaustively.checker.compiled_properties]
    assert all(isinstance(r.outcome, Undecided) and r.outcome.reason.startswith("stopped at ") for r in results)
    assert set(explored) == {"least"}
    explored.clear()
    assert exhaustively.exhaustive(exhaustively.checker.compiled_properties[1], StateLimits()).exact is not None
    assert explored == ["greatest"]


def test_a_single_property_is_not_remembered() -> None:
    checker = ModelChecker(model(tossing()))
    explorations = Explorations()
    never = next(p for p in checker.compiled_properties if p.question.name == "never")
    answers = [explorations.exact(checker, never, None, lambda: None) for _ in range(2)]
    assert answers == [None, None]
    assert not explorations._known


@given(networks())
@settings(max_examples=examples(60), deadline=None)
def test_shared_values_are_those_of_separate_explorations(written: Json) -> None:
    (asked,) = written["properties"]
    expression = asked["expression"]
    values = expression["values"] if expression["op"] == "filter" else expression
    other = {**values, "op": "Pmax" if values["op"] == "Pmin" else "Pmin"}
    turned = {**expression, "values": other} if expression["op"] == "filter" else other
    written["properties"] = [asked, {"name": "other", "expression": turned}]
    together = verifier(written)
    if together.checker.refused:
        return
    first, second = together.checker.compiled_properties
    assert subject_of(together.checker, first) == subject_of(together.checker, second)
    shared = [together.exhaustive(p, StateLimits()) for p in (first, second)]
    alone = [verifier(written, properties=[p.question.name]) for p in (first, second)]
    separate = [v.exhaustive(v.checker.compiled_properties[0], StateLimits()) for v in alone]
    for one, two in zip(shared, separate, strict=True):
        assert one.name == two.name
        assert one.outcome == two.outcome

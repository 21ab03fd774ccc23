# SPDX-License-Identifier: Apache-2.0
"""An endless trace shows why a value is 0 or 1 if no finite trace does."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from loose_networks import networks
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

from as2fm_lsp.verification.report import one_as_text
from examples import examples
from roaml.explicit.endless import endless
from roaml.explicit.path import shortest
from roaml.explicit.space import LimitError, Space, StateLimits, explore
from roaml.explicit.values import NoValueError, values_of
from roaml.smc.fault import FaultError
from roaml.smc.goal import NOT
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.verification.exhaustive import alone
from roaml.verification.results import Computed, Result
from roaml.verification.target import target_of
from roaml.verification.verifier import verifier_of


def waiting(formula: Json, operator: str = "Pmin") -> Json:
    """A worker with one step, and two machines that can pass a token to each other for ever."""
    return document(
        automaton("ping", "s", [edge("s", way("s", token=1), guard=op("=", "token", 0))]),
        automaton("pong", "s", [edge("s", way("s", token=0), guard=op("=", "token", 1))]),
        automaton("worker", "a b", [edge("a", way("b", done=True))]),
        variables=[variable("token"), variable("done", "bool", False)],
        properties={"p": probability(formula, operator)},
    )


def result_of(written: Json) -> Result:
    return verifier_of(target_of(model(written)), None).exhaustive(
        ModelChecker(model(written)).compiled_properties[0], StateLimits()
    )


@pytest.mark.parametrize(
    ("formula", "operator", "reason"),
    [
        (op("F", "done"), "Pmin", "the property does not hold, for example, if `worker` is delayed for ever while"),
        (op("G", op("¬", "done")), "Pmax", "the property holds, for example, if `worker` is delayed for ever while"),
    ],
)
def test_the_delayed_element_is_named(formula: Json, operator: str, reason: str) -> None:
    result = result_of(waiting(formula, operator))
    assert isinstance(result.outcome, Computed)
    assert result.outcome.reason == f"{reason} `ping` and `pong` repeat 2 steps"
    assert result.outcome.reason in one_as_text(result, lambda *_: None)


def test_a_finite_trace_is_reason_enough() -> None:
    """A trace that ends explains the minimum, so no endless one is looked for."""
    written = waiting(op("F", op("=", "token", 2)))
    written["properties"] = [{"name": "p", "expression": probability(op("U", op("=", "token", 0), "done"))}]
    result = result_of(written)
    assert isinstance(result.outcome, Computed)
    assert (result.outcome.exact.least, result.outcome.exact.greatest) == (0, 1)
    assert result.outcome.exact.shortest(FALSE) is not None
    assert result.outcome.reason == ""


def replayed(space: Space) -> int:
    """The verdict of the endless trace of a space. The trace is replayed: each step is possible and decides nothing,
    also if the cycle is repeated. Variables that are not read again may have other values then."""
    found = endless(space)
    assert found is not None
    assert found.cycle
    compiled = space.checker.compiled(space.compiled_property)
    kernel = Kernel(compiled.program, compiled.goal)
    kernel.root(found.path.root)
    for step in (*found.path.steps, *found.cycle * 3):
        assert step.vector in [vector for vector, _, _ in kernel.choices()]
        assert kernel.go(step.vector, list(step.edges), list(step.ways)) == UNKNOWN
    return found.path.verdict


def test_there_is_an_endless_trace_whenever_no_finite_one_explains_the_value() -> None:
    verdicts: set[int] = set()

    @given(networks())
    @settings(max_examples=examples(300), deadline=None)
    def check(written: Json) -> None:
        checker = ModelChecker(model(written))
        if checker.refused:
            return
        own, property_ = alone(checker, checker.compiled_properties[0])
        goal = property_.goal
        if len(goal.left) != 1 or property_.question.is_reward or goal.upper[0] >= 0 or goal.lower[0] != 0:
            return
        for is_reduced in (False, True):
            try:
                space = explore(own, property_, StateLimits(states=2_000, reduces=is_reduced))
                values = values_of(space)
            except (FaultError, LimitError, NoValueError):
                return
            if space.problem is not None:
                return
            is_negated = goal.formula.count(NOT) % 2 == 1
            lasts, extreme = (TRUE, values.maximum.lower) if is_negated else (FALSE, values.minimum.upper)
            if shortest(space, lasts) is None and extreme == (1 if is_negated else 0):
                assert replayed(space) == lasts
                verdicts.add(lasts)
            elif endless(space) is not None:
                assert replayed(space) == lasts

    check()
    assert verdicts


def test_a_chain_has_no_endless_trace_that_is_certain() -> None:
    """Chance leaves each cycle of states at last."""
    step = edge("s", way("s", 0.5), way("e", 0.5, done=True))
    written = document(
        automaton("a", "s e", [step]),
        variables=[variable("done", "bool", False)],
        properties={"p": probability(op("F", "done"))},
    )
    checker = ModelChecker(model(written))
    assert endless(explore(checker, checker.compiled_properties[0], StateLimits())) is None

# SPDX-License-Identifier: Apache-2.0
"""Expected rewards with rare values: the traces do not end before a rare value can occur, and expectations are not met
by values that happen to be equal."""

from __future__ import annotations

import math
from typing import Any

import pytest
from smc_models import automaton, document, edge, model, variable, way

from roaml.smc.model import ModelChecker
from roaml.smc.pool import Pool
from roaml.smc.run import MIN_REWARD_TRACES, Answer, EstimationMethod, Options
from roaml.verification.expectations import check_expectation, parse


def lottery(chance: float, prize: int) -> dict[str, Any]:
    """One step, whose reward is `prize` with the probability `chance` and otherwise 0."""
    ways = way("t", chance, r=prize, done=True), way("t", 1 - chance, done=True)
    paid = {"op": "Emin", "exp": "r", "accumulate": ["steps"], "reach": "done"}
    value = {"op": "filter", "fun": "values", "values": paid, "states": {"op": "initial"}}
    return document(
        automaton("a", "s t", [edge("s", *ways)]),
        variables=[variable("r", transient=True), variable("done", "bool", False)],
        properties={"p": value},
        type_="dtmc",
    )


def answer(written: dict[str, Any], **options: Any) -> Answer:
    checker = ModelChecker(model(written))
    with Pool() as pool:
        return checker.answer(checker.compiled_properties[0], Options(**options), pool)


def met(expected: str, answered: Answer) -> tuple[bool, bool]:
    verdict = check_expectation(parse(expected), answered)
    return verdict.is_met, verdict.is_certain


def test_a_rare_reward_is_seen() -> None:
    """The first 100 traces usually contain only zeros."""
    for seed in range(5):
        answered = answer(lottery(0.001, 1000), seed=seed, epsilon=0.3)
        assert answered.tally.traces >= MIN_REWARD_TRACES
        assert answered.bounds.lower <= 1 <= answered.bounds.upper
        assert not all(met("p <= 0.5", answered))


@pytest.mark.parametrize("method", [EstimationMethod.ADAPTIVE, EstimationMethod.FIXED])
def test_equal_rewards_meet_no_expectation(method: EstimationMethod) -> None:
    answered = answer(lottery(1e-9, 10**9), method=method, max_traces=20_000)
    assert answered.value == 0
    assert answered.bounds == (-math.inf, math.inf)
    assert not answered.is_complete
    for expected in ("p <= 0.5", "p >= -1", "p == 0"):
        assert met(expected, answered) == (False, False)


def test_the_interval_decides_expectations() -> None:
    answered = answer(lottery(0.5, 2), epsilon=0.05)
    assert answered.is_complete
    assert met("p <= 1.5", answered) == (True, True)
    assert met("p >= 1.5", answered) == (False, True)

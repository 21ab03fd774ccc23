# SPDX-License-Identifier: Apache-2.0
"""All states of models of the Quantitative Verification Benchmark Set, if it is in a folder beside the project: the
values are those of `expected.json`, which Storm has computed. The other models are rejected with the reason."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import conformance
from roaml.explicit.space import StateLimits
from roaml.jani.model import Model
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Pool
from roaml.smc.run import EstimationMethod, Options
from roaml.verification.exhaustive import UndecidedError, exact_values
from roaml.verification.schedulers import is_minimised

FOLDER = conformance.ROOT.parent / "qvbs"
MAX_STATES = 6_000
"""Larger models take more time than a test should."""
WIDTH = 1e-6
STORM = 2e-6
"""The distance of Storm's values, from value iteration without bounds: for `c2` of consensus, whose minimum is 49/128,
it ended at 0.3828113."""
BOUNDED = [
    {"model": "coupon.jani", "property": "collect_all_bounded", "asked": 0.5225472},
    {"model": "eajs.jani", "property": "ProbUtil", "asked": 0.02804450541},
    {"model": "firewire.jani", "property": "deadline", "asked": 0.5},
    {"model": "resource-gathering.jani", "property": "expgold", "asked": 22.07144159},
]
"""Properties with bounds on rewards, or with rewards up to a step, that `expected.json` does not contain, with the
values that Storm computes for the same files."""
SEVERAL_INITIAL_STATES = [
    {"model": "herman.jani", "property": "steps", "asked": 4 / 3, "initial": 8, "uniform": 1 / 3},
    {"model": "herman#2.jani", "property": "steps", "asked": 16 / 5, "initial": 32, "uniform": 29 / 15},
]
"""Properties that ask for the maximum over all initial states, with the mean value of these states: Storm's values."""
REFUSED = {
    "brp-pta": "type `pta`",
    "cluster": "type `ctmc`",
    "embedded": "type `ctmc`",
    "ftwc": "type `ma`",
    "jobs": "type `ma`",
    "polling": "type `ctmc`",
    "repudiation_malicious": "type `pta`",
    "stream": "type `ma`",
}


def rows() -> list[Any]:
    """Model, property and values of each answer that is known."""
    if not FOLDER.is_dir():
        return []
    expected = json.loads((FOLDER / "expected.json").read_text(encoding="utf-8"))
    small = [row for row in expected if row["states"] <= MAX_STATES]
    return [pytest.param(row, id=f"{Path(row['model']).stem}-{row['property']}") for row in small]


def load(name: str) -> Model:
    value, _ = parse((FOLDER / name).read_text(encoding="utf-8-sig"))
    model, findings = read_model(value, name)
    assert model is not None, findings
    return model


@pytest.mark.parametrize("row", rows())
def test_values_are_those_of_storm(row: dict[str, Any]) -> None:
    model = load(row["model"])
    checker = ModelChecker(
        model,
        [property_ for property_ in model.properties if property_.name == row["property"]],
    )
    property_ = checker.compiled_properties[0]
    exact = exact_values(checker, property_, StateLimits())
    assert exact.is_precise
    extreme = exact.minimum if is_minimised(property_.question) else exact.maximum
    for bounds, value in ((extreme, row["asked"]), (exact.uniform, row["uniform"])):
        assert bounds.upper - bounds.lower <= WIDTH
        assert bounds.lower - STORM <= value <= bounds.upper + STORM


@pytest.mark.parametrize("row", BOUNDED if FOLDER.is_dir() else (), ids=lambda row: Path(row["model"]).stem)
def test_values_with_bounds_on_rewards_are_those_of_storm(row: dict[str, Any]) -> None:
    model = load(row["model"])
    checker = ModelChecker(model, [property_ for property_ in model.properties if property_.name == row["property"]])
    property_ = checker.compiled_properties[0]
    exact = exact_values(checker, property_, StateLimits())
    extreme = exact.minimum if is_minimised(property_.question) else exact.maximum
    assert extreme.upper - extreme.lower <= WIDTH * max(1.0, row["asked"])
    assert extreme.lower - STORM * max(1.0, row["asked"]) <= row["asked"]
    assert row["asked"] <= extreme.upper + STORM * max(1.0, row["asked"])


@pytest.mark.parametrize("row", SEVERAL_INITIAL_STATES if FOLDER.is_dir() else (), ids=lambda row: row["model"])
def test_values_over_several_initial_states_are_those_of_storm(row: dict[str, Any]) -> None:
    model = load(row["model"])
    checker = ModelChecker(model)
    assert checker.initial_states == row["initial"]
    exact = exact_values(checker, checker.compiled_properties[0], StateLimits())
    for bounds in (exact.minimum, exact.maximum, exact.uniform):
        assert bounds.lower - WIDTH <= row["asked"] <= bounds.upper + WIDTH
    options = Options(method=EstimationMethod.FIXED, max_traces=40_000)
    with Pool() as pool:
        answer = checker.answer(checker.compiled_properties[0], options, pool)
    assert abs(answer.value - row["uniform"]) < 0.04


@pytest.mark.parametrize("name", ["bluetooth"] if FOLDER.is_dir() else ())
def test_initial_states_need_not_be_listed(name: str) -> None:
    """Storm cannot list them either."""
    checker = ModelChecker(load(f"{name}.jani"))
    property_ = checker.compiled_properties[0]
    assert checker.initial_states == 4096 * 32 * 2 * 16 * 128
    with pytest.raises(UndecidedError, match="there are 536,870,912 initial states, more than"):
        exact_values(checker, property_, StateLimits(states=1_000_000))
    with Pool() as pool:
        answer = checker.answer(property_, Options(method=EstimationMethod.FIXED, max_traces=200), pool)
    assert (answer.tally.successes, 1_000 < answer.value < 4_000) == (200, True)


@pytest.mark.parametrize("name", REFUSED if FOLDER.is_dir() else ())
def test_other_models_are_refused_with_the_reason(name: str) -> None:
    with pytest.raises(FaultError, match=REFUSED[name]):
        ModelChecker(load(f"{name}.jani"))

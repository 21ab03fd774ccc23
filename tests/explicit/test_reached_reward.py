# SPDX-License-Identifier: Apache-2.0
"""Exact values under a condition: rewards of random chains, compared with the forward iteration of their distribution,
and probabilities, compared with Storm."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest
import stormpy
from smc_models import Json, automaton, document, edge, op, variable, way

from roaml import api
from roaml.experiments.grid import ExperimentOptions
from roaml.experiments.points import PointKind, Schedulers
from roaml.verification.results import Computed

SIZE = 6
GOAL, TRAP = SIZE - 2, SIZE - 1


def random_rows(seed: int) -> list[list[tuple[float, int, int]]]:
    """For each state but the last two, its destinations: probability, state, increase of the counter."""
    chance = random.Random(seed)
    rows = []
    for _ in range(SIZE - 2):
        targets = chance.sample(range(SIZE), 3)
        parts = [chance.randint(1, 6) for _ in targets]
        rows.append([(part / sum(parts), to, chance.randint(0, 1)) for part, to in zip(parts, targets, strict=True)])
    rows[0] = [(0.5, 1, 1), *((chance / 2, to, earned) for chance, to, earned in rows[0])]
    rows[-1][0] = (rows[-1][0][0], GOAL, 1)
    return rows


def model(rows: list[list[tuple[float, int, int]]]) -> Json:
    edges = [
        edge("at", *(way("at", chance, s=to, earned=earned) for chance, to, earned in row), guard=op("=", "s", state))
        for state, row in enumerate(rows)
    ]
    edges += [edge("at", way("at", earned=0), guard=op("≥", "s", GOAL))]
    walker = automaton("walker", "at", edges)
    declared = [variable("s"), variable("earned", transient=True)]
    return document(walker, variables=declared, type_="dtmc", properties={})


def forward(rows: list[list[tuple[float, int, int]]], reward: str) -> tuple[float, float]:
    """The probability to reach GOAL, and the expected sum on the way there among the traces that do."""
    shares, sums = [1.0] + [0.0] * (SIZE - 1), [0.0] * SIZE
    for _ in range(5000):
        next_shares, next_sums = [0.0] * SIZE, [0.0] * SIZE
        for state in range(SIZE):
            moves = [(1.0, state, 0)] if state >= GOAL else rows[state]
            for chance, to, earned in moves:
                gained = 0.0 if state >= GOAL else 1.0 if reward == '"steps"' else float(earned)
                next_shares[to] += shares[state] * chance
                next_sums[to] += chance * (sums[state] + gained * shares[state])
        shares, sums = next_shares, next_sums
    return shares[GOAL], sums[GOAL] / shares[GOAL]


def point(path: Path, text: str) -> float:
    (only,) = api.experiment(str(path), [], [text]).points
    (other,) = api.experiment(str(path), [], [text], ExperimentOptions(is_exhaustive=True)).points
    assert other.value == pytest.approx(only.value)
    assert only.kind is PointKind.EXACT
    assert only.schedulers is Schedulers.ALL
    assert only.high - only.low < 1e-5 * max(1.0, only.value)
    return only.value


@pytest.mark.parametrize("seed", range(12))
def test_random_chains(seed: int, tmp_path: Path) -> None:
    rows = random_rows(seed)
    path = tmp_path / "model.jani"
    path.write_text(json.dumps(model(rows)), encoding="utf-8")
    share, steps = forward(rows, '"steps"')
    goal = f"(s={GOAL})"
    assert point(path, f"P=? [ F {goal} ]") == pytest.approx(share, abs=1e-6)
    assert point(path, f'R{{"steps"}}=? [ F {goal} || F {goal} ]') == pytest.approx(steps, abs=1e-6)
    assert point(path, f"P=? [ F {goal} || F (s=1) ]") == pytest.approx(storm(path, f"F {goal} || F s=1"), abs=1e-6)
    quotients = {
        f"F<=3 {goal} || F {goal}": (f"F<=3 {goal}", f"F {goal}"),
        f"F {goal} || G (s!=2)": (f"s!=2 U {goal}", "G s!=2"),
    }
    for text, (joint, condition) in quotients.items():
        expected = storm(path, joint) / storm(path, condition)
        assert point(path, f"P=? [ {text} ]") == pytest.approx(expected, abs=1e-6), text


def storm(path: Path, formula: str) -> float:
    """The probability of a formula in Storm, which parses it itself, also conditions."""
    parsed, _ = stormpy.parse_jani_model(str(path))
    asked = stormpy.parse_properties(f"P=? [ {formula} ]", parsed)
    built = stormpy.build_model(parsed, asked)
    checked = stormpy.model_checking(built, asked[0], only_initial_states=True)
    return float(checked.get_value(built.initial_states[0]))


def test_choices(tmp_path: Path) -> None:
    """With choices that matter, only the value under uniform choices is known: of two ways that need one and three
    steps, and arrive with the probabilities 0.5 and 0.9."""
    edges = [
        edge("begin", way("good", 0.5, done=1), way("bad", 0.5)),
        edge("begin", "far"),
        edge("far", "near"),
        edge("near", way("good", 0.9, done=1), way("bad", 0.1)),
    ]
    path = tmp_path / "model.jani"
    robot = automaton("robot", "begin far near good bad", edges)
    path.write_text(json.dumps(document(robot, variables=[variable("done")])), encoding="utf-8")
    text = 'R{"steps"}=? [ F done=1 || F done=1 ]'
    (uniform,) = api.experiment(str(path), [], [text], ExperimentOptions(only_uniform=True)).points
    assert (uniform.kind, uniform.schedulers) == (PointKind.EXACT, Schedulers.UNIFORM)
    assert uniform.value == pytest.approx((0.25 * 1 + 0.45 * 3) / 0.7)
    assert (uniform.minimum, uniform.maximum) == (None, None)
    (estimate,) = api.verify(api.target(str(path)), [text], exact_if_small=True)
    assert not isinstance(estimate.outcome, Computed)
    (undecided,) = api.experiment(str(path), [], [text], ExperimentOptions(is_exhaustive=True)).points
    assert "only if all schedulers have the same" in undecided.note
    short = "P=? [ F<=1 done=1 || F done=1 ]"
    (share,) = api.experiment(str(path), [], [short], ExperimentOptions(only_uniform=True)).points
    assert share.value == pytest.approx(0.25 / 0.7)


def test_the_condition_is_certain(tmp_path: Path) -> None:
    """Then the value is that of all traces, with a minimum and a maximum."""
    edges = [edge("begin", way("good", 0.25, done=1), way("begin", 0.75)), edge("begin", way("good", done=1))]
    path = tmp_path / "model.jani"
    robot = automaton("robot", "begin good", edges)
    path.write_text(json.dumps(document(robot, variables=[variable("done")])), encoding="utf-8")
    (least,) = api.experiment(str(path), [], ['R{"steps"}min=? [ F done=1 || F done=1 ]'], ExperimentOptions()).points
    (uniform,) = api.experiment(
        str(path), [], ['R{"steps"}=? [ F done=1 || F done=1 ]'], ExperimentOptions(only_uniform=True)
    ).points
    assert least.has_value
    assert uniform.value == pytest.approx(1 / 0.625)

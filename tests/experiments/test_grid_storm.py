# SPDX-License-Identifier: Apache-2.0
"""Exact points of grids, compared with Storm at each point: probabilities with and without bounds and conditions, and
rewards until a state, up to a step, and conditional on reaching a state."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import pytest
import stormpy
from smc_models import Json, automaton, document, edge, op, variable, way

from roaml import api
from roaml.experiments.points import PointKind

P, Q = (0.1, 0.45, 0.9), (0.2, 0.7)
WAY, GOAL, TRAP = 1, 2, 3
VARIABLES = [variable("s"), variable("earned", transient=True)]


def robot(p: object, q: object) -> Json:
    """A walk from 0 over 1 to a goal or a trap, with a counter of attempts."""
    rest = op("-", 1, q)
    edges = [
        edge("at", way("at", p, s=WAY, earned=1), way("at", op("-", 1, p), s=0, earned=2), guard=op("=", "s", 0)),
        edge(
            "at",
            way("at", q, s=GOAL, earned=1),
            way("at", op("*", rest, 0.75), s=0, earned=0),
            way("at", op("*", rest, 0.25), s=TRAP, earned=0),
            guard=op("=", "s", WAY),
        ),
        edge("at", way("at", earned=0), guard=op("≥", "s", GOAL)),
    ]
    return document(automaton("walker", "at", edges), variables=VARIABLES, type_="dtmc", properties={})


def write_parametric(folder: Path) -> Path:
    path = folder / "model.jani"
    constants = [{"name": name, "type": "real"} for name in "pq"]
    path.write_text(json.dumps({**robot("p", "q"), "constants": constants}), encoding="utf-8")
    return path


FORMS = {
    "P=? [ F (s=2) ]": "P=? [F s=2]",
    "P=? [ F<=5 (s=2) ]": "P=? [F<=5 s=2]",
    "P=? [ (s!=0) U<=3 (s=2) ]": "P=? [s!=0 U<=3 s=2]",
    "P=? [ F (s=2) || F (s=1) ]": "P=? [F s=2 || F s=1]",
    'R{"earned"}=? [ F (s>=2) ]': 'R{"earned"}=? [F s>=2]',
    'R{"earned"}=? [ C<=6 ]': 'R{"earned"}=? [C<=6]',
}
"""A property -> the same one for Storm."""


@pytest.mark.parametrize("text", FORMS)
def test_all_points_are_those_of_storm(text: str, tmp_path: Path) -> None:
    path = write_parametric(tmp_path)
    result = api.experiment(str(path), {"p": P, "q": Q}, [text])
    assert [point.kind for point in result.points] == [PointKind.EXACT] * len(P) * len(Q)
    for point, (p, q) in zip(result.points, itertools.product(P, Q), strict=True):
        assert point.value == pytest.approx(storm(robot(p, q), FORMS[text]), abs=1e-6, rel=1e-6), point.setting


def test_conditional_rewards_are_those_of_the_conditional_chain(tmp_path: Path) -> None:
    """Storm gets the chain of the traces that reach the goal: each probability is multiplied by that of reaching the
    goal afterwards, and divided by that of reaching it before, which is h in the states 0 and 1."""
    path = write_parametric(tmp_path)
    result = api.experiment(str(path), {"p": P, "q": Q}, ['R{"steps"}=? [ F (s=2) || F (s=2) ]', "P=? [ F (s=2) ]"])
    rewards, shares = result.points[::2], result.points[1::2]
    assert {point.kind for point in result.points} == {PointKind.EXACT}
    for reward, share, (p, q) in zip(rewards, shares, itertools.product(P, Q), strict=True):
        h = q / (1 - 0.75 * (1 - q))  # from 1, the goal is reached at once, or 0 is, from which 1 is always reached
        assert share.value == pytest.approx(h, abs=1e-9)
        edges = [
            edge("at", way("at", p, s=WAY, earned=1), way("at", 1 - p, s=0, earned=1), guard=op("=", "s", 0)),
            edge(
                "at", way("at", q / h, s=GOAL, earned=1), way("at", 1 - q / h, s=0, earned=1), guard=op("=", "s", WAY)
            ),
            edge("at", way("at", earned=0), guard=op("=", "s", GOAL)),
        ]
        chain = document(automaton("walker", "at", edges), variables=VARIABLES, type_="dtmc", properties={})
        assert reward.value == pytest.approx(storm(chain, 'R{"earned"}=? [F s=2]'), rel=1e-6), reward.setting


def storm(written: Json, formula: str) -> float:
    parsed, _ = stormpy.parse_jani_model_from_string(json.dumps(written))
    asked = stormpy.parse_properties(formula, parsed)
    built = stormpy.build_model(parsed, asked)
    checked = stormpy.model_checking(built, asked[0], only_initial_states=True)
    return float(checked.get_value(built.initial_states[0]))

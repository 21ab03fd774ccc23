# SPDX-License-Identifier: Apache-2.0
"""Initial values that no variable can have are errors in the model, not in the tool."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from command import Command

HUGE = 2**63
FIRST = {"op": "aa", "exp": "x", "index": 0}
INTS = {"kind": "array", "base": "int"}
REALS = {"kind": "array", "base": "real"}
EMPTY = {"kind": "bounded", "base": "int", "lower-bound": 5, "upper-bound": 2}


def elements(*values: Any) -> dict[str, Any]:
    return {"op": "av", "elements": list(values)}


def model(variable: dict[str, Any], read: Any, restricted: Any = None) -> dict[str, Any]:
    reaches = {"op": "F", "exp": {"op": "=", "left": read, "right": 1}}
    values = {"op": "filter", "fun": "values", "values": {"op": "Pmin", "exp": reaches}, "states": {"op": "initial"}}
    return {
        "jani-version": 1,
        "name": "m",
        "type": "mdp",
        "features": ["arrays", "derived-operators"],
        "variables": [{"name": "x", **variable}],
        **({} if restricted is None else {"restrict-initial": {"exp": restricted}}),
        "automata": [{"name": "A", "locations": [{"name": "l"}], "initial-locations": ["l"], "edges": []}],
        "system": {"elements": [{"automaton": "A"}]},
        "properties": [{"name": "p", "expression": values}],
    }


def equals(value: Any) -> dict[str, Any]:
    return {"op": "=", "left": "x", "right": value}


@pytest.mark.parametrize(
    ("written", "message"),
    [
        (model({"type": EMPTY}, "x"), "the lower bound is greater than the upper bound"),
        (model({"type": EMPTY}, "x", equals(3)), "there is no initial state"),
        (model({"type": EMPTY, "initial-value": 5}, "x"), "outside of its bounds"),
        (model({"type": INTS, "initial-value": elements(HUGE, 1)}, FIRST), "64 bits"),
        (model({"type": INTS, "initial-value": elements(1, -HUGE - 1)}, FIRST), "64 bits"),
        (
            model({"type": INTS, "initial-value": {"op": "ac", "var": "i", "length": 2, "exp": HUGE}}, FIRST),
            "64 bits",
        ),
        (
            model({"type": {"kind": "array", "base": INTS}, "initial-value": elements(elements(HUGE))}, FIRST),
            "the two values must have the same type",
        ),
        (model({"type": REALS, "initial-value": elements(10**400)}, FIRST), "64 bits"),
        (model({"type": "int", "initial-value": HUGE}, "x"), "64 bits"),
        (model({"type": "real", "initial-value": 10**400}, "x"), "64 bits"),
        (model({"type": "int"}, "x", equals(HUGE)), "64 bits"),
        (model({"type": "real"}, "x", equals(10**400)), "64 bits"),
        (model({"type": "int"}, "x", equals({"op": "pow", "left": 10, "right": 30})), "64 bits"),
        (model({"type": "int"}, "x", equals({"op": "pow", "left": 10.0, "right": 30})), ""),
    ],
)
def test_impossible_initial_values(command: Command, tmp_path: Path, written: dict[str, Any], message: str) -> None:
    (tmp_path / "m.jani").write_text(json.dumps(written))
    for call in (["verify"], ["verify", "--method=fixed", "--max-traces=5"], ["verify", "--exhaustive"], ["simulate"]):
        done = command(*call, "m.jani")
        assert done.status == 1, done.err
        assert "Traceback" not in done.err
        assert message in done.err

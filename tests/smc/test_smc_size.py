# SPDX-License-Identifier: Apache-2.0
"""Models with a small text and an enormous translation are rejected before they are expanded."""

from __future__ import annotations

import itertools
import json
from typing import Any

import pytest

from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker


def model(assigned: Any, initial: Any = 0, type_: Any = "int", functions: tuple[Any, ...] = ()) -> ModelChecker:
    variables = [
        {"name": "v", "type": "int", "initial-value": 0},
        {"name": "a", "type": type_, "initial-value": initial},
    ]
    destination = {"location": "l", "assignments": [{"ref": "v", "value": assigned}]}
    automaton = {
        "name": "A",
        "locations": [{"name": "l"}],
        "initial-locations": ["l"],
        "edges": [{"location": "l", "destinations": [destination]}],
    }
    value = {
        "jani-version": 1,
        "name": "model",
        "type": "mdp",
        "features": ["functions", "arrays"],
        "functions": functions,
        "variables": variables,
        "automata": [automaton],
        "system": {"elements": [{"automaton": "A"}]},
    }
    actual_model, findings = read_model(parse(json.dumps(value))[0])
    assert actual_model is not None
    assert findings == ()
    return ModelChecker(actual_model)


def function(name: str, body: Any) -> Any:
    return {"name": name, "type": "int", "parameters": [{"name": "x", "type": "int"}], "body": body}


def call(name: str) -> Any:
    return {"op": "call", "function": name, "args": ["v" if name == "f" else "x"]}


def doubling(count: int) -> tuple[Any, ...]:
    """Functions that each call the next one twice. The outermost is `f`."""
    names = ["f", *(f"f{number}" for number in range(1, count))]
    inner = itertools.pairwise(names)
    twice = [function(name, {"op": "+", "left": call(other), "right": call(other)}) for name, other in inner]
    return (*twice, function(names[-1], "x"))


def test_functions_that_double() -> None:
    model(call("f"), functions=doubling(8))
    with pytest.raises(FaultError, match=r"`f\d+` expands to [\d,]+ operations with all calls in it") as error:
        model(call("f"), functions=doubling(40))
    assert error.value.origin is not None


def test_many_calls_of_one_function() -> None:
    once = {"op": "call", "function": "f", "args": ["v"]}
    many: Any = once
    for _ in range(400):
        many = {"op": "+", "left": many, "right": once}
    with pytest.raises(FaultError, match="calls of functions expand to"):
        model(many, functions=doubling(10))


def test_functions_that_call_themselves() -> None:
    with pytest.raises(FaultError, match="calls itself"):
        model(call("f"), functions=(function("f", call("g")), function("g", {**call("f"), "args": ["x"]})))


def test_arrays_by_rule() -> None:
    def array(*lengths: int) -> Any:
        value: Any = 0
        for number, length in enumerate(reversed(lengths)):
            value = {"op": "ac", "var": f"i{number}", "length": length, "exp": value}
        return value

    of = {"kind": "array", "base": "int"}
    model(1, array(100, 100), {"kind": "array", "base": of})
    with pytest.raises(FaultError, match="an array cannot have 1,000,000,000 elements"):
        model(1, array(1000, 1000, 1000), {"kind": "array", "base": {"kind": "array", "base": of}})

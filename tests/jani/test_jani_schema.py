# SPDX-License-Identifier: Apache-2.0
"""The JSON Schema of property files agrees with the reader."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from jani_strategies import FORMULAS
from jsonschema import Draft202012Validator

from roaml.jani.operators import BINARY_OPERATORS, DISTRIBUTIONS, NUMBER_CONSTANTS, UNARY_OPERATORS
from roaml.jani.properties import Formula, Property
from roaml.jani.reader import read_properties
from roaml.jani.writer import write_properties
from roaml.json_syntax import parse

SCHEMA = json.loads((Path(__file__).parents[2] / "schemas" / "jani-properties.schema.json").read_text(encoding="utf-8"))
VALIDATOR = Draft202012Validator(SCHEMA)
FILTER = {
    "op": "filter",
    "fun": "values",
    "values": {"op": "Pmin", "exp": {"op": "F", "exp": "seen.valid"}},
    "states": {"op": "initial"},
}


def file_with(expression: Any) -> Any:
    return {"properties": [{"name": "p", "expression": expression}]}


def test_the_schema_is_sound_and_documented() -> None:
    Draft202012Validator.check_schema(SCHEMA)
    for name, definition in SCHEMA["$defs"].items():
        assert {"title", "description"} <= definition.keys(), name


def test_operators_are_those_of_the_table() -> None:
    definitions = SCHEMA["$defs"]
    assert definitions["unaryOperator"]["enum"] == list(UNARY_OPERATORS)
    assert definitions["binaryOperator"]["enum"] == list(BINARY_OPERATORS)
    assert definitions["distribution"]["properties"]["distribution"]["enum"] == list(DISTRIBUTIONS)
    assert definitions["namedNumber"]["properties"]["constant"]["enum"] == list(NUMBER_CONSTANTS)


BAD = [
    [],
    {},
    {"properties": {}},
    {"properties": [1]},
    {"properties": [{"name": "p"}]},
    {"properties": [{"expression": True}]},
    {"properties": [{"name": "", "expression": True}]},
    {"properties": [{"name": "p", "expression": True, "coment": "x"}]},
    file_with(None),
    file_with([]),
    file_with(""),
    file_with({}),
    file_with({"op": "Pmn", "exp": True}),
    file_with({"op": "Pmin"}),
    file_with({"op": 1}),
    file_with({**FILTER, "fun": "value"}),
    file_with({**FILTER, "stats": True}),
    file_with({key: FILTER[key] for key in ("op", "fun", "values")}),
    file_with({"op": "∧", "left": True}),
    file_with({"op": "∧", "left": True, "right": None}),
    file_with({"op": "¬", "left": True}),
    file_with({"op": "ite", "if": True, "then": 1}),
    file_with({"op": "F", "exp": True, "step-bounds": 3}),
    file_with({"op": "F", "exp": True, "step-bounds": {"uper": 3}}),
    file_with({"op": "F", "exp": True, "step-bounds": {"upper": {"op": "F", "exp": True}}}),
    file_with({"op": "F", "exp": True, "time-bounds": {"upper-exclusive": 1}}),
    file_with({"op": "F", "exp": True, "reward-bounds": [{"exp": 1}]}),
    file_with({"op": "Emin", "exp": 1, "accumulate": ["step"]}),
    file_with({"op": "av", "elements": 1}),
    file_with({"op": "av", "elements": [{"op": "Pmin", "exp": True}]}),
    file_with({"op": "aa", "exp": "a"}),
    file_with({"op": "ac", "var": 1, "length": 2, "exp": 3}),
    file_with({"op": "dv", "type": "P", "values": [{"member": "x"}]}),
    file_with({"op": "call", "function": "f"}),
    file_with({"constant": "pi"}),
    file_with({"distribution": "Uniforn", "args": []}),
    file_with({"comment": 3, "op": "initial"}),
]


def reader_complains(document: Any) -> bool:
    return bool(read_properties(parse(json.dumps(document))[0])[1])


@pytest.mark.parametrize("document", BAD, ids=json.dumps)
def test_bad_files(document: Any) -> None:
    assert not VALIDATOR.is_valid(document)
    assert reader_complains(document)


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every container in `value`, with each key or index in it."""
    stack = [value]
    while stack:
        container = stack.pop()
        keys = list(container) if isinstance(container, dict) else range(len(container))
        for key in keys:
            yield container, key
            if isinstance(container[key], (dict, list)):
                stack.append(container[key])


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(FORMULAS, st.data())
def test_schema_and_reader_agree(formula: Formula, data: st.DataObject) -> None:
    """On a random file, and on the same file with one part removed, renamed or replaced."""
    document = {"properties": json.loads(write_properties([Property("p", formula)]))}
    damaged = copy.deepcopy(document)
    container, key = data.draw(st.sampled_from(list(places(damaged))))
    match data.draw(st.sampled_from(["remove", "rename", "replace"])):
        case "remove":
            del container[key]
        case "rename" if isinstance(container, dict):
            container["unheard-of"] = container.pop(key)
        case _:
            container[key] = data.draw(st.sampled_from([None, 1, True, "", "op", [], {}, [1], {"op": "initial"}]))
    for file in (document, damaged):
        if '"distribution"' not in json.dumps(file):  # the number of arguments is beyond the schema
            assert VALIDATOR.is_valid(file) is not reader_complains(file)

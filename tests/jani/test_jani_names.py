# SPDX-License-Identifier: Apache-2.0
"""Unknown names, and the names of types in messages."""

from __future__ import annotations

import json

import pytest

from roaml.jani.reader import read_model
from roaml.jani.types import (
    BOOL,
    INT,
    REAL,
    UNKNOWN,
    ArrayType,
    BasicType,
    BoundedType,
    DatatypeType,
    OptionType,
    Type,
    describe,
    fits,
    join,
)
from roaml.json_syntax import parse


def test_many_unknown_names() -> None:
    """Suggestions must not compare each unknown name with all names. If they do, this test takes very long."""
    count = 2000
    places = [{"name": f"location_number_{i}"} for i in range(count)]
    edges = [{"location": f"locaton_number_{i}", "destinations": []} for i in range(count)]
    automaton = {"name": "a", "locations": places, "initial-locations": [], "edges": edges}
    model = {"jani-version": 1, "type": "lts", "automata": [automaton], "system": {"elements": []}}
    value, _ = parse(json.dumps(model))
    _, findings = read_model(value)
    assert len(findings) == count
    assert findings[0].fixes[0].edits[0].new_text == "location_number_0"


DEEP: Type = INT
for _ in range(5000):
    DEEP = ArrayType(DEEP)


@pytest.mark.parametrize(
    ("type_", "target", "expected"),
    [
        (INT, REAL, True),
        (REAL, INT, False),
        (BoundedType(INT), BasicType.CLOCK, True),
        (BOOL, INT, False),
        (ArrayType(INT), ArrayType(REAL), True),
        (ArrayType(UNKNOWN), ArrayType(BOOL), True),
        (OptionType(REAL), OptionType(INT), False),
        (DatatypeType("P"), DatatypeType("Q"), False),
        (ArrayType(INT), INT, False),
        (UNKNOWN, DatatypeType("P"), True),
        (DEEP, DEEP, True),
    ],
)
def test_fits(type_: Type, target: Type, expected: bool) -> None:
    assert fits(type_, target) is expected


@pytest.mark.parametrize(
    ("left", "right", "expected"),
    [
        (INT, REAL, REAL),
        (BoundedType(INT), INT, INT),
        (BOOL, INT, None),
        (ArrayType(REAL), ArrayType(INT), ArrayType(REAL)),
        (UNKNOWN, INT, UNKNOWN),
    ],
)
def test_join(left: Type, right: Type, expected: Type | None) -> None:
    assert join(left, right) == expected
    assert join(right, left) == expected


@pytest.mark.parametrize(
    ("type_", "words"),
    [
        (INT, "an int"),
        (BasicType.CLOCK, "a clock"),
        (BoundedType(REAL), "a real"),
        (ArrayType(ArrayType(BOOL)), "an array of array of bool"),
        (OptionType(DatatypeType("P")), "an option of `P`"),
        (DatatypeType("P"), "a `P`"),
    ],
)
def test_types_in_words(type_: Type, words: str) -> None:
    assert describe(type_) == words

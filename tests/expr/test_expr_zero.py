# SPDX-License-Identifier: Apache-2.0
"""The neutral value of each type is a value of this type, and is written in its form."""

from __future__ import annotations

import pytest

from roaml.expr.parse import parse
from roaml.expr.types import BASE_TYPES, EMPTY_ARRAY, INT, UNKNOWN, Array, Struct, Type
from roaml.expr.zero import zero, zero_text
from roaml.model.initial import check_initial
from roaml.text import Decoded

INNER = Struct("Inner", (("on", BASE_TYPES["bool"]), ("many", Array(INT, 3))))
OUTER = Struct("Outer", (("inner", INNER), ("text", BASE_TYPES["string"]), ("speed", BASE_TYPES["float32"])))
TYPES: dict[str, Type] = {
    **BASE_TYPES,
    "array": Array(INNER),
    "empty array": EMPTY_ARRAY,
    "struct": OUTER,
    "unknown": UNKNOWN,
}


@pytest.mark.parametrize("type_", TYPES.values(), ids=list(TYPES))
def test_is_of_its_type(type_: Type) -> None:
    assert check_initial(zero(type_), type_) == ()
    written, problems = parse(Decoded(zero_text(type_), 0))
    assert problems == ()
    assert check_initial(written, type_) == ()


def test_is_written_in_one_way() -> None:
    assert zero_text(OUTER) == "{'inner': {'on': false, 'many': []}, 'text': '', 'speed': 0.0}"
    assert zero_text(UNKNOWN) == "0"

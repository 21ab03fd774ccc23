# SPDX-License-Identifier: Apache-2.0
"""The places of parts of formulas in the text of a property file in JANI."""

from __future__ import annotations

from roaml.json_syntax import JsonArray, JsonObject, JsonString, JsonValue
from roaml.text import Span


def operator_at(value: JsonValue, place: Span) -> JsonString | None:
    """The operator of the formula at `place` in a file."""
    stack = [value]
    while stack:
        inner = stack.pop()
        if isinstance(inner, JsonObject):
            operator = inner.get("op")
            if inner.span == place and isinstance(operator, JsonString):
                return operator
            stack += [member.value for member in inner.members if member.value is not None]
        elif isinstance(inner, JsonArray):
            stack += inner.items
    return None

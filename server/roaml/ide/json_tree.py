# SPDX-License-Identifier: Apache-2.0
"""Iteration over a JSON tree of any depth."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.json_syntax import JsonArray, JsonObject, JsonString, JsonValue, Member
from roaml.text import Span


def values(value: JsonValue) -> Iterator[JsonValue]:
    """`value` and all values inside it, in the order of the text."""
    stack = [value]
    while stack:
        inner = stack.pop()
        yield inner
        if isinstance(inner, JsonObject):
            stack += [member.value for member in reversed(inner.members) if member.value is not None]
        elif isinstance(inner, JsonArray):
            stack += reversed(inner.items)


def members(value: JsonValue) -> dict[str, JsonValue]:
    """The members of an object by their keys, without those that have no value; empty for other values."""
    written = value.members if isinstance(value, JsonObject) else ()
    return {member.key: member.value for member in written if member.value is not None}


def spans_at(value: JsonValue, offset: int) -> list[Span]:
    """The spans of the values, members, keys and contents of strings that contain an offset, outermost first."""
    spans: list[Span] = []
    inner: JsonValue | Member | None = value
    while inner is not None and inner.span.contains(offset):
        spans.append(inner.span)
        parts: tuple[JsonValue | Member, ...] = ()
        if isinstance(inner, JsonObject):
            parts = inner.members
        elif isinstance(inner, JsonArray):
            parts = inner.items
        elif isinstance(inner, JsonString):
            spans += [inner.content_span] if inner.content_span.contains(offset) else []
        elif isinstance(inner, Member):
            if inner.key_span.contains(offset):
                spans += [span for span in (inner.key_span, inner.key_content_span) if span.contains(offset)]
            elif inner.value is not None:
                parts = (inner.value,)
        inner = next((part for part in parts if part.span.contains(offset)), None)
    return spans

# SPDX-License-Identifier: Apache-2.0
"""The state of the parser: the brackets that are open, and the name whose value follows; and what follows from their
maximum number."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from roaml.json_syntax.values import JsonValue, Member
from roaml.record import Record

MAX_DEPTH = 1000
"""The maximum depth of nested brackets; a text with deeper brackets is not read further."""
RECURSION_LIMIT = 8_000
"""Python's recursion limit for functions that follow the nesting of a text, a few of them for each bracket."""


@contextmanager
def deep_recursion() -> Iterator[None]:
    """Raise Python's recursion limit to `RECURSION_LIMIT`."""
    depth = sys.getrecursionlimit()
    sys.setrecursionlimit(max(depth, RECURSION_LIMIT))
    try:
        yield
    finally:
        sys.setrecursionlimit(depth)


class PendingName(Record, frozen=True):
    """The name of a member whose value has not been read yet. `quotes` are the lengths of the opening and closing
    quote. `colon` is false until the colon after the name has been read."""

    text: str
    start: int
    end: int
    quotes: tuple[int, int] = (1, 1)
    colon: bool = True

    def member(self, value: JsonValue | None) -> Member:
        return Member(self.text, self.start, self.end, value, self.quotes)


class Bracket(Record, frozen=True):
    """An open bracket that is not the innermost one, with the state of the parser inside it."""

    start: int
    is_object: bool
    parts: list[Any]
    key: PendingName | None

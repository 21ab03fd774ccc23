# SPDX-License-Identifier: Apache-2.0
"""The JSON tree.

- Frozen; every value has the `span` of its text, including brackets and quotes. (It is stored as two offsets: one JANI
  file has hundreds of thousands of values, and a second object for each would double the time to read them.)
- A missing or unreadable value is a `JsonError` (or a `Member` without a value), so the rest of the tree stays usable;
  a finding contains the reason.
- Values may nest up to `roaml.json_syntax.brackets.MAX_DEPTH`: functions over trees must not recurse.
"""

from __future__ import annotations

from typing import TypeAlias, cast

from roaml.record import Record
from roaml.text import Span


class _Value(Record, frozen=True):
    start: int
    end: int

    @property
    def span(self) -> Span:
        return Span(self.start, self.end)


class JsonObject(_Value, frozen=True):
    """An object. `members` are in the order of the text; members with equal keys are all kept."""

    members: tuple[Member, ...]

    def get(self, key: str) -> JsonValue | None:
        """The value of the last member with `key`, which is the one that other JSON parsers use; `None` if there is
        none."""
        for member in reversed(self.members):
            if member.key == key:
                return member.value
        return None


class Nulls(_Value, frozen=True):
    """The text `null,null,...`, without white space, as one part of a list."""

    @property
    def count(self) -> int:
        return (self.end - self.start + 1) // _NULL_AND_COMMA

    @property
    def items(self) -> tuple[JsonNull, ...]:
        starts = range(self.start, self.end, _NULL_AND_COMMA)
        return tuple(JsonNull(start, start + len("null")) for start in starts)


_NULL_AND_COMMA = len("null,")


class JsonArray(_Value, frozen=True):
    """A list. `parts` are its items, except that a run of nulls is one part. Most values in a JANI file are the nulls
    of its synchronisation table, which has a column for each automaton."""

    parts: tuple[JsonValue | Nulls, ...]

    @property
    def items(self) -> tuple[JsonValue, ...]:
        """All items, with a value for each `null`. If there are runs of nulls, each call creates a new tuple."""
        if Nulls not in map(type, self.parts):
            return cast("tuple[JsonValue, ...]", self.parts)
        items: list[JsonValue] = []
        for part in self.parts:
            if isinstance(part, Nulls):
                items += part.items
            else:
                items.append(part)
        return tuple(items)

    @property
    def length(self) -> int:
        """The number of items."""
        return sum(part.count if isinstance(part, Nulls) else 1 for part in self.parts)

    @property
    def items_but_nulls(self) -> list[tuple[int, JsonValue]]:
        """The items that are not `null`, each with its index."""
        items: list[tuple[int, JsonValue]] = []
        index = 0
        for part in self.parts:
            if isinstance(part, JsonString):  # Nearly all items of synchronisation tables.
                items.append((index, part))
                index += 1
            elif isinstance(part, Nulls):
                index += part.count
            else:
                if not isinstance(part, JsonNull):
                    items.append((index, part))
                index += 1
        return items


class JsonString(_Value, frozen=True):
    """A string. `value` has its escapes resolved. `quotes` are the lengths of the opening and closing quote in the
    text, 0 if a quote is missing."""

    value: str
    quotes: tuple[int, int] = (1, 1)

    @property
    def content_span(self) -> Span:
        """The text between the quotes."""
        return Span(self.start + self.quotes[0], self.end - self.quotes[1])


class JsonNumber(_Value, frozen=True):
    """A number. `text` is the number as written; `value` is an int if `text` has neither a point nor an exponent."""

    value: int | float
    text: str


class JsonBool(_Value, frozen=True):
    value: bool


class JsonNull(_Value, frozen=True):
    pass


class JsonError(_Value, frozen=True):
    """A value that cannot be read or is missing; a finding contains the reason."""


JsonValue: TypeAlias = JsonObject | JsonArray | JsonString | JsonNumber | JsonBool | JsonNull | JsonError


class Member(Record, frozen=True):
    """One `"key": value`. The key extends from `start` to `key_end`, including quotes of the given lengths.

    `value` is `None` if the value is missing.
    """

    key: str
    start: int
    key_end: int
    value: JsonValue | None
    quotes: tuple[int, int] = (1, 1)

    @property
    def key_span(self) -> Span:
        return Span(self.start, self.key_end)

    @property
    def key_content_span(self) -> Span:
        """The text of the key between its quotes."""
        return Span(self.start + self.quotes[0], self.key_end - self.quotes[1])

    @property
    def span(self) -> Span:
        return Span(self.start, self.value.end if self.value else self.key_end)


_KINDS: dict[type, str] = {
    JsonObject: "an object",
    JsonArray: "a list",
    JsonString: "a string",
    JsonNumber: "a number",
    JsonBool: "true or false",
    JsonNull: "null",
    JsonError: "nothing readable",
}


def kind(value: JsonValue) -> str:
    """The kind of `value`, as a phrase for a message."""
    return _KINDS[type(value)]

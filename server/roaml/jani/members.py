# SPDX-License-Identifier: Apache-2.0
"""Reads the members of JSON objects that must have a certain shape, and reports everything that does not fit.

- A member is reported at most once: a member that is not valid JSON or has the wrong kind is treated as missing.
- An unknown member is an error, because it may change the meaning of the model; in an open shape, it is a warning. Only
  members that are known to be comments (`HARMLESS`) are ignored if JANI does not define them.
"""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.jani.node import Origin
from roaml.jani.notes import SYNTAX, Notes
from roaml.json_syntax import (
    JsonArray,
    JsonBool,
    JsonError,
    JsonNumber,
    JsonObject,
    JsonString,
    JsonValue,
    Member,
    kind,
)
from roaml.record import Record
from roaml.text import Span, location_of, span_of

HARMLESS = frozenset(("comment", "metadata"))
"""The names of members that never change the meaning of a model."""


class ObjectShape(Record, frozen=True):
    """The shape of an object.

    Attributes:
        phrase: the kind of the object with its article, for messages.
        required: the names of the members that it must have.
        allowed: the names of all members that it may have.
        is_open: whether other members are reported as warnings instead of errors, because they do not change the
            meaning of the model.
    """

    phrase: str
    required: frozenset[str]
    allowed: frozenset[str]
    is_open: bool = False


def shape(phrase: str, required: str, optional: str = "", is_open: bool = False) -> ObjectShape:
    """An object shape. `required` and `optional` are names of members, separated by spaces."""
    needed = frozenset(required.split())
    return ObjectShape(phrase, needed, needed | frozenset(optional.split()), is_open)


class ValueSource:
    """A file from which JSON values are read: its path and the findings in it."""

    def __init__(self, path: str, notes: Notes) -> None:
        self.path = path
        self.notes = notes

    def origin(self, value: JsonValue) -> Origin:
        return location_of((self.path, span_of((value.start, value.end))))

    def content_origin(self, text: JsonString) -> Origin:
        """The place of the text between the quotes."""
        return location_of((self.path, span_of((text.start + text.quotes[0], text.end - text.quotes[1]))))

    def members(self, value: JsonValue | None, form: ObjectShape) -> Members | None:
        """The members of `value`; `None` if it is not an object, with a finding unless it is missing or not valid
        JSON."""
        if isinstance(value, JsonObject):
            return Members(value, form, self)
        self.wrong_kind(value, form.phrase + " must be an object `{ }`")
        return None

    def wrong_kind(self, value: JsonValue | None, expected: str) -> None:
        if value is not None and not isinstance(value, JsonError):
            self.notes.syntax(value.span, f"{expected}, not {kind(value)}")


class Members:
    """The members of one object. If names are repeated, the last member is used."""

    __slots__ = ("form", "notes", "origin", "source", "values")

    values: dict[str, JsonValue]

    def __init__(self, value: JsonObject, form: ObjectShape, source: ValueSource) -> None:
        self.form = form
        self.notes = source.notes
        self.source = source
        self.origin = source.origin(value)
        self.values = values = {}
        allowed = form.allowed
        for member in value.members:
            key, content = member.key, member.value
            if key not in allowed:
                self._report_unknown(member)
            elif content is not None and not isinstance(content, JsonError):
                values[key] = content
        if not form.required <= values.keys():
            missing = form.required.difference(member.key for member in value.members)
            if missing:
                names = " and ".join(f"`{name}`" for name in sorted(missing))
                self.notes.syntax(Span(value.start, value.start + 1), f"{form.phrase} needs {names}")

    def _report_unknown(self, member: Member) -> None:
        if not member.key and member.start == member.key_end:
            return  # the parser has reported the missing name
        if member.key in HARMLESS:
            return
        place, known = member.key_content_span, sorted(self.form.allowed)
        severity = Severity.WARNING if self.form.is_open else None
        self.notes.unknown("member", member.key, place, known, code=SYNTAX, severity=severity, owner=self.form.phrase)

    def string(self, key: str) -> JsonString | None:
        """The member `key`, which must be a non-empty string; `None` if it is missing, empty or not a string."""
        value = self.values.get(key)
        if isinstance(value, JsonString):
            if value.value:
                return value
            self.notes.syntax(value.span, f"`{key}` must not be empty")
        else:
            self.source.wrong_kind(value, f"`{key}` must be a string")
        return None

    def text(self, key: str) -> str | None:
        value = self.string(key)
        return None if value is None else value.value

    def comment(self, key: str = "comment") -> str | None:
        """The member `key`, which must be a string and may be empty; `None` if it is missing or not a string."""
        if key not in self.values:
            return None
        value = self.values[key]
        if isinstance(value, JsonString):
            return value.value
        self.source.wrong_kind(value, f"`{key}` must be a string")
        return None

    def flag(self, key: str) -> bool | None:
        value = self.values.get(key)
        if isinstance(value, JsonBool):
            return value.value
        self.source.wrong_kind(value, f"`{key}` must be true or false")
        return None

    def integer(self, key: str) -> int | None:
        value = self.values.get(key)
        if isinstance(value, JsonNumber) and isinstance(value.value, int):
            return value.value
        if isinstance(value, JsonNumber):
            self.notes.syntax(value.span, f"`{key}` must be a whole number")
        else:
            self.source.wrong_kind(value, f"`{key}` must be a whole number")
        return None

    def items(self, key: str) -> tuple[JsonValue, ...]:
        """The items of the list in the member `key`; empty if it is missing or not a list."""
        array = self.array(key)
        return () if array is None else array.items

    def array(self, key: str) -> JsonArray | None:
        """The list in the member `key`; `None` if it is missing or not a list."""
        value = self.values.get(key)
        if isinstance(value, JsonArray):
            return value
        self.source.wrong_kind(value, f"`{key}` must be a list `[ ]`")
        return None

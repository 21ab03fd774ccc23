# SPDX-License-Identifier: Apache-2.0
"""Reads the frequent tokens of valid JSON inside brackets; `roaml.json_syntax.parse` reads the others.

Plain Python; Cython compiles it with the types in `frequent.pxd`. A JANI file of 12 MB has 400,000 values.
"""

from __future__ import annotations

from typing import Any

from roaml.json_syntax.brackets import MAX_DEPTH, Bracket, PendingName
from roaml.json_syntax.values import (
    JsonArray,
    JsonBool,
    JsonNull,
    JsonNumber,
    JsonObject,
    JsonString,
    JsonValue,
    Member,
    Nulls,
)

END = "\0"
"""The character after the text to read. No token of JSON contains it."""

_MAX_DIGITS = 18
"""The maximum length of the numbers that are read here. Longer ones may be too long for `int`."""

_RUNS = tuple(",null" * count for count in (512, 64, 8, 1))
"""Runs of nulls; comparing with the long ones first takes the least time for all lengths."""


def compiled() -> bool:
    """Whether this module is the compiled extension."""
    return not __file__.endswith(".py")


def read_frequent(
    text: str, at: int, stack: list[Bracket], start: int, is_object: bool, parts: list[Any], words: dict[str, str]
) -> tuple[int, int, bool, list[Any], PendingName | None]:
    """Read `text` from the offset `at` as far as it is valid and consists of frequent tokens inside brackets: strings
    without escapes, numbers without exponents, literals and brackets. A bracket is only closed inside another one, and
    an object only if its names differ.

    Args:
        text: the text to read, and `END` after it.
        stack: the brackets around the innermost one, from the outermost one, which is the text. It is changed.
        start, is_object, parts: the innermost bracket and the values or members in it. `parts` is changed.
        words: names and strings that have been read, so that equal ones are one object.

    Returns:
        The offset after what was read, the innermost bracket there (`start`, `is_object`, `parts`), and the name whose
        value follows, if the value after a name is not a frequent token.
    """
    key: PendingName | None = None
    name, name_start, name_end = "", 0, 0
    while True:
        here = past_space(text, at)
        character = text[here]
        if character in "]}":
            outer = stack[len(stack) - 1]
            if (character == "}") is not is_object or len(stack) == 1 or is_waiting(outer.key):
                break
            value = closed(start, here + 1, is_object, parts)
            if value is None:
                break
            stack.pop()
            start, is_object, parts, at = outer.start, outer.is_object, outer.parts, here + 1
            parts.append(value if outer.key is None else outer.key.member(value))
            continue
        if (character == ",") is not (len(parts) > 0):
            break
        if character == ",":
            here = past_space(text, here + 1)
        if is_object:
            name_start = here
            name_end = end_of_string(text, here)
            colon = past_space(text, name_end)
            if name_end == here or text[colon] != ":":
                break
            name = text[name_start + 1 : name_end - 1]
            name = words.setdefault(name, name)
            here = past_space(text, colon + 1)
        character = text[here]
        if character in "[{":
            if len(stack) >= MAX_DEPTH:
                break
            stack.append(
                Bracket(start, is_object, parts, PendingName(name, name_start, name_end) if is_object else None)
            )
            start, is_object, parts, at = here, character == "{", [], here + 1
            continue
        part = atom(text, here, not is_object, words)
        if part is None:
            if is_object:
                key, at = PendingName(name, name_start, name_end), here
            break
        parts.append(Member(name, name_start, name_end, part) if is_object else part)
        at = part.end
    return at, start, is_object, parts, key


def is_waiting(key: PendingName | None) -> bool:
    """Whether the colon after the name `key` is missing."""
    return key is not None and not key.colon


def closed(start: int, end: int, is_object: bool, parts: list[Any]) -> JsonValue | None:
    """The value of a bracket; `None` for an object in which names are repeated."""
    if not is_object:
        return JsonArray(start, end, tuple(parts))
    if len(parts) > 1 and len({member.key for member in parts}) < len(parts):
        return None
    return JsonObject(start, end, tuple(parts))


def atom(text: str, start: int, is_item: bool, words: dict[str, str]) -> Any:
    """The string, number or literal at `start`, or the `Nulls` if it is an item of a list; `None` if there is no
    frequent token."""
    character = text[start]
    if character == '"':
        end = end_of_string(text, start)
        if end == start or text[past_space(text, end)] == ":":
            return None
        word = text[start + 1 : end - 1]
        return JsonString(start, end, words.setdefault(word, word))
    if character == "n" and text.startswith("null", start):
        end = first = start + len("null")
        if is_item:
            for run in _RUNS:
                while text.startswith(run, end):
                    end += len(run)
        if ends_word(text[end]):
            return JsonNull(start, end) if end == first else Nulls(start, end)
    elif character == "t" and text.startswith("true", start) and ends_word(text[start + 4]):
        return JsonBool(start, start + 4, True)
    elif character == "f" and text.startswith("false", start) and ends_word(text[start + 5]):
        return JsonBool(start, start + 5, False)
    elif character in "-0123456789":
        return number(text, start)
    return None


def number(text: str, start: int) -> JsonNumber | None:
    """The number at `start`; `None` if it is not valid, has an exponent or is long."""
    first = start + (text[start] == "-")
    end = past_digits(text, first)
    if end == first or end - start > _MAX_DIGITS or (text[first] == "0" and end > first + 1):
        return None
    is_real = text[end] == "."
    if is_real:
        first = end + 1
        end = past_digits(text, first)
    if end == first or not ends_word(text[end]):
        return None
    written = text[start:end]
    return JsonNumber(start, end, float(written) if is_real else int(written), written)


def end_of_string(text: str, start: int) -> int:
    """The offset after the string at `start`; `start` if there is no string, or one that is not frequent."""
    if text[start] != '"':
        return start
    end = text.find('"', start + 1)
    if end < 0:
        return start
    content = text[start + 1 : end]
    return end + 1 if content.isprintable() and "\\" not in content else start


def past_digits(text: str, at: int) -> int:
    character = text[at]
    while "0" <= character <= "9":
        at += 1
        character = text[at]
    return at


def past_space(text: str, at: int) -> int:
    character = text[at]
    while character in " \n\r\t":
        at += 1
        character = text[at]
    return at


def ends_word(character: str) -> bool:
    """Whether `character` can follow a literal or number in valid JSON."""
    return character in ",]} \n\r\t"

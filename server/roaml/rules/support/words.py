# SPDX-License-Identifier: Apache-2.0
"""The words of names, which similar names share."""

from __future__ import annotations

import functools
from collections.abc import Iterator

from roaml.record import Record
from roaml.regex import regex

_WORD = regex(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")

LIMITS = frozenset(("max", "min", "maximum", "minimum", "limit", "threshold"))
"""A word in the name of a constant with which a variable is compared."""

NEGATIVE = frozenset(
    (
        "abort",
        "aborted",
        "aborts",
        "broken",
        "error",
        "fail",
        "failed",
        "failing",
        "fails",
        "failure",
        "fault",
        "faulty",
        "jammed",
        "never",
        "no",
        "not",
        "reject",
        "rejects",
        "stuck",
        "unavailable",
        "unreachable",
        "unsuccessful",
    )
)
"""Words in the name of a machine that fails intentionally, or succeeds if something else has failed."""

DUMMY = frozenset(("dummy", "fake", "mock", "stub", "test"))
"""Words in the name of a machine that stands for another one, and may do only a part of what that one does."""


def words_of(name: str) -> list[str]:
    """The words of a name such as `battery_level` or `BatteryLevel`, in lower case."""
    return list(_words(name))


@functools.lru_cache(maxsize=4096)  # the names of a machine are compared with each other
def _words(name: str) -> tuple[str, ...]:
    return tuple(match.group().lower() for match in _WORD.finditer(name))


def difference(name: str, other: str) -> tuple[str, str] | None:
    """The only words in which two names differ, in lower case; `None` if they differ in more."""
    words, others = words_of(name), words_of(other)
    different = [pair for pair in zip(words, others, strict=False) if pair[0] != pair[1]]
    return different[0] if len(words) == len(others) and len(different) == 1 else None


class Hole(Record, frozen=True):
    """A name without one of its words.

    Attributes:
        position: the number of words before it.
        others: the other words.
    """

    position: int
    others: tuple[str, ...]


def holes(name: str) -> Iterator[tuple[Hole, str]]:
    """The words of a name, each with what remains without it. Two names that differ in one word have one in common."""
    words = _words(name)
    for index, word in enumerate(words):
        yield Hole(index, (*words[:index], *words[index + 1 :])), word


def with_word(path: str, old: str, new: str) -> str | None:
    """A path whose last name contains the word `old` once, with `new` in its place; otherwise `None`."""
    if old not in path.lower():  # the usual case
        return None
    begin = path.rfind(".") + 1
    matches = [match for match in _WORD.finditer(path, begin) if match.group().lower() == old]
    if len(matches) != 1:
        return None
    match = matches[0]
    word = new
    if len(new) > 1 and match.group()[0].isupper():
        word = new.upper() if len(old) > 1 and match.group().isupper() else new.capitalize()
    return path[: match.start()] + word + path[match.end() :]

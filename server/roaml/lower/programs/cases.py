# SPDX-License-Identifier: Apache-2.0
"""Cases of a `Switch`: when BehaviorTree.CPP regards its variable and a case as equal (docs/spec/mocks.md#cases)."""

from __future__ import annotations

import re

from roaml.lower.programs.entries import EntryKind
from roaml.regex import regex

_INTEGER = regex(r"\s*[+-]?[0-9]+", re.ASCII)
_REAL = regex(r"\s*[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?", re.ASCII)


def number_in(text: str, *, is_whole: bool) -> int | float | None:
    """The number that the library reads from a text; `None` if there is none.

    Args:
        is_whole: whether all of the text must be the number. If not, the number is the integer with which the text
            begins; without one, the real number with which it begins.
    """
    integer = _read(_INTEGER, text, is_whole)
    return _read(_REAL, text, is_whole) if integer is None else int(integer)


def are_equal(variable: str, case: str, *, is_whole: bool) -> bool:
    """Whether two constant texts are equal: as texts, as integers, or as real numbers. `is_whole` as for
    `number_in`."""
    numbers = ((_read(pattern, variable, is_whole), _read(pattern, case, is_whole)) for pattern in (_INTEGER, _REAL))
    return variable == case or any(first is not None and first == second for first, second in numbers)


def _read(pattern: re.Pattern[str], text: str, is_whole: bool) -> float | None:
    match = pattern.fullmatch(text) if is_whole else pattern.match(text)
    return None if match is None else float(match[0])


def case_value(text: str, kinds: set[EntryKind], *, is_whole: bool) -> int | float | str:
    """The value of a constant text in a port of a `Switch`: a number if the other ports are bound only to entries of
    numbers and the text can be read as one (`number_in`), otherwise the text. `kinds` contains the kinds of these
    entries."""
    if not kinds or EntryKind.TEXT in kinds:
        return text
    number = number_in(text, is_whole=is_whole)
    return text if number is None else number

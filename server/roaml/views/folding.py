# SPDX-License-Identifier: Apache-2.0
"""Folds the turns of an explanation: consecutive repetitions of the same lines become one line that states their
number."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from roaml.record import Record

MAX_LINES = 24
"""The maximum number of lines that are recognised as one repetition."""
MIN_TIMES = 3
"""How often the same lines must occur before their repetitions are folded."""


class Repetition(Record, frozen=True):
    """The repetitions of the lines directly before.

    Attributes:
        lines: the number of lines that are repeated.
        times: the number of further repetitions.
        first, last: the indices of the first and the last folded turn.
    """

    lines: int
    times: int
    first: int
    last: int


class LeftOut(Record, frozen=True):
    """Lines in the middle that are left out. `first` and `last` are the indices of the first and the last turn."""

    first: int
    last: int


Shown: TypeAlias = "int | Repetition | LeftOut"
"""The index of a turn that is shown, or turns that are folded."""


def without_middle(lines: Sequence[Shown], begin: int, end: int) -> list[Shown]:
    """Lines of which those in the middle are left out if there are more than `begin` at the beginning and `end` at the
    end."""
    if len(lines) <= begin + end + 1:
        return list(lines)
    return [*lines[:begin], LeftOut(_first(lines[begin]), _last(lines[-end - 1])), *lines[-end:]]


def folded(keys: Sequence[str | None]) -> list[Shown]:
    """The lines that are shown of a list of turns.

    Args:
        keys: a text for each turn; turns with equal texts are the same except for numbers. `None` for a turn that is
            always shown.
    """
    lines: list[Shown] = list(range(len(keys)))
    for length in range(1, MAX_LINES + 1):  # the shortest first, so that folded lines contain no repetitions
        lines = _folded(lines, keys, length)
    return lines


def _folded(lines: list[Shown], keys: Sequence[str | None], length: int) -> list[Shown]:
    """The lines with repetitions of `length` lines folded."""
    signs = [_sign(line, keys) for line in lines]
    shown: list[Shown] = []
    at = 0
    while at < len(lines):
        times = _times(signs, at, length)
        if times < MIN_TIMES:
            shown.append(lines[at])
            at += 1
            continue
        end = at + length * times
        shown += lines[at : at + length]
        shown.append(Repetition(length, times - 1, _first(lines[at + length]), _last(lines[end - 1])))
        at = end
    return shown


def _times(signs: Sequence[object], at: int, length: int) -> int:
    """How often the `length` lines at a position occur there one after the other."""
    block = signs[at : at + length]
    if None in block:
        return 1
    times = 1
    while signs[at + times * length : at + (times + 1) * length] == block:
        times += 1
    return times


def _sign(line: Shown, keys: Sequence[str | None]) -> object:
    match line:
        case int():
            return keys[line]
        case Repetition(lines=number):
            return ("repeated", number)
        case _:
            return None


def _first(line: Shown) -> int:
    return line if isinstance(line, int) else line.first


def _last(line: Shown) -> int:
    return line if isinstance(line, int) else line.last

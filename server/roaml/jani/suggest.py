# SPDX-License-Identifier: Apache-2.0
"""The known name that was probably meant by an unknown one."""

from __future__ import annotations

from collections.abc import Iterable


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The first of the `known` names that differs from `name` in the shortest part; `None` if all differ a lot.

    The part is what remains without the common beginning and end: one character for a missing, an additional or a wrong
    letter, and two for two letters in the wrong order.
    """
    limit = min(len(name) // 3, 1 + len(name) // 5)
    best: str | None = None
    for other in known:
        if abs(len(other) - len(name)) <= limit and (stretch := _stretch(name, other)) <= limit:
            best, limit = other, stretch - 1
    return best


def _stretch(left: str, right: str) -> int:
    start = _shared(left, right)
    left, right = left[start:], right[start:]
    end = _shared(left[::-1], right[::-1])
    longest = max(len(left), len(right)) - end
    return 1 if longest == 2 and left[:2] == right[1::-1] else longest


def _shared(left: str, right: str) -> int:
    """The length of the common beginning."""
    for i, (one, other) in enumerate(zip(left, right, strict=False)):
        if one != other:
            return i
    return min(len(left), len(right))

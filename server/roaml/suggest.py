# SPDX-License-Identifier: Apache-2.0
"""Which name is meant where an unknown one is written.

Two measures of what names have in common serve two kinds of names:

- `close_names` and `are_similar` are generous, for names that people choose: any case, several mistakes.
- `nearest_name` accepts a few wrong letters only. Names that tools make have long parts in common and come by the
  thousand; it is fast enough for these.
"""

from __future__ import annotations

import difflib
import functools
from collections.abc import Iterable

MAX_LENGTH = 80
"""Only so many characters of an unknown name are compared."""
_MIN_SIMILARITY = 0.6
"""Of `difflib`, between 0 and 1."""


def did_you_mean(names: tuple[str, ...], most: int = 1) -> str:
    """`; did you mean …?` with the first names, or nothing."""
    return f"; did you mean {' or '.join(f'`{name}`' for name in names[:most])}?" if names else ""


def close_names(name: str, candidates: Iterable[str], most: int = 3) -> tuple[str, ...]:
    """Those of `candidates` that look like `name`, the nearest first."""
    return _close_names(name[:MAX_LENGTH], tuple(candidates), most)


@functools.lru_cache(maxsize=256)
def _close_names(name: str, candidates: tuple[str, ...], most: int) -> tuple[str, ...]:
    """Remembered, as one mistake is often made many times."""
    by_lower = {candidate.lower(): candidate for candidate in candidates}
    matches = difflib.get_close_matches(name.lower(), list(by_lower), most, _MIN_SIMILARITY)
    return tuple(by_lower[match] for match in matches)


def are_similar(name: str, other: str) -> bool:
    """Whether `other` may be meant where `name` is written."""
    return len(other) <= 2 * MAX_LENGTH and bool(close_names(name, (other,)))


def nearest_name(name: str, known: Iterable[str]) -> str | None:
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

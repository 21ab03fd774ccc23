# SPDX-License-Identifier: Apache-2.0
"""Which name is meant where an unknown one is written.

Two measures of what names have in common serve two kinds of names:

- `close_names` and `are_similar` are generous, for names that people choose: any case, several mistakes.
- `nearest_name` accepts a few wrong letters only. Names that tools make have long parts in common and come by the
  thousand; it is fast enough for these.
"""

from __future__ import annotations

import bisect
import difflib
import functools
import itertools
from collections.abc import Iterable, Iterator, Sequence

MAX_LENGTH = 80
"""Only so many characters of an unknown name are compared."""
_MIN_SIMILARITY = 0.6
"""Of `difflib`, between 0 and 1."""
MAX_COMPARED = 40
"""Candidates that are compared with a name letter by letter. Of more than these, the likely ones are chosen first."""
_NEIGHBOURS = 5
"""On each side of a name in an order of candidates."""


def did_you_mean(names: tuple[str, ...], most: int = 1) -> str:
    """`; did you mean …?` with the first names, or nothing."""
    return f"; did you mean {' or '.join(f'`{name}`' for name in names[:most])}?" if names else ""


def close_names(name: str, candidates: Iterable[str], most: int = 3) -> tuple[str, ...]:
    """Those of `candidates` that look like `name`, the nearest first.

    Takes time for `MAX_COMPARED` comparisons at most, so that very many mistakes among very many names take linear
    time. Of more candidates, those are compared that differ in one letter, or that begin or end like `name`.
    """
    return _close_names(name[:MAX_LENGTH], tuple(candidates), most)


@functools.lru_cache(maxsize=256)
def _close_names(name: str, candidates: tuple[str, ...], most: int) -> tuple[str, ...]:
    """Remembered, as one mistake is often made many times."""
    lower = name.lower()
    if len(candidates) <= MAX_COMPARED:
        by_lower = {candidate.lower(): candidate for candidate in candidates}
        likely: Iterable[str] = by_lower
    else:
        index = _index(candidates)
        by_lower, likely = index.by_lower, index.likely(lower)
    matches = difflib.get_close_matches(lower, likely, most, _MIN_SIMILARITY)
    return tuple(by_lower[match] for match in matches)


class _Index:
    """Many names, arranged such that those like a given one are found without looking at all.

    Attributes:
        by_lower: name in lower case -> name, without those that are too long to be like any `MAX_LENGTH` letters.
    """

    def __init__(self, names: Iterable[str]) -> None:
        longest = MAX_LENGTH * (2 / _MIN_SIMILARITY - 1)
        self.by_lower = {name.lower(): name for name in names if len(name) <= longest}
        self._forward = sorted(self.by_lower)
        self._backward = sorted(name[::-1] for name in self.by_lower)
        self._shortened: dict[str, list[str]] = {}
        for name in self.by_lower:
            for shorter in _shortened(name[:MAX_LENGTH]):
                same = self._shortened.setdefault(shorter, [])
                if len(same) < _NEIGHBOURS:
                    same.append(name)

    def likely(self, name: str) -> list[str]:
        """At most `MAX_COMPARED` names, those that are one letter away first."""
        one_letter_away = (match for shorter in _shortened(name) for match in self._shortened.get(shorter, ()))
        matches = dict.fromkeys(itertools.islice(one_letter_away, MAX_COMPARED))
        matches |= dict.fromkeys(_around(name, self._forward))
        matches |= dict.fromkeys(match[::-1] for match in _around(name[::-1], self._backward))
        return list(matches)[:MAX_COMPARED]


@functools.lru_cache(maxsize=8)
def _index(names: tuple[str, ...]) -> _Index:
    return _Index(names)


def _shortened(name: str) -> Iterator[str]:
    """The name itself, and without one letter. Two names share one of these if one letter was added, left out or
    changed, or two neighbours were exchanged."""
    yield name
    for position in range(len(name)):
        yield name[:position] + name[position + 1 :]


def _around(name: str, names: Sequence[str]) -> Sequence[str]:
    """The neighbours of a name in an order."""
    position = bisect.bisect_left(names, name)
    return names[max(0, position - _NEIGHBOURS) : position + _NEIGHBOURS]


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

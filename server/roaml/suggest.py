# SPDX-License-Identifier: Apache-2.0
"""Suggestions for unknown names.

There are two measures of similarity, for two kinds of names:

- `close_names` and `are_similar` are for names that people choose: they ignore case and accept several differences.
- `nearest_name` is for names that tools generate: it accepts only a few wrong letters, because such names have long
  parts in common, and it is fast enough for thousands of candidates.
"""

from __future__ import annotations

import bisect
import functools
import itertools
from collections.abc import Iterable, Iterator, Sequence

MAX_LENGTH = 80
"""The maximum number of characters of an unknown name that are compared."""
_MIN_SIMILARITY = 0.6
"""The minimum similarity as computed by `difflib`, from 0 to 1."""
MAX_COMPARED = 40
"""The maximum number of candidates that `difflib` compares with a name; if there are more, the likely ones are selected
first."""
_NEIGHBOURS = 3
"""The number of neighbours on each side of a name in a sorted list of candidates."""


def did_you_mean(names: tuple[str, ...], most: int = 1) -> str:
    """`; did you mean …?` with the first `most` names; "" if there are no names."""
    return f"; did you mean {' or '.join(f'`{name}`' for name in names[:most])}?" if names else ""


MAX_LISTED = 6
"""The maximum number of known names that a message lists."""


def alternatives(close: tuple[str, ...], known: Iterable[str], noun: str, most: float = MAX_LISTED) -> str:
    """What a message about an unknown name suggests: the most similar name; or all known names, if none is similar.

    Args:
        close: the similar names, the most similar first.
        noun: a noun in the singular for what the names denote, such as `state`.
        most: the maximum number of names that are listed.

    Returns:
        A clause such as ``; the states are `a` and `b` ``; "" if there are no names, or more than `most`.
    """
    if close:
        return did_you_mean(close)
    names = tuple(dict.fromkeys(known))
    if not 0 < len(names) <= most:
        return ""
    plural = f"{noun[:-1]}ies" if noun.endswith("y") else f"{noun}s"
    return f"; the only {noun} is `{names[0]}`" if len(names) == 1 else f"; the {plural} are {listing(names)}"


def listing(names: Iterable[str]) -> str:
    """The names in backquotes, as in `a`, `b` and `c`; "none" if there are no names."""
    quoted = [f"`{name}`" for name in names]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} and {quoted[-1]}" if quoted else "none"


def close_names(name: str, candidates: Iterable[str], most: int = 3) -> tuple[str, ...]:
    """The candidates that are similar to `name`, the most similar first.

    At most `MAX_COMPARED` candidates are compared, so that the time is linear even with many unknown names and many
    candidates. If there are more, only candidates that differ in one letter, or that begin or end like `name`, are
    compared.
    """
    return _close_names(name[:MAX_LENGTH], tuple(candidates), most)


@functools.lru_cache(maxsize=256)
def _close_names(name: str, candidates: tuple[str, ...], most: int) -> tuple[str, ...]:
    """The result of `close_names`, which is cached because the same unknown name often occurs many times."""
    lower = name.lower()
    if len(candidates) <= MAX_COMPARED:
        by_lower = {candidate.lower(): candidate for candidate in candidates}
        likely: Iterable[str] = by_lower
    else:
        index = _index(candidates)
        by_lower, likely = index.by_lower, index.likely(lower)
    import difflib  # noqa: PLC0415 - only unknown names need it

    matches = difflib.get_close_matches(lower, likely, most, _MIN_SIMILARITY)
    return tuple(by_lower[match] for match in matches)


class _Index:
    """An index of many names that finds the names similar to a given name without comparing all of them.

    Attributes:
        by_lower: name in lower case -> name, without names that are too long to be similar to a name of `MAX_LENGTH`
            characters.
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
                if len(same) < 2 * _NEIGHBOURS:
                    same.append(name)

    def likely(self, name: str) -> list[str]:
        """At most `6 * _NEIGHBOURS` names that may be similar to `name`. Names that differ in one letter come first."""
        one_letter_away = (match for shorter in _shortened(name) for match in self._shortened.get(shorter, ()))
        matches = dict.fromkeys(itertools.islice(one_letter_away, 2 * _NEIGHBOURS))
        matches |= dict.fromkeys(_around(name, self._forward))
        matches |= dict.fromkeys(match[::-1] for match in _around(name[::-1], self._backward))
        return list(matches)


@functools.lru_cache(maxsize=8)
def _index(names: tuple[str, ...]) -> _Index:
    return _Index(names)


def _shortened(name: str) -> Iterator[str]:
    """The name itself, and the name without each of its letters. Two names share one of these if one letter was added,
    removed or changed, or two adjacent letters were swapped."""
    yield name
    for position in range(len(name)):
        yield name[:position] + name[position + 1 :]


def _around(name: str, names: Sequence[str]) -> Sequence[str]:
    """The neighbours of a name in a sorted list."""
    position = bisect.bisect_left(names, name)
    return names[max(0, position - _NEIGHBOURS) : position + _NEIGHBOURS]


def are_similar(name: str, other: str) -> bool:
    """Whether the names are so similar that `name` may be a misspelling of `other`."""
    return len(other) <= 2 * MAX_LENGTH and bool(close_names(name, (other,)))


def nearest_name(name: str, known: Iterable[str]) -> str | None:
    """The known name whose differing part is the shortest; `None` if all known names differ too much from `name`. If
    several are equally near, the first one is returned.

    The differing part of two names is what remains without their common beginning and end. Its length is 1 for a
    missing, additional or wrong letter, and also for two adjacent letters in the wrong order.
    """
    limit = min(len(name) // 3, 1 + len(name) // 5)
    best: str | None = None
    for other in known:
        if abs(len(other) - len(name)) <= limit and (stretch := _stretch(name, other)) <= limit:
            best, limit = other, stretch - 1
    return best


def _stretch(left: str, right: str) -> int:
    """The length of the part in which two names differ."""
    start = _shared(left, right)
    left, right = left[start:], right[start:]
    end = _shared(left[::-1], right[::-1])
    longest = max(len(left), len(right)) - end
    return 1 if longest == 2 and left[:2] == right[1::-1] else longest


def _shared(left: str, right: str) -> int:
    """The length of the common prefix."""
    for i, (one, other) in enumerate(zip(left, right, strict=False)):
        if one != other:
            return i
    return min(len(left), len(right))

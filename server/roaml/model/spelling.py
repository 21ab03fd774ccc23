# SPDX-License-Identifier: Apache-2.0
"""Which names look alike, and what is meant where a name is misspelled."""

from __future__ import annotations

import bisect
import difflib
import functools
import itertools
from collections.abc import Container, Iterable, Iterator, Sequence

from roaml.model.syntax import Name, name_of
from roaml.xml_syntax import Element

MAX_COMPARED = 40
"""Candidates that are compared with a name letter by letter. Of more than these, the likely ones are chosen first."""

MAX_LENGTH = 80
"""Letters of a name that are looked at."""

_CUTOFF = 0.6
"""The least ratio of similarity, as `difflib` defines it."""

_NEIGHBOURS = 5
"""On each side of a name in an order of candidates."""


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
    matches = difflib.get_close_matches(lower, likely, most, _CUTOFF)
    return tuple(by_lower[match] for match in matches)


class _Index:
    """Many names, arranged such that those like a given one are found without looking at all.

    Attributes:
        by_lower: name in lower case -> name, without those that are too long to be like any `MAX_LENGTH` letters.
    """

    def __init__(self, names: Iterable[str]) -> None:
        longest = MAX_LENGTH * (2 / _CUTOFF - 1)
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


def meant(element: Element, name: str, known: Container[str]) -> Name | None:
    """The value of the attribute `name`, also if the attribute is misspelled as one that the element does not have."""
    if element.get(name) is not None:
        return name_of(element.get(name))
    strange = [a for a in element.attributes if a.name not in known and close_names(a.name, [name])]
    return name_of(strange[0]) if strange else None

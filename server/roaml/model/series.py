# SPDX-License-Identifier: Apache-2.0
"""Elements that are alike except for their numbers, such as the checks of points 1 to 6, and the number in one of them
that does not match the others.

The search takes linear time in the number of elements.
"""

from __future__ import annotations

import itertools
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence

from roaml.model.syntax import Name
from roaml.record import Record
from roaml.regex import regex

_NUMBER = regex(r"\d+")
_MIN_CONSISTENT = 3
"""How many elements must have equal numbers at two places before another element is suspicious."""
_MIN_OF_COPIES = 2
"""The same, if the number is that of another element and differs from two other numbers of its own element."""
_MAX_PLACES = 16
"""How many places with numbers of an element are compared with each other."""


class KeyedText(Record, frozen=True):
    """A text of an element. `key` is what the text is: the name of a port or attribute."""

    key: str
    name: Name


class Alike(Record, frozen=True):
    """An element that may be alike to others.

    Attributes:
        shape: what else must be equal in elements that are alike.
        texts: the texts with numbers, in the order of the file.
    """

    shape: tuple[str, ...]
    texts: Sequence[KeyedText]


class OddNumber(Record, frozen=True):
    """A number that differs from another one in the same element, unlike in the elements that are alike.

    Attributes:
        text: the text that contains the number.
        expected: the number that the other places of the element have.
        fixed: the text with the expected number.
        other: a text with the expected number.
    """

    text: Name
    expected: str
    fixed: str
    other: Name


class _Place(Record, frozen=True):
    text: KeyedText
    start: int
    number: str

    def may_equal(self, other: _Place) -> bool:
        """Whether two places probably have the same number on purpose. Two numbers alone do only if they have the same
        meaning: coordinates are often equal by chance."""
        return self.text.key == other.text.key or not (self._is_alone and other._is_alone)

    @property
    def _is_alone(self) -> bool:
        return self.text.name.value.strip() == self.number


def odd_numbers(elements: Iterable[Alike]) -> Iterator[OddNumber]:
    """The odd numbers of elements. Elements are alike if their shapes are equal and their texts differ only in numbers;
    at least three of them must be consistent, with different numbers; or two, if the third repeats a number of them."""
    groups: dict[object, list[list[_Place]]] = defaultdict(list)
    for element in elements:
        masked = tuple((text.key, _NUMBER.sub("#", text.name.value)) for text in element.texts)
        places = [_Place(t, m.start(), m.group()) for t in element.texts for m in _NUMBER.finditer(t.name.value)]
        if 2 <= len(places) <= _MAX_PLACES:
            groups[element.shape, masked].append(places)
    for group in groups.values():
        if len(group) > _MIN_OF_COPIES:
            yield from _odd_in(group)


def _odd_in(group: Sequence[Sequence[_Place]]) -> Iterator[OddNumber]:
    places = enumerate(group[0])
    pairs = [(a, b) for (a, first), (b, second) in itertools.combinations(places, 2) if first.may_equal(second)]
    suspects: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for first, second in pairs:
        equal = [element[first].number for element in group if element[first].number == element[second].number]
        if len(equal) != len(group) - 1 or len(set(equal)) < min(_MIN_CONSISTENT, len(equal)):
            continue
        (odd,) = (n for n, element in enumerate(group) if element[first].number != element[second].number)
        suspects[odd].append((first, second))
    for odd, disagreements in suspects.items():
        finding = _odd_place(group, odd, disagreements)
        if finding is not None:
            yield finding


def _odd_place(
    group: Sequence[Sequence[_Place]], odd: int, disagreements: Sequence[tuple[int, int]]
) -> OddNumber | None:
    """The place of an element that disagrees with most of its other places, or, of two places, the one whose number
    another element has, too; `None` if both may be wrong."""
    votes = Counter(place for pair in disagreements for place in pair)
    most = max(votes.values())
    candidates = [place for place in votes if votes[place] == most]
    if len(candidates) > 1:
        candidates = [place for place in candidates if _is_repeated(group, odd, place)]
    if len(candidates) != 1:
        return None
    (wrong,) = candidates
    is_copy = most > 1 and _is_repeated(group, odd, wrong)
    if len(group) <= _MIN_CONSISTENT and not is_copy:
        return None
    right = next(second if first == wrong else first for first, second in disagreements if wrong in (first, second))
    place, expected = group[odd][wrong], group[odd][right]
    end = place.start + len(place.number)
    text = place.text.name.value
    fixed = text[: place.start] + expected.number + text[end:]
    return OddNumber(place.text.name, expected.number, fixed, expected.text.name)


def _is_repeated(group: Sequence[Sequence[_Place]], odd: int, place: int) -> bool:
    number = group[odd][place].number
    return any(element[place].number == number for other, element in enumerate(group) if other != odd)

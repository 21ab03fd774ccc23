# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about trees and the declarations of their nodes."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.forest.forest import Forest
from roaml.rules.rule import TreeContext
from roaml.suggest import close_names

MAX_WRONG_LETTERS = 3
"""The maximum number of wrong letters in a misspelled name."""


def forest_of(context: TreeContext) -> Forest | None:
    """The forest of a file that is checked without a system; `None` for other files, and for files of version 3. The
    latter must be converted first, and other findings in them would only be consequences."""
    forest = context.forest
    return None if forest is None or forest.is_version_3 else forest


def trees_of(context: TreeContext) -> Forest | None:
    """The trees that are checked together with a file, in a system or without one; `None` for files of version 3
    without a system, as for `forest_of`."""
    return forest_of(context) if context.system is None else context.trees


def probably_meant(name: str, known: Iterable[str], most: int = MAX_WRONG_LETTERS) -> str | None:
    """The known name that differs from `name` only in upper and lower case or underscores, or in at most `most` letters
    and at most a third of its letters. `None` if there is none.

    Users choose the names of nodes, and many are similar: `IsDoorClosed` is not a misspelling of `DoorClosed`. So
    a name that only has additional letters at one end may have at most one of them.
    """
    by_plain = {other.lower().replace("_", ""): other for other in known}
    plain = name.lower().replace("_", "")
    if plain in by_plain:
        return by_plain[plain]
    limit = min(most, len(plain) // 3)
    for close in close_names(plain, by_plain):
        key = close.lower()
        distance = _distance(plain, key)
        extends = plain.startswith(key) or plain.endswith(key) or key.startswith(plain) or key.endswith(plain)
        if distance <= (min(limit, 1) if extends else limit):
            return by_plain[key]
    return None


def _distance(name: str, other: str) -> int:
    """The number of different letters: the edit distance, in which a transposition is one edit (Damerau 1964)."""
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, letter in enumerate(name, 1):
        above, row_before = row, before
        row = [i]
        for j, other_letter in enumerate(other, 1):
            cost = min(above[j] + 1, row[-1] + 1, above[j - 1] + (letter != other_letter))
            if i > 1 and j > 1 and letter == other[j - 2] and name[i - 2] == other_letter:
                cost = min(cost, row_before[j - 2] + 1)
            row.append(cost)
        before = above
    return row[-1]

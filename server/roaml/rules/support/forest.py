# SPDX-License-Identifier: Apache-2.0
"""What rules about trees that belong to no system share."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.forest.forest import Forest
from roaml.rules.rule import TreeContext
from roaml.suggest import close_names

MAX_WRONG_LETTERS = 3
"""So many letters of a name may be wrong."""


def forest_of(context: TreeContext) -> Forest | None:
    """The forest of a file that is checked as such. A file of version 3 is converted first, what else is said about it
    would only follow."""
    forest = context.forest
    return None if forest is None or forest.is_version_3 else forest


def probably_meant(name: str, known: Iterable[str], most: int = MAX_WRONG_LETTERS) -> str | None:
    """The known name that differs from `name` in a few letters, or only in upper and lower case or underscores.

    Names of nodes are chosen by people, and many resemble each other: `IsDoorClosed` is not meant for `DoorClosed`. So
    a name that only has more letters than another at one end differs in one of them at most.
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
    """How many letters differ: the edit distance with swapped neighbours as one edit (Damerau 1964)."""
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

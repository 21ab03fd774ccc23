# SPDX-License-Identifier: Apache-2.0
"""What rules about trees that belong to no system share."""

from __future__ import annotations

from roaml.forest.forest import Forest
from roaml.rules.rule import TreeContext
from roaml.suggest import close_names, nearest_name

NAME_LIMIT = 3


def forest_of(context: TreeContext) -> Forest | None:
    """The forest of a file that is checked as such. A file of version 3 is converted first, what else is said about it
    would only follow."""
    forest = context.forest
    return None if forest is None or forest.is_version_3 else forest


def probably_meant(name: str, known: tuple[str, ...]) -> str | None:
    """The known name that differs from `name` in little more than a few letters.

    Names of nodes are chosen by people, and many are alike: `close_names` finds too much where any name is possible.
    """
    by_lower = {each.lower(): each for each in known}
    if name.lower() in by_lower:
        return by_lower[name.lower()]
    near = nearest_name(name, known)
    if near is not None:
        return near
    plain = {each.lower().replace("_", ""): each for each in known}
    stem = name.lower().replace("_", "")
    found = nearest_name(stem, plain)
    if found is not None:
        return plain[found]
    close = close_names(name, known, 1)
    return close[0] if close and _share_letters(name, close[0]) else None


def _share_letters(name: str, other: str) -> bool:
    """Whether two names differ in few letters wherever they stand (Levenshtein 1966)."""
    limit = 1 + len(name) // 5
    row = list(range(len(other) + 1))
    for i, letter in enumerate(name, 1):
        previous, row[0] = row[0], i
        for j, other_letter in enumerate(other, 1):
            cost = previous + (letter != other_letter)
            previous, row[j] = row[j], min(cost, row[j] + 1, row[j - 1] + 1)
    return row[-1] <= min(limit, NAME_LIMIT)

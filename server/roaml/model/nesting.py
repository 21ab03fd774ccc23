# SPDX-License-Identifier: Apache-2.0
"""How large things are that contain each other, structs and messages, counted before they are put together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

MAX_FIELDS = 10_000
"""Of a struct or message, with all that is in its members."""

MAX_DEPTH = 100
"""How deep structs and messages may be in each other."""


@dataclass(frozen=True, slots=True)
class TypeExtent:
    """Attributes:
    fields: that are no structs themselves.
    depth: how many structs are in each other at most.
    """

    fields: int
    depth: int

    @property
    def is_too_large(self) -> bool:
        return self.fields > MAX_FIELDS or self.depth > MAX_DEPTH


def extents(members: Mapping[str, Sequence[str]]) -> dict[str, TypeExtent]:
    """The extent of each name, inner ones first. What contains itself counts one field there.

    Args:
        members: name -> what its members are; names that are not among the keys are plain fields.
    """
    found: dict[str, TypeExtent] = {}
    for name in _inner_first(members):
        inner = [found[member] for member in members[name] if member in found]
        fields = len(members[name]) - len(inner) + sum(each.fields for each in inner)
        found[name] = TypeExtent(fields, 1 + max((each.depth for each in inner), default=0))
    return found


def _inner_first(members: Mapping[str, Sequence[str]]) -> Iterator[str]:
    entered: set[str] = set()
    for start in members:
        if start in entered:
            continue
        entered.add(start)
        stack = [(start, iter(members[start]))]
        while stack:
            name, left = stack[-1]
            inner = next((each for each in left if each in members and each not in entered), None)
            if inner is None:
                stack.pop()
                yield name
            else:
                entered.add(inner)
                stack.append((inner, iter(members[inner])))

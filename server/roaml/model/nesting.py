# SPDX-License-Identifier: Apache-2.0
"""The sizes of structs and messages, including those that they contain. They are computed without expanding them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from roaml.record import Record

MAX_FIELDS = 10_000
"""The maximum number of fields of a struct or message, including those of its members."""

MAX_DEPTH = 100
"""The maximum nesting depth of structs and messages."""


class TypeExtent(Record, frozen=True):
    """The size of a struct or message.

    Attributes:
        fields: the number of fields that are not structs themselves, including those of nested structs.
        depth: the maximum nesting depth of structs.
    """

    fields: int
    depth: int

    @property
    def is_too_large(self) -> bool:
        return self.fields > MAX_FIELDS or self.depth > MAX_DEPTH


def extents(members: Mapping[str, Sequence[str]]) -> dict[str, TypeExtent]:
    """The extent of each struct or message; those that others contain come first. A recursive member is regarded as one
    field.

    Args:
        members: struct -> the types of its members; types that are not keys are not structs.
    """
    extent_of: dict[str, TypeExtent] = {}
    for name in _inner_first(members):
        inner = [extent_of[member] for member in members[name] if member in extent_of]
        fields = len(members[name]) - len(inner) + sum(extent.fields for extent in inner)
        extent_of[name] = TypeExtent(fields, 1 + max((extent.depth for extent in inner), default=0))
    return extent_of


def _inner_first(members: Mapping[str, Sequence[str]]) -> Iterator[str]:
    entered: set[str] = set()
    for start in members:
        if start in entered:
            continue
        entered.add(start)
        stack = [(start, iter(members[start]))]
        while stack:
            name, left = stack[-1]
            inner = next((name for name in left if name in members and name not in entered), None)
            if inner is None:
                stack.pop()
                yield name
            else:
                entered.add(inner)
                stack.append((inner, iter(members[inner])))

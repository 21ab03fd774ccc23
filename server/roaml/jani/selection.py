# SPDX-License-Identifier: Apache-2.0
"""Selection of properties by their names."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol, TypeVar


class Named(Protocol):
    """A property in any form."""

    @property
    def name(self) -> str: ...


NamedT = TypeVar("NamedT", bound=Named)


class PropertyError(ValueError):
    """There is no property with this name; the message lists the existing properties."""


def select(
    properties: Sequence[NamedT], names: Iterable[str], owner: str, others: Sequence[str] = ()
) -> tuple[NamedT, ...]:
    """The properties of some names, in the order of the names.

    Args:
        owner: the owner of the properties, for the message: `model` or `system`.
        others: further names that can be requested, for the message.

    Raises:
        PropertyError: there is no property with one of the names.
    """
    by_name = {property_.name: property_ for property_ in properties}
    chosen = []
    for name in names:
        if name not in by_name:
            known = ", ".join([*by_name, *others]) or "none"
            raise PropertyError(f"there is no property {name}; the {owner} has: {known}")
        chosen.append(by_name[name])
    return tuple(chosen)

# SPDX-License-Identifier: Apache-2.0
"""Choosing properties by their names."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol, TypeVar


class Named(Protocol):
    """A property in any form."""

    @property
    def name(self) -> str: ...


NamedT = TypeVar("NamedT", bound=Named)


class PropertyError(ValueError):
    """A property does not exist; the message lists the properties that exist."""


def select(
    properties: Sequence[NamedT], names: Iterable[str], owner: str, others: Sequence[str] = ()
) -> tuple[NamedT, ...]:
    """The properties with these names, in the order of the names.

    Args:
        owner: what the properties belong to, for the message: `model` or `system`.
        others: further names that can be chosen, for the message.

    Raises:
        PropertyError: a property does not exist.
    """
    by_name = {property_.name: property_ for property_ in properties}
    chosen = []
    for name in names:
        if name not in by_name:
            known = ", ".join([*by_name, *others]) or "none"
            raise PropertyError(f"the {owner} has no property `{name}`; its properties are: {known}")
        chosen.append(by_name[name])
    return tuple(chosen)

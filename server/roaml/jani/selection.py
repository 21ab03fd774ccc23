# SPDX-License-Identifier: Apache-2.0
"""Selects properties by their names."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol, TypeVar


class Named(Protocol):
    """A property of any type that has a name."""

    @property
    def name(self) -> str: ...


NamedT = TypeVar("NamedT", bound=Named)


class PropertyError(ValueError):
    """Raised if a property does not exist. The message lists the properties that exist."""


def select(
    properties: Sequence[NamedT], names: Iterable[str], owner: str, others: Sequence[str] = ()
) -> tuple[NamedT, ...]:
    """The properties named `names`, in the order of the names.

    Args:
        owner: `model` or `system`: a word for the owner of the properties in the message.
        others: further names that users may select, for the message.

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

# SPDX-License-Identifier: Apache-2.0
"""What all parts of a JANI model have in common."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NoReturn, TypeAlias

from roaml.text import Location

Origin: TypeAlias = Location
"""A place in the JANI file (filled in by the reader) or in the robot model (by the translator)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Node:
    """`origin` is the place that the node exists for; nodes that differ in nothing else are equal."""

    origin: Origin | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class CommentedNode(Node):
    """A node whose JSON form may have a member `comment`."""

    comment: str | None = None


def never(value: NoReturn) -> NoReturn:
    """The last case of a `match` over a closed world; mypy proves that it is not reached."""
    raise AssertionError(f"unknown kind of node: {value!r}")

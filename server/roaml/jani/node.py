# SPDX-License-Identifier: Apache-2.0
"""The base classes of all parts of a JANI model."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from roaml.text import Location

Origin: TypeAlias = Location
"""A position in the JANI file (set by the reader) or in the robot model (set by the translator)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Node:
    """A part of a model. `origin` is the place from which it comes; equality ignores it."""

    origin: Origin | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class CommentedNode(Node):
    """A node whose JSON form may have a member `comment`."""

    comment: str | None = None

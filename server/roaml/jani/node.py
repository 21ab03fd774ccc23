# SPDX-License-Identifier: Apache-2.0
"""The base classes of all parts of a JANI model."""

from __future__ import annotations

from typing import TypeAlias

from roaml.record import PartlyCompared
from roaml.text import Location

Origin: TypeAlias = Location
"""A position in the JANI file (set by the reader) or in the robot model (set by the translator)."""


class Node(PartlyCompared, frozen=True, kw_only=True):
    """A part of a model. `origin` is the place from which it comes; equality ignores it."""

    UNCOMPARED = frozenset({"origin"})

    origin: Origin | None = None


class CommentedNode(Node, frozen=True, kw_only=True):
    """A node whose JSON form may have a member `comment`."""

    comment: str | None = None

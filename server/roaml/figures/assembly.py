# SPDX-License-Identifier: Apache-2.0
"""Moves groups of a drawing."""

from __future__ import annotations

from roaml.exhaustive import assert_never
from roaml.figures.drawing import Area, Glyph, Group, Item, Polyline, Shape, TextItem
from roaml.figures.geometry import Point
from roaml.record import replace


def moved(group: Group, dx: float, dy: float) -> Group:
    """The group, moved by `dx` to the right and by `dy` downwards."""
    return replace(group, items=tuple(_moved(item, dx, dy) for item in group.items))


def _moved(item: Item, dx: float, dy: float) -> Item:
    match item:
        case Group():
            return moved(item, dx, dy)
        case Shape() | Glyph():
            return replace(item, box=item.box.moved(dx, dy))
        case Polyline() | Area():
            return replace(item, points=tuple(Point(x + dx, y + dy) for x, y in item.points))
        case TextItem():
            return replace(item, x=item.x + dx, y=item.y + dy)
        case _:
            return assert_never(item)

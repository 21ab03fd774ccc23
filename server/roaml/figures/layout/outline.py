# SPDX-License-Identifier: Apache-2.0
"""Layout of trees as outlines: one node below another, children after their parent and indented."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.layout.graph import Layout, Route

INDENT = 26.0
"""The distance between the left sides of a node and its children, in pixels."""
ROW_DISTANCE = 6.0
_STEM = 14.0
"""The distance of the line to the children from the left side of a node, in pixels."""


def outline(nodes: Mapping[str, Extent], children: Mapping[str, Sequence[str]]) -> Layout:
    """The layout of a forest in one column. The routes lead from each parent to each child, in the order of `children`.

    Args:
        children: the children of each node in their order; nodes without children may be omitted.
    """
    boxes: dict[str, Box] = {}
    y = 0.0
    for name, depth in rows(nodes, children):
        boxes[name] = Box(depth * INDENT, y, *nodes[name])
        y += nodes[name].height + ROW_DISTANCE
    routes = (_route(boxes[parent], boxes[child]) for parent, group in children.items() for child in group)
    width = max((box.right for box in boxes.values()), default=0.0)
    return Layout(Extent(width, max(0.0, y - ROW_DISTANCE)), boxes, tuple(routes))


def rows(names: Mapping[str, object], children: Mapping[str, Sequence[str]]) -> Iterator[tuple[str, int]]:
    """Each node with the number of nodes above it, parents before their children."""
    inner = {child for group in children.values() for child in group}
    pending = [(name, 0) for name in names if name not in inner][::-1]
    while pending:
        name, depth = pending.pop()
        yield name, depth
        pending += [(child, depth + 1) for child in reversed(children.get(name, ()))]


def _route(parent: Box, child: Box) -> Route:
    x, y = parent.x + min(_STEM, parent.width / 2), child.y + child.height / 2
    return Route(((Point(x, parent.bottom), Point(x, y), Point(child.x, y)),))

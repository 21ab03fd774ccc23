# SPDX-License-Identifier: Apache-2.0
"""Layout of trees: parents above the middle of their children, subtrees as near to each other as their outlines allow
(Reingold, Tilford 1981, with nodes of any size)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.layout.graph import Layout, LayoutDirection, Route

SIBLING_DISTANCE = 20.0
COUSIN_DISTANCE = 30.0
LEVEL_DISTANCE = 40.0
NEARLY_STRAIGHT = 8.0
"""If the middles of a node and a child differ by less than this, the line between them is straight."""


def tidy_tree(nodes: Mapping[str, Extent], children: Mapping[str, Sequence[str]], direction: LayoutDirection) -> Layout:
    """The layout of a forest. The routes lead from each parent to each child, in the order of `children`.

    Args:
        children: the children of each node in their order; nodes without children may be omitted.
    """
    if direction is LayoutDirection.RIGHT:
        turned = {name: size.turned for name, size in nodes.items()}
        return tidy_tree(turned, children, LayoutDirection.DOWN).turned
    inner = {child for group in children.values() for child in group}
    roots = [name for name in nodes if name not in inner]
    levels = _levels(roots, children)
    offsets: dict[str, float] = {}
    outlines: dict[str, _Outline] = {}
    for level in reversed(levels):
        for name in level:
            below = children.get(name, ())
            outlines[name] = _join(nodes[name].width, [outlines[child] for child in below], offsets, below)
    forest = [outlines[root] for root in roots]
    _join(0.0, forest, offsets, roots)
    boxes: dict[str, Box] = {}
    middles = {root: offsets[root] for root in roots}
    y = 0.0
    bottoms = []
    for level in levels:
        thickness = max(nodes[name].height for name in level)
        for name in level:
            boxes[name] = Box(middles[name] - nodes[name].width / 2, y, *nodes[name])
            middles |= {child: middles[name] + offsets[child] for child in children.get(name, ())}
        bottoms.append(y + thickness)
        y += thickness + LEVEL_DISTANCE
    left = min((box.x for box in boxes.values()), default=0.0)
    depth = {name: index for index, level in enumerate(levels) for name in level}
    routes = [
        route.moved(-left, 0)
        for parent, group in children.items()
        for route in _elbows(
            boxes[parent], [boxes[child] for child in group], bottoms[depth[parent]] + LEVEL_DISTANCE / 2
        )
    ]
    placed = {name: boxes[name].moved(-left, 0) for name in nodes}
    width = max((box.right for box in placed.values()), default=0.0)
    return Layout(Extent(width, bottoms[-1] if bottoms else 0.0), placed, tuple(routes))


def _levels(roots: Sequence[str], children: Mapping[str, Sequence[str]]) -> list[list[str]]:
    levels = []
    level = list(roots)
    while level:
        levels.append(level)
        level = [child for name in level for child in children.get(name, ())]
    return levels


class _Outline:
    """The left and right borders of a subtree on each level, relative to the middle of its root."""

    __slots__ = ("left", "right")

    def __init__(self, left: list[float], right: list[float]) -> None:
        self.left = left
        self.right = right


def _join(width: float, parts: Sequence[_Outline], offsets: dict[str, float], names: Sequence[str]) -> _Outline:
    """The outline of a node with its subtrees. The offsets of the subtrees are stored in `offsets`."""
    left: list[float] = []
    right: list[float] = []
    places: list[float] = []
    for part in parts:
        place = max(
            (
                border - own + (SIBLING_DISTANCE if level == 0 else COUSIN_DISTANCE)
                for level, (border, own) in enumerate(zip(right, part.left, strict=False))
            ),
            default=0.0,
        )
        if places:
            place = max(place, places[-1])
        places.append(place)
        left += [border + place for border in part.left[len(left) :]]
        shifted = [border + place for border in part.right]
        right = shifted + right[len(shifted) :]
    middle = (places[0] + places[-1]) / 2 if places else 0.0
    for name, place in zip(names, places, strict=True):
        offsets[name] = place - middle
    return _Outline(
        [-width / 2, *(border - middle for border in left)], [width / 2, *(border - middle for border in right)]
    )


def _elbows(parent: Box, children: Sequence[Box], track: float) -> list[Route]:
    """The routes to the children of a node. All begin at the same point: above the child that is nearly in the middle,
    if there is one, so that its route is straight; otherwise in the middle."""
    middle = parent.x + parent.width / 2
    ends = [Point(child.x + child.width / 2, child.y) for child in children]
    tolerance = min(NEARLY_STRAIGHT, parent.width / 2)
    start = Point(next((end.x for end in ends if abs(end.x - middle) < tolerance), middle), parent.bottom)
    return [
        Route(((start, end) if end.x == start.x else (start, Point(start.x, track), Point(end.x, track), end),))
        for end in ends
    ]

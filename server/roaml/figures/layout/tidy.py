# SPDX-License-Identifier: Apache-2.0
"""Layout of trees: parents above the middle of their children, subtrees as near to each other as their outlines allow
(Reingold, Tilford 1981, with nodes of any size). If a tree is too wide, some of its subtrees are outlines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.layout.graph import Layout, LayoutDirection, Route
from roaml.figures.layout.outline import ROW_DISTANCE, outline

SIBLING_DISTANCE = 20.0
COUSIN_DISTANCE = 30.0
LEVEL_DISTANCE = 40.0
NEARLY_STRAIGHT = 8.0
"""If the middles of a node and a child differ by less than this, the line between them is straight."""
MAX_RATIO = 2.5
"""The ratio of width to height above which subtrees are drawn as outlines."""
GROWTH = (1.0, 1.25, 1.6, 2.0, 2.5, 3.2)
"""The heights that are tried for a tree that is too wide, as multiples of the height without outlines."""


def tidy_tree(nodes: Mapping[str, Extent], children: Mapping[str, Sequence[str]], direction: LayoutDirection) -> Layout:
    """The layout of a forest. The routes lead from each parent to each child, in the order of `children`.

    Args:
        children: the children of each node in their order; nodes without children may be omitted.
    """
    if direction is LayoutDirection.RIGHT:
        turned = {name: size.turned for name, size in nodes.items()}
        return _tidy(turned, children).turned
    whole = _tidy(nodes, children)
    if _ratio(whole) <= MAX_RATIO:
        return whole
    best = whole
    for factor in GROWTH:
        layout = _with_outlines(nodes, children, list(_low(nodes, children, whole.size.height * factor)))
        if _excess(layout) < _excess(best):
            best = layout
        if _ratio(best) <= MAX_RATIO:
            break
    return best


def _low(nodes: Mapping[str, Extent], children: Mapping[str, Sequence[str]], limit: float) -> Iterator[str]:
    """The uppermost nodes with children whose subtrees, as outlines, end above a limit in pixels. The root is none of
    them."""
    heights: dict[str, float] = {}
    for level in reversed(_levels(_roots(nodes, children), children)):
        for name in level:
            heights[name] = nodes[name].height + sum(heights[child] + ROW_DISTANCE for child in children.get(name, ()))
    pending = [(root, 0.0) for root in reversed(_roots(nodes, children))]
    while pending:
        name, top = pending.pop()
        if top and children.get(name) and top + heights[name] <= limit:
            yield name
            continue
        below = top + nodes[name].height + LEVEL_DISTANCE
        pending += [(child, below) for child in reversed(children.get(name, ()))]


def _ratio(layout: Layout) -> float:
    return layout.size.width / max(1.0, layout.size.height)


def _excess(layout: Layout) -> float:
    """The ratio of the longer to the shorter side."""
    return max(_ratio(layout), 1 / max(0.001, _ratio(layout)))


class _Subtree(NamedTuple):
    """The layout of a subtree in its own rectangle; `routes` are those from each of its nodes to the children."""

    size: Extent
    nodes: Mapping[str, Box]
    routes: Mapping[str, Sequence[Route]]

    def moved(self, dx: float, dy: float) -> _Subtree:
        boxes = {name: box.moved(dx, dy) for name, box in self.nodes.items()}
        routes = {name: [route.moved(dx, dy) for route in group] for name, group in self.routes.items()}
        return _Subtree(self.size, boxes, routes)


def _with_outlines(nodes: Mapping[str, Extent], children: Mapping[str, Sequence[str]], heads: Sequence[str]) -> Layout:
    """The layout in which the subtrees of some nodes are outlines. Other children are directly below their parent, side
    by side, so that a high subtree does not move the levels of others."""
    done = {name: _outlined(nodes, children, name) for name in heads}
    hidden = {member for subtree in done.values() for member in subtree.nodes}
    roots = _roots(nodes, children)
    for level in reversed(_levels(roots, children)):
        for name in level:
            if name not in hidden:
                below = children.get(name, ())
                done[name] = _above(name, nodes[name], below, _side_by_side([done[child] for child in below]))
    forest = _side_by_side([done[root] for root in roots])
    boxes = {name: forest.nodes[name] for name in nodes}
    return Layout(forest.size, boxes, tuple(route for name in children for route in forest.routes[name]))


def _outlined(nodes: Mapping[str, Extent], children: Mapping[str, Sequence[str]], root: str) -> _Subtree:
    members = [root]
    for member in members:
        members += children.get(member, ())
    own = {member: children[member] for member in members if member in children}
    layout = outline({member: nodes[member] for member in members}, own)
    routes = iter(layout.routes)
    return _Subtree(layout.size, layout.nodes, {name: [next(routes) for _ in group] for name, group in own.items()})


def _side_by_side(subtrees: Sequence[_Subtree]) -> _Subtree:
    boxes: dict[str, Box] = {}
    routes: dict[str, Sequence[Route]] = {}
    x = 0.0
    for subtree in subtrees:
        placed = subtree.moved(x, 0)
        boxes |= placed.nodes
        routes |= placed.routes
        x += subtree.size.width + COUSIN_DISTANCE
    height = max((subtree.size.height for subtree in subtrees), default=0.0)
    return _Subtree(Extent(max(0.0, x - COUSIN_DISTANCE), height), boxes, routes)


def _above(name: str, size: Extent, children: Sequence[str], row: _Subtree) -> _Subtree:
    """A node above the middle of its children."""
    if not children:
        return _Subtree(size, {name: Box(0, 0, *size)}, {name: ()})
    first, last = row.nodes[children[0]], row.nodes[children[-1]]
    left = (first.x + first.width / 2 + last.x + last.width / 2 - size.width) / 2
    placed = row.moved(max(0.0, -left), size.height + LEVEL_DISTANCE)
    box = Box(max(0.0, left), 0, *size)
    routes = _elbows(box, [placed.nodes[child] for child in children], size.height + LEVEL_DISTANCE / 2)
    width = max(box.right, row.size.width + max(0.0, -left))
    whole = Extent(width, size.height + LEVEL_DISTANCE + row.size.height)
    return _Subtree(whole, {name: box, **placed.nodes}, {name: routes, **placed.routes})


def _roots(nodes: Mapping[str, object], children: Mapping[str, Sequence[str]]) -> list[str]:
    inner = {child for group in children.values() for child in group}
    return [name for name in nodes if name not in inner]


def _tidy(nodes: Mapping[str, Extent], children: Mapping[str, Sequence[str]]) -> Layout:
    """The layout downwards, without outlines."""
    roots = _roots(nodes, children)
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

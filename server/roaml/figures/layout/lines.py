# SPDX-License-Identifier: Apache-2.0
"""Layout of long lines and rings: graphs in which each node leads to the next one, in columns that are read like text.

All columns begin at the top, and their nodes are in rows. From the end of a column, a link leads through the channel on
the left of the next column to its top. The last node may lead back to an earlier one: this link is below all columns,
then in the channel on the left of its target. So no links cross.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.layout.graph import Layout, Link, Route, at_origin
from roaml.record import Record

LENGTH = 24.0
TURN = 16.0
APART = 20.0
"""Distances in pixels: of two neighbours in a column; of a turn or a channel from nodes and labels; of the link back
from other links."""
WINDOW, MAX_RATIO = 1180.0, 4.5
"""The desired maximum length of a column, in pixels, and the maximum ratio of width to height that it may cause."""
MAX_DOT = 12.0
"""The maximum size of a first node that is drawn above the first column, in pixels: the dot before an initial state."""


class Succession(Record, frozen=True):
    """A graph in which each node leads to the next one.

    Attributes:
        names: the nodes in their order.
        links: the index of the link that leaves each node; the last node may have none.
        back: the place in `names` of the node to which the last one leads; `None` if it has no link.
    """

    names: tuple[str, ...]
    links: tuple[int, ...]
    back: int | None


def find_line(names: Sequence[str], indexes: Sequence[int], links: Sequence[Link]) -> Succession | None:
    """A connected graph as a line; `None` if a node has several links, or if several nodes have no predecessor.

    Args:
        names: the nodes of the graph.
        indexes: the indexes of its links.
    """
    leaving = {links[index].source: index for index in indexes}
    if len(leaving) < len(indexes):
        return None
    targets = {links[index].target for index in indexes}
    name: str | None = next((name for name in names if name not in targets), names[0])
    places: dict[str, int] = {}
    while name is not None and name not in places:
        places[name] = len(places)
        name = links[leaving[name]].target if name in leaving else None
    if len(places) < len(names):
        return None
    order = tuple(leaving[name] for name in places if name in leaving)
    return Succession(tuple(places), order, None if name is None else places[name])


def in_columns(line: Succession, sizes: Mapping[str, Extent], links: Sequence[Link], aspect: float) -> Layout:
    """The layout of a line, in the number of columns that suits a ratio of width to height best. If possible, columns
    are not longer than a window. The routes are in the order of the indexes of the links."""
    start = links[line.links[0]]
    has_dot = line.back != 0 and max(sizes[line.names[0]]) <= MAX_DOT and start.label is None
    count = len(line.names) - has_dot
    lengths = {math.ceil(count / columns) for columns in range(1, count + 1)}
    layouts = (_Columns(line, sizes, links, length, has_dot=has_dot).layout() for length in sorted(lengths))

    def fitness(layout: Layout) -> tuple[float, float]:
        width, height = layout.size
        excess = max(0.0, height - WINDOW) if width <= MAX_RATIO * height else math.inf
        return excess, abs(math.log(width / height / aspect))

    return min(layouts, key=fitness)


class _Columns:
    """A line in columns that have, except the last one, the same number of nodes."""

    def __init__(
        self, line: Succession, sizes: Mapping[str, Extent], links: Sequence[Link], length: int, *, has_dot: bool
    ) -> None:
        self.line = line
        self.sizes = [sizes[name] for name in line.names]
        self.labels = [links[index].label for index in line.links]
        self.first = int(has_dot)
        """The node at the top of the first column."""
        nodes = range(self.first, len(self.sizes))
        self.columns = [nodes[start : start + length] for start in range(0, len(nodes), length)]
        self.column = {node: number for number, column in enumerate(self.columns) for node in column}

    def layout(self) -> Layout:
        tops, heights = self._rows()
        axes, channels = self._axes()
        boxes: list[Box] = []
        if self.first:
            width, height = self.sizes[0]
            boxes.append(Box(axes[0] - width / 2, -LENGTH - height, width, height))
        for axis, column in zip(axes, self.columns, strict=True):
            for node, top, row in zip(column, tops, heights, strict=False):
                width, height = self.sizes[node]
                boxes.append(Box(axis - width / 2, top + (row - height) / 2, width, height))
        end = tops[-1] + heights[-1] + TURN
        routes = {index: self._route(node, boxes, channels, end) for node, index in enumerate(self.line.links)}
        nodes = dict(zip(self.line.names, boxes, strict=True))
        return at_origin(nodes, [routes[index] for index in sorted(routes)])

    def _rows(self) -> tuple[list[float], list[float]]:
        """The place of the top of each row, and its height."""
        tops: list[float] = []
        heights: list[float] = []
        y = 0.0
        for row in range(len(self.columns[0])):
            nodes = [column[row] for column in self.columns if row < len(column)]
            inner = [self.labels[node] for node in nodes if self.column.get(node + 1) == self.column[node]]
            tops.append(y)
            heights.append(max(self.sizes[node].height for node in nodes))
            label = max((label.height + LENGTH for label in inner if label), default=0.0)
            y += heights[-1] + LENGTH + label
        return tops, heights

    def _axes(self) -> tuple[list[float], list[tuple[float, float]]]:
        """The middle of each column, and the places of the links in the channel on its left: of the one to its top, and
        of the one back to a node in it."""
        axes: list[float] = []
        channels: list[tuple[float, float]] = []
        x = 0.0
        for number, column in enumerate(self.columns):
            up = back = 0.0
            if number:
                half = _half(self.labels[column[0] - 1])
                up = x + TURN + half
                x = up + half + TURN
            if self.line.back is not None and self.column[self.line.back] == number:
                half = _half(self.labels[-1])
                back = x + half + (APART - TURN if number else 0.0)
                x = back + half + TURN
            inner = [self.labels[node] for node in column[:-1]]
            half = max([self.sizes[node].width / 2 for node in column] + [_half(label) for label in inner])
            axes.append(x + half)
            channels.append((up, back))
            x += 2 * half
        return axes, channels

    def _route(self, node: int, boxes: Sequence[Box], channels: Sequence[tuple[float, float]], end: float) -> Route:
        """The route of the link that leaves a node; `end` is below all columns."""
        label = self.labels[node]
        x, y = _middle(boxes[node]).x, boxes[node].bottom
        if node + 1 == len(boxes):
            assert self.line.back is not None
            target = boxes[self.line.back]
            back = channels[self.column[self.line.back]][1]
            below, height = end + APART, _middle(target).y
            corners = [(x, y), (x, below), (back, below), (back, height), (target.x, height)]
            return _labelled([Point(*corner) for corner in corners], 2, label)
        target = boxes[node + 1]
        if node < self.first or self.column[node] == self.column[node + 1]:
            return _labelled([Point(x, y), Point(x, target.y)], 0, label)
        up, middle = channels[self.column[node + 1]][0], _middle(target).x
        corners = [(x, y), (x, end), (up, end), (up, -TURN), (middle, -TURN), (middle, target.y)]
        return _labelled([Point(*corner) for corner in corners], 2, label)


def _labelled(points: Sequence[Point], piece: int, label: Extent | None) -> Route:
    """A line with its label in the middle of one of its vertical pieces."""
    if label is None:
        return Route((tuple(points),))
    (x, start), (_, end) = points[piece : piece + 2]
    box = Box(x - label.width / 2, (start + end - label.height) / 2, *label)
    near, far = (box.y, box.bottom) if start < end else (box.bottom, box.y)
    return Route(((*points[: piece + 1], Point(x, near)), (Point(x, far), *points[piece + 1 :])), box)


def _middle(box: Box) -> Point:
    return Point(box.x + box.width / 2, box.y + box.height / 2)


def _half(label: Extent | None) -> float:
    return label.width / 2 if label else 0.0

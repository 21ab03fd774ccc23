# SPDX-License-Identifier: Apache-2.0
"""The input and the output of layouts."""

from __future__ import annotations

import enum
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from roaml.figures.geometry import Box, Extent, Point
from roaml.record import Record, replace


class LayoutDirection(enum.Enum):
    """The direction in which links lead, except those that close cycles."""

    DOWN = "down"
    RIGHT = "right"


class Link(Record, frozen=True):
    """A line from one node to another, and the size of its label if it has one.

    Attributes:
        source_port, target_port: where the line should leave its source and enter its target, in pixels from the middle
            of the side of the node; `None` if it may be anywhere.
    """

    source: str
    target: str
    label: Extent | None = None
    source_port: float | None = None
    target_port: float | None = None

    def port(self, node: str) -> float | None:
        """Where the line should end at one of its nodes."""
        return self.source_port if node == self.source else self.target_port

    @property
    def turned(self) -> Link:
        return replace(self, label=self.label.turned if self.label else None)


class Route(Record, frozen=True):
    """The line of a link from its source to its target.

    Attributes:
        parts: one polyline, or two if the label interrupts it.
        label: the place of the label, if the link has one.
    """

    parts: tuple[tuple[Point, ...], ...]
    label: Box | None = None

    def moved(self, dx: float, dy: float) -> Route:
        parts = tuple(tuple(Point(x + dx, y + dy) for x, y in part) for part in self.parts)
        return Route(parts, self.label.moved(dx, dy) if self.label else None)

    @property
    def pieces(self) -> Iterator[Box]:
        """The areas of the straight pieces of the line."""
        for part in self.parts:
            for a, b in pairwise(part):
                yield Box(min(a.x, b.x), min(a.y, b.y), abs(a.x - b.x), abs(a.y - b.y))

    @property
    def length(self) -> float:
        """The length of the line, in pixels."""
        return sum(abs(a.x - b.x) + abs(a.y - b.y) for part in self.parts for a, b in pairwise(part))

    @property
    def turned(self) -> Route:
        parts = tuple(tuple(point.turned for point in part) for part in self.parts)
        return Route(parts, self.label.turned if self.label else None)


class Layout(Record, frozen=True):
    """Boxes by the names of nodes, routes in the order of the links. Everything is within `size`."""

    size: Extent
    nodes: Mapping[str, Box]
    routes: tuple[Route, ...]

    @property
    def turned(self) -> Layout:
        boxes = {name: box.turned for name, box in self.nodes.items()}
        return Layout(self.size.turned, boxes, tuple(route.turned for route in self.routes))

    @property
    def mirrored(self) -> Layout:
        """The layout with its left and right sides exchanged."""

        def box(old: Box) -> Box:
            return Box(self.size.width - old.right, old.y, old.width, old.height)

        routes = tuple(
            Route(
                tuple(tuple(Point(self.size.width - x, y) for x, y in part) for part in route.parts),
                box(route.label) if route.label else None,
            )
            for route in self.routes
        )
        return Layout(self.size, {name: box(old) for name, old in self.nodes.items()}, routes)


def at_origin(boxes: Mapping[str, Box], routes: Sequence[Route]) -> Layout:
    """A layout moved so that its upper left corner is the origin."""
    areas = [*boxes.values(), *(route.label for route in routes if route.label)]
    points = [point for route in routes for part in route.parts for point in part]
    left = min([area.x for area in areas] + [point.x for point in points])
    top = min([area.y for area in areas] + [point.y for point in points])
    right = max([area.right for area in areas] + [point.x for point in points])
    bottom = max([area.bottom for area in areas] + [point.y for point in points])
    return Layout(
        Extent(right - left, bottom - top),
        {name: box.moved(-left, -top) for name, box in boxes.items()},
        tuple(route.moved(-left, -top) for route in routes),
    )

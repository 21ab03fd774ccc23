# SPDX-License-Identifier: Apache-2.0
"""Points, sizes and boxes, in pixels; y grows downwards."""

from __future__ import annotations

from typing import NamedTuple


class Point(NamedTuple):
    x: float
    y: float

    @property
    def turned(self) -> Point:
        """The point with its axes exchanged."""
        return Point(self.y, self.x)


class Extent(NamedTuple):
    width: float
    height: float

    @property
    def turned(self) -> Extent:
        return Extent(self.height, self.width)


class Box(NamedTuple):
    x: float
    y: float
    width: float
    height: float

    @property
    def right(self) -> float:
        return self.x + self.width

    @property
    def bottom(self) -> float:
        return self.y + self.height

    @property
    def turned(self) -> Box:
        return Box(self.y, self.x, self.height, self.width)

    def moved(self, dx: float, dy: float) -> Box:
        return Box(self.x + dx, self.y + dy, self.width, self.height)

    def grown(self, margin: float) -> Box:
        """The box with a margin on every side; a negative margin shrinks it."""
        return Box(self.x - margin, self.y - margin, self.width + 2 * margin, self.height + 2 * margin)

    def overlaps(self, other: Box) -> bool:
        """Whether both boxes have a common area. A common border is not an area."""
        return self.x < other.right and other.x < self.right and self.y < other.bottom and other.y < self.bottom

    def contains(self, other: Box) -> bool:
        return self.x <= other.x and other.right <= self.right and self.y <= other.y and other.bottom <= self.bottom

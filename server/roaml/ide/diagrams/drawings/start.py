# SPDX-License-Identifier: Apache-2.0
"""The dot before the initial state, beside this state where there is space."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.figures.geometry import Box, Point
from roaml.figures.layout import LayoutDirection, Route

DOT = 10.0
"""The diameter of the dot, in pixels."""
_LENGTH = 28.0
_CLEARANCE = 12.0
_CORNER, _STEP = 14.0, 12.0
"""Distances in pixels: of the dot from its state, of dot and line from everything else, of the line from the corners of
the state, and of two places that are tried."""
_SIDES = {
    LayoutDirection.RIGHT: (Point(-1, 0), Point(0, -1), Point(0, 1)),
    LayoutDirection.DOWN: (Point(0, -1), Point(-1, 0), Point(1, 0)),
}
"""The sides of a state in the order in which they are tried: first where lines usually come from."""


def start_beside(state: Box, solid: Sequence[Box], direction: LayoutDirection) -> tuple[Box, Route] | None:
    """The dot, and the line from it to the state; `None` if each place covers something.

    Args:
        solid: the areas of everything but the state.
    """
    for side in _SIDES[direction]:
        for end in _ends(state, side):
            center = Point(end.x + side.x * (_LENGTH + DOT / 2), end.y + side.y * (_LENGTH + DOT / 2))
            dot = Box(center.x - DOT / 2, center.y - DOT / 2, DOT, DOT)
            begin = Point(center.x - side.x * DOT / 2, center.y - side.y * DOT / 2)
            left, top = min(dot.x, end.x - DOT / 2 * abs(side.y)), min(dot.y, end.y - DOT / 2 * abs(side.x))
            width, height = (DOT, DOT + _LENGTH) if side.y else (DOT + _LENGTH, DOT)
            area = Box(left, top, width, height).grown(_CLEARANCE)
            if not any(area.overlaps(other) for other in solid):
                return dot, Route(((begin, end),))
    return None


def _ends(state: Box, side: Point) -> Iterator[Point]:
    """Places at a side of a state, from its middle to its corners."""
    size = state.width if side.y else state.height
    x = state.x + state.width / 2 * (1 + side.x)
    y = state.y + state.height / 2 * (1 + side.y)
    for number in range(int(max(0.0, size / 2 - _CORNER) / _STEP) + 1):
        for shift in {-number * _STEP, number * _STEP}:
            yield Point(x + shift * abs(side.y), y + shift * abs(side.x))

# SPDX-License-Identifier: Apache-2.0
"""Names beside lines, where there is space."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.figures.drawing import TextItem
from roaml.figures.geometry import Box
from roaml.figures.layout import Route
from roaml.figures.text import SMALL, text_width

HEIGHT = 15.0
"""The height of the area of a name, in pixels."""
_PADDING, _GAP = 3.0, 2.0
_FROM_ENDS = 14.0
"""The minimum distance of a name from the ends of its piece of the line, where corners and arrow heads are, in
pixels."""
_STEP = 24.0
_MAX_PLACES = 40


class LineNames:
    """Finds places for names one after the other: above or below a horizontal piece of the line, where the name covers
    nothing.

    Args:
        solid: the areas that names must not cover.
        routes: all lines.
        width, height: the size of the drawing, in pixels.
    """

    def __init__(self, solid: Sequence[Box], routes: Sequence[Route], width: float, height: float) -> None:
        self._page = Box(0.0, 0.0, width, height)
        self._taken = [*solid, *(piece.grown(_GAP) for route in routes for piece in route.pieces)]

    def place(self, name: str, route: Route) -> TextItem | None:
        """The text near the middle of the longest piece that has space, first above it; `None` if none has."""
        width = text_width(name, SMALL) + 2 * _PADDING
        level = [piece for piece in route.pieces if not piece.height and piece.width >= width + 2 * _FROM_ENDS]
        for piece in sorted(level, key=lambda piece: -piece.width):
            for top in (piece.y - _GAP - HEIGHT - 0.5, piece.y + _GAP + 0.5):
                row = Box(piece.x, top, piece.width, HEIGHT)
                near = [taken for taken in self._taken if taken.overlaps(row)]
                for x in _places(piece, width):
                    box = Box(x, top, width, HEIGHT)
                    if self._page.contains(box) and not any(box.overlaps(taken) for taken in near):
                        self._taken.append(box.grown(_PADDING))
                        return TextItem(name, x + _PADDING, box.bottom - 3.5, SMALL, "text")
        return None


def _places(piece: Box, width: float) -> Iterator[float]:
    """The left ends of a name beside a piece of a line, from its middle to its ends."""
    low, high = piece.x + _FROM_ENDS, piece.right - _FROM_ENDS - width
    middle = (low + high) / 2
    yield middle
    for number in range(1, min(_MAX_PLACES, int((high - low) / 2 / _STEP)) + 1):
        yield from (middle - number * _STEP, middle + number * _STEP)

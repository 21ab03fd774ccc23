# SPDX-License-Identifier: Apache-2.0
"""Where the names of lines are, if they are written beside the ends of the lines."""

from __future__ import annotations

from collections.abc import Sequence

from roaml.figures.layout.spread import spread


def label_heights(lines: Sequence[Sequence[float]], distance: float, low: float, high: float) -> list[float]:
    """The vertical position of the name of each line, in pixels: as near to the end of the line as the others permit.

    Lines that end at the same height have their names in the order in which they arrive there. The name of a line
    without points is the last.

    Args:
        lines: the vertical positions of the points of each line, in pixels.
        distance: the minimum distance of two names.
        low, high: the least and the greatest position of a name.
    """
    arriving = [[round(height) for height in reversed(line)] or [round(high)] for line in lines]
    order = sorted(range(len(lines)), key=lambda number: arriving[number])
    ends = [float(arriving[number][0]) for number in order]
    placed = spread(ends, [distance] * (len(ends) - 1), low=low, high=high)
    heights = dict(zip(order, placed, strict=True))
    return [heights[number] for number in range(len(lines))]

# SPDX-License-Identifier: Apache-2.0
"""A diagram of times by sizes, with logarithmic scales on both axes. Linear growth is parallel to the grey lines."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

WIDTH, HEIGHT, MARGIN = 560, 380, 56
COLORS = ("#1f6feb", "#c2410c", "#15803d")

Point = tuple[float, float]
"""The place of the plot in the picture."""


def svg(
    series: Mapping[str, Sequence[Point]],
    across: str = "size of the JANI file in MB",
    up: str = "translating and writing in s",
) -> str:
    """A diagram as SVG.

    Args:
        series: name -> points. All numbers are positive.
        across, up: the labels of the axes.
    """
    return "".join(f"{line}\n" for line in _lines(series, across, up))


def _lines(series: Mapping[str, Sequence[Point]], across: str, up: str) -> Iterator[str]:
    points = [point for line_points in series.values() for point in line_points]
    (left, right), (low, high) = (_decades([point[axis] for point in points]) for axis in (0, 1))

    def place(size: float, took: float) -> str:
        x = MARGIN + (math.log10(size) - left) / (right - left) * (WIDTH - 2 * MARGIN)
        y = HEIGHT - MARGIN - (math.log10(took) - low) / (high - low) * (HEIGHT - 2 * MARGIN)
        return f"{x:.1f},{y:.1f}"

    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
        'font-size="12"><rect width="100%" height="100%" fill="white"/>'
    )
    for decade in range(left - high, right - low):
        ends = [(10.0**x, 10.0 ** (x - decade)) for x in (max(left, decade + low), min(right, decade + high))]
        if ends[0] < ends[1]:
            yield f'<polyline points="{" ".join(place(*end) for end in ends)}" stroke="#ddd" fill="none"/>'
    for x in range(left, right + 1):
        at, _, _ = place(10.0**x, 10.0**low).partition(",")
        yield f'<text x="{at}" y="{HEIGHT - MARGIN + 18}" text-anchor="middle">{10.0**x:g}</text>'
    for y in range(low, high + 1):
        _, _, at = place(10.0**left, 10.0**y).partition(",")
        yield f'<text x="{MARGIN - 8}" y="{at}" text-anchor="end" dominant-baseline="middle">{10.0**y:g}</text>'
    frame = [(10.0**left, 10.0**high), (10.0**left, 10.0**low), (10.0**right, 10.0**low)]
    yield f'<polyline points="{" ".join(place(*corner) for corner in frame)}" stroke="black" fill="none"/>'
    yield f'<text x="{WIDTH / 2}" y="{HEIGHT - 14}" text-anchor="middle">{across}</text>'
    yield f'<text x="14" y="{MARGIN - 24}">{up}</text>'
    for number, (name, curve) in enumerate(series.items()):
        color = COLORS[number % len(COLORS)]
        yield f'<polyline curve="{" ".join(place(*p) for p in points)}" stroke="{color}" fill="none" stroke-width="2"/>'
        for point in curve:
            x, _, y = place(*point).partition(",")
            yield f'<circle cx="{x}" cy="{y}" r="3.5" fill="{color}"/>'
        yield f'<text x="{MARGIN + 14}" y="{MARGIN + 16 * number}" fill="{color}">{name}</text>'
    yield "</svg>"


def _decades(values: Sequence[float]) -> tuple[int, int]:
    """The powers of ten around all values."""
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    return low, max(high, low + 1)

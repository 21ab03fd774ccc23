# SPDX-License-Identifier: Apache-2.0
"""Symbols for kinds of tree nodes and for random choices, as strokes in the unit square, so that no font is needed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from roaml.figures.drawing import Glyph, Outline, Shape
from roaml.figures.geometry import Box, Point
from roaml.ide.diagrams.diagram import DiagramNode, DiagramNodeKind

BADGE = 18.0
"""The width and height of a symbol, in pixels."""
_Strokes = tuple[tuple[Point, ...], ...]


def _strokes(*lines: Sequence[tuple[float, float]]) -> _Strokes:
    return tuple(tuple(Point(x, y) for x, y in line) for line in lines)


def _arc(x: float, y: float, radius: float, start: float, end: float) -> list[tuple[float, float]]:
    """Points of an arc; angles in degrees, clockwise from the right."""
    steps = max(4, round(abs(end - start) / 30))
    angles = (math.radians(start + (end - start) * step / steps) for step in range(steps + 1))
    return [(x + radius * math.cos(angle), y + radius * math.sin(angle)) for angle in angles]


_SEQUENCE = _strokes([(0.2, 0.5), (0.78, 0.5)], [(0.55, 0.28), (0.78, 0.5), (0.55, 0.72)])
_FALLBACK = _strokes([*_arc(0.5, 0.36, 0.18, -180, 90), (0.5, 0.64)], [(0.5, 0.8), (0.5, 0.81)])
_PARALLEL = _strokes(
    [(0.2, 0.34), (0.78, 0.34)], [(0.63, 0.2), (0.78, 0.34), (0.63, 0.48)],
    [(0.2, 0.68), (0.78, 0.68)], [(0.63, 0.54), (0.78, 0.68), (0.63, 0.82)],
)  # fmt: skip
_BRANCHES = _strokes(
    [(0.5, 0.2), (0.5, 0.5)], [(0.22, 0.8), (0.22, 0.5), (0.78, 0.5), (0.78, 0.8)], [(0.5, 0.5), (0.5, 0.8)]
)
_DIAMOND = _strokes([(0.5, 0.18), (0.82, 0.5), (0.5, 0.82), (0.18, 0.5), (0.5, 0.18)])
_PLAY = _strokes([(0.32, 0.22), (0.78, 0.5), (0.32, 0.78), (0.32, 0.22)])
_CHECK = _strokes([(0.2, 0.52), (0.42, 0.74), (0.8, 0.28)])
_SUBTREE = _strokes(
    [(0.36, 0.18), (0.64, 0.18), (0.64, 0.4), (0.36, 0.4), (0.36, 0.18)], [(0.5, 0.4), (0.5, 0.56)],
    [(0.24, 0.82), (0.24, 0.56), (0.76, 0.56), (0.76, 0.82)],
)  # fmt: skip

_DOTS = [(0.2, 0.2), (0.8, 0.2), (0.5, 0.5), (0.2, 0.8), (0.8, 0.8)]
_DIE = _strokes(*([(x - 0.05, y), (x + 0.05, y)] for x, y in _DOTS))

_KINDS: Mapping[DiagramNodeKind, _Strokes] = {
    DiagramNodeKind.CONTROL: _BRANCHES,
    DiagramNodeKind.DECORATOR: _DIAMOND,
    DiagramNodeKind.ACTION: _PLAY,
    DiagramNodeKind.CONDITION: _CHECK,
    DiagramNodeKind.SUBTREE: _SUBTREE,
}
_CONTROLS = (("Sequence", _SEQUENCE), ("Fallback", _FALLBACK), ("Parallel", _PARALLEL))
"""Parts of names of control nodes, with the symbols that publications on behavior trees use for these nodes."""


def die(box: Box, size: float) -> Glyph:
    """The five of a die in the middle of a box: a random choice. `size` is its width and height, in pixels."""
    return Glyph(Box(box.x + (box.width - size) / 2, box.y + (box.height - size) / 2, size, size), _DIE)


def badge(node: DiagramNode, x: float, y: float) -> tuple[Shape, Glyph] | None:
    """The symbol of a node in a square with the color of its kind; `None` if the kind has no symbol."""
    strokes = _KINDS.get(node.kind)
    if strokes is None:
        return None
    if node.kind is DiagramNodeKind.CONTROL and node.title is not None:
        strokes = next((symbol for part, symbol in _CONTROLS if part in node.title.plugin), strokes)
    box = Box(x, y, BADGE, BADGE)
    return Shape(box, Outline.RECTANGLE, "badge"), Glyph(box, strokes)

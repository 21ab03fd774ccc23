# SPDX-License-Identifier: Apache-2.0
"""Geometric checks of a drawing."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations

from roaml.figures.drawing import Drawing, Glyph, Group, Polyline, Shape, TextItem
from roaml.figures.geometry import Box, Point
from roaml.ide.diagrams import EdgeKind, Picture

SOLID = ("card", "label-card", "junction", "dot")
"""The shapes that must not be overlapped."""
MIN_SIZE = 11.0
_NEAR = 0.05
_APART = 3.0
"""The distance below which two parallel lines look like one."""


def problems(picture: Picture, drawing: Drawing) -> list[str]:
    """Descriptions of the errors; empty if the drawing is correct."""
    return [*_areas(drawing), *_texts(drawing), *_lines(drawing), *_completeness(picture, drawing)]


def _areas(drawing: Drawing) -> Iterator[str]:
    page = Box(0, 0, *drawing.size).grown(_NEAR)
    solid = [item.box for _, item in drawing.walk() if isinstance(item, Shape) and item.role in SOLID]
    for a, b in combinations(solid, 2):
        if a.overlaps(b):
            yield f"two shapes overlap: {a}, {b}"
    for _, item in drawing.walk():
        boxes = [item.box] if not isinstance(item, Polyline) else [Box(x, y, 0, 0) for x, y in item.points]
        yield from (f"outside of the drawing: {item}" for box in boxes if not page.contains(box))
    frames = [item.box for _, item in drawing.walk() if isinstance(item, Shape) and item.role == "frame"]
    for frame in frames:
        for box in solid:
            if frame.overlaps(box) and not frame.contains(box):
                yield f"a frame cuts a shape: {frame}, {box}"


def _texts(drawing: Drawing) -> Iterator[str]:
    texts = [(groups, item) for groups, item in drawing.walk() if isinstance(item, TextItem)]
    solid = [item.box for _, item in drawing.walk() if isinstance(item, Shape) and item.role in SOLID]
    for groups, text in texts:
        if text.size < MIN_SIZE:
            yield f"small text: {text}"
        if not text.text.strip():
            yield f"a text without letters: {text}"
        around = [item for group in groups for item in group.items if isinstance(item, Shape)]
        if groups[-1].role == "line-name":
            yield from (f"a name of a line on a card: {text}" for card in solid if card.overlaps(text.box))
            continue
        card = next((item for item in around if item.role in ("card", "label-card", "frame")), None)
        if card is None or not card.box.grown(-1).contains(text.box):
            yield f"a text leaves its card: {text}"
        for shape in around if card is not None else ():
            if shape.role in ("bar", "badge") and not _is_inside(shape.box, card):
                yield f"a symbol leaves its card: {shape}"
        if card is not None and not _is_inside(text.box, card):
            yield f"a text is in a round corner: {text}"
        for shape in around:
            if shape.role in ("bar", "badge") and shape.box.overlaps(text.box):
                yield f"a text on a symbol: {text}"
    for (_, a), (_, b) in combinations(texts, 2):
        if a.box.overlaps(b.box):
            yield f"two texts overlap: {a.text!r}, {b.text!r}"


def _is_inside(box: Box, card: Shape) -> bool:
    """Whether a box is inside a card with round corners."""
    radius, outer = card.rounding, card.box
    for x in (box.x, box.right):
        for y in (box.y, box.bottom):
            dx = max(outer.x + radius - x, x - (outer.right - radius), 0.0)
            dy = max(outer.y + radius - y, y - (outer.bottom - radius), 0.0)
            if dx and dy and math.hypot(dx, dy) > radius + _NEAR:
                return False
    return True


def _lines(drawing: Drawing) -> Iterator[str]:
    solid = [item.box for _, item in drawing.walk() if isinstance(item, Shape) and item.role in SOLID]
    solid += [item.box for _, item in drawing.walk() if isinstance(item, TextItem | Glyph)]
    segments: list[tuple[tuple[Group, ...], Point, Point]] = []
    for groups, item in drawing.walk():
        if isinstance(item, Polyline) and item.role == "line":
            segments += [(groups, a, b) for a, b in zip(item.points, item.points[1:], strict=False)]
    for _, a, b in segments:
        if a.x != b.x and a.y != b.y:
            yield f"a slanted line: {a}, {b}"
        area = Box(min(a.x, b.x), min(a.y, b.y), abs(a.x - b.x), abs(a.y - b.y))
        yield from (f"a line crosses {box}: {a}, {b}" for box in solid if _crosses(area, box))
    for (first, a, b), (second, c, d) in combinations(segments, 2):
        if first != second and "child" not in first[-1].kind and _coincide((a, b), (c, d)):
            yield f"two lines coincide: {a}, {b} and {c}, {d}"


def _crosses(line: Box, box: Box) -> bool:
    inner = box.grown(-_NEAR)
    return (
        line.x < inner.right and inner.x < line.right and line.y < inner.bottom and inner.y < line.bottom
        if (line.width and line.height)
        else (line.x <= inner.right and inner.x <= line.right and line.y <= inner.bottom and inner.y <= line.bottom)
    )


def _coincide(first: Sequence[Point], second: Sequence[Point]) -> bool:
    """Whether two straight lines are parallel, near, and beside each other."""
    (a, b), (c, d) = first, second
    for axis in (0, 1):
        other = 1 - axis
        if a[axis] == b[axis] and c[axis] == d[axis] and abs(a[axis] - c[axis]) < _APART:
            low = max(min(a[other], b[other]), min(c[other], d[other]))
            high = min(max(a[other], b[other]), max(c[other], d[other]))
            if high - low > _NEAR:
                return True
    return False


def _completeness(picture: Picture, drawing: Drawing) -> Iterator[str]:
    """Every edge is drawn, and every node except choices that are rows of their state."""
    groups = {id(group): group for around, _ in drawing.walk() for group in around}.values()
    edges = {index for group in groups for index in group.edges}
    yield from (f"not drawn: {edge}" for index, edge in enumerate(picture.edges) if index not in edges)
    with_line = {
        index for group in groups for index in group.edges if any(isinstance(item, Polyline) for item in group.items)
    }
    boxes = {node.id for index, node in enumerate(picture.nodes) if index in drawing.nodes}
    for index, edge in enumerate(picture.edges):
        is_port = edge.kind in (EdgeKind.READS, EdgeKind.WRITES)
        if (
            edge.source != edge.target
            and {edge.source, edge.target} <= boxes
            and not is_port
            and index not in with_line
        ):
            yield f"no line: {edge}"
    nodes = {group.node for group in groups if group.node is not None}
    for index, node in enumerate(picture.nodes):
        if index not in nodes and node.kind.value != "choice":
            yield f"not drawn: {node}"
    for index, box in drawing.nodes.items():
        if picture.nodes[index].kind.value != "thread" and not box.width > 0 < box.height:
            yield f"no size: {picture.nodes[index]}"

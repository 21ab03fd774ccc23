# SPDX-License-Identifier: Apache-2.0
"""Drawings as SVG: for a view, which has its own style sheet, or as a file with a style sheet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from html import escape

from roaml.exhaustive import assert_never
from roaml.figures.drawing import Area, Drawing, Glyph, Group, Leaf, Outline, Polyline, Shape, TextItem
from roaml.figures.geometry import Box, Point
from roaml.figures.themes import AUTOMATIC, THEMES, file_style

MARGIN = 16.0
_CORNER = 6.0
_HEAD = (9.0, 4.5)
"""The length and half the width of an arrow head, in pixels."""


PICTURE_STYLES, TIMELINE_STYLES = ("figure.css",), ("figure.css", "timeline.css")
PLOT_STYLES = ("figure.css", "plot.css")
CHANGE_STYLES = ("figure.css", "changes.css")


def svg_file(
    drawing: Drawing,
    title: str,
    theme: str = "light",
    styles: tuple[str, ...] = PICTURE_STYLES,
    description: str = "",
) -> str:
    """The text of an SVG file.

    Args:
        theme: one of `THEMES`, or `AUTOMATIC`: light, or dark if the reader prefers dark colors.
        styles: the names of the style sheets.
        description: what the drawing shows, for readers who do not see it.
    """
    width, height = drawing.size.width + 2 * MARGIN, drawing.size.height + 2 * MARGIN
    area = f'x="{_n(-MARGIN)}" y="{_n(-MARGIN)}" width="{_n(width)}" height="{_n(height)}"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{_n(-MARGIN)} {_n(-MARGIN)} {_n(width)} {_n(height)}" '
        f'width="{_n(width)}" height="{_n(height)}" role="img">\n'
        f"<title>{escape(title)}</title>\n"
        f"{f'<desc>{escape(description)}</desc>{chr(10)}' if description else ''}"
        f"<style>\n{file_style(theme, styles)}</style>\n"
        f'<rect class="paper" {area} fill="{THEMES["light" if theme == AUTOMATIC else theme]["background"]}"/>\n'
        f"{svg_scene(drawing, has_keys=False)}</svg>\n"
    )


def svg_scene(drawing: Drawing, *, has_keys: bool = True) -> str:
    """The group that contains the whole drawing. The groups of nodes and edges have their indexes as data.

    Args:
        has_keys: whether the keys of groups are data, too. Only views need them. A group of one rectangle is then this
            rectangle.
    """
    groups = "".join(_group(group, has_keys=has_keys) for group in drawing.groups)
    return f'<g class="scene">\n{groups}</g>\n'


def _group(group: Group, *, has_keys: bool) -> str:
    classes = [group.role, f"tone-{group.tone.value}", *(f"is-{kind}" for kind in group.kind.split())]
    data = f' data-node="{group.node}"' if group.node is not None else ""
    data += f' data-edges="{" ".join(map(str, group.edges))}"' if group.edges else ""
    data += f' data-step="{group.step}"' if group.step is not None else ""
    data += f' data-key="{escape(group.key)}"' if group.key and has_keys else ""
    hint = f"<title>{escape(group.hint)}</title>" if group.hint else ""
    item = group.items[0] if len(group.items) == 1 else None
    if has_keys and not group.kind and isinstance(item, Shape) and item.outline is Outline.RECTANGLE:
        # In a view, every element takes time.
        shape = _rectangle(item.box, item.rounding, " ".join((*classes, item.role)), data)
        return f"{shape.removesuffix('/>')}>{hint}</rect>\n" if hint else f"{shape}\n"
    items = "".join(
        _group(item, has_keys=has_keys) if isinstance(item, Group) else "".join(_item(item)) for item in group.items
    )
    return f'<g class="{" ".join(classes)}"{data}>{hint}{items}</g>\n'


def _item(item: Leaf) -> Iterator[str]:
    match item:
        case Shape():
            yield from _shape(item)
        case TextItem():
            role = f"{item.role} strong" if item.bold else item.role
            place = f'x="{_n(item.x)}" y="{_n(item.y)}" font-size="{_n(item.size)}"'
            yield f'<text class="{role}" {place}>{escape(item.text, quote=False)}</text>'
        case Polyline():
            yield f'<path class="{item.role}" d="{path(_shortened(item), _CORNER if item.is_round else 0.0)}"/>'
            if item.has_arrow:
                yield f'<polygon class="head" points="{_points(_head(item.points))}"/>'
        case Area():
            yield f'<polygon class="{item.role}" points="{_points(item.points)}"/>'
        case Glyph():
            x, y, width, height = item.box
            for stroke in item.strokes:
                placed = [Point(x + width * point.x, y + height * point.y) for point in stroke]
                yield f'<polyline class="glyph" points="{_points(placed)}"/>'
        case _:
            assert_never(item)


def _shape(shape: Shape) -> Iterator[str]:
    match shape.outline:
        case Outline.RECTANGLE | Outline.ROUNDED | Outline.PILL:
            yield _rectangle(shape.box, shape.rounding, shape.role)
        case Outline.DOUBLE:
            yield _rectangle(shape.box, shape.rounding, shape.role)
            yield _rectangle(shape.box.grown(-3), 2, f"{shape.role} inner")
        case Outline.HEXAGON:
            yield _cut(shape, min(8, shape.box.height / 2), shape.box.height / 2)
        case Outline.CUT:
            yield _cut(shape, 7, 7)
        case _:
            assert_never(shape.outline)


def _cut(shape: Shape, dx: float, dy: float) -> str:
    """A rectangle whose corners are cut off."""
    x, y, right, bottom = shape.box.x, shape.box.y, shape.box.right, shape.box.bottom
    corners = (
        ((x + dx, y), (right - dx, y), (right, y + dy), (right, bottom - dy)),
        ((right - dx, bottom), (x + dx, bottom), (x, bottom - dy), (x, y + dy)),
    )
    points = [Point(*corner) for side in corners for corner in side]
    return f'<polygon class="{shape.role}" points="{_points(points)}"/>'


def _rectangle(box: Box, radius: float, role: str, data: str = "") -> str:
    place = f'x="{_n(box.x)}" y="{_n(box.y)}" width="{_n(box.width)}" height="{_n(box.height)}"'
    return f'<rect class="{role}"{data} {place} rx="{_n(radius)}"/>'


def path(points: Sequence[Point], radius: float = _CORNER) -> str:
    """A polyline as the attribute `d` of a `<path>` in SVG, with corners of a radius in pixels."""
    if not radius:
        return "M " + " L ".join(f"{_n(point.x)} {_n(point.y)}" for point in points)
    parts = [f"M {_n(points[0].x)} {_n(points[0].y)}"]
    for before, corner, after in zip(points, points[1:], points[2:], strict=False):
        bend = min(radius, math.dist(before, corner) / 2, math.dist(corner, after) / 2)
        start, end = _towards(corner, before, bend), _towards(corner, after, bend)
        parts.append(f"L {_n(start.x)} {_n(start.y)} Q {_n(corner.x)} {_n(corner.y)} {_n(end.x)} {_n(end.y)}")
    parts.append(f"L {_n(points[-1].x)} {_n(points[-1].y)}")
    return " ".join(parts)


def _shortened(line: Polyline) -> tuple[Point, ...]:
    """The line, shortened to the middle of its arrow head, so that it does not cover the tip."""
    if not line.has_arrow:
        return line.points
    *rest, before, tip = line.points
    return (*rest, before, _towards(tip, before, min(_HEAD[0] / 2, math.dist(tip, before))))


def _head(points: Sequence[Point]) -> tuple[Point, Point, Point]:
    before, tip = points[-2:]
    length, half = _HEAD
    base = _towards(tip, before, length)
    whole = math.dist(before, tip) or 1
    dx, dy = (tip.x - before.x) / whole * half, (tip.y - before.y) / whole * half
    return tip, Point(base.x - dy, base.y + dx), Point(base.x + dy, base.y - dx)


def _towards(start: Point, end: Point, length: float) -> Point:
    whole = math.dist(start, end) or 1
    return Point(start.x + (end.x - start.x) * length / whole, start.y + (end.y - start.y) * length / whole)


def _points(points: Sequence[Point]) -> str:
    return " ".join(f"{_n(point.x)},{_n(point.y)}" for point in points)


def _n(number: float) -> str:
    """A number as text, with at most one decimal."""
    return f"{round(number, 1):g}" if abs(number) < 1e5 else f"{number:.0f}"

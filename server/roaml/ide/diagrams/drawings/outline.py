# SPDX-License-Identifier: Apache-2.0
"""The drawing of a behavior tree as an outline: a row for each node, with its children indented below.

A row has the symbol, the name, the plugin and the number of its node, then its ports, scripts and mock, continued in
further lines if necessary. Of several constant ports, those are shown for which the last line has space; a hover shows
the others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from roaml.figures.drawing import MAX_ROUNDING, Drawing, Group, Item, Outline, Shape
from roaml.figures.geometry import Box, Extent
from roaml.figures.layout import outline
from roaml.figures.layout.outline import INDENT, rows
from roaml.figures.text import ELLIPSIS, MEDIUM, wrap
from roaml.ide.diagrams.diagram import DetailKind, DiagramNode, DiagramNodeKind, Picture
from roaml.ide.diagrams.drawings.cards import NO_NAME, PADDING, Row, TextLine, paragraph, row_items
from roaml.ide.diagrams.drawings.changes import kind_of, tone_of
from roaml.ide.diagrams.drawings.glyphs import BADGE, badge
from roaml.ide.diagrams.drawings.tree import (
    OUTLINES,
    TONES,
    children_of,
    common_texts,
    hidden_row,
    links,
    port_rows,
    subtitle,
    with_blackboard,
)

OUTLINE_WIDTHS = (380.0, 860.0)
"""The widths of whole drawings, in pixels, if no node is too deep: they are legible in panels of 400 and 840 pixels. In
the wide drawing, most nodes need one line."""
_MIN_TEXT_WIDTH = 180.0
"""The width of the lines of a node that is too deep, in pixels."""
MAX_LINES = 2
"""The maximum number of lines of a port, condition or script."""
_BADGE_DISTANCE = 7.0
_CHIP_DISTANCE = 12.0
_PADDING = 5.0
"""The distances between the symbol and the name, between texts in a line, and of the lines from the edges above and
below, in pixels."""


def draw_outline(picture: Picture, width: float = OUTLINE_WIDTHS[0]) -> Drawing:
    """The outline of a tree; its lines have at most a width in pixels."""
    index = {node.id: number for number, node in enumerate(picture.nodes)}
    children = children_of(picture)
    variables = [node.id for node in picture.nodes if node.kind is DiagramNodeKind.VARIABLE]
    written = [node.id for node in picture.nodes if node.kind is not DiagramNodeKind.VARIABLE]
    depths = dict(rows(dict.fromkeys(written), children))
    common = common_texts(picture)
    available = {name: width - depth * INDENT for name, depth in depths.items()}
    available |= dict.fromkeys(variables, OUTLINE_WIDTHS[0])
    cards = {name: _Lines(picture, picture.nodes[index[name]], own, common) for name, own in available.items()}
    layout = outline({name: cards[name].size for name in written}, children)
    boxes, size = with_blackboard(layout.nodes, layout.size, {name: cards[name].size for name in variables})
    groups = links(picture, children, layout.routes)
    groups += [cards[name].group(index[name], box) for name, box in boxes.items()]
    return Drawing(size, tuple(groups), {index[name]: box for name, box in boxes.items()})


class _Lines:
    """The texts of a node, in lines.

    Args:
        available: the maximum width of the node, in pixels.
        common: the number of nodes with each constant; constants that few have come first.
    """

    def __init__(self, picture: Picture, node: DiagramNode, available: float, common: Mapping[str, int]) -> None:
        self.node = node
        self.shape = OUTLINES.get(node.kind, Outline.ROUNDED)
        self.side = 0.0 if node.title is None else BADGE + _BADGE_DISTANCE
        # The ends of conditions are round, those of decorators slanted.
        inset = {Outline.PILL: MAX_ROUNDING / 2, Outline.HEXAGON: 6.0, Outline.DOUBLE: 3.0}.get(self.shape, 0.0)
        width = max(_MIN_TEXT_WIDTH, available - self.side - 2 * (PADDING + inset))
        self.lines = _filled(*_texts(picture, node, width, common), width)
        across = max(map(_width, self.lines)) + self.side + 2 * PADDING
        height = max(BADGE, sum(map(_height, self.lines))) + 2 * _PADDING
        if self.shape is Outline.PILL:
            inset = min(height / 2, MAX_ROUNDING) / 2
        self.inset = inset
        self.size = Extent(round(across + 2 * inset + 0.5), round(height + 0.5))

    def group(self, index: int, box: Box) -> Group:
        node = self.node
        items: list[Item] = [Shape(box, self.shape, "card")]
        left, y = box.x + PADDING + self.inset, box.y + (box.height - sum(map(_height, self.lines))) / 2
        items += badge(node, left, y + (self.lines[0][0].lines[0].height - BADGE) / 2) or ()
        for line in self.lines:
            x, height = left + self.side, _height(line)
            first = max(row.lines[0].height for row in line)
            for row in line:
                items += row_items(row, x, y + (first - row.lines[0].height) / 2)
                x += row.size.width + _CHIP_DISTANCE
            y += height
        kind = kind_of(node.change, f"{node.kind.value} initial" if node.initial else node.kind.value)
        return Group("node", tone_of(node.change, TONES[node.kind]), tuple(items), kind, node=index)


def _texts(picture: Picture, node: DiagramNode, width: float, common: Mapping[str, int]) -> tuple[list[Row], list[Row]]:
    """The texts of a node that are shown in any case, and its constants; no line is wider."""
    name = f"{{{node.label}}}" if node.title is None else node.title.name.strip() or NO_NAME
    short = wrap(name, MEDIUM, width, bold=True, limit=1)
    texts = [Row((TextLine(short[0], MEDIUM, "title", bold=True),), hint=name if short[0] != name else "")]
    if node.title is None:
        return texts, []
    numbered: list[tuple[int, Row]] = []
    if subtitle(node.title):
        texts.append(Row(paragraph(subtitle(node.title), width, "muted", limit=1)))
    for detail, row in zip(node.details, port_rows(picture, node, width, MAX_LINES), strict=True):
        if detail.kind is DetailKind.CONSTANT:
            numbered.append((common[detail.text], row))
        else:
            texts.append(row)
    constants = [row for _, row in sorted(numbered, key=lambda pair: pair[0])]
    return (texts, constants) if len(constants) > 1 else (texts + constants, [])


def _filled(texts: Sequence[Row], constants: Sequence[Row], width: float) -> list[list[Row]]:
    """Lines of texts that are at most as wide, with the constants for which they have space."""
    lines: list[list[Row]] = [[]]
    reserved = [hidden_row(ELLIPSIS, constants)] if constants else []
    for row in texts:
        if lines[-1] and _width([*lines[-1], row, *reserved]) > width:
            lines.append([])
        lines[-1].append(row)
    hidden: list[Row] = []
    for row in constants:
        rest = reserved if hidden or row is not constants[-1] else []
        (lines[-1] if _width([*lines[-1], row, *rest]) <= width else hidden).append(row)
    if hidden:
        lines[-1].append(hidden_row(ELLIPSIS, hidden))
    return lines


def _width(line: Sequence[Row]) -> float:
    return sum(row.size.width for row in line) + _CHIP_DISTANCE * (len(line) - 1)


def _height(line: Sequence[Row]) -> float:
    return max(row.size.height for row in line)

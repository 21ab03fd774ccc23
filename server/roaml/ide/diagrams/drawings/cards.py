# SPDX-License-Identifier: Apache-2.0
"""Cards, which consist of rows of text: their size, and the items to draw at a position."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.figures.drawing import Group, Item, Outline, Polyline, Shape, TextItem, Tone
from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.text import LINE_HEIGHT, MEDIUM, SMALL, text_width, wrap
from roaml.record import Record

PADDING = 10.0
"""The default distance of the rows of a card from its edge, in pixels."""
NO_NAME = "(no name)"
_ROW_DISTANCE = 5.0
_BAR_WIDTH, _BAR_DISTANCE = 3.0, 7.0
_INDENT = 10.0


class TextLine(Record, frozen=True):
    """A line of a row; `size`, the size of the letters, and `indent` are in pixels."""

    text: str
    size: float = SMALL
    role: str = "text"
    bold: bool = False
    indent: float = 0.0

    @property
    def width(self) -> float:
        return self.indent + text_width(self.text, self.size, bold=self.bold)

    @property
    def height(self) -> float:
        return self.size * LINE_HEIGHT


class Row(Record, frozen=True):
    """Lines of a card that represent edges of the diagram, or that describe the node itself if `edges` is empty.

    Attributes:
        kind: the kinds of the edges, as classes of the style sheet.
        edges: the indices of the edges in the diagram.
        has_bar: whether a bar in the row's tone is drawn on the left of the lines.
        is_joined: whether there is no distance to the row above.
        indent: the distance from the beginning of the other rows, in pixels.
        hint: the complete text if the lines show only a part of it, otherwise "".
    """

    lines: tuple[TextLine, ...]
    tone: Tone = Tone.PLAIN
    kind: str = ""
    edges: tuple[int, ...] = ()
    has_bar: bool = False
    is_joined: bool = False
    hint: str = ""
    indent: float = 0.0

    @property
    def size(self) -> Extent:
        bar = _BAR_WIDTH + _BAR_DISTANCE if self.has_bar else 0.0
        width = max((line.width for line in self.lines), default=0.0)
        return Extent(width + bar + self.indent, sum(line.height for line in self.lines))


class Card(Record, frozen=True):
    """A column of rows. `ruled` is true if a line separates the first row from the others; if there are no others, the
    first row is in the middle of a wider box. `side` is the free width on
    the left of the first row, for a badge, and `padding` the distance of the rows from the edge of the card, both in
    pixels."""

    rows: tuple[Row, ...]
    ruled: bool = False
    side: float = 0.0
    padding: float = PADDING

    @property
    def size(self) -> Extent:
        widths = [row.size.width + (self.side if index == 0 else 0) for index, row in enumerate(self.rows)]
        height = sum(self._heights())
        return Extent(
            round(max(widths, default=0.0) + 2 * self.padding + 0.5), round(height + 2 * 0.7 * self.padding + 0.5)
        )

    def row_middle(self, index: int) -> float:
        """The distance of the middle of a row from that of the card, in pixels; negative above it."""
        heights = list(self._heights())
        return sum(heights[: index + 1]) - self.rows[index].size.height / 2 - sum(heights) / 2

    def _heights(self) -> Iterator[float]:
        for index, row in enumerate(self.rows):
            yield (self._gap(index) if index else 0.0) + row.size.height

    def _gap(self, index: int) -> float:
        if self.ruled and index == 1:
            return 2 * _ROW_DISTANCE
        return 0.0 if self.rows[index].is_joined else _ROW_DISTANCE

    def items(self, box: Box) -> tuple[Item, ...]:
        """The items of the rows in a box, which is at least as large as the card."""
        items: list[Item] = []
        y = box.y + (box.height - sum(self._heights())) / 2
        for index, row in enumerate(self.rows):
            if index:
                gap = self._gap(index)
                if self.ruled and index == 1:
                    rule = (Point(box.x, y + gap / 2), Point(box.right, y + gap / 2))
                    items.append(Polyline(rule, role="rule"))
                y += gap
            x = box.x + self.padding + (self.side if index == 0 else 0)
            if self.ruled and len(self.rows) == 1:
                x = box.x + (box.width - row.size.width) / 2
            items += row_items(row, x, y)
            y += row.size.height
        return tuple(items)


def row_items(row: Row, x: float, y: float) -> tuple[Item, ...]:
    """The items of a row whose upper left corner is at a place."""
    drawn = _row(row, x, y)
    if row.edges:
        return (Group("edge", row.tone, drawn, row.kind, edges=row.edges, hint=row.hint),)
    if row.has_bar or row.hint:
        return (Group("row", row.tone, drawn, row.kind, hint=row.hint),)
    return drawn


def _row(row: Row, x: float, y: float) -> tuple[Item, ...]:
    items: list[Item] = []
    x += row.indent
    if row.has_bar:
        items.append(Shape(Box(x, y + 1, _BAR_WIDTH, row.size.height - 2), Outline.PILL, "bar"))
        x += _BAR_WIDTH + _BAR_DISTANCE
    for line in row.lines:
        y += line.height
        base = y - (line.height - 0.72 * line.size) / 2
        items.append(TextItem(line.text, x + line.indent, base, line.size, line.role, line.bold))
    return tuple(items)


def title(text: str, width: float) -> tuple[TextLine, ...]:
    """The lines of a title in bold letters, wrapped to a width in pixels; at most 3 lines. The name may be missing in a
    model with errors."""
    lines = wrap(text.strip() or NO_NAME, MEDIUM, width, bold=True, limit=3)
    return tuple(TextLine(line, MEDIUM, "title", bold=True) for line in lines)


def paragraph(
    text: str, width: float, role: str = "text", *, limit: int = 0, bold: bool = False
) -> tuple[TextLine, ...]:
    """The lines of a text in small letters, wrapped to a width in pixels; at most `limit` lines, or any number if
    `limit` is 0. All lines except the first are indented."""
    if not text:
        return ()
    lines = wrap(text, SMALL, width - _INDENT, bold=bold, limit=limit)
    return tuple(TextLine(line, SMALL, role, bold, _INDENT if index else 0.0) for index, line in enumerate(lines))


def is_shortened(lines: Sequence[TextLine], *texts: str) -> bool:
    """Whether the lines contain only a part of the texts."""
    return sum(len("".join(line.text.split())) for line in lines) < sum(len("".join(text.split())) for text in texts)

# SPDX-License-Identifier: Apache-2.0
"""The drawing of a behavior tree.

A node is a card with the symbol and the color of its kind, its name, its plugin and its number. Its ports, conditions,
scripts and mock are further rows of the card. The entries of the blackboard are drawn below the tree.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence

from roaml.figures.drawing import MAX_ROUNDING, Drawing, Group, Item, Outline, Polyline, Shape, Tone
from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.layout import LayoutDirection, Route, tidy_tree
from roaml.figures.layout.packing import rows_within
from roaml.ide.diagrams.diagram import DetailKind, DiagramNode, DiagramNodeKind, EdgeKind, Picture, TreeNodeTitle
from roaml.ide.diagrams.drawings.cards import Card, Row, TextLine, is_shortened, paragraph, title
from roaml.ide.diagrams.drawings.changes import is_marked, kind_of, signed, tone_of
from roaml.ide.diagrams.drawings.glyphs import BADGE, badge

TITLE_WIDTH, PORT_WIDTH = 190.0, 210.0
"""The maximum widths of lines of text in titles, and in rows of ports, in pixels."""
MAX_PORT_LINES = 3
"""The maximum number of lines of a port, condition or script."""
TONES: Mapping[DiagramNodeKind, Tone] = {
    DiagramNodeKind.CONTROL: Tone.CONTROL,
    DiagramNodeKind.DECORATOR: Tone.DECORATOR,
    DiagramNodeKind.ACTION: Tone.ACTION,
    DiagramNodeKind.CONDITION: Tone.CONDITION,
    DiagramNodeKind.SUBTREE: Tone.SUBTREE,
    DiagramNodeKind.VARIABLE: Tone.BLACKBOARD,
}
OUTLINES: Mapping[DiagramNodeKind, Outline] = {
    DiagramNodeKind.CONTROL: Outline.RECTANGLE,
    DiagramNodeKind.DECORATOR: Outline.HEXAGON,
    DiagramNodeKind.CONDITION: Outline.PILL,
    DiagramNodeKind.SUBTREE: Outline.DOUBLE,
}
_DETAIL_TONES: Mapping[DetailKind, Tone] = {
    DetailKind.REFERENCE: Tone.BLACKBOARD,
    DetailKind.SCRIPT: Tone.BLACKBOARD,
    DetailKind.MOCK: Tone.CHANCE,
}
"""The tones of the bars of rows. Rows of other kinds have no bar."""
LARGE, MAX_CONSTANTS = 40, 2
"""In a tree with more nodes than `LARGE`, a card with more constants than `MAX_CONSTANTS` shows the first one and the
number of the others."""
_BLACKBOARD_DISTANCE = 44.0
_BADGE_DISTANCE = 7.0


def draw_tree(picture: Picture, direction: LayoutDirection) -> Drawing:
    index = {node.id: number for number, node in enumerate(picture.nodes)}
    common = common_texts(picture)
    cards = {node.id: _card(picture, node, common) for node in picture.nodes}
    children = children_of(picture)
    variables = [node.id for node in picture.nodes if node.kind is DiagramNodeKind.VARIABLE]
    sizes = {name: _size(cards[name], picture.nodes[index[name]].kind) for name in cards}
    tree = tidy_tree({name: sizes[name] for name in sizes if name not in variables}, children, direction)
    boxes, size = with_blackboard(tree.nodes, tree.size, {name: sizes[name] for name in variables})
    groups = links(picture, children, tree.routes)
    groups += [_node(picture.nodes[index[name]], index[name], cards[name], box) for name, box in boxes.items()]
    return Drawing(size, tuple(groups), {index[name]: box for name, box in boxes.items()})


def children_of(picture: Picture) -> dict[str, list[str]]:
    """The id of a node of a tree -> those of its children, in order."""
    children: dict[str, list[str]] = {}
    for edge in picture.edges:
        if edge.kind is EdgeKind.CHILD:
            children.setdefault(edge.source, []).append(edge.target)
    return children


def links(picture: Picture, children: Mapping[str, Sequence[str]], routes: Iterable[Route]) -> list[Group]:
    """The lines from the nodes of a tree to their children. `routes` are in the order of `children`."""
    numbers = {(e.source, e.target): number for number, e in enumerate(picture.edges) if e.kind is EdgeKind.CHILD}
    pairs = ((parent, child) for parent, group in children.items() for child in group)
    return [_link(picture, numbers[pair], route.parts[0]) for pair, route in zip(pairs, routes, strict=True)]


def _link(picture: Picture, number: int, points: tuple[Point, ...]) -> Group:
    change = picture.edges[number].change
    kind = kind_of(change, "child")
    return Group("link", tone_of(change, Tone.PLAIN), (Polyline(points),), kind, edges=(number,))


def with_blackboard(
    tree: Mapping[str, Box], size: Extent, variables: Mapping[str, Extent]
) -> tuple[dict[str, Box], Extent]:
    """The boxes of the tree's nodes and of the entries of the blackboard, which are placed in rows below the tree; and
    the size of the whole drawing."""
    boxes = dict(tree)
    if not variables:
        return boxes, size
    width = max(size.width, 240.0, *(entry.width for entry in variables.values()))
    places, shelf = rows_within(list(variables.values()), width, 16.0)
    top = size.height + _BLACKBOARD_DISTANCE if tree else 0.0
    for (name, own), (x, y) in zip(variables.items(), places, strict=True):
        boxes[name] = Box(x, top + y, *own)
    return boxes, Extent(max(size.width, shelf.width), top + shelf.height)


def _size(card: Card, kind: DiagramNodeKind) -> Extent:
    """The size of a card; shapes with slanted or round ends need more space at the sides."""
    width, height = card.size
    outline = OUTLINES.get(kind, Outline.ROUNDED)
    extra = {Outline.HEXAGON: 12.0, Outline.PILL: min(height / 2, MAX_ROUNDING), Outline.DOUBLE: 6.0}.get(outline, 0.0)
    return Extent(width + extra, height)


def common_texts(picture: Picture) -> Mapping[str, int]:
    """The number of nodes with the same constant, by its text."""
    return Counter(
        detail.text for node in picture.nodes for detail in node.details if detail.kind is DetailKind.CONSTANT
    )


def _card(picture: Picture, node: DiagramNode, common: Mapping[str, int]) -> Card:
    if node.title is None:
        return Card((Row(title(f"{{{node.label}}}", PORT_WIDTH)),))
    rows = [Row(title(node.title.name, TITLE_WIDTH))]
    if subtitle(node.title):
        rows.append(Row((TextLine(subtitle(node.title), role="muted"),), is_joined=True))
    ports = list(zip(node.details, port_rows(picture, node, PORT_WIDTH, MAX_PORT_LINES), strict=True))
    constants = [row for detail, row in ports if detail.kind is DetailKind.CONSTANT]
    if len(picture.nodes) > LARGE and len(constants) > MAX_CONSTANTS and not any(detail.change for detail, _ in ports):
        # The constant that the fewest nodes have says most.
        shown = min((pair for pair in ports if pair[1] in constants), key=lambda pair: common[pair[0].text])[1]
        rows += [row for detail, row in ports if detail.kind is not DetailKind.CONSTANT or row is shown]
        others = [row for row in constants if row is not shown]
        rows.append(hidden_row(f"… {len(others)} more", others))
    else:
        rows += [row for _, row in ports]
    return Card(tuple(rows), side=BADGE + _BADGE_DISTANCE)


def subtitle(parts: TreeNodeTitle) -> str:
    """The plugin of a node, if its name is another one, and the number of the node, if it has one."""
    plugin = [parts.plugin] if parts.plugin != parts.name else []
    return " · ".join((*plugin, *([str(parts.number)] if parts.number is not None else ())))


def hidden_row(text: str, rows: Sequence[Row]) -> Row:
    """A text for rows that are not shown; its hint contains theirs."""
    return Row((TextLine(text, role="muted"),), hint="\n".join(row.hint or _written(row) for row in rows))


def _written(row: Row) -> str:
    return " ".join(line.text for line in row.lines)


def port_rows(picture: Picture, node: DiagramNode, width: float, limit: int) -> Iterator[Row]:
    """The rows of the ports, conditions, scripts and mocks, one for each detail of a node. The row of a port that is
    bound to the blackboard represents an edge.

    Args:
        width: the maximum width of lines of text, in pixels.
        limit: the maximum number of lines of a row.
    """
    bound: dict[str, list[int]] = {}
    for number, edge in enumerate(picture.edges):
        if edge.kind in (EdgeKind.READS, EdgeKind.WRITES) and node.id in (edge.source, edge.target):
            bound.setdefault(edge.labels[0], []).append(number)
    for detail in node.details:
        edges = tuple(bound.get(detail.key, ())) if detail.kind is DetailKind.REFERENCE else ()
        tone = _DETAIL_TONES.get(detail.kind)
        lines = paragraph(detail.text, width, "muted" if tone is None else "text", limit=limit)
        hint = detail.text if is_shortened(lines, detail.text) else ""
        kind = " ".join(picture.edges[number].kind.value for number in edges)
        has_bar = tone is not None or is_marked(detail.change)
        shown = tone_of(detail.change, tone or Tone.PLAIN)
        yield Row(signed(lines, detail.change), shown, kind, edges, has_bar=has_bar, hint=hint)


def _node(node: DiagramNode, index: int, card: Card, box: Box) -> Group:
    items: list[Item] = [Shape(box, OUTLINES.get(node.kind, Outline.ROUNDED), "card")]
    width = card.size.width
    inner = Box(box.x + (box.width - width) / 2, box.y, width, box.height)
    rows = card.items(inner)
    items += rows
    first = next((item for item in rows if not isinstance(item, Group)), None)
    symbol = badge(node, inner.x + card.padding, getattr(first, "y", inner.y) - 13.5)
    items += symbol or ()
    kind = kind_of(node.change, f"{node.kind.value} initial" if node.initial else node.kind.value)
    return Group("node", tone_of(node.change, TONES.get(node.kind, Tone.PLAIN)), tuple(items), kind, node=index)

# SPDX-License-Identifier: Apache-2.0
"""The drawing of a ROS graph: nodes and plugins, the interfaces between them, and plain events.

The color of a line shows whether it represents a topic, a service, an action, or plain events. Its arrow points to the
receiver. A namespace is a frame around what is in it; a collapsed one is a card. If interfaces are rows of cards, their
names are also beside the lines, where there is space, except those of lines that end at their row.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from roaml.figures.drawing import Drawing, Group, Outline, Polyline, Shape, Tone
from roaml.figures.geometry import Box, Point
from roaml.figures.layout import Boxes, Layout, LayoutDirection, Link, nested
from roaml.ide.diagrams.diagram import DetailKind, DiagramEdge, DiagramNode, DiagramNodeKind, EdgeKind, Picture
from roaml.ide.diagrams.drawings.cards import Card, Row, paragraph, title
from roaml.ide.diagrams.drawings.changes import is_marked, kind_of, signed, tone_of
from roaml.ide.diagrams.drawings.line_names import LineNames

CARD_WIDTH = {LayoutDirection.RIGHT: 220.0, LayoutDirection.DOWN: 140.0}
"""The maximum widths of lines of text in cards, in pixels. They are smaller if nodes are drawn side by side."""
LABEL_WIDTH = 150.0
"""The maximum width of lines of text in labels, in pixels."""
MAX_NAMES = 2
"""The maximum number of names beside a line."""
_NEAR = 2.0
_ASPECT = {LayoutDirection.RIGHT: 1.8, LayoutDirection.DOWN: 0.8}
_CHANNELS: Mapping[DiagramNodeKind, Tone] = {
    DiagramNodeKind.TOPIC: Tone.TOPIC,
    DiagramNodeKind.SERVICE: Tone.SERVICE,
    DiagramNodeKind.ACTION_INTERFACE: Tone.ROS_ACTION,
}
_OUTLINES: Mapping[DiagramNodeKind, Outline] = {
    DiagramNodeKind.TOPIC: Outline.RECTANGLE,
    DiagramNodeKind.SERVICE: Outline.DOUBLE,
    DiagramNodeKind.ACTION_INTERFACE: Outline.CUT,
}
_WORDS: Mapping[DiagramNodeKind, str] = {
    DiagramNodeKind.NAMESPACE: "namespace",
    DiagramNodeKind.PLUGIN: "plugin",
    DiagramNodeKind.TOPIC: "topic",
    DiagramNodeKind.SERVICE: "service",
    DiagramNodeKind.ACTION_INTERFACE: "action",
}


def draw_ros(picture: Picture, direction: LayoutDirection) -> Drawing:
    index = {node.id: number for number, node in enumerate(picture.nodes)}
    parents = {node.id: node.parent for node in picture.nodes if node.parent}
    framed = set(parents.values())
    cards = {node.id: _card(node, CARD_WIDTH[direction]) for node in picture.nodes}
    shown = [(number, edge) for number, edge in enumerate(picture.edges) if edge.source != edge.target]
    labels = [_label(number, edge) for number, edge in shown]
    nodes = {node.id: node for node in picture.nodes}

    def port(edge: DiagramEdge, end: str) -> float | None:
        return _row_of(edge, nodes[end], cards[end]) if direction is LayoutDirection.RIGHT else None

    links = [
        Link(edge.source, edge.target, label.size if label else None, port(edge, edge.source), port(edge, edge.target))
        for (_, edge), label in zip(shown, labels, strict=True)
    ]
    boxes = Boxes(parents, {name: cards[name].size for name in framed})
    sizes = {name: card.size for name, card in cards.items() if name not in framed}
    layout = nested(sizes, links, boxes, direction, _ASPECT[direction])
    groups = [_frame(node, index[node.id], cards, layout.nodes) for node in picture.nodes if node.id in framed]
    for (number, edge), label, route in zip(shown, labels, layout.routes, strict=True):
        tone = _tone(edge, picture.nodes[index[edge.source]], picture.nodes[index[edge.target]])
        lines = tuple(Polyline(part, has_arrow=part is route.parts[-1]) for part in route.parts)
        groups.append(Group("edge", tone, lines, kind_of(edge.change, edge.kind.value), edges=(number,)))
        if label and route.label:
            shape = Shape(route.label, Outline.ROUNDED, "label-card")
            groups.append(Group("label", tone, (shape, *label.items(route.label))))
    groups += _line_names(shown, layout, nodes, cards)
    groups += [
        _node(node, number, cards[node.id], layout.nodes[node.id])
        for number, node in enumerate(picture.nodes)
        if node.id not in framed
    ]
    return Drawing(layout.size, tuple(groups), {index[name]: box for name, box in layout.nodes.items()})


def _line_names(
    shown: Sequence[tuple[int, DiagramEdge]],
    layout: Layout,
    nodes: Mapping[str, DiagramNode],
    cards: Mapping[str, Card],
) -> Iterator[Group]:
    """The names of the interfaces through which lines lead, beside the lines."""
    # Of a frame, the size of its card is that of its heading.
    solid = [Box(box.x, box.y, *cards[name].size) for name, box in layout.nodes.items()]
    solid += [route.label for route in layout.routes if route.label]
    places = LineNames(solid, layout.routes, *layout.size)
    for (number, edge), route in zip(shown, layout.routes, strict=True):
        ends = ((edge.source, route.parts[0][0]), (edge.target, route.parts[-1][-1]))
        if edge.interface is None or any(_is_at_row(edge, nodes[n], cards[n], layout.nodes[n], p) for n, p in ends):
            continue
        text = places.place(_interfaces(edge, nodes[edge.source], nodes[edge.target]), route)
        if text:
            tone = _tone(edge, nodes[edge.source], nodes[edge.target])
            yield Group("line-name", tone, (text,), edges=(number,))


def _is_at_row(edge: DiagramEdge, node: DiagramNode, card: Card, box: Box, end: Point) -> bool:
    """Whether a line ends at the row for its only interface."""
    row = _row_of(edge, node, card)
    return len(edge.labels) == 1 and row is not None and abs(box.y + box.height / 2 + row - end.y) < _NEAR


def _interfaces(edge: DiagramEdge, source: DiagramNode, target: DiagramNode) -> str:
    """The names of the interfaces of a line, without those of its nodes; at most `MAX_NAMES`."""
    owners = {text for node in (source, target) for text in (node.label, *(detail.text for detail in node.details))}
    names = []
    for label in edge.labels:
        owner, _, name = label.removeprefix("/").partition("/")
        names.append(name if name and owner in owners else label)
    names = list(dict.fromkeys(names))
    more = f" +{len(names) - MAX_NAMES}" if len(names) > MAX_NAMES else ""
    return ", ".join(names[:MAX_NAMES]) + more


def _frame(node: DiagramNode, number: int, cards: Mapping[str, Card], places: Mapping[str, Box]) -> Group:
    box, heading = places[node.id], cards[node.id]
    items = (Shape(box, Outline.ROUNDED, "frame"), *heading.items(Box(box.x, box.y, box.width, heading.size.height)))
    return Group("node", tone_of(node.change, Tone.PLAIN), items, kind_of(node.change, node.kind.value), node=number)


def _card(node: DiagramNode, width: float) -> Card:
    word = _WORDS.get(node.kind, "node")
    rows = [Row(title(node.label, width))]
    interfaces = [detail for detail in node.details if detail.kind is DetailKind.INTERFACE]
    details = [(detail.text, detail.change) for detail in node.details if detail not in interfaces] or [(word, None)]
    for text, change in details:
        lines = signed(paragraph(text, width, "muted"), change)
        rows.append(Row(lines, tone_of(change, Tone.PLAIN), has_bar=is_marked(change), is_joined=True))
    tones = {kind.value: tone for kind, tone in _CHANNELS.items()}
    for detail in interfaces:
        # The name of the node is that of the card.
        name = detail.text.removeprefix(f"/{node.label}/")
        rows.append(Row(paragraph(name, width), tones[detail.key], has_bar=True))
    return Card(tuple(rows), padding=14.0 if node.kind in _CHANNELS else 12.0)


def _row_of(edge: DiagramEdge, node: DiagramNode, card: Card) -> float | None:
    """The place of the row of a card for the first interface through which an edge leads; `None` if it has none."""
    interfaces = [detail for detail in node.details if detail.kind is DetailKind.INTERFACE]
    first = len(card.rows) - len(interfaces)
    for number, detail in enumerate(interfaces, first):
        if edge.interface is not None and detail.key == edge.interface.value and detail.text in edge.labels:
            return card.row_middle(number)
    return None


def _label(number: int, edge: DiagramEdge) -> Card | None:
    """The label of an edge with the names of its plain events; `None` for other edges, which have no label."""
    if edge.kind is not EdgeKind.SENDS:
        return None
    lines = tuple(line for text in edge.labels for line in paragraph(text, LABEL_WIDTH, bold=True))
    row = Row(signed(lines, edge.change), tone_of(edge.change, Tone.EVENT), edge.kind.value, (number,), has_bar=True)
    return Card((row,), padding=7.0)


def _tone(edge: DiagramEdge, source: DiagramNode, target: DiagramNode) -> Tone:
    if edge.kind is EdgeKind.SENDS:
        return tone_of(edge.change, Tone.EVENT)
    if edge.interface is not None:
        return tone_of(edge.change, _CHANNELS[edge.interface])
    return tone_of(edge.change, _CHANNELS.get(source.kind) or _CHANNELS.get(target.kind) or Tone.PLAIN)


def _node(node: DiagramNode, index: int, card: Card, box: Box) -> Group:
    shape = Shape(box, _OUTLINES.get(node.kind, Outline.ROUNDED), "card")
    tone = tone_of(node.change, _CHANNELS.get(node.kind, Tone.PLAIN))
    kind = kind_of(node.change, node.kind.value)
    return Group("node", tone, (shape, *card.items(box)), kind, node=index)

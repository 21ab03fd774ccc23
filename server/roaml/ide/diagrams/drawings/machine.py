# SPDX-License-Identifier: Apache-2.0
"""The drawing of a state machine.

- A state is a card with its entry and exit actions; it has a double border if no transition leaves it. Transitions from
  a state to itself are rows of its card.
- All transitions from one state to another share a line; its label has a row for each of them.
- A choice is a small junction with the five of a die. If all its targets are the state from which it comes, it is a row
  of the state's card.
- In a large chart, a long line ends at its label, which names the target; the card of the target names the source.
- Each action thread is drawn separately, in a frame.
- A group is a frame around its states; a collapsed one is a card.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple, TypeAlias

from roaml.figures.assembly import moved
from roaml.figures.drawing import Drawing, Group, Item, Outline, Polyline, Shape, Tone
from roaml.figures.geometry import Box, Extent
from roaml.figures.layout import Boxes, Layout, LayoutDirection, Link, Route, nested
from roaml.figures.layout.graph import at_origin
from roaml.figures.layout.packing import best_rows
from roaml.ide.diagrams.diagram import DetailKind, DiagramEdge, DiagramNodeKind, EdgeKind, Picture
from roaml.ide.diagrams.drawings.cards import Card, Row, TextLine, is_shortened, paragraph, title
from roaml.ide.diagrams.drawings.changes import is_marked, kind_of, signed, tone_of
from roaml.ide.diagrams.drawings.glyphs import die
from roaml.ide.diagrams.drawings.start import DOT, start_beside

CARD_WIDTH, LABEL_WIDTH = 260.0, 210.0
"""The maximum widths of lines of text in cards and labels, in pixels."""
LABEL_PADDING = 7.0
"""The distance of the text of a label from its edge, in pixels."""
MAX_GUARD_LINES, MAX_ACTION_LINES, MAX_ACTIONS = 4, 3, 6
"""The maximum numbers of lines of a condition and of an action, and of the actions of a transition that are shown."""
MAX_FOLLOWED, MIN_FAR = 30, 4
FAR = 700.0
"""The number of states above which lines that are longer than `FAR`, in pixels, end at their labels, if there are at
least `MIN_FAR` of them."""
_SHORTENINGS = 2
"""How often such lines are searched: without them, others are in different places."""
_OUTCOME_INDENT = 10.0
"""The distance of the outcomes of a choice in a card from the transition to it, in pixels."""
_JUNCTION, _DIE = 14.0, 9.0
_START = "start"
_FRAME_MARGIN = 18.0
_ASPECT = {LayoutDirection.RIGHT: 1.8, LayoutDirection.DOWN: 0.8}
_TONES: Mapping[EdgeKind, Tone] = {
    EdgeKind.EVENT: Tone.EVENT,
    EdgeKind.ROS: Tone.ROS,
    EdgeKind.BT: Tone.TREE,
}


def draw_machine(picture: Picture, direction: LayoutDirection) -> Drawing:
    frames = [index for index, node in enumerate(picture.nodes) if node.kind is DiagramNodeKind.THREAD]
    charts = [_Chart(picture, "").drawing(direction)]
    charts += [_framed(picture, frame, direction) for frame in frames]
    places, size = best_rows([chart.size for chart in charts], _ASPECT[direction])
    groups: list[Group] = []
    nodes: dict[int, Box] = {}
    for chart, (dx, dy) in zip(charts, places, strict=True):
        groups += [moved(group, dx, dy) for group in chart.groups]
        nodes |= {index: box.moved(dx, dy) for index, box in chart.nodes.items()}
    return Drawing(size, tuple(groups), nodes)


def _framed(picture: Picture, index: int, direction: LayoutDirection) -> Drawing:
    """The drawing of an action thread in its frame; `index` is the node of the thread."""
    node = picture.nodes[index]
    chart = _Chart(picture, node.id).drawing(direction)
    heading = Card((Row((*title(" ".join((node.label, *(f"({detail.text})" for detail in node.details))), 400.0),)),))
    top = heading.size.height
    size = Extent(
        max(chart.size.width + 2 * _FRAME_MARGIN, heading.size.width), chart.size.height + top + _FRAME_MARGIN
    )
    box = Box(0, 0, *size)
    items = (Shape(box, Outline.ROUNDED, "frame"), *heading.items(Box(0, 0, size.width, top)))
    frame = Group("node", tone_of(node.change, Tone.PLAIN), items, "thread", node=index)
    inner = [moved(group, _FRAME_MARGIN, top) for group in chart.groups]
    nodes = {number: place.moved(_FRAME_MARGIN, top) for number, place in chart.nodes.items()}
    return Drawing(size, (frame, *inner), {index: box, **nodes})


_Bundle: TypeAlias = tuple[str, str, list[tuple[int, DiagramEdge]]]
"""Edges that are drawn as one line: their source, their target, and each edge with its index."""


class _Arranged(NamedTuple):
    """A chart with the places of its parts.

    Attributes:
        labels: the label of each bundle, and `places` where it is, if it is drawn.
        start: the line from the dot to the initial state, if there is one.
    """

    layout: Layout
    cards: Mapping[str, Card]
    bundles: Sequence[_Bundle]
    labels: Sequence[Card]
    places: Sequence[Box | None]
    start: Route | None
    routes: Sequence[Route]


class _Chart:
    """Draws one chart: that of the machine, or that of an action thread."""

    def __init__(self, picture: Picture, frame: str) -> None:
        self._picture = picture
        self._index: dict[str, int] = {}
        for index, node in enumerate(picture.nodes):  # groups are before their content
            if node.kind is not DiagramNodeKind.THREAD and (node.parent == frame or node.parent in self._index):
                self._index[node.id] = index
        self._parents = {name: picture.nodes[index].parent for name, index in self._index.items()}
        self._framed = set(self._parents.values()) & self._index.keys()
        self._edges = [(i, edge) for i, edge in enumerate(picture.edges) if edge.source in self._index]
        self._inlined = self._inlined_choices()
        self._cards = {
            name: Card((Row(title(picture.nodes[index].label, CARD_WIDTH)), *self._rows(name)), ruled=True)
            for name, index in self._index.items()
            if picture.nodes[index].kind in (DiagramNodeKind.STATE, DiagramNodeKind.GROUP)
        }

    def _inlined_choices(self) -> frozenset[str]:
        """The ids of the choices whose only target is the state from which they come."""
        origin = {edge.target: edge.source for _, edge in self._edges if not edge.probabilistic}
        choices = {
            name for name, index in self._index.items() if self._picture.nodes[index].kind is DiagramNodeKind.CHOICE
        }
        leaving = {edge.source for _, edge in self._edges if edge.probabilistic and edge.target != origin[edge.source]}
        return frozenset(choices - leaving)

    def _rows(self, state: str) -> Iterator[Row]:
        """The rows below the title of a state: its details, and its transitions to itself."""
        details = self._picture.nodes[self._index[state]].details
        for detail in details:
            lines = paragraph(detail.text, CARD_WIDTH, "muted", limit=MAX_ACTIONS)
            hint = detail.text if is_shortened(lines, detail.text) else ""
            tone = tone_of(detail.change, Tone.PLAIN)
            yield Row(signed(lines, detail.change), tone, has_bar=is_marked(detail.change), hint=hint)
        returns = any(detail.kind is DetailKind.ACTIONS for detail in details)
        for index, edge in self._edges:
            if edge.source == state and edge.target == state:
                yield _row(index, edge, CARD_WIDTH, "↻ " if returns and not edge.internal else "")
            elif edge.source == state and edge.target in self._inlined:
                yield _row(index, edge, CARD_WIDTH)
                for number, outcome in self._edges:
                    if outcome.source == edge.target:
                        yield _row(number, outcome, CARD_WIDTH, joined=True)

    def drawing(self, direction: LayoutDirection) -> Drawing:
        arranged = self._arranged(direction, frozenset())
        far: frozenset[int] = frozenset()
        for _ in range(_SHORTENINGS):
            more = self._far(arranged) - far
            if len(more) < MIN_FAR:
                break
            far |= more
            arranged = self._arranged(direction, far)
        return self._drawn(arranged)

    def _arranged(self, direction: LayoutDirection, far: frozenset[int]) -> _Arranged:
        """The places of all parts.

        Args:
            far: the bundles whose lines end at their labels, which name the targets.
        """
        sizes: dict[str, Extent] = {}
        links: list[Link] = []
        bundles = [bundle for bundle in self._bundles() if self._is_drawn(bundle[0]) and self._is_drawn(bundle[1])]
        cards = dict(self._cards)
        for name in {bundles[index][1] for index in far}:
            sources = dict.fromkeys(bundles[index][0] for index in sorted(far) if bundles[index][1] == name)
            names = ", ".join(self._name(source) for source in sources)
            cards[name] = Card((*cards[name].rows, Row(paragraph(f"from {names}", CARD_WIDTH, "muted"))), ruled=True)
        initial = next((name for name in cards if self._picture.nodes[self._index[name]].initial), None)
        parents = {name: parent for name, parent in self._parents.items() if parent in self._framed}
        if initial is not None:
            sizes[initial] = cards[initial].size
        for name in self._index:
            if name in self._framed:
                continue
            if name in cards:
                sizes[name] = cards[name].size
            elif self._is_drawn(name):
                sizes[name] = Extent(_JUNCTION, _JUNCTION)
        labels = [
            _label(edges, self._name(target) if index in far else "")
            for index, (_, target, edges) in enumerate(bundles)
        ]
        for index, ((source, target, _), label) in enumerate(zip(bundles, labels, strict=True)):
            if index in far:
                sizes[_stub(index)] = label.size
                if source in parents:
                    parents[_stub(index)] = parents[source]
                links.append(Link(source, _stub(index)))
            else:
                links.append(Link(source, target, label.size if label.rows else None))
        boxes = Boxes(parents, {name: cards[name].size for name in self._framed})
        layout = nested(sizes, links, boxes, direction, _ASPECT[direction])
        if initial is not None:
            layout = _with_start(layout, sizes, links, boxes, initial, direction)
        start, routes = (None, layout.routes) if initial is None else (layout.routes[0], layout.routes[1:])
        places = [layout.nodes[_stub(index)] if index in far else route.label for index, route in enumerate(routes)]
        return _Arranged(layout, cards, bundles, labels, places, start, routes)

    def _is_drawn(self, name: str) -> bool:
        """Whether a state or a choice has its own place."""
        return name in self._cards or (name in self._index and name not in self._inlined)

    def _name(self, name: str) -> str:
        return self._picture.nodes[self._index[name]].label

    def _far(self, arranged: _Arranged) -> frozenset[int]:
        """The bundles with lines that are too long to be followed, in a large chart. The lines on which each state is
        reached first are kept."""
        if len(self._cards) <= MAX_FOLLOWED:
            return frozenset()
        leaving: dict[str, list[int]] = {}
        for index, (source, _, _) in enumerate(arranged.bundles):
            leaving.setdefault(source, []).append(index)
        kept: set[int] = set()
        reached: dict[str, None] = {}
        for start in self._cards:
            pending = [] if start in reached else [start]
            reached[start] = None
            for source in pending:
                for index in leaving.get(source, ()):
                    target = arranged.bundles[index][1]
                    if target not in reached:
                        reached[target] = None
                        kept.add(index)
                        pending.append(target)
        return frozenset(
            index
            for index, ((_, target, _), route) in enumerate(zip(arranged.bundles, arranged.routes, strict=True))
            if index not in kept and target in self._cards and route.length > FAR
        )

    def _drawn(self, arranged: _Arranged) -> Drawing:
        layout, labels, routes = arranged.layout, arranged.labels, arranged.routes
        groups: list[Group] = []
        if arranged.start is not None:
            line = Polyline(arranged.start.parts[0], has_arrow=True)
            dot = Shape(layout.nodes[_START], Outline.PILL, "dot")
            groups.append(Group("start", Tone.PLAIN, (line, dot)))
        for (_, _, edges), route, place in zip(arranged.bundles, routes, arranged.places, strict=True):
            ends = len(route.parts) - 1 if route.label or place is None else len(route.parts)
            lines = tuple(Polyline(part, has_arrow=number == ends) for number, part in enumerate(route.parts))
            groups.append(Group("link", _tone(edges), lines, _kinds(edges), edges=tuple(i for i, _ in edges)))
        for (_, _, edges), label, place in zip(arranged.bundles, labels, arranged.places, strict=True):
            if place is not None:
                shape = Shape(place, Outline.ROUNDED, "label-card")
                groups.append(Group("label", _tone(edges), (shape, *label.items(place))))
        nodes = {self._index[name]: box for name, box in layout.nodes.items() if name in self._index}
        groups += [self._frame(name, layout.nodes[name]) for name in self._index if name in self._framed]
        groups += [
            self._node(index, box, arranged.cards) for index, box in sorted(nodes.items()) if self._is_card(index)
        ]
        return Drawing(layout.size, tuple(groups), nodes)

    def _bundles(self) -> list[_Bundle]:
        """The edges that are drawn as lines, grouped by source and target, in the order of the first edge of each
        group."""
        bundles: dict[tuple[str, str], list[tuple[int, DiagramEdge]]] = {}
        for index, edge in self._edges:
            if edge.source != edge.target:
                bundles.setdefault((edge.source, edge.target), []).append((index, edge))
        return [(source, target, edges) for (source, target), edges in bundles.items()]

    def _is_card(self, index: int) -> bool:
        return self._picture.nodes[index].id not in self._framed

    def _frame(self, name: str, box: Box) -> Group:
        """The frame of a group. It is drawn over the lines, which may cross its upper edge where its heading is."""
        node, card = self._picture.nodes[self._index[name]], self._cards[name]
        heading = Box(box.x, box.y, *card.size)
        items = (Shape(box, Outline.ROUNDED, "frame"), Shape(heading, Outline.ROUNDED, "label-card"))
        tone = tone_of(node.change, Tone.PLAIN)
        return Group("node", tone, (*items, *card.items(heading)), node.kind.value, node=self._index[name])

    def _node(self, index: int, box: Box, cards: Mapping[str, Card]) -> Group:
        node = self._picture.nodes[index]
        if node.kind is DiagramNodeKind.CHOICE:
            shape = Shape(box, Outline.PILL, "junction")
            return Group("node", tone_of(node.change, Tone.CHANCE), (shape, die(box, _DIE)), "choice", node=index)
        is_final = all(edge.source != node.id for _, edge in self._edges)
        outline = Outline.DOUBLE if is_final else Outline.ROUNDED
        items: tuple[Item, ...] = (Shape(box, outline, "card"), *cards[node.id].items(box))
        kind = kind_of(node.change, f"{node.kind.value} initial" if node.initial else node.kind.value)
        return Group("node", tone_of(node.change, Tone.PLAIN), items, kind, node=index)


def _row(index: int, edge: DiagramEdge, width: float, mark: str = "", *, joined: bool = False) -> Row:
    """The row for a transition: its trigger, its condition and its actions."""
    lines: list[TextLine] = []
    heads, guards = _split(edge)
    if heads:
        lines += paragraph(mark + heads, width, bold=True, limit=MAX_ACTION_LINES)
    for text in guards:
        lines += paragraph(("" if heads or lines else mark) + text, width, limit=MAX_GUARD_LINES)
    for number, action in enumerate(edge.actions[:MAX_ACTIONS]):
        dots = " …" if number == MAX_ACTIONS - 1 < len(edge.actions) - 1 else ""
        lines += paragraph(f"/ {action}{dots}", width, "muted", limit=MAX_ACTION_LINES)
    if not lines:
        lines = [TextLine(f"{mark}without event")]
    texts = (*edge.labels, edge.order, *(f"/ {action}" for action in edge.actions))
    hint = "\n".join(texts) if is_shortened(lines, *texts) else ""
    return Row(
        signed(lines, edge.change),
        _edge_tone(edge),
        _kinds([(index, edge)]),
        (index,),
        has_bar=True,
        is_joined=joined,
        indent=_OUTCOME_INDENT if joined else 0.0,
        hint=hint,
    )


def _label(edges: Sequence[tuple[int, DiagramEdge]], target: str) -> Card:
    """The label of a line, with a row for each edge that has labels, actions or an order.

    Args:
        target: the name of the target if the line ends at the label, otherwise "".
    """
    rows = [_row(index, edge, LABEL_WIDTH) for index, edge in edges if edge.labels or edge.actions or edge.order]
    if target:
        lines = paragraph(f"→ {target}", LABEL_WIDTH, "title", bold=True)
        rows.append(Row(lines, _tone(edges), _kinds(edges), tuple(index for index, _ in edges)))
    return Card(tuple(rows), padding=LABEL_PADDING)


def _with_start(
    layout: Layout,
    sizes: Mapping[str, Extent],
    links: Sequence[Link],
    boxes: Boxes,
    initial: str,
    direction: LayoutDirection,
) -> Layout:
    """The layout with the dot before the initial state; the line from it is the first route. If there is no space
    beside the state, or if the state is in a frame, the dot is a further node."""
    if initial not in boxes.parents:
        solid = [box for name, box in layout.nodes.items() if name != initial]
        solid += [route.label for route in layout.routes if route.label]
        solid += [piece for route in layout.routes for piece in route.pieces]
        found = start_beside(layout.nodes[initial], solid, direction)
        if found:
            return at_origin({**layout.nodes, _START: found[0]}, (found[1], *layout.routes))
    parents = dict(boxes.parents)
    if initial in parents:
        parents[_START] = parents[initial]
    with_start = {_START: Extent(DOT, DOT), **sizes}
    return nested(
        with_start, [Link(_START, initial), *links], Boxes(parents, boxes.headings), direction, _ASPECT[direction]
    )


def _stub(index: int) -> str:
    """The name of the end of a bundle in the layout; no state has it, because ids of states contain no such letter."""
    return f"\0{index}"


def _split(edge: DiagramEdge) -> tuple[str, list[str]]:
    """The labels of an edge that are not conditions, as one text; and the conditions, with their order."""
    guards = [text for text in edge.labels if text.startswith("[")]
    heads = " ".join(text for text in edge.labels if text not in guards)
    if edge.order:
        guards = [" ".join((edge.order, *guards[:1])), *guards[1:]]
    return heads, guards


def _tone(edges: Sequence[tuple[int, DiagramEdge]]) -> Tone:
    """The tone of a line: the common tone of its transitions. If they have different tones, it is `PLAIN`, or `CHANGED`
    if versions are compared."""
    tones = {_edge_tone(edge) for _, edge in edges}
    if len(tones) == 1:
        return tones.pop()
    return Tone.PLAIN if all(edge.change is None for _, edge in edges) else Tone.CHANGED


def _edge_tone(edge: DiagramEdge) -> Tone:
    return tone_of(edge.change, Tone.CHANCE if edge.probabilistic else _TONES.get(edge.kind, Tone.PLAIN))


def _kinds(edges: Sequence[tuple[int, DiagramEdge]]) -> str:
    """The common kind of edges, for the style sheet; "" if they have different kinds."""
    kinds = {
        kind_of(edge.change, f"{edge.kind.value} chance" if edge.probabilistic else edge.kind.value)
        for _, edge in edges
    }
    return kinds.pop() if len(kinds) == 1 else ""

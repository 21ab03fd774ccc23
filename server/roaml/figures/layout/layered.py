# SPDX-License-Identifier: Apache-2.0
"""Layered layout of a graph with orthogonal lines and labels; `roaml.figures.layout` describes its steps."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cached_property

from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.layout.cycles import closing_links, fanned_links
from roaml.figures.layout.graph import Layout, LayoutDirection, Link, Route, at_origin
from roaml.figures.layout.layers import assign_layers, column_starts
from roaml.figures.layout.lines import find_line, in_columns
from roaml.figures.layout.order import order_layers
from roaml.figures.layout.packing import components, pack
from roaml.figures.layout.ports import PORT_DISTANCE, PORT_MARGIN, Ports
from roaml.figures.layout.positions import distances, place_vertices
from roaml.figures.layout.straight import Straightening
from roaml.figures.layout.tracks import assign_tracks
from roaml.figures.layout.vertices import Vertex, VertexKind
from roaml.record import Record, field

LAYER_DISTANCE = 18.0
TRACK_MARGIN = 11.0
TRACK_DISTANCE = 9.0
"""Distances between layers, in pixels: the minimum distance of two layers; of a track from a layer; of two tracks."""
MAX_RATIO = 2.0
"""The ratio of the sides of a part above which it is wrapped. Frames and headings are added to parts, so it is smaller
than the ratio that a drawing may have, which is 3."""
WRAPPED_RATIO = 1.3
"""The desired ratio of height to width after wrapping."""
MIN_LINE, MIN_WRAPPED = 12, 20
"""The minimum numbers of nodes of a line or ring in columns, and of another part that is wrapped. Smaller parts are
easier to follow if they are not wrapped, and suit a page in one of the two directions."""
MAX_ATTEMPTS = 6
DIVISION = 1.2
"""The maximum number of attempts to wrap a part, and the minimum factor by which layers become narrower in each."""
BELOW_START = 2
"""The number of layers above further columns."""
STRAIGHTENINGS = 2
"""How often vertices, then ports, are moved so that lines become straight."""
MIN_MIRRORED = 0.6
"""The place of the first node in a part, as a fraction of the width, from which on the part is mirrored."""
MAX_COMPARED = 100
"""The maximum number of nodes of a part whose layers are divided in all these ways, to find the smallest drawing."""


def layered(nodes: Mapping[str, Extent], links: Sequence[Link], direction: LayoutDirection, aspect: float) -> Layout:
    """The layout of a graph. Links between a node and itself are not supported.

    Nodes are drawn in their order if links allow it, the first one first. A node grows if it has too many links for its
    size. Parts of the graph that are not connected are packed side by side.

    Args:
        aspect: the desired ratio of width to height, for packing.
    """
    is_right = direction is LayoutDirection.RIGHT
    if is_right:
        nodes = {name: size.turned for name, size in nodes.items()}
        links = [link.turned for link in links]
    parts = []
    for names, indexes in components(nodes, links):
        part = _part(nodes, names, indexes, links, 1 / aspect if is_right else aspect)
        parts.append((part.turned if is_right else part, indexes))
    return pack(parts, len(links), aspect)


class Boundary(Record, frozen=True):
    """What surrounds a connected graph that is the content of a box, and the boxes in it.

    Attributes:
        anchors: the place at which a link leaves or enters a box, relative to its middle, by the name of the box and
            the index of the link.
        tops: nodes in a layer above all others: the ports of links from outside.
        bottoms: nodes in a layer below all others: the ports of links to outside.
    """

    anchors: Mapping[tuple[str, int], float] = field(default_factory=dict)
    tops: frozenset[str] = frozenset()
    bottoms: frozenset[str] = frozenset()


def component(
    sizes: Mapping[str, Extent], names: Sequence[str], indexes: Sequence[int], links: Sequence[Link], boundary: Boundary
) -> Layout:
    """The layout of a connected graph, downwards; it is not wrapped if it contains boxes or ports.

    Args:
        names: the nodes of the graph.
        indexes: the indexes of its links.
    """
    fixed = {name for name, _ in boundary.anchors} | boundary.tops | boundary.bottoms
    if fixed.isdisjoint(names):
        return _part(sizes, names, indexes, links, 1 / WRAPPED_RATIO)
    return _Component(sizes, names, indexes, links, boundary=boundary).layout()


def _part(
    sizes: Mapping[str, Extent], names: Sequence[str], indexes: Sequence[int], links: Sequence[Link], aspect: float
) -> Layout:
    """The layout of a connected graph, downwards. If it is much higher than wide, its layers are continued in further
    columns; if it is much wider than high, its layers are divided.

    Args:
        aspect: the desired ratio of width to height of a long line or ring.
    """
    line = find_line(names, indexes, links) if len(names) >= MIN_LINE else None
    if line is not None:
        return in_columns(line, sizes, links, aspect)

    def made(columns: int = 1, limit: float | None = None) -> Layout:
        return _Component(sizes, names, indexes, links, columns, limit).layout()

    best = made()
    if len(names) < MIN_WRAPPED:
        return _from_the_beginning(best, names, [links[index] for index in indexes])
    width, height = best.size
    if _excess(best) > 1 and height > width:
        columns = 1
        for _ in range(MAX_ATTEMPTS):
            # More columns are also higher, because their links pass other nodes.
            factor = math.sqrt(best.size.height / best.size.width / WRAPPED_RATIO)
            columns = max(columns + 1, round(columns * factor))
            best = min(best, made(columns=columns), key=_excess)
            if _excess(best) <= 1:
                break
    if _excess(best) > 1 and best.size.width > best.size.height:
        limit = width
        for _ in range(MAX_ATTEMPTS):
            limit = limit / max(DIVISION, math.sqrt(best.size.width / best.size.height / WRAPPED_RATIO))
            best = min(best, made(limit=limit), key=lambda layout: (_excess(layout), _area(layout)))
            if _excess(best) <= 1 and len(names) > MAX_COMPARED:
                break
    return _from_the_beginning(best, names, [links[index] for index in indexes])


def _from_the_beginning(layout: Layout, names: Sequence[str], links: Sequence[Link]) -> Layout:
    """The layout, mirrored if its first node is much nearer to the right side, so that it is read from the left. If all
    layers are in the order of the nodes, they stay so, and also if links have wanted places at nodes."""
    middles = [layout.nodes[name].x + layout.nodes[name].width / 2 for name in names]
    if middles[0] < MIN_MIRRORED * layout.size.width or any(
        link.port(end) is not None for link in links for end in (link.source, link.target)
    ):
        return layout
    rows: dict[float, list[float]] = {}
    for name, middle in zip(names, middles, strict=True):
        rows.setdefault(round(layout.nodes[name].y + layout.nodes[name].height / 2), []).append(middle)
    return layout if all(row == sorted(row) for row in rows.values()) else layout.mirrored


def _area(layout: Layout) -> float:
    return layout.size.width * layout.size.height


def _excess(layout: Layout) -> float:
    """The ratio of the longer to the shorter side, as a multiple of `MAX_RATIO`; 1 if it is not greater."""
    width, height = max(1.0, layout.size.width), max(1.0, layout.size.height)
    return max(1.0, width / height / MAX_RATIO, height / width / MAX_RATIO)


_NO_BOUNDARY = Boundary()


class _Edge(Record, frozen=True):
    """A piece of a link between two vertices in neighbouring layers, downwards."""

    link: int
    upper: int
    lower: int


class _Component:
    """The layout of a connected graph, downwards."""

    def __init__(
        self,
        sizes: Mapping[str, Extent],
        names: Sequence[str],
        indexes: Sequence[int],
        links: Sequence[Link],
        columns: int = 1,
        limit: float | None = None,
        boundary: Boundary = _NO_BOUNDARY,
    ) -> None:
        self.limit = limit
        self.is_wrapped = columns > 1
        self.boundary = boundary
        self.names = names
        self.indexes = indexes
        self.links = links
        number = {name: index for index, name in enumerate(names)}
        ends = [(number[links[index].source], number[links[index].target]) for index in indexes]
        turned = closing_links(len(names), ends)
        if columns == 1:
            turned |= fanned_links(len(names), ends)
        else:
            turned = self._wrapped(ends, turned, [sizes[name] for name in names], columns)
        self.turned = {index: position in turned for position, index in enumerate(indexes)}
        downwards = {
            index: (target, source) if self.turned[index] else (source, target)
            for index, (source, target) in zip(indexes, ends, strict=True)
        }
        self.vertices = [Vertex(VertexKind.NODE, sizes[name]) for name in names]
        self.labels: dict[int, int] = {}
        self.edges: list[_Edge] = []
        self._add_edges(downwards)
        self._split_long_edges()
        self._grow()

    @staticmethod
    def _wrapped(
        ends: Sequence[tuple[int, int]], turned: frozenset[int], sizes: Sequence[Extent], columns: int
    ) -> frozenset[int]:
        """The links that lead upwards if the layers are continued in further columns, each beginning at the top.

        Args:
            turned: the links that lead upwards in one column.
        """
        down = [(b, a) if position in turned else (a, b) for position, (a, b) in enumerate(ends)]
        layers = assign_layers([Vertex(VertexKind.NODE, size) for size in sizes], down)
        starts = column_starts(layers, down, columns)
        column_of = [bisect_right(starts, layer) - 1 for layer in layers]
        uses = Counter(end for pair in down for end in pair)
        for a, b in down:
            if uses[b] == 1:  # what leads nowhere remains below the node that leads to it
                column_of[b] = column_of[a]
        place = list(zip(column_of, layers, strict=True))
        # All further columns begin below the dot of an initial state and the state.
        row = [layer - starts[column] + (BELOW_START if column else 0) for column, layer in place]
        upwards = {position for position, (a, b) in enumerate(down) if place[a][0] != place[b][0] and row[a] >= row[b]}
        now = [(b, a) if position in upwards else (a, b) for position, (a, b) in enumerate(down)]
        return turned ^ upwards ^ closing_links(len(sizes), now)

    def _add_edges(self, downwards: Mapping[int, tuple[int, int]]) -> None:
        for index in self.indexes:
            source, target = downwards[index]
            label = self.links[index].label
            if label is None:
                self.edges.append(_Edge(index, source, target))
                continue
            self.labels[index] = len(self.vertices)
            self.vertices.append(Vertex(VertexKind.LABEL, label))
            self.edges += [_Edge(index, source, self.labels[index]), _Edge(index, self.labels[index], target)]

    def _split_long_edges(self) -> None:
        """Add a vertex to each layer that a link passes."""
        pairs = [(edge.upper, edge.lower) for edge in self.edges]
        self.layers = self._outermost(assign_layers(self.vertices, pairs + self._below_first(pairs), self.limit))
        short: list[_Edge] = []
        for edge in self.edges:
            upper = edge.upper
            for layer in range(self.layers[edge.upper] + 1, self.layers[edge.lower]):
                self.vertices.append(Vertex(VertexKind.PASSING, Extent(0, 0)))
                self.layers.append(layer)
                short.append(_Edge(edge.link, upper, len(self.vertices) - 1))
                upper = len(self.vertices) - 1
            short.append(_Edge(edge.link, upper, edge.lower))
        self.edges = short

    def _below_first(self, pairs: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
        """Pairs that make the first node the highest one, although further columns begin with other nodes."""
        if not self.is_wrapped:
            return []
        following = [lower for upper, lower in pairs if upper == 0]
        first = following[0] if len(following) == 1 else 0
        entered = {lower for _, lower in pairs}
        return [(first, node) for node in range(1, len(self.names)) if node not in entered]

    def _outermost(self, layers: list[int]) -> list[int]:
        """The layers with the ports in the first and the last one."""
        tops, bottoms = self.boundary.tops, self.boundary.bottoms
        for index, name in enumerate(self.names):
            if name in tops:
                layers[index] = -1
            elif name in bottoms:
                layers[index] = len(layers)
        used = {layer: index for index, layer in enumerate(sorted(set(layers)))}
        return [used[layer] for layer in layers]

    @cached_property
    def _anchors(self) -> tuple[Mapping[int, float], Mapping[int, float]]:
        """The places of edges at boxes, relative to their middles: where they leave the upper one and where they enter
        the lower one."""
        leaving: dict[int, float] = {}
        entering: dict[int, float] = {}
        anchors = self.boundary.anchors
        for index, edge in enumerate(self.edges if anchors else ()):
            for places, vertex in ((leaving, edge.upper), (entering, edge.lower)):
                name = self.names[vertex] if vertex < len(self.names) else ""
                if (name, edge.link) in anchors:
                    places[index] = anchors[name, edge.link]
        return leaving, entering

    @cached_property
    def _wanted(self) -> tuple[Mapping[int, float], Mapping[int, float]]:
        """Where edges should leave their upper and enter their lower node, relative to the middles of the nodes."""
        leaving: dict[int, float] = {}
        entering: dict[int, float] = {}
        for index, edge in enumerate(self.edges):
            for places, vertex in ((leaving, edge.upper), (entering, edge.lower)):
                port = self.links[edge.link].port(self.names[vertex]) if vertex < len(self.names) else None
                if port is not None:
                    places[index] = port
        return leaving, entering

    def _grow(self) -> None:
        """Make nodes wide enough for their links. Boxes are as wide as their contents."""
        boxes = {name for name, _ in self.boundary.anchors}
        upper, lower = [0] * len(self.vertices), [0] * len(self.vertices)
        for edge in self.edges:
            lower[edge.upper] += 1
            upper[edge.lower] += 1
        for index, vertex in enumerate(self.vertices):
            ports = max(upper[index], lower[index])
            if vertex.kind is VertexKind.NODE and ports > 1 and self.names[index] not in boxes:
                width = 2 * PORT_MARGIN + (ports - 1) * PORT_DISTANCE
                self.vertices[index] = Vertex(vertex.kind, Extent(max(vertex.size.width, width), vertex.size.height))

    def layout(self) -> Layout:
        pairs = [(edge.upper, edge.lower) for edge in self.edges]
        rows = order_layers(self.layers, pairs)
        middles = place_vertices(self.vertices, rows, pairs, *self._anchors)
        ports = Ports(self.vertices, rows, pairs, middles, self._anchors, self._wanted)
        for _ in range(STRAIGHTENINGS):
            straightening = Straightening(rows, distances(self.vertices, rows), pairs, middles, ports.shifts)
            straightening.run()
            middles = straightening.places
            ports.move(middles)
        gaps: list[list[int]] = [[] for _ in rows]
        for index, edge in enumerate(self.edges):
            gaps[self.layers[edge.upper]].append(index)
        bends: dict[int, list[Point]] = {}
        boxes: dict[int, Box] = {}
        y = 0.0
        for row, gap in zip(rows, gaps, strict=True):
            thickness = max(self.vertices[vertex].size.height for vertex in row)
            for vertex in row:
                width, height = self.vertices[vertex].size
                boxes[vertex] = Box(middles[vertex] - width / 2, y + (thickness - height) / 2, width, height)
            y += thickness
            turns, count = assign_tracks([(ports.leaving[index], ports.entering[index]) for index in gap])
            for index, line in zip(gap, turns, strict=True):
                x = ports.leaving[index]
                bends[index] = []
                for turn in line:
                    track = y + TRACK_MARGIN + turn.track * TRACK_DISTANCE
                    bends[index] += [Point(x, track), Point(turn.to, track)]
                    x = turn.to
            y += max(LAYER_DISTANCE, 2 * TRACK_MARGIN + (count - 1) * TRACK_DISTANCE) if gap else 0
        return self._assembled(boxes, bends, ports)

    def _assembled(self, boxes: Mapping[int, Box], bends: Mapping[int, Sequence[Point]], ports: Ports) -> Layout:
        pieces: dict[int, list[int]] = {}
        for index, edge in enumerate(self.edges):
            pieces.setdefault(edge.link, []).append(index)
        routes = []
        for link in self.indexes:
            parts: list[list[Point]] = [[]]
            for index in pieces[link]:
                edge = self.edges[index]
                if self.vertices[edge.upper].kind is not VertexKind.PASSING:
                    parts[-1].append(Point(ports.leaving[index], boxes[edge.upper].bottom))
                parts[-1] += bends[index]
                if self.vertices[edge.lower].kind is not VertexKind.PASSING:
                    parts[-1].append(Point(ports.entering[index], boxes[edge.lower].y))
                    parts.append([])
            lines = [simplified(part) for part in parts if part]
            if self.turned[link]:
                lines = [line[::-1] for line in reversed(lines)]
            routes.append(Route(tuple(lines), boxes[self.labels[link]] if link in self.labels else None))
        placed = {name: boxes[index] for index, name in enumerate(self.names)}
        return at_origin(placed, routes)


def simplified(points: Sequence[Point]) -> tuple[Point, ...]:
    """The line without the points at which its direction does not change."""
    kept: list[Point] = []
    for point in points:
        while len(kept) >= 2 and (kept[-2].x == kept[-1].x == point.x or kept[-2].y == kept[-1].y == point.y):
            kept.pop()
        kept.append(point)
    return tuple(kept)

# SPDX-License-Identifier: Apache-2.0
"""Layered layout of a graph whose nodes are in boxes, which may contain further boxes.

The content of each box is laid out by itself; around it, the box is a node of a given size. A link that leaves a box
has a port in its content: a point in the first or last layer, from which the line continues outside. So boxes contain
their nodes and nothing else, and no line crosses a box in which it does not end, by construction.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence

from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.layout.cycles import closing_links
from roaml.figures.layout.graph import Layout, LayoutDirection, Link, Route
from roaml.figures.layout.layered import Boundary, component, layered, simplified
from roaml.figures.layout.packing import DISTANCE, components, pack
from roaml.record import Record

BOX_MARGIN = 18.0
"""The distance of the content of a box from its border, in pixels."""


class Boxes(Record, frozen=True):
    """The boxes around the nodes of a graph.

    Attributes:
        parents: the box that contains a node or another box; nodes and boxes that are in none are missing.
        headings: the size of the heading of each box.
    """

    parents: Mapping[str, str]
    headings: Mapping[str, Extent]

    def path(self, name: str) -> tuple[str, ...]:
        """The boxes around a node, the outermost first, and the node itself."""
        path = [name]
        while path[-1] in self.parents:
            path.append(self.parents[path[-1]])
        return tuple(reversed(path))


def nested(
    nodes: Mapping[str, Extent], links: Sequence[Link], boxes: Boxes, direction: LayoutDirection, aspect: float
) -> Layout:
    """The layout of a graph with boxes; its nodes contain the boxes, too. Links between a node and itself, and between
    a box and its content, are not supported.

    Args:
        aspect: the desired ratio of width to height, for packing.
    """
    if not boxes.headings:
        return layered(nodes, links, direction, aspect)
    if direction is LayoutDirection.DOWN:
        return _Nested(nodes, links, boxes, aspect, is_turned=False).layout()
    sizes = {name: size.turned for name, size in nodes.items()}
    turned = [link.turned for link in links]
    return _Nested(sizes, turned, boxes, 1 / aspect, is_turned=True).layout().turned


class _Content(Record, frozen=True):
    """The layout of a box and its content, downwards.

    Attributes:
        nodes: the places of the nodes and boxes in it.
        routes: the parts of links in it, from their upper to their lower end.
        ports: the place at the upper or lower border where each link leaves the box.
    """

    size: Extent
    nodes: Mapping[str, Box]
    routes: Mapping[int, Route]
    ports: Mapping[int, float]


class _Nested:
    """The layout downwards; `is_turned` tells whether it will be turned, so that headings are at the left sides."""

    def __init__(
        self, sizes: Mapping[str, Extent], links: Sequence[Link], boxes: Boxes, aspect: float, *, is_turned: bool
    ) -> None:
        self.sizes = sizes
        self.links = links
        self.boxes = boxes
        self.aspect = aspect
        self.is_turned = is_turned
        self.ends = [(boxes.path(link.source), boxes.path(link.target)) for link in links]
        self.reversed: set[int] = set()
        """The links whose source is below their target."""

    def layout(self) -> Layout:
        content = self._content("", 0, {})
        routes = []
        for index in range(len(self.links)):
            route = content.routes[index]
            routes.append(_backwards(route) if index in self.reversed else route)
        return Layout(content.size, content.nodes, tuple(routes))

    def _content(self, box: str, depth: int, leaving: Mapping[int, bool]) -> _Content:
        """The layout of a box; "" is the whole graph.

        Args:
            depth: the number of boxes around its content.
            leaving: the links with one end in the box, and whether they leave it at its upper border.
        """
        children = list(dict.fromkeys(path[depth] for path in map(self.boxes.path, self.sizes) if _is_in(path, box)))
        number = {name: index for index, name in enumerate(children)}
        pairs = {
            index: (source[depth], target[depth])
            for index, (source, target) in enumerate(self.ends)
            if _is_in(source, box) and _is_in(target, box) and source[depth] != target[depth]
        }
        closing = closing_links(len(children), [(number[a], number[b]) for a, b in pairs.values()])
        turned = {index for position, index in enumerate(pairs) if position in closing}
        self.reversed |= turned
        down = {index: (b, a) if index in turned else (a, b) for index, (a, b) in pairs.items()}
        for index, is_top in leaving.items():
            source, target = self.ends[index]
            inner, port = (source if _is_in(source, box) else target)[depth], _port(index)
            down[index] = (port, inner) if is_top else (inner, port)
        contents: dict[str, _Content] = {}
        for child in children:
            if child in self.boxes.headings:
                own = {index: b == child for index, (a, b) in down.items() if child in (a, b)}
                contents[child] = self._content(child, depth + 1, own)
        layout = self._arranged(children, down, contents, leaving, labelled=frozenset(pairs))
        content = self._joined(layout, down, contents, leaving)
        return self._framed(box, content, leaving) if box else content

    def _arranged(
        self,
        children: Sequence[str],
        down: Mapping[int, tuple[str, str]],
        contents: Mapping[str, _Content],
        leaving: Mapping[int, bool],
        labelled: frozenset[int],
    ) -> Layout:
        """The layout of the children of a box and its ports. The routes are in the order of `down`."""
        sizes = {name: contents[name].size if name in contents else self.sizes[name] for name in children}
        sizes |= {_port(index): Extent(0, 0) for index in leaving}
        links = [self._link(index, ends, is_labelled=index in labelled) for index, ends in down.items()]
        anchors = {
            (name, position): contents[name].ports[index] - contents[name].size.width / 2
            for position, (index, ends) in enumerate(down.items())
            for name in ends
            if name in contents
        }
        tops = frozenset(_port(index) for index, is_top in leaving.items() if is_top)
        bottoms = frozenset(_port(index) for index, is_top in leaving.items() if not is_top)
        boundary = Boundary(anchors, tops, bottoms)
        parts = [
            (component(sizes, names, indexes, links, boundary), indexes) for names, indexes in components(sizes, links)
        ]
        if not leaving:
            return self._packed(parts, len(links))
        closed = [part for part in parts if part[0].nodes.keys().isdisjoint(tops | bottoms)]
        open_parts = [part for part in parts if not part[0].nodes.keys().isdisjoint(tops | bottoms)]
        if closed:
            own = sorted(index for _, indexes in closed for index in indexes)
            place = {index: position for position, index in enumerate(own)}
            local = [(layout, [place[index] for index in indexes]) for layout, indexes in closed]
            open_parts.append((self._packed(local, len(own)), own))
        return _in_a_row(open_parts, links, bottoms)

    def _packed(self, parts: Sequence[tuple[Layout, Sequence[int]]], links: int) -> Layout:
        """Parts in rows as readers see them, also if the layout will be turned."""
        if not self.is_turned:
            return pack(parts, links, self.aspect)
        return pack([(layout.turned, indexes) for layout, indexes in parts], links, 1 / self.aspect).turned

    def _link(self, index: int, ends: tuple[str, str], *, is_labelled: bool) -> Link:
        """The part of a link between two children of a box."""
        link = self.links[index]
        ports = (link.port(end) if end in (link.source, link.target) else None for end in ends)
        return Link(*ends, link.label if is_labelled else None, *ports)

    def _joined(
        self,
        layout: Layout,
        down: Mapping[int, tuple[str, str]],
        contents: Mapping[str, _Content],
        leaving: Mapping[int, bool],
    ) -> _Content:
        """A layout with the contents of its boxes."""
        nodes: dict[str, Box] = {}
        routes = dict(zip(down, layout.routes, strict=True))
        for name, place in layout.nodes.items():
            if name in contents or name in self.sizes:
                nodes[name] = place
            if name not in contents:
                continue
            content = contents[name]
            nodes |= {inner: box.moved(place.x, place.y) for inner, box in content.nodes.items()}
            for index, route in content.routes.items():
                inside = route.moved(place.x, place.y)
                if index not in down:
                    routes[index] = inside
                elif down[index][0] == name:
                    routes[index] = _chained(inside, routes[index])
                else:
                    routes[index] = _chained(routes[index], inside)
        ports = {index: layout.nodes[_port(index)].x for index in leaving}
        return _Content(layout.size, nodes, routes, ports)

    def _framed(self, box: str, content: _Content, leaving: Mapping[int, bool]) -> _Content:
        """The content with a margin and the space for the heading, which no line crosses."""
        heading = self.boxes.headings[box]
        width, height = content.size
        if self.is_turned:
            x, y = heading.height, BOX_MARGIN
            size = Extent(x + width + BOX_MARGIN, max(y + height + BOX_MARGIN, heading.width))
        else:
            # All lines that enter at the top are at the right of the heading.
            x = max([BOX_MARGIN, *(heading.width - content.ports[index] for index in leaving if leaving[index])])
            y = heading.height
            size = Extent(max(x + width + BOX_MARGIN, heading.width), y + height + BOX_MARGIN)
        ports = {index: place + x for index, place in content.ports.items()}
        routes = {index: route.moved(x, y) for index, route in content.routes.items()}
        for index, is_top in leaving.items():
            end = _point(ports[index], 0.0 if is_top else size.height)
            routes[index] = _chained(end, routes[index]) if is_top else _chained(routes[index], end)
        return _Content(size, {name: place.moved(x, y) for name, place in content.nodes.items()}, routes, ports)


def _port(index: int) -> str:
    """The name of the port of a link; no node has it, because names of nodes are not empty."""
    return f"\0{index}"


def _is_in(path: Sequence[str], box: str) -> bool:
    """Whether a node with this path is in a box."""
    return not box or box in path[:-1]


def _in_a_row(parts: Sequence[tuple[Layout, Sequence[int]]], links: Sequence[Link], bottoms: Container[str]) -> Layout:
    """Parts side by side, so that straight lines lead from their ports to the borders.

    Args:
        parts: each layout, with the indexes of its links.
        bottoms: the ports at the lower border.
    """
    height = max(layout.size.height for layout, _ in parts)
    nodes: dict[str, Box] = {}
    routes: dict[int, Route] = {}
    x = 0.0
    for layout, indexes in parts:
        for name, box in layout.nodes.items():
            nodes[name] = Box(box.x + x, height, 0, 0) if name in bottoms else box.moved(x, 0)
        for index, route in zip(indexes, layout.routes, strict=True):
            target, moved = links[index].target, route.moved(x, 0)
            routes[index] = _chained(moved, _point(nodes[target].x, height)) if target in bottoms else moved
        x += layout.size.width + DISTANCE
    return Layout(Extent(x - DISTANCE, height), nodes, tuple(routes[index] for index in range(len(links))))


def _point(x: float, y: float) -> Route:
    return Route(((Point(x, y),),))


def _chained(upper: Route, lower: Route) -> Route:
    """A line that continues another one."""
    joint = simplified([*upper.parts[-1], *lower.parts[0]])
    return Route((*upper.parts[:-1], joint, *lower.parts[1:]), upper.label or lower.label)


def _backwards(route: Route) -> Route:
    return Route(tuple(part[::-1] for part in reversed(route.parts)), route.label)

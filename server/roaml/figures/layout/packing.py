# SPDX-License-Identifier: Apache-2.0
"""Parts of a graph that are not connected, and their places side by side."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence

from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.layout.graph import Layout, Link, Route

DISTANCE = 48.0
"""The distance between parts that are not connected, in pixels."""
MAX_IN_ROW = 50
"""The maximum number of parts in the first row."""


def components(names: Iterable[str], links: Sequence[Link]) -> Iterator[tuple[list[str], list[int]]]:
    """The connected parts: their nodes and the indexes of their links, in the order of the nodes."""
    neighbours: dict[str, list[str]] = {name: [] for name in names}
    for link in links:
        neighbours[link.source].append(link.target)
        neighbours[link.target].append(link.source)
    part: dict[str, int] = {}
    count = 0
    for start in neighbours:
        if start in part:
            continue
        stack = [start]
        while stack:
            name = stack.pop()
            if name not in part:
                part[name] = count
                stack += neighbours[name]
        count += 1
    nodes: list[list[str]] = [[] for _ in range(count)]
    indexes: list[list[int]] = [[] for _ in range(count)]
    for name, number in part.items():
        nodes[number].append(name)
    for index, link in enumerate(links):
        indexes[part[link.source]].append(index)
    order = {name: index for index, name in enumerate(neighbours)}
    return (
        (sorted(group, key=order.__getitem__), group_links) for group, group_links in zip(nodes, indexes, strict=True)
    )


def rows_within(sizes: Sequence[Extent], limit: float, distance: float) -> tuple[list[Point], Extent]:
    """The places of boxes in rows, in their order, and the size of all rows.

    Args:
        limit: the maximum width of a row with several boxes, in pixels.
        distance: the distance between boxes, in pixels.
    """
    places: list[Point] = []
    x = y = height = width = 0.0
    for size in sizes:
        if x > 0 and x + size.width > limit:
            x, y, height = 0.0, y + height + distance, 0.0
        places.append(Point(x, y))
        width, height = max(width, x + size.width), max(height, size.height)
        x += size.width + distance
    return places, Extent(width, y + height)


def best_rows(sizes: Sequence[Extent], aspect: float, distance: float = DISTANCE) -> tuple[list[Point], Extent]:
    """The places of boxes in rows whose number suits a page best, in their order, and the size of all rows.

    Args:
        aspect: the ratio of width to height of the page.
        distance: the distance between boxes, in pixels.
    """
    widths = itertools.accumulate(size.width + distance for size in sizes)
    least = max((size.width for size in sizes), default=0.0)
    candidates = (rows_within(sizes, max(least, width), distance) for width in itertools.islice(widths, MAX_IN_ROW))
    return min(candidates, key=lambda rows: max(rows[1].width, rows[1].height * aspect), default=([], Extent(0.0, 0.0)))


def pack(parts: Sequence[tuple[Layout, Sequence[int]]], links: int, aspect: float) -> Layout:
    """Several layouts side by side and in rows below each other, in their order, as one layout.

    Args:
        parts: each layout, with the indexes of its links in the whole graph.
        links: the number of links of the whole graph.
        aspect: the desired ratio of width to height.
    """
    places, size = best_rows([layout.size for layout, _ in parts], aspect)
    boxes: dict[str, Box] = {}
    routes: dict[int, Route] = {}
    for (layout, indexes), (dx, dy) in zip(parts, places, strict=True):
        boxes |= {name: box.moved(dx, dy) for name, box in layout.nodes.items()}
        routes |= {index: route.moved(dx, dy) for index, route in zip(indexes, layout.routes, strict=True)}
    return Layout(size, boxes, tuple(routes[index] for index in range(links)))

# SPDX-License-Identifier: Apache-2.0
"""The places of vertices within their layers: near their neighbours in other layers, with a minimum distance from the
next vertex of the layer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

from roaml.figures.layout.spread import spread
from roaml.figures.layout.vertices import Vertex, VertexKind, distance

SWEEPS = 16
_STRAIGHTNESS = {0: 1.0, 1: 3.0, 2: 10.0}
"""The weight of a link, by the number of its ends at which a line only passes a layer."""


def place_vertices(
    vertices: Sequence[Vertex],
    rows: Sequence[Sequence[int]],
    edges: Sequence[tuple[int, int]],
    leaving: Mapping[int, float],
    entering: Mapping[int, float],
) -> list[float]:
    """The place of the middle of each vertex within its layer.

    Args:
        leaving, entering: where edges, by their indexes, leave their upper and enter their lower vertex, relative to
            its middle, if that is fixed.
    """
    gaps = distances(vertices, rows)
    neighbours: list[list[tuple[int, float, float]]] = [[] for _ in vertices]
    for index, (source, target) in enumerate(edges):
        shift = leaving.get(index, 0.0) - entering.get(index, 0.0)
        passing = sum(vertices[end].kind is VertexKind.PASSING for end in (source, target))
        neighbours[source].append((target, _STRAIGHTNESS[passing], -shift))
        neighbours[target].append((source, _STRAIGHTNESS[passing], shift))
    places = [0.0] * len(vertices)
    for row, row_gaps in zip(rows, gaps, strict=True):
        middle = sum(row_gaps) / 2
        for vertex, place in zip(row, spread([-middle] * len(row), row_gaps), strict=True):
            places[vertex] = place
    indexes = range(len(rows))
    for sweep in range(SWEEPS):
        for index in indexes if sweep % 2 == 0 else reversed(indexes):
            row = rows[index]
            pulls = [sum(weight for _, weight, _ in neighbours[vertex]) for vertex in row]
            desired = [
                sum((places[other] + shift) * weight for other, weight, shift in neighbours[vertex]) / pull
                if pull
                else places[vertex]
                for vertex, pull in zip(row, pulls, strict=True)
            ]
            moved = spread(desired, gaps[index], [pull or 0.1 for pull in pulls])
            for vertex, place in zip(row, moved, strict=True):
                places[vertex] = place
    _straighten(vertices, rows, gaps, edges, places)
    return places


def distances(vertices: Sequence[Vertex], rows: Sequence[Sequence[int]]) -> list[list[float]]:
    """The minimum distances between the middles of neighbours in each row."""
    return [
        [
            (vertices[a].size.width + vertices[b].size.width) / 2 + distance(vertices[a], vertices[b])
            for a, b in pairwise(row)
        ]
        for row in rows
    ]


def _straighten(
    vertices: Sequence[Vertex],
    rows: Sequence[Sequence[int]],
    gaps: Sequence[Sequence[float]],
    edges: Sequence[tuple[int, int]],
    places: list[float],
) -> None:
    """Give the vertices of one line the same place, if their neighbours leave enough space for it."""
    where = {vertex: (index, column) for index, row in enumerate(rows) for column, vertex in enumerate(row)}

    def limits(vertex: int) -> tuple[float, float]:
        index, column = where[vertex]
        row = rows[index]
        low = places[row[column - 1]] + gaps[index][column - 1] if column > 0 else float("-inf")
        high = places[row[column + 1]] - gaps[index][column] if column < len(row) - 1 else float("inf")
        return low, high

    for line in _lines(vertices, edges):
        start = 0
        while start < len(line):
            low, high = limits(line[start])
            end = start + 1
            while end < len(line):
                next_low, next_high = limits(line[end])
                if max(low, next_low) > min(high, next_high):
                    break
                low, high = max(low, next_low), min(high, next_high)
                end += 1
            part = line[start:end]
            middle = sorted(places[vertex] for vertex in part)[len(part) // 2]
            for vertex in part:
                places[vertex] = min(max(middle, low), high)
            start = end


def _lines(vertices: Sequence[Vertex], edges: Sequence[tuple[int, int]]) -> list[list[int]]:
    """The vertices on each long link, without its ends. The longest link is first."""
    following = {a: b for a, b in edges if VertexKind.NODE not in (vertices[a].kind, vertices[b].kind)}
    inner = set(following.values())
    lines = []
    for start in following:
        if start in inner:
            continue
        line = [start]
        while line[-1] in following:
            line.append(following[line[-1]])
        lines.append(line)
    return sorted(lines, key=len, reverse=True)

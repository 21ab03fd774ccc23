# SPDX-License-Identifier: Apache-2.0
"""The points where lines leave and enter nodes. Lines are as straight as possible, with a minimum distance from each
other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from roaml.figures.layout.spread import spread
from roaml.figures.layout.tracks import CLEARANCE
from roaml.figures.layout.vertices import Vertex, VertexKind

PORT_DISTANCE = 16.0
PORT_MARGIN = 12.0
LABEL_MARGIN = 7.0
"""The minimum distances, in pixels: of two lines at a node; of a line from a corner of a node; of a line from a corner
of a label."""
_SWEEPS = 6


class Ports:
    """The ports of all edges.

    `leaving` and `entering`, by the indexes of edges, are the places of those that are fixed, relative to the middle of
    their vertices: of edges at boxes.

    Attributes:
        leaving: the place where each edge leaves its upper vertex.
        entering: the place where each edge enters its lower vertex.
    """

    def __init__(
        self,
        vertices: Sequence[Vertex],
        rows: Sequence[Sequence[int]],
        edges: Sequence[tuple[int, int]],
        middles: Sequence[float],
        leaving: Mapping[int, float],
        entering: Mapping[int, float],
    ) -> None:
        self._vertices = vertices
        self._middles = middles
        column = {vertex: index for row in rows for index, vertex in enumerate(row)}
        self._fixed = {edges[index][0] for index in leaving} | {edges[index][1] for index in entering}
        self.leaving = [middles[upper] + leaving.get(index, 0.0) for index, (upper, _) in enumerate(edges)]
        self.entering = [middles[lower] + entering.get(index, 0.0) for index, (_, lower) in enumerate(edges)]
        outgoing: list[list[int]] = [[] for _ in vertices]
        incoming: list[list[int]] = [[] for _ in vertices]
        for index, (upper, lower) in enumerate(edges):
            outgoing[upper].append(index)
            incoming[lower].append(index)
        for vertex in range(len(vertices)):
            outgoing[vertex].sort(key=lambda index: (column[edges[index][1]], index))
            incoming[vertex].sort(key=lambda index: (column[edges[index][0]], index))
        for _ in range(_SWEEPS):
            for row in rows:
                for vertex in row:
                    self._place(vertex, incoming[vertex], self.entering, self.leaving)
                    self._place(vertex, outgoing[vertex], self.leaving, self.entering)
        for index, (upper, lower) in enumerate(edges):
            self._align(index, (upper, outgoing[upper]), (lower, incoming[lower]))

    def _place(self, vertex: int, edges: Sequence[int], own: list[float], other: Sequence[float]) -> None:
        """Place the lines at one side of a vertex so that each is opposite to its other end, if possible."""
        if not edges or vertex in self._fixed or self._vertices[vertex].kind is VertexKind.PASSING:
            return
        low, high = self._limits(vertex)
        distances = [PORT_DISTANCE] * (len(edges) - 1)
        for index, place in zip(edges, spread([other[e] for e in edges], distances, None, low, high), strict=True):
            own[index] = place

    def _limits(self, vertex: int) -> tuple[float, float]:
        margin = LABEL_MARGIN if self._vertices[vertex].kind is VertexKind.LABEL else PORT_MARGIN
        half = max(0.0, self._vertices[vertex].size.width / 2 - margin)
        return self._middles[vertex] - half, self._middles[vertex] + half

    def _align(self, index: int, upper: tuple[int, Sequence[int]], lower: tuple[int, Sequence[int]]) -> None:
        """Remove the bend of a line whose ends are nearly opposite to each other."""
        if abs(self.leaving[index] - self.entering[index]) >= CLEARANCE:
            return
        if self._is_free(*lower, index, self.entering, self.leaving[index]):
            self.entering[index] = self.leaving[index]
        elif self._is_free(*upper, index, self.leaving, self.entering[index]):
            self.leaving[index] = self.entering[index]

    def _is_free(self, vertex: int, edges: Sequence[int], index: int, own: Sequence[float], place: float) -> bool:
        if vertex in self._fixed or self._vertices[vertex].kind is VertexKind.PASSING:
            return False
        low, high = self._limits(vertex)
        return low <= place <= high and all(e == index or abs(own[e] - place) >= CLEARANCE for e in edges)

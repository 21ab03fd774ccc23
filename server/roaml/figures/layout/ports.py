# SPDX-License-Identifier: Apache-2.0
"""The points where lines leave and enter nodes. Lines are as straight as possible, with a minimum distance from each
other. A line passes through the middle of its label."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from roaml.figures.layout.spread import spread
from roaml.figures.layout.tracks import CLEARANCE
from roaml.figures.layout.vertices import Vertex, VertexKind

PORT_DISTANCE = 16.0
PORT_MARGIN = 12.0
CORNER = 8.0
"""The minimum distances, in pixels: of two lines at a node; of a line from a corner of a node, and the same if this
removes a small bend."""
_SWEEPS = 6


class Ports:
    """The ports of all edges.

    `fixed` are the places of the edges that are fixed, by their indexes, where they leave their upper vertex and where
    they enter the lower one, relative to the middles of the vertices: of edges at boxes. `wanted` are those near which
    edges should be. If a side of a node has such edges, the others at this side are at its beginning.

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
        fixed: tuple[Mapping[int, float], Mapping[int, float]],
        wanted: tuple[Mapping[int, float], Mapping[int, float]],
    ) -> None:
        leaving, entering = fixed
        self._vertices = vertices
        self._middles = middles
        column = {vertex: index for row in rows for index, vertex in enumerate(row)}
        self._fixed = {edges[index][0] for index in leaving} | {edges[index][1] for index in entering}
        self._settled: set[tuple[int, tuple[int, ...]]] = set()
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
            for side, places, own in ((outgoing, wanted[0], self.leaving), (incoming, wanted[1], self.entering)):
                self._settle(vertex, side[vertex], places, own)
        self._edges = edges
        self._outgoing, self._incoming = outgoing, incoming
        for _ in range(_SWEEPS):
            for row in rows:
                for vertex in row:
                    self._place(vertex, incoming[vertex], self.entering, self.leaving)
                    self._place(vertex, outgoing[vertex], self.leaving, self.entering)
        self._align()

    @property
    def shifts(self) -> list[float]:
        """Where each edge leaves its upper vertex minus where it enters the lower one, relative to their middles."""
        return [
            (leaving - self._middles[upper]) - (entering - self._middles[lower])
            for leaving, entering, (upper, lower) in zip(self.leaving, self.entering, self._edges, strict=True)
        ]

    def move(self, middles: Sequence[float]) -> None:
        """Move the ports with the middles of their vertices, then each port opposite to its other end if possible."""
        for index, (upper, lower) in enumerate(self._edges):
            self.leaving[index] += middles[upper] - self._middles[upper]
            self.entering[index] += middles[lower] - self._middles[lower]
        self._middles = middles
        self._align()

    def _settle(self, vertex: int, edges: list[int], wanted: Mapping[int, float], own: list[float]) -> None:
        """Place the lines at one side of a vertex if some of them have a wanted place."""
        if not any(index in wanted for index in edges):
            return
        low, high = self._limits(vertex)
        places = {index: self._middles[vertex] + wanted[index] if index in wanted else low for index in edges}
        edges.sort(key=places.__getitem__)
        distances = [CLEARANCE] * (len(edges) - 1)
        placed = spread([places[index] for index in edges], distances, None, low, high)
        for index, place in zip(edges, placed, strict=True):
            own[index] = place
        self._settled.add((vertex, tuple(edges)))

    def _place(self, vertex: int, edges: Sequence[int], own: list[float], other: Sequence[float]) -> None:
        """Place the lines at one side of a vertex so that each is opposite to its other end, if possible. A single line
        is in the middle."""
        if len(edges) < 2 or not self._has_choice(vertex, edges):
            return
        low, high = self._limits(vertex)
        distances = [PORT_DISTANCE] * (len(edges) - 1)
        for index, place in zip(edges, spread([other[e] for e in edges], distances, None, low, high), strict=True):
            own[index] = place

    def _limits(self, vertex: int, margin: float = PORT_MARGIN) -> tuple[float, float]:
        half = max(0.0, self._vertices[vertex].size.width / 2 - margin)
        return self._middles[vertex] - half, self._middles[vertex] + half

    def _align(self) -> None:
        """Remove the bends of lines one of whose ends can be opposite to the other one."""
        for index, (upper, lower) in enumerate(self._edges):
            leaving, entering = self.leaving[index], self.entering[index]
            if leaving == entering:
                continue
            if self._fits(lower, self._incoming[lower], index, self.entering, leaving):
                self.entering[index] = leaving
            elif self._fits(upper, self._outgoing[upper], index, self.leaving, entering):
                self.leaving[index] = entering

    def _fits(self, vertex: int, edges: Sequence[int], index: int, own: Sequence[float], place: float) -> bool:
        """Whether an edge can have its port at a place, at a distance from others and in the same order. The distances
        may be smaller than usual if this removes a small bend."""
        if not self._has_choice(vertex, edges):
            return False
        is_small = abs(own[index] - place) < PORT_DISTANCE
        low, high = self._limits(vertex, CORNER if is_small else PORT_MARGIN)
        distance = CLEARANCE if is_small else PORT_DISTANCE
        position = edges.index(index)
        if position > 0:
            low = max(low, own[edges[position - 1]] + distance)
        if position < len(edges) - 1:
            high = min(high, own[edges[position + 1]] - distance)
        return low <= place <= high

    def _has_choice(self, vertex: int, edges: Sequence[int]) -> bool:
        """Whether the lines at one side of a vertex can be at different places."""
        is_node = self._vertices[vertex].kind is VertexKind.NODE
        return is_node and vertex not in self._fixed and (vertex, tuple(edges)) not in self._settled

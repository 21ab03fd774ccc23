# SPDX-License-Identifier: Apache-2.0
"""Straight lines: vertices are moved within their layers so that lines have few bends.

What straight lines connect moves together, and pushes aside what is in its way. A move is made if it removes more bends
and length than it adds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

BEND = 40.0
"""The length, in pixels, that is as bad as a line which is not straight; twice as much if it is nearly straight."""
STRAIGHT, NEARLY = 0.01, 14.0
"""A line whose ends differ by less than this is straight, or nearly straight, in pixels."""
_ROUNDS = 4
_MAX_MOVED = 40
"""The maximum number of vertices that move together."""


class Straightening:
    """The places of the vertices of a layered graph, in which lines become straight.

    Attributes:
        places: the place of the middle of each vertex within its layer.
    """

    def __init__(
        self,
        rows: Sequence[Sequence[int]],
        gaps: Sequence[Sequence[float]],
        edges: Sequence[tuple[int, int]],
        places: Sequence[float],
        shifts: Sequence[float],
    ) -> None:
        """
        Args:
            gaps: the minimum distances between the middles of neighbours in each row.
            edges: links between neighbouring layers.
            shifts: the place where each edge leaves its upper vertex minus the one where it enters the lower one, both
                relative to the middles of these vertices.
        """
        self.places = list(places)
        self._edges = edges
        self._shifts = shifts
        self._incident: list[list[int]] = [[] for _ in places]
        for index, ends in enumerate(edges):
            for end in ends:
                self._incident[end].append(index)
        self._after: dict[int, tuple[int, float]] = {}
        self._before: dict[int, tuple[int, float]] = {}
        for row, row_gaps in zip(rows, gaps, strict=True):
            for (left, right), gap in zip(pairwise(row), row_gaps, strict=True):
                self._after[left] = right, gap
                self._before[right] = left, gap
        self._groups: list[list[int]] = [[] for _ in places]
        """The vertices that straight lines connect with each vertex."""
        self._connect(range(len(places)))

    def run(self) -> None:
        for _ in range(_ROUNDS):
            bent = [index for index in range(len(self._edges)) if abs(self._offset(index)) > STRAIGHT]
            changes = [self._straighten(index) for index in sorted(bent, key=lambda index: abs(self._offset(index)))]
            if not any(changes):
                return

    def _offset(self, index: int) -> float:
        upper, lower = self._edges[index]
        return self.places[upper] + self._shifts[index] - self.places[lower]

    def _connect(self, vertices: Sequence[int]) -> None:
        """Group the vertices that straight lines connect; these lead to no others than the given ones."""
        for vertex in vertices:
            self._groups[vertex] = []
        for start in vertices:
            if self._groups[start]:
                continue
            group = [start]
            self._groups[start] = group
            for vertex in group:
                for index in self._incident[vertex]:
                    if abs(self._offset(index)) <= STRAIGHT:
                        for other in self._edges[index]:
                            if not self._groups[other]:
                                self._groups[other] = group
                                group.append(other)

    def _move(self, distances: Mapping[int, float]) -> None:
        """Move vertices, and group again those whose lines have changed."""
        for vertex, distance in distances.items():
            self.places[vertex] += distance
        near = {end for vertex in distances for index in self._incident[vertex] for end in self._edges[index]}
        self._connect(sorted({member for vertex in near.union(distances) for member in self._groups[vertex]}))

    def _straighten(self, index: int) -> bool:
        """Move one of the ends of an edge so that it is straight; return whether this is better."""
        offset = self._offset(index)
        if abs(offset) <= STRAIGHT:
            return False
        upper, lower = self._edges[index]
        best: Mapping[int, float] = {}
        least = 0.0
        for moving, fixed, distance in ((lower, upper, offset), (upper, lower, -offset)):
            moved = self._pushed(moving, fixed, distance)
            if moved and (cost := self._added(moved)) < least - STRAIGHT:
                best, least = moved, cost
        self._move(best)
        return bool(best)

    def _pushed(self, vertex: int, fixed: int, distance: float) -> Mapping[int, float]:
        """How far each vertex moves if one moves by a distance; empty if a fixed vertex would move, or too many."""
        way = 1.0 if distance > 0 else -1.0
        if self._groups[vertex] is self._groups[fixed]:
            return {}
        following = self._after if distance > 0 else self._before
        groups, places, barrier = self._groups, self.places, self._groups[fixed]
        moved: dict[int, float] = {}
        pending = [(vertex, abs(distance))]
        while pending:
            start, length = pending.pop()
            if moved.get(start, 0.0) >= length - STRAIGHT:
                continue
            group = groups[start]
            if group is barrier or len(moved) + len(group) > 2 * _MAX_MOVED:
                return {}
            for member in group:
                moved[member] = length
                if member in following:
                    other, gap = following[member]
                    needed = gap - way * (places[other] - places[member]) + length
                    if needed > STRAIGHT:
                        pending.append((other, needed))
            if len(moved) > _MAX_MOVED:
                return {}
        return {member: way * length for member, length in moved.items()}

    def _added(self, moved: Mapping[int, float]) -> float:
        """What a move adds to the length of all lines, with their bends."""
        added = 0.0
        for index in {index for vertex in moved for index in self._incident[vertex]}:
            upper, lower = self._edges[index]
            before = self._offset(index)
            after = before + moved.get(upper, 0.0) - moved.get(lower, 0.0)
            added += _cost(after) - _cost(before)
        return added


def _cost(offset: float) -> float:
    if abs(offset) <= STRAIGHT:
        return 0.0
    return abs(offset) + (2 * BEND if abs(offset) < NEARLY else BEND)

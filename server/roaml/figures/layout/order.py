# SPDX-License-Identifier: Apache-2.0
"""The order of vertices within their layers, with few crossings of lines."""

from __future__ import annotations

import random
from bisect import bisect_right, insort
from collections.abc import Sequence
from itertools import pairwise

MAX_SWEEPS = 12
MAX_STARTS = 12
MAX_WORK = 3000
"""The maximum number of orders from which the sweeps begin, and of vertices in all of them together."""


def order_layers(layers: Sequence[int], edges: Sequence[tuple[int, int]]) -> list[list[int]]:
    """The vertices of each layer from left to right.

    The vertices of a layer are in the order of a depth-first search along the edges; another order is used only if it
    has fewer crossings.

    Args:
        layers: the layer of each vertex.
        edges: links between neighbouring layers.
    """
    count = max(layers, default=-1) + 1
    rows: list[list[int]] = [[] for _ in range(count)]
    above: list[list[int]] = [[] for _ in layers]
    below: list[list[int]] = [[] for _ in layers]
    for source, target in edges:
        below[source].append(target)
        above[target].append(source)
    for vertex in _by_depth(layers, below, above):
        rows[layers[vertex]].append(vertex)
    best, least = [list(row) for row in rows], crossings(rows, below)
    for start in range(max(1, min(MAX_STARTS, MAX_WORK // max(1, len(layers))))):
        if start > 0:
            chance = random.Random(start)
            rows = [chance.sample(row, len(row)) for row in best]
            if start % 2:
                rows = [[] for _ in range(count)]
                for vertex in _by_depth(layers, below, above, chance):
                    rows[layers[vertex]].append(vertex)
        for sweep in range(MAX_SWEEPS):
            if least == 0:
                return best
            downwards = (sweep + start) % 2 == 0
            for index in range(1, count) if downwards else range(count - 2, -1, -1):
                fixed = rows[index - 1 if downwards else index + 1]
                rows[index] = _by_barycenter(rows[index], fixed, above if downwards else below)
            _exchange(rows, above, below)
            now = crossings(rows, below)
            if now < least:
                best, least = [list(row) for row in rows], now
    return best


def crossings(rows: Sequence[Sequence[int]], below: Sequence[Sequence[int]]) -> int:
    """The number of crossings of the links between all neighbouring layers."""
    total = 0
    for upper, lower in pairwise(rows):
        place = {vertex: index for index, vertex in enumerate(lower)}
        ends: list[int] = []
        for vertex in upper:
            targets = sorted(place[target] for target in below[vertex])
            total += sum(len(ends) - bisect_right(ends, target) for target in targets)
            for target in targets:
                insort(ends, target)
    return total


def _by_depth(
    layers: Sequence[int],
    below: Sequence[Sequence[int]],
    above: Sequence[Sequence[int]],
    chance: random.Random | None = None,
) -> list[int]:
    """All vertices in the order of a depth-first search downwards, then upwards; with `chance`, from random ones."""
    order: dict[int, None] = {}
    starts = sorted(range(len(layers)), key=lambda vertex: (layers[vertex], vertex))
    for start in starts if chance is None else chance.sample(starts, len(starts)):
        stack = [start]
        while stack:
            vertex = stack.pop()
            if vertex in order:
                continue
            order[vertex] = None
            stack += [other for other in reversed((*below[vertex], *above[vertex])) if other not in order]
    return list(order)


def _by_barycenter(row: list[int], fixed: Sequence[int], neighbours: Sequence[Sequence[int]]) -> list[int]:
    """The vertices of a row, ordered by the mean of the places of their neighbours. Vertices without neighbours keep
    their places."""
    place = {vertex: index for index, vertex in enumerate(fixed)}
    means = {
        vertex: sum(place[other] for other in neighbours[vertex]) / len(neighbours[vertex])
        for vertex in row
        if neighbours[vertex]
    }
    movable = iter(sorted(means, key=lambda vertex: means[vertex]))
    return [next(movable) if vertex in means else vertex for vertex in row]


def _exchange(rows: list[list[int]], above: Sequence[Sequence[int]], below: Sequence[Sequence[int]]) -> None:
    """Exchange adjacent vertices of a row where this removes crossings."""
    place = {vertex: index for row in rows for index, vertex in enumerate(row)}
    for row in rows:
        improved = True
        while improved:
            improved = False
            for index in range(len(row) - 1):
                left, right = row[index], row[index + 1]
                now = _pair(above, left, right, place) + _pair(below, left, right, place)
                other = _pair(above, right, left, place) + _pair(below, right, left, place)
                if other < now:
                    row[index], row[index + 1] = right, left
                    place[left], place[right] = index + 1, index
                    improved = True


def _pair(neighbours: Sequence[Sequence[int]], left: int, right: int, place: dict[int, int]) -> int:
    """The number of crossings of the links of two vertices, if `left` is left of `right`."""
    return sum(place[a] > place[b] for a in neighbours[left] for b in neighbours[right])

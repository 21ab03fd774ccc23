# SPDX-License-Identifier: Apache-2.0
"""The order of vertices within their layers, with few crossings of lines."""

from __future__ import annotations

import math
import random
from bisect import bisect_right, insort
from collections.abc import Mapping, Sequence
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
        earlier: list[list[list[int]]] = []
        for sweep in range(MAX_SWEEPS):
            if least == 0:
                return best
            downwards = (sweep + start) % 2 == 0
            for index in range(1, count) if downwards else range(count - 2, -1, -1):
                fixed = rows[index - 1 if downwards else index + 1]
                rows[index] = _by_barycenter(rows[index], fixed, above if downwards else below)
            _exchange(rows, above, below)
            now = crossings(rows, below, least)
            if now < least:
                best, least = [list(row) for row in rows], now
            if rows in earlier[-2::-2]:  # the sweeps that follow repeat those after this one
                break
            earlier.append([list(row) for row in rows])
    return best


def crossings(rows: Sequence[Sequence[int]], below: Sequence[Sequence[int]], limit: float = math.inf) -> int:
    """The number of crossings of the links between all neighbouring layers; a smaller number if it is above a limit."""
    total = 0
    for upper, lower in pairwise(rows):
        place = {vertex: index for index, vertex in enumerate(lower)}
        ends: list[int] = []
        for vertex in upper:
            targets = [place[target] for target in below[vertex]]
            if len(targets) > 1:
                targets.sort()
            for target in targets:
                total += len(ends) - bisect_right(ends, target)
            for target in targets:
                insort(ends, target)
        if total > limit:
            break
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
    means: dict[int, float] = {}
    for vertex in row:
        others = neighbours[vertex]
        if len(others) == 1:
            means[vertex] = place[others[0]]
        elif others:
            means[vertex] = sum([place[other] for other in others]) / len(others)
    movable = iter(sorted(means, key=means.__getitem__))
    return [next(movable) if vertex in means else vertex for vertex in row]


def _exchange(rows: list[list[int]], above: Sequence[Sequence[int]], below: Sequence[Sequence[int]]) -> None:
    """Exchange adjacent vertices of a row where this removes crossings."""
    place = {vertex: index for row in rows for index, vertex in enumerate(row)}
    for row in rows:
        ends = {vertex: (_ends(above[vertex], place), _ends(below[vertex], place)) for vertex in row}
        improved = True
        while improved:
            improved = False
            for index in range(len(row) - 1):
                left, right = row[index], row[index + 1]
                (left_above, left_below), (right_above, right_below) = ends[left], ends[right]
                if _are_apart(left_above, right_above) and _are_apart(left_below, right_below):
                    continue
                if _removed(left_above, right_above) + _removed(left_below, right_below) > 0:
                    row[index], row[index + 1] = right, left
                    improved = True
        for index, vertex in enumerate(row):
            place[vertex] = index


def _ends(neighbours: Sequence[int], place: Mapping[int, int]) -> list[int]:
    """The places of the neighbours of a vertex in the next row, in their order."""
    if len(neighbours) == 1:
        return [place[neighbours[0]]]
    return sorted([place[other] for other in neighbours])


def _are_apart(left: Sequence[int], right: Sequence[int]) -> bool:
    """Whether the links to these places do not cross."""
    return not left or not right or left[-1] <= right[0]


def _removed(left: Sequence[int], right: Sequence[int]) -> int:
    """The number of crossings that an exchange of two adjacent vertices removes."""
    return sum([(a > b) - (a < b) for a in left for b in right])

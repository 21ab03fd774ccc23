# SPDX-License-Identifier: Apache-2.0
"""The layer of every vertex: each link leads to a later layer."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence

from roaml.figures.layout.vertices import NODE_DISTANCE, Vertex, VertexKind


def assign_layers(
    vertices: Sequence[Vertex], edges: Sequence[tuple[int, int]], limit: float | None = None
) -> list[int]:
    """The layer of each vertex, from 0. A node is in the first possible layer, a node without predecessors is directly
    before its first successor, and a label is near the middle of its link.

    Args:
        edges: the pairs (from, to) of an acyclic graph.
        limit: the desired maximum width of a layer. A vertex for which there is no space is in a later layer; what
            follows a vertex is then near it, because it is placed before the neighbours of this vertex.
    """
    successors: list[list[int]] = [[] for _ in vertices]
    predecessors: list[list[int]] = [[] for _ in vertices]
    for source, target in edges:
        successors[source].append(target)
        predecessors[target].append(source)
    order = _topological(successors, predecessors, deep=limit is not None)
    layers = [0] * len(vertices)
    widths: dict[int, float] = {}
    for vertex in order:
        layers[vertex] = max((layers[p] + 1 for p in predecessors[vertex]), default=0)
        if limit is not None:
            width = vertices[vertex].size.width + NODE_DISTANCE
            while widths.get(layers[vertex]) and widths[layers[vertex]] + width > limit:
                layers[vertex] += 1
            widths[layers[vertex]] = widths.get(layers[vertex], 0) + width
    for vertex in reversed(order) if limit is None else ():
        if not predecessors[vertex] and successors[vertex]:
            layers[vertex] = min(layers[s] for s in successors[vertex]) - 1
    _balance_labels(vertices, predecessors, successors, layers)
    used = {layer: index for index, layer in enumerate(sorted(set(layers)))}
    return [used[layer] for layer in layers]


def column_starts(layers: Sequence[int], edges: Sequence[tuple[int, int]], columns: int) -> list[int]:
    """The first layers of columns of about the same length. Each column begins where few edges pass.

    Args:
        edges: the pairs (from, to) of vertices; the second one is in a later layer.
    """
    count = max(layers) + 1
    passing = [0] * (count + 1)
    for source, target in edges:
        for layer in range(layers[source] + 1, layers[target] + 1):
            passing[layer] += 1
    length = count / columns
    starts = [0]
    for column in range(1, columns):
        ideal = column * length
        near = range(max(starts[-1] + 1, math.ceil(ideal - length / 4)), min(count, int(ideal + length / 4) + 1))
        if near:
            starts.append(min(near, key=lambda layer: (passing[layer], abs(layer - ideal))))
    return starts


def _topological(
    successors: Sequence[Sequence[int]], predecessors: Sequence[Sequence[int]], *, deep: bool
) -> list[int]:
    """The vertices in an order in which all edges lead forwards. If `deep`, what follows a vertex is near it."""
    missing = [len(p) for p in predecessors]
    pending = deque(vertex for vertex, count in enumerate(missing) if count == 0)
    order: list[int] = []
    while pending:
        vertex = pending.popleft()
        order.append(vertex)
        free = []
        for successor in successors[vertex]:
            missing[successor] -= 1
            if missing[successor] == 0:
                free.append(successor)
        if deep:
            pending.extendleft(reversed(free))
        else:
            pending.extend(free)
    return order


def _balance_labels(
    vertices: Sequence[Vertex],
    predecessors: Sequence[Sequence[int]],
    successors: Sequence[Sequence[int]],
    layers: list[int],
) -> None:
    """Move the labels of long links to the least filled layers, if possible to layers that contain no nodes."""
    filled: dict[int, float] = {}
    with_nodes: set[int] = set()
    for vertex, layer in zip(vertices, layers, strict=True):
        filled[layer] = filled.get(layer, 0) + vertex.size.width
        if vertex.kind is VertexKind.NODE:
            with_nodes.add(layer)
    for index, vertex in enumerate(vertices):
        if vertex.kind is not VertexKind.LABEL:
            continue
        first, last = layers[predecessors[index][0]] + 1, layers[successors[index][0]] - 1
        if first >= last:
            continue
        middle = (first + last) / 2
        filled[layers[index]] -= vertex.size.width
        layers[index] = min(
            range(first, last + 1),
            key=lambda layer: (layer in with_nodes, filled.get(layer, 0), abs(layer - middle), layer),
        )
        filled[layers[index]] = filled.get(layers[index], 0) + vertex.size.width

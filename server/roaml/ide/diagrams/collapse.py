# SPDX-License-Identifier: Apache-2.0
"""Diagrams of trees in which nodes are collapsed: the nodes below them are not shown."""

from __future__ import annotations

from collections.abc import Collection

from roaml.ide.diagrams.diagram import Detail, DetailKind, DiagramNodeKind, EdgeKind, Picture
from roaml.record import replace


def collapsed(picture: Picture, ids: Collection[str]) -> Picture:
    """The diagram without the nodes below the nodes whose ids are `ids`, and without the entries of the blackboard that
    only removed nodes use. The last of the details of a collapsed node is the number of removed nodes. Ids that the
    diagram does not contain are ignored."""
    children: dict[str, list[str]] = {}
    for edge in picture.edges:
        if edge.kind is EdgeKind.CHILD:
            children.setdefault(edge.source, []).append(edge.target)
    hidden: set[str] = set()
    counts: dict[str, int] = {}
    for name in ids:
        below, pending = set[str](), list(children.get(name, ()))
        while pending:
            child = pending.pop()
            below.add(child)
            pending += children.get(child, ())
        if below:
            counts[name] = len(below)
            hidden |= below
    edges = [edge for edge in picture.edges if not {edge.source, edge.target} & hidden]
    ends = {end for edge in edges for end in (edge.source, edge.target)}
    nodes = [
        replace(node, details=(*node.details, _hidden(counts[node.id]))) if node.id in counts else node
        for node in picture.nodes
        if node.id not in hidden and (node.kind is not DiagramNodeKind.VARIABLE or node.id in ends)
    ]
    return replace(picture, nodes=tuple(nodes), edges=tuple(edges))


def _hidden(count: int) -> Detail:
    return Detail(DetailKind.COUNT, "… 1 node" if count == 1 else f"… {count} nodes")

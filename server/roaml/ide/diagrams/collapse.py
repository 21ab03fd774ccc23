# SPDX-License-Identifier: Apache-2.0
"""Diagrams in which nodes are collapsed: of a node of a tree, the nodes below it are not shown; a group of states or a
namespace becomes a single node."""

from __future__ import annotations

from collections.abc import Collection

from roaml.ide.diagrams.diagram import (
    Detail,
    DetailKind,
    DiagramEdge,
    DiagramNode,
    DiagramNodeKind,
    EdgeKind,
    Picture,
)
from roaml.ide.diagrams.namespaces import content
from roaml.record import replace

_CONTENT = {DiagramNodeKind.GROUP: "state", DiagramNodeKind.NAMESPACE: "part"}
"""The word for what a node contains, by its kind."""
_TRANSITIONS = (EdgeKind.EVENTLESS, EdgeKind.EVENT, EdgeKind.ROS, EdgeKind.BT)


def collapsed(picture: Picture, ids: Collection[str]) -> Picture:
    """The diagram in which nodes are collapsed. The last of the details of a collapsed node is the number of nodes that
    are not shown. Ids that the diagram does not contain, and those of other nodes, are ignored."""
    return _with_closed(_without_descendants(picture, ids), ids)


def _without_descendants(picture: Picture, ids: Collection[str]) -> Picture:
    """The diagram without the nodes below nodes of a tree, and without the entries of the blackboard that only removed
    nodes use."""
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
        replace(node, details=(*node.details, _count(counts[node.id], "node"))) if node.id in counts else node
        for node in picture.nodes
        if node.id not in hidden and (node.kind is not DiagramNodeKind.VARIABLE or node.id in ends)
    ]
    return replace(picture, nodes=tuple(nodes), edges=tuple(edges))


def _with_closed(picture: Picture, ids: Collection[str]) -> Picture:
    """The diagram in which groups and namespaces are single nodes, which have the edges of what they contain, and hide
    it."""
    closed = {node.id for node in picture.nodes if node.id in ids and node.kind in _CONTENT}
    closed -= content(picture, closed)
    if not closed:
        return picture
    inside = {name: content(picture, {name}) for name in closed}
    representative = {node: name for name, nodes in inside.items() for node in nodes}
    nodes = tuple(
        _closed(picture, node, inside[node.id]) if node.id in closed else node
        for node in picture.nodes
        if node.id not in representative
    )
    edges: dict[tuple[object, ...], DiagramEdge] = {}
    for edge in picture.edges:
        source, target = (representative.get(end, end) for end in (edge.source, edge.target))
        moved = replace(edge, source=source, target=target)
        if source == target and moved != edge:
            continue
        # Edges between the same ends are one, which has the names of all plain events; but each transition remains.
        key = (source, target, edge.kind) if moved != edge and edge.kind not in _TRANSITIONS else (moved,)
        known = edges.get(key, moved)
        edges[key] = replace(known, labels=tuple(dict.fromkeys((*known.labels, *moved.labels))))
    return replace(picture, nodes=nodes, edges=tuple(edges.values()))


def _closed(picture: Picture, box: DiagramNode, ids: Collection[str]) -> DiagramNode:
    inside = [node for node in picture.nodes if node.id in ids]
    count = sum(node.kind not in (*_CONTENT, DiagramNodeKind.CHOICE) for node in inside)
    return replace(
        box,
        details=(*box.details, _count(count, _CONTENT[box.kind])),
        initial=any(node.initial for node in inside),
        hides=tuple(node.id for node in inside),
    )


def _count(count: int, word: str) -> Detail:
    return Detail(DetailKind.COUNT, f"… {count} {word}" if count == 1 else f"… {count} {word}s")

# SPDX-License-Identifier: Apache-2.0
"""Large ROS graphs in which nodes with the same neighbours are one card."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.ide.diagrams.diagram import Detail, DetailKind, DiagramEdge, DiagramNode, DiagramNodeKind, Picture
from roaml.record import replace

_KINDS = (DiagramNodeKind.ROS_NODE, DiagramNodeKind.PLUGIN)


def with_nodes_alike(picture: Picture) -> Picture:
    """The graph with one card for all nodes of one namespace that are connected to the same nodes, in the same way. It
    contains their names, has the id of the first one, and hides the others; edges through it have all their labels."""
    ends: dict[str, list[tuple[object, ...]]] = {node.id: [] for node in picture.nodes}
    for edge in picture.edges:
        ends[edge.source].append((edge.target, edge.kind, edge.interface, True))
        ends[edge.target].append((edge.source, edge.kind, edge.interface, False))
    alike: dict[object, list[DiagramNode]] = {}
    for node in picture.nodes:
        is_single = node.kind not in _KINDS or not ends[node.id]
        key = node.id if is_single else (node.kind, node.parent, frozenset(ends[node.id]))
        alike.setdefault(key, []).append(node)
    first = {node.id: group[0].id for group in alike.values() for node in group}
    nodes = tuple(_card(group) if len(group) > 1 else group[0] for group in alike.values())
    return replace(picture, nodes=nodes, edges=_merged(picture, first))


def _card(group: list[DiagramNode]) -> DiagramNode:
    word = "plugins" if group[0].kind is DiagramNodeKind.PLUGIN else "nodes"
    names = tuple(Detail(DetailKind.COUNT, node.label) for node in group)
    hidden = tuple(id_ for node in group for id_ in (*node.hides, node.id))
    others = tuple(id_ for id_ in hidden if id_ != group[0].id)
    return replace(group[0], label=f"{len(group)} {word}", details=names, hides=others)


def _merged(picture: Picture, first: Mapping[str, str]) -> tuple[DiagramEdge, ...]:
    edges: dict[tuple[object, ...], DiagramEdge] = {}
    for edge in picture.edges:
        source, target = first[edge.source], first[edge.target]
        key = (source, target, edge.kind, edge.interface)
        known = edges.get(key, replace(edge, source=source, target=target, labels=()))
        edges[key] = replace(known, labels=tuple(dict.fromkeys((*known.labels, *edge.labels))))
    return tuple(edges.values())

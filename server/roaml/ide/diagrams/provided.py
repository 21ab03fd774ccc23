# SPDX-License-Identifier: Apache-2.0
"""Large ROS graphs in which most topics, services and actions are rows of the card of their publisher or server.

A line then leads from a client to the server, and from the publisher to a subscriber. Interfaces with several
publishers or servers, or with none, remain nodes. Nodes that then have the same neighbours are one card (`alike`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from roaml.ide.diagrams.alike import with_nodes_alike
from roaml.ide.diagrams.diagram import Detail, DetailKind, DiagramEdge, DiagramNode, DiagramNodeKind, EdgeKind, Picture
from roaml.ide.diagrams.namespaces import INTERFACES
from roaml.record import replace

MAX_SEPARATE = 60
"""The maximum number of nodes of a graph in which every interface is a node."""


def with_provided_interfaces(picture: Picture) -> Picture:
    """The graph with the interfaces of nodes in their cards if it is large; otherwise the same graph. The cards hide
    the nodes of the interfaces."""
    if len(picture.nodes) <= MAX_SEPARATE:
        return picture
    provider = _providers(picture)
    provided: dict[str, list[DiagramNode]] = {}
    for node in picture.nodes:
        if node.id in provider:
            provided.setdefault(provider[node.id], []).append(node)
    nodes = [_with_rows(node, provided.get(node.id, ())) for node in picture.nodes if node.id not in provider]
    nodes = _without_empty_namespaces(nodes)
    return with_nodes_alike(replace(picture, nodes=tuple(nodes), edges=tuple(_edges(picture, provider))))


def _providers(picture: Picture) -> Mapping[str, str]:
    """The id of an interface -> the id of its only publisher or server."""
    kinds = {node.id: node.kind for node in picture.nodes}
    ends: dict[str, set[str]] = {}
    for edge in picture.edges:
        if edge.kind is EdgeKind.SERVES:
            ends.setdefault(edge.source, set()).add(edge.target)
        elif edge.kind is EdgeKind.PUBLISHES:
            ends.setdefault(edge.target, set()).add(edge.source)
    nodes = (DiagramNodeKind.ROS_NODE, DiagramNodeKind.PLUGIN)
    single = {interface: next(iter(names)) for interface, names in ends.items() if len(names) == 1}
    return {
        interface: name for interface, name in single.items() if kinds[interface] in INTERFACES and kinds[name] in nodes
    }


def _with_rows(node: DiagramNode, interfaces: Sequence[DiagramNode]) -> DiagramNode:
    rows = (Detail(DetailKind.INTERFACE, interface.label, interface.kind.value) for interface in interfaces)
    hidden = tuple(interface.id for interface in interfaces)
    return replace(node, details=(*node.details, *rows), hides=(*node.hides, *hidden))


def _without_empty_namespaces(nodes: Sequence[DiagramNode]) -> list[DiagramNode]:
    kept = list(nodes)
    while True:
        parents = {node.parent for node in kept}
        empty = [n for n in kept if n.kind is DiagramNodeKind.NAMESPACE and n.id not in parents and not n.hides]
        if not empty:
            return kept
        kept = [node for node in kept if node not in empty]


def _edges(picture: Picture, provider: Mapping[str, str]) -> Iterator[DiagramEdge]:
    """The edges between the shown nodes. Those through interfaces of the same kind of the same nodes are one, which has
    the names of the interfaces."""
    nodes = {node.id: node for node in picture.nodes}
    merged: dict[tuple[object, ...], DiagramEdge] = {}
    for edge in picture.edges:
        hidden = next((end for end in (edge.source, edge.target) if end in provider), None)
        source, target = (provider.get(end, end) for end in (edge.source, edge.target))
        if source == target:
            continue
        if hidden is None:
            merged[(edge,)] = edge
            continue
        interface = nodes[hidden]
        key = (source, target, edge.kind, interface.kind)
        known = merged.get(key, replace(edge, source=source, target=target, labels=(), interface=interface.kind))
        merged[key] = replace(known, labels=_joined(known.labels, interface.label))
    return iter(merged.values())


def _joined(labels: Collection[str], label: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys((*labels, label)))

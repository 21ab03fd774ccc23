# SPDX-License-Identifier: Apache-2.0
"""The ROS graph of a system: its nodes and plugins, their topics, services and actions, and plain events.

A plugin is drawn once for each tree, even if the tree uses it several times.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.ide.diagrams.diagram import Detail, DetailKind, DiagramEdge, DiagramNode, DiagramNodeKind, EdgeKind, Picture
from roaml.ide.diagrams.namespaces import with_namespaces
from roaml.model.system import Channel, ChannelEndpoint, System, SystemAutomaton
from roaml.project.analysis import Analysis
from roaml.roles import SymbolKind
from roaml.text import Location

_ROLES: Mapping[SymbolKind, EdgeKind] = {
    SymbolKind.PUBLISHER: EdgeKind.PUBLISHES,
    SymbolKind.SUBSCRIBER: EdgeKind.SUBSCRIBES,
    SymbolKind.SERVICE_SERVER: EdgeKind.SERVES,
    SymbolKind.SERVICE_CLIENT: EdgeKind.CALLS,
    SymbolKind.ACTION_SERVER: EdgeKind.SERVES,
    SymbolKind.ACTION_CLIENT: EdgeKind.CALLS,
}
_TO_CHANNEL = (EdgeKind.PUBLISHES, EdgeKind.CALLS)


def ros_picture(analysis: Analysis, path: str) -> Picture | None:
    """The ROS graph of a system; `None` if `path` is not a system file."""
    system = analysis.system(path)
    if system is None:
        return None
    title = path.replace("\\", "/").rpartition("/")[2]
    nodes = dict(_machines(analysis, system))
    edges: dict[DiagramEdge, None] = {}
    for kind, channels in (
        (DiagramNodeKind.TOPIC, system.topics),
        (DiagramNodeKind.SERVICE, system.services),
        (DiagramNodeKind.ACTION_INTERFACE, system.actions),
    ):
        for channel in channels.values():
            ends = [endpoint for endpoint in channel.endpoints if _id(endpoint.automaton) in nodes]
            node = _channel(analysis, kind, channel, ends)
            nodes[node.id] = node
            edges.update(dict.fromkeys(_edge(analysis, node, end) for end in ends))
    edges.update(dict.fromkeys(_events(system, nodes)))
    picture = Picture(title, tuple(nodes.values()), tuple(edges))
    return with_namespaces(picture, {name: space for name, space in _namespaces(analysis, path) if name in nodes})


def _namespaces(analysis: Analysis, path: str) -> Iterator[tuple[str, str]]:
    """The ids of nodes and plugins that are in a namespace, and the namespace."""
    expanded, system = analysis.expanded(path), analysis.system(path)
    linked = expanded.linked(path) if expanded is not None else None
    if expanded is None or linked is None or system is None:
        return
    # An instance has a text of its own, but in a picture the path of its file.
    for automaton, instance in zip(system.automata, linked.automata, strict=True):
        namespace = expanded.expansion.namespaces.get(instance.path)
        if namespace is not None:
            yield _id(automaton), namespace


def _id(automaton: SystemAutomaton) -> str:
    if automaton.instance is None:
        return f"node {automaton.index} {automaton.path}"
    return f"plugin {automaton.instance.tree or 0} {automaton.path}"


def _title(automaton: SystemAutomaton) -> str:
    tree = automaton.instance.tree if automaton.instance is not None else ""
    return f"{tree}.{automaton.outline.name}" if tree else automaton.outline.name


def machine_node_ids(system: System) -> Mapping[str, tuple[str, ...]]:
    """The file of a machine or plugin -> the ids of the nodes that show it."""
    ids: dict[str, tuple[str, ...]] = {}
    for automaton in system.automata:
        if automaton.path:
            ids[automaton.path] = tuple(dict.fromkeys((*ids.get(automaton.path, ()), _id(automaton))))
    return ids


def _machines(analysis: Analysis, system: System) -> Iterator[tuple[str, DiagramNode]]:
    for automaton in system.automata:
        place = _place(analysis, automaton) if automaton.path else None
        if place is not None:
            kind = DiagramNodeKind.ROS_NODE if automaton.instance is None else DiagramNodeKind.PLUGIN
            yield _id(automaton), DiagramNode(_id(automaton), kind, _title(automaton), place=place)


def _place(analysis: Analysis, automaton: SystemAutomaton) -> Location | None:
    """The machine of an automaton, or the `<channel>` for which the expansion added it."""
    machine = analysis.machine(automaton.path)
    if machine is not None:
        return Location(automaton.path, machine.element.span)
    expanded = analysis.expanded(automaton.path)
    channels = dict(expanded.expansion.channels.values()) if expanded is not None else {}
    span = channels.get(automaton.outline.name)
    return None if span is None else Location(automaton.path, span)


def _channel(analysis: Analysis, kind: DiagramNodeKind, channel: Channel, ends: list[ChannelEndpoint]) -> DiagramNode:
    names = [name for end in ends if (name := end.automaton.interface_name(end.use))]
    types = dict.fromkeys(end.use.type for end in ends if end.use.type)
    details = tuple(Detail(DetailKind.TYPE, name) for name in types)
    place = next((place for end in ends if (place := _declared(analysis, end))), None)
    return DiagramNode(f"{kind.value} {channel.name}", kind, names[0] if names else channel.name, details, place=place)


def _edge(analysis: Analysis, channel: DiagramNode, end: ChannelEndpoint) -> DiagramEdge:
    role, machine = _ROLES[end.use.kind], _id(end.automaton)
    source, target = (machine, channel.id) if role in _TO_CHANNEL else (channel.id, machine)
    return DiagramEdge(source, target, role, place=_declared(analysis, end))


def _declared(analysis: Analysis, end: ChannelEndpoint) -> Location | None:
    machine, kind_and_handle = analysis.machine(end.automaton.path), (end.use.kind, end.use.handle)
    for declaration in machine.declarations if machine else ():
        if kind_and_handle == (declaration.kind, declaration.handle.value if declaration.handle else ""):
            return Location(end.automaton.path, declaration.element.span)
    return None


def _events(system: System, nodes: Mapping[str, DiagramNode]) -> Iterator[DiagramEdge]:
    """The edges for plain events, one for each pair of a sender and a receiver."""
    between: dict[tuple[str, str], dict[str, None]] = {}
    for event in system.events.values():
        for sender, _ in event.senders:
            for receiver, _ in event.receivers:
                ends = _id(sender), _id(receiver)
                if ends[0] != ends[1] and ends[0] in nodes and ends[1] in nodes:
                    between.setdefault(ends, {})[event.name] = None
    for (source, target), names in between.items():
        yield DiagramEdge(source, target, EdgeKind.SENDS, tuple(names))

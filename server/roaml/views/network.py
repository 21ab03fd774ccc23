# SPDX-License-Identifier: Apache-2.0
"""A diagram of the JANI network: the automata and the events that they exchange. A link is labelled
with the events that one automaton sends to another; the automata that buffer events are not shown."""

from __future__ import annotations

from roaml.jani.model import Model
from roaml.scxml.names import is_generated, received_by, sent_by
from roaml.views.graph import Graph, GraphLink, GraphNode, Kind


def network_graph(model: Model, title: str) -> Graph:
    senders: dict[str, dict[str, None]] = {}
    receivers: dict[str, dict[str, None]] = {}
    for automaton in model.automata:
        for edge in automaton.edges:
            action = edge.action or ""
            for event, automata_by_event in ((sent_by(action), senders), (received_by(action), receivers)):
                if event not in ("", automaton.name):
                    automata_by_event.setdefault(event, {})[automaton.name] = None
    labels: dict[tuple[str, str], list[str]] = {}
    for event, sources in senders.items():
        for source in sources:
            for target in receivers.get(event, ()):
                labels.setdefault((source, target), []).append(event)
    nodes = tuple(
        GraphNode(automaton.name, (automaton.name,), is_generated(automaton.name))
        for automaton in model.automata
        if automaton.name not in senders
    )
    links = tuple(GraphLink(source, target, tuple(events)) for (source, target), events in labels.items())
    return Graph(Kind.NETWORK, title, nodes, links)

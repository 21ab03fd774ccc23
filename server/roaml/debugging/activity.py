# SPDX-License-Identifier: Apache-2.0
"""The active parts of pictures while a run is stopped: active states, statuses of tree nodes, messages that have been
sent and have not been received yet."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.debugging.debugger import Debugger
from roaml.debugging.frames import node_of
from roaml.ide.diagrams import DiagramKind, DiagramNodeKind
from roaml.ide.diagrams.machine import state_id
from roaml.ide.diagrams.ros import machine_node_ids
from roaml.ide.diagrams.system import id_in_system
from roaml.jani.node import Origin
from roaml.model.machine import Chart
from roaml.model.system import System
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.scxml.names import InterfaceEventKind, read_interface_event, received_by, sanitise
from roaml.simulation.state import MachineState, SystemState

ACTIVE, NEXT, MESSAGE = "active", "next", "message"
"""The looks of parts: of an active state, of an active state of a machine that takes the next step, and of a message.
The look of a tree node is its status in lower case."""


class ActiveNode(Record, frozen=True):
    """An active node of a picture.

    Attributes:
        path: the file of the picture: the file of a machine, or the system file.
        node: the id of the node in the picture.
        look: `ACTIVE`, `NEXT`, `MESSAGE`, or the status of a node of the tree in lower case.
    """

    picture: DiagramKind
    path: str
    node: str
    look: str


class ActiveEdge(Record, frozen=True):
    """An edge of the ROS graph between the sender or receiver of a message and its topic, service or action. `source`
    and `target` are ids of nodes in the picture."""

    source: str
    target: str


def active_nodes(debugger: Debugger) -> Iterator[ActiveNode]:
    """The active nodes of all pictures of the system, or of the tree without a system; none for a JANI model."""
    session, path = debugger.session, debugger.sources.target.path
    state, nodes = debugger.state, debugger.sources.nodes
    for tree_node in state.nodes:
        if tree_node.number in nodes:
            look = tree_node.status.value.lower()
            yield ActiveNode(DiagramKind.TREE, path, nodes[tree_node.number].picture, look)
    analysis, system = _sources(debugger)
    if analysis is None or system is None:
        return
    upcoming = debugger.upcoming()
    actors = {part.automaton for part in session.actors(upcoming)} if upcoming is not None else set()
    origins = {automaton.name: automaton.origin for automaton in session.automata_of_model}
    for machine in state.machines:
        origin = origins[machine.automaton]
        chart = _chart(analysis, machine, origin)
        if chart is not None and origin is not None:
            node, look = state_id(chart, machine.state), NEXT if machine.automaton in actors else ACTIVE
            yield ActiveNode(DiagramKind.MACHINE, origin.path, node, look)
            yield ActiveNode(DiagramKind.SYSTEM, path, id_in_system(origin.path, node), look)
    for channel in dict.fromkeys(channel for channel, _, _ in _in_flight(state, system)):
        yield ActiveNode(DiagramKind.ROS, path, channel, MESSAGE)


def active_edges(debugger: Debugger) -> Iterator[ActiveEdge]:
    """The edges of the ROS graph with a message that has not been received yet: from its sender, and to its receivers
    if the next step receives it."""
    analysis, system = _sources(debugger)
    if analysis is None or system is None:
        return
    session, upcoming = debugger.session, debugger.upcoming()
    state, ids = debugger.state, machine_node_ids(system)
    machines = {
        automaton.name: ids.get(automaton.origin.path, ())
        for instance, automaton in enumerate(session.automata_of_model)
        if automaton.origin is not None and session.is_machine(instance)
    }
    senders = {machine.name: machines.get(machine.automaton, ()) for machine in state.machines}
    actors = [part.automaton for part in session.actors(upcoming)] if upcoming is not None else []
    received = received_by(upcoming.action or "") if upcoming is not None else ""
    for channel, event, sender in _in_flight(state, system):
        for node in senders.get(sender, ()):
            yield ActiveEdge(node, channel)
        if event == received:
            for actor in actors:
                yield from (ActiveEdge(channel, node) for node in machines.get(actor, ()))


def nodes_of_automata(debugger: Debugger, automata: Iterable[str]) -> Iterator[tuple[str, ...]]:
    """The ids of the nodes in pictures that show the machine or tree node of each automaton. An id that ends with `#`
    is the beginning of those of the states of a machine, in the picture of the system."""
    nodes = debugger.sources.nodes
    _, system = _sources(debugger)
    ids = machine_node_ids(system) if system is not None else {}
    origins = {known.name: known.origin for known in debugger.session.automata_of_model}
    for automaton in automata:
        number, origin = node_of(automaton), origins[automaton]
        node = (nodes[number].picture,) if number in nodes else ()
        yield (*node, *((id_in_system(origin.path, ""), *ids.get(origin.path, ())) if origin is not None else ()))


def _sources(debugger: Debugger) -> tuple[Analysis | None, System | None]:
    analysis = debugger.sources.analysis
    return analysis, None if analysis is None else analysis.system(debugger.sources.target.path)


def _chart(analysis: Analysis, machine: MachineState, origin: Origin | None) -> Chart | None:
    """The chart of a machine that contains its state; of several, the chart around `origin`, the place of its next
    step."""
    read = None if origin is None else analysis.machine(origin.path)
    charts = [
        chart
        for chart in (read.charts if read is not None else ())
        if any(state.id is not None and state.id.value == machine.state for state in chart.states)
    ]
    place = machine.origin
    return next((chart for chart in charts if place is not None and _contains(chart, place)), next(iter(charts), None))


def _contains(chart: Chart, place: Origin) -> bool:
    spans = (state.element.span for state in chart.states)
    return any(span.start <= place.span.start and place.span.end <= span.end for span in spans)


def _in_flight(state: SystemState, system: System) -> Iterator[tuple[str, str, str]]:
    """The ids of topics, services and actions, each with an event that has not been received yet and its sender."""
    pictured = (
        (DiagramNodeKind.TOPIC, system.topics),
        (DiagramNodeKind.SERVICE, system.services),
        (DiagramNodeKind.ACTION_INTERFACE, system.actions),
    )
    nodes = {
        (kind, sanitise(channel.name)): f"{kind.value} {channel.name}"
        for kind, channels in pictured
        for channel in channels.values()
    }
    clients = {automaton.name for automaton in system.automata}
    for event in state.events:
        read = read_interface_event(event.event, clients) if event.is_waiting else None
        if read is not None and (node := nodes.get((_node_kind(read.kind), read.name))):
            yield node, event.event, event.sender


def _node_kind(kind: InterfaceEventKind) -> DiagramNodeKind:
    match kind:
        case InterfaceEventKind.MESSAGE:
            return DiagramNodeKind.TOPIC
        case InterfaceEventKind.REQUEST | InterfaceEventKind.RESPONSE:
            return DiagramNodeKind.SERVICE
        case _:
            return DiagramNodeKind.ACTION_INTERFACE

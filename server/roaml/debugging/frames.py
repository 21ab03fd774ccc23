# SPDX-License-Identifier: Apache-2.0
"""Threads and stacks: the position of each machine and of the tree, and the statements that they execute next.

A thread is a state machine, or the tree with all its nodes. The innermost frame of a stack is the statement that is
executed next. The frames of a machine are the statement, its handler and its state; the frames of the tree are the
nodes that are being ticked.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from enum import Enum

from roaml.debugging.sources import Sources
from roaml.jani.model import Automaton
from roaml.jani.node import Origin
from roaml.record import Record
from roaml.scxml.names import NODE_AUTOMATON, received_by
from roaml.simulation.session import Session
from roaml.simulation.state import MachineState, NodeState, NodeStatus, SystemState
from roaml.smc.record import AutomatonStep, TraceStep
from roaml.views.event_words import event_phrase

TREE_THREAD = 1


class DebugThread(Record, frozen=True):
    """A machine, or a tree.

    Attributes:
        instance: the number of the automaton; -1 for a tree.
        root: the number of the topmost node of the tree; 0 for a machine.
    """

    number: int
    name: str
    instance: int
    root: int = 0


class FrameRole(Enum):
    """What a frame of a stack shows."""

    STATEMENT = "statement"
    HANDLER = "handler"
    STATE = "state"
    NODE = "node of the tree"


class Frame(Record, frozen=True):
    """A frame of a stack.

    Attributes:
        origin: the place of the statement, handler, state or node.
        instance: the number of the automaton whose variables the frame shows; -1 if there is none.
        node: the number of the node of the tree; 0 for a machine.
    """

    thread: int
    name: str
    origin: Origin | None
    instance: int
    node: int
    role: FrameRole


def threads(session: Session, sources: Sources) -> tuple[DebugThread, ...]:
    """The threads of a system: the trees, then the machines in their order."""
    roots = [node for node in sources.nodes.values() if node.parent is None]
    threads_ = [
        DebugThread(number, f"tree {root.tree}" if len(roots) > 1 else "tree", -1, root.number)
        for number, root in enumerate(roots, TREE_THREAD)
    ]
    number = TREE_THREAD + max(1, len(roots))
    for instance, automaton in enumerate(session.automata_of_model):
        if session.is_machine(instance) and not _is_node(automaton.name, sources):
            threads_.append(DebugThread(number, session.names[automaton.name], instance))
            number += 1
    return tuple(threads_)


def _is_node(automaton: str, sources: Sources) -> bool:
    return bool(sources.nodes) and NODE_AUTOMATON.fullmatch(automaton) is not None


def node_of(automaton: str) -> int:
    """The number of the node of the tree that an automaton executes; 0 for other automata."""
    match = NODE_AUTOMATON.fullmatch(automaton)
    return int(match[1]) if match else 0


def root_of(node: int, sources: Sources) -> int:
    """The number of the topmost node of the tree that contains the node with the number `node`."""
    while (parent := sources.nodes[node].parent) is not None:
        node = parent
    return node


class Stacks:
    """The stacks at the position of a session.

    Args:
        upcoming: the step that is taken next; `None` if there is none.
    """

    def __init__(self, session: Session, sources: Sources, state: SystemState, upcoming: TraceStep | None) -> None:
        self._session = session
        self._sources = sources
        self._locations = session.locations()
        self._state = state
        self._instances = {automaton.name: number for number, automaton in enumerate(session.automata_of_model)}
        self._machines = {machine.automaton: machine for machine in state.machines}
        self._action = "" if upcoming is None else upcoming.action or ""
        actors = [] if upcoming is None else session.actors(upcoming)
        self._parts: Mapping[int, AutomatonStep] = {part.instance: part for part in actors}

    def stack(self, thread: DebugThread) -> list[Frame]:
        """The frames of a thread, the innermost first."""
        if thread.instance >= 0:
            automaton = self._session.automata_of_model[thread.instance].name
            return list(self._machine_frames(thread.number, self._machines[automaton], thread.instance, 0))
        return list(self._tree_frames(thread))

    def executed(self, thread: int, instance: int, origin: Origin) -> Frame:
        """A frame for a statement or a node that an instance has executed in the last step."""
        automaton = self._session.automata_of_model[instance].name
        number = node_of(automaton)
        node = number if number in self._sources.nodes else 0
        name = self._session.names[automaton]
        tag = self._sources.tag(origin)
        text = f"{name}: {tag}" if tag else name
        return Frame(thread, f"{text}, executed last", origin, instance, node, FrameRole.STATEMENT)

    def _machine_frames(self, thread: int, machine: MachineState, instance: int, node: int) -> Iterator[Frame]:
        automaton = self._session.automata_of_model[instance]
        location = self._locations[instance]
        part = self._parts.get(instance)
        received = received_by(self._action) if part is not None else ""
        handler, event = machine.handler, machine.event
        drawn = None if part is None or len(part.edge.destinations) < 2 else part.destination.origin
        if part is not None and drawn not in (None, part.edge.origin):
            yield Frame(
                thread,
                f"{machine.name}: {self._sources.tag(drawn)} by chance",
                drawn,
                instance,
                node,
                FrameRole.STATEMENT,
            )
        if not self._session.is_resting(instance, location):
            edge = part.edge if part is not None else next(e for e in automaton.edges if e.source == location)
            name = self._sources.tag(edge.origin) or machine.state
            yield Frame(thread, f"{machine.name}: {name}", edge.origin, instance, node, FrameRole.STATEMENT)
        elif received and part is not None:
            handler, event = part.edge.origin, received
        else:
            handler, event = None, ""
        states = self._sources.states(automaton)
        if handler is not None and handler != states.get(machine.state):
            text = event_phrase(event, self._session.automata, taken=True)
            yield Frame(thread, f"{machine.name}: {text}", handler, instance, node, FrameRole.HANDLER)
        origin = states.get(machine.state, machine.origin)
        yield Frame(thread, f"{machine.name}: {machine.state}", origin, instance, node, FrameRole.STATE)

    def _tree_frames(self, tree: DebugThread) -> Iterator[Frame]:
        thread = tree.number
        statuses = {node.number: node for node in self._state.nodes}
        active = self._active_node(statuses, tree.root)
        instance = self._instances.get(self._sources.nodes[active].automaton, -1) if active else -1
        automaton = self._session.automata_of_model[instance] if instance >= 0 else None
        if automaton is not None and self._executes_machine(instance, automaton):
            machine = self._machines[automaton.name]
            if instance in self._parts or not self._session.is_resting(instance, self._locations[instance]):
                yield from self._machine_frames(thread, machine, instance, active)
        number: int | None = active
        while number:
            node = self._sources.nodes[number]
            status = statuses[number].status.value if number in statuses else NodeStatus.IDLE.value
            is_named = node.name != node.type
            name = f"{node.name} : {node.type}" if is_named else self._session.names[node.automaton]
            instance = self._instances.get(node.automaton, -1)
            yield Frame(thread, f"{name}: {status}", node.origin, instance, number, FrameRole.NODE)
            number = node.parent

    def _executes_machine(self, instance: int, automaton: Automaton) -> bool:
        """Whether a node of the tree executes a machine that the user has written."""
        return self._session.is_machine(instance) and not self._sources.is_library_node(automaton)

    def _active_node(self, statuses: Mapping[int, NodeState], root: int) -> int:
        """The node of a tree that executes the next step; if none does, the innermost node that is being ticked, or the
        root."""
        for part in self._parts.values():
            number = node_of(part.automaton)
            if number in self._sources.nodes and root_of(number, self._sources) == root:
                return number
        ticked = [n for n, node in statuses.items() if node.status is NodeStatus.TICKED and n in self._sources.nodes]
        own = [number for number in ticked if root_of(number, self._sources) == root]
        return max(own, key=self._depth, default=root)

    def _depth(self, number: int) -> int:
        depth = 0
        parent = self._sources.nodes[number].parent
        while parent is not None:
            depth += 1
            parent = self._sources.nodes[parent].parent
        return depth

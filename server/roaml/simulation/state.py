# SPDX-License-Identifier: Apache-2.0
"""The state of a system in terms of its model: machines, nodes of the tree, messages, and the clock."""

from __future__ import annotations

import enum
from collections.abc import Mapping

from roaml.jani.node import Origin
from roaml.record import Record
from roaml.smc.record import Plain
from roaml.views.arrays import DeclaredValue


class NodeStatus(enum.Enum):
    """The status of a tree node as in BehaviorTree.CPP; `TICKED` from a tick until the node returns a status."""

    IDLE = "IDLE"
    TICKED = "TICKED"
    RUNNING = "RUNNING"
    SUCCESS = "SUCCESS"
    FAILURE = "FAILURE"
    SKIPPED = "SKIPPED"


class MachineState(Record, frozen=True):
    """The state of a state machine or of a plugin of the tree.

    Attributes:
        name: the name of the machine for users; `automaton` is the name of its automaton.
        identifier: the name of the machine in expressions and in the headers of tables; of an action thread, the name
            of its automaton.
        state: its current state; while it handles an event, the state in which it received the event.
        variables: its own variables.
        handles: the name of the event that it handles; "" while it waits for one.
        origin: the place in the source of its state, or of the statement that it executes next.
        event: the event that it handles, with the name of the client of a service or action.
        handler: the place of the handler of this event; `None` if there is no event.
    """

    name: str
    automaton: str
    identifier: str
    state: str
    variables: Mapping[str, Plain]
    handles: str
    origin: Origin | None
    event: str = ""
    handler: Origin | None = None


class NodeState(Record, frozen=True):
    """The state of a node of the tree: its number, its type, its name in texts for users, and its status."""

    number: int
    type: str
    name: str
    status: NodeStatus


class EventState(Record, frozen=True):
    """An event with the parameters with which it was last sent.

    Attributes:
        name: the name of the event, without the name of the client of a service or action.
        text: a description such as "a message on the topic `/level`".
        sender: the name of the sender for users; "" if there is none.
        step: the number of the step that sent it.
        is_waiting: whether it has not been received yet.
    """

    event: str
    name: str
    text: str
    sender: str
    parameters: Mapping[str, DeclaredValue]
    step: int
    is_waiting: bool


class SystemState(Record, frozen=True):
    """The state after step `step`.

    Attributes:
        time: the time in s; `None` if the model has no clock.
        machines: the state machines and the plugins of the tree.
        nodes: all nodes of the tree, ordered by their numbers.
        events: each event that was sent, such as the message of a topic or the request of a service, as it was last
            sent; in the order of sending.
        blackboard: the entries of the blackboard.
        shared: the global variables of the model that belong to no event.
    """

    step: int
    time: float | None
    machines: tuple[MachineState, ...]
    nodes: tuple[NodeState, ...]
    events: tuple[EventState, ...]
    blackboard: Mapping[str, Plain]
    shared: Mapping[str, Plain]

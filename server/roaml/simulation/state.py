# SPDX-License-Identifier: Apache-2.0
"""The state of a system as its engineers think of it: machines, nodes of the tree, messages, the clock."""

from __future__ import annotations

import enum
import re
from collections.abc import Mapping
from dataclasses import dataclass

from roaml.jani.node import Origin
from roaml.smc.record import Plain

NODE_AUTOMATON = re.compile(r"BT_plugin_(\d+)_(.+)")
"""The automaton of a tree node: its number and its type."""


class NodeStatus(enum.Enum):
    """The status of a tree node, as BehaviorTree.CPP has it; `TICKED` while its tick is not answered yet."""

    IDLE = "IDLE"
    TICKED = "TICKED"
    RUNNING = "RUNNING"
    SUCCESS = "SUCCESS"
    FAILURE = "FAILURE"


@dataclass(frozen=True, slots=True)
class MachineState:
    """A state machine.

    Attributes:
        name: of the machine in the model; `automaton` is that of its automaton.
        state: the state that it is in, or that it was in when the event came that it handles.
        variables: its own variables.
        handles: the name of the event that it handles; "" if it waits for one.
        origin: where in the text it is: the state, or the statement that it is about to execute.
    """

    name: str
    automaton: str
    state: str
    variables: Mapping[str, Plain]
    handles: str
    origin: Origin | None


@dataclass(frozen=True, slots=True)
class NodeState:
    """A node of the tree: its number, its type and its status."""

    number: int
    type: str
    status: NodeStatus


@dataclass(frozen=True, slots=True)
class EventState:
    """An event as it was sent last.

    Attributes:
        name: of the event, without that of the client whom a service or action serves with it.
        text: the event in words, such as "a message on the topic `/level`".
        step: the number of the step in which it was sent.
        is_waiting: whether it waits for its receivers.
    """

    event: str
    name: str
    text: str
    sender: str
    parameters: Mapping[str, Plain]
    step: int
    is_waiting: bool


@dataclass(frozen=True, slots=True)
class SystemState:
    """The state after step `step`.

    Attributes:
        time: in seconds; None if the model has no clock.
        machines: the state machines, and the plugins of the tree.
        nodes: all nodes of the tree, in the order of their numbers.
        events: the last message of each topic, call of each service and so on, in the order in which they were sent.
        blackboard: the entries of the blackboard.
        shared: the variables of a JANI model that belong to no event.
    """

    step: int
    time: float | None
    machines: tuple[MachineState, ...]
    nodes: tuple[NodeState, ...]
    events: tuple[EventState, ...]
    blackboard: Mapping[str, Plain]
    shared: Mapping[str, Plain]

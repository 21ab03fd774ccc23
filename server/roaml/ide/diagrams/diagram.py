# SPDX-License-Identifier: Apache-2.0
"""The content of a diagram, independent of its rendering.

- The ids of nodes are unique; the ends of every edge, and every parent, are nodes of the diagram.
- The values of the enumerations are part of the interface to the renderer.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

from roaml.text import Location


class DiagramKind(enum.Enum):
    """What a diagram shows."""

    MACHINE = "machine"
    TREE = "tree"
    ROS = "ros"
    SYSTEM = "system"


class DiagramNodeKind(enum.Enum):
    STATE = "state"
    CHOICE = "choice"
    THREAD = "thread"
    MACHINE = "machine"
    CONTROL = "control"
    DECORATOR = "decorator"
    ACTION = "action"
    CONDITION = "condition"
    SUBTREE = "subtree"
    VARIABLE = "variable"
    ROS_NODE = "node"
    PLUGIN = "plugin"
    TOPIC = "topic"
    SERVICE = "service"
    ACTION_INTERFACE = "action-interface"


class EdgeKind(enum.Enum):
    """The kind of an edge: the trigger of a transition, or a relation in a tree or a system."""

    EVENTLESS = "eventless"
    EVENT = "event"
    ROS = "ros"
    BT = "bt"
    CHILD = "child"
    READS = "reads"
    WRITES = "writes"
    PUBLISHES = "publishes"
    SUBSCRIBES = "subscribes"
    SERVES = "serves"
    CALLS = "calls"
    SENDS = "sends"


@dataclass(frozen=True, slots=True)
class DiagramNode:
    """
    Attributes:
        details: lines below the label.
        parent: the id of the enclosing node; "" if there is none.
        place: the place in the files that it represents; `None` if there is none.
    """

    id: str
    kind: DiagramNodeKind
    label: str
    details: tuple[str, ...] = ()
    parent: str = ""
    initial: bool = False
    place: Location | None = None


@dataclass(frozen=True, slots=True)
class DiagramEdge:
    """
    Attributes:
        labels: lines of text: of a transition, the trigger, the condition in brackets, and the probability.
        actions: what a transition executes.
        probabilistic: whether it is one of several randomly chosen edges; such edges leave a choice.
        internal: whether it is a transition without a target, which does not leave its state.
    """

    source: str
    target: str
    kind: EdgeKind
    labels: tuple[str, ...] = ()
    actions: tuple[str, ...] = ()
    probabilistic: bool = False
    internal: bool = False
    place: Location | None = None


@dataclass(frozen=True, slots=True)
class Picture:
    title: str
    nodes: tuple[DiagramNode, ...]
    edges: tuple[DiagramEdge, ...]

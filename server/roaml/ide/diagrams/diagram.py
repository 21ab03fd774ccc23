# SPDX-License-Identifier: Apache-2.0
"""The content of a diagram, independent of its rendering.

- The ids of nodes are unique; the ends of every edge, and every parent, are nodes of the diagram.
- The values of the enumerations are part of the protocol between server and client.
"""

from __future__ import annotations

import enum

from roaml.record import Record
from roaml.text import Location

MOCK = "mock: "
"""The beginning of the line with the mock of a leaf, in which its probability and its duration follow."""


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


class DiagramNode(Record, frozen=True):
    """A node of a diagram.

    Attributes:
        details: lines below the label.
        parent: the id of the enclosing node; "" if there is none.
        initial: whether it is an initial state.
        place: the place in a file that the node represents; `None` if there is none.
    """

    id: str
    kind: DiagramNodeKind
    label: str
    details: tuple[str, ...] = ()
    parent: str = ""
    initial: bool = False
    place: Location | None = None


class DiagramEdge(Record, frozen=True):
    """An edge of a diagram.

    Attributes:
        labels: lines of text. Those of a transition are the trigger, the condition in brackets, and the probability.
        actions: the texts for the statements that a transition executes.
        probabilistic: whether it is one of several edges of a choice, of which one is chosen at random.
        internal: whether it represents a transition without a target, which does not leave its state.
        place: the place in a file that the edge represents; `None` if there is none.
    """

    source: str
    target: str
    kind: EdgeKind
    labels: tuple[str, ...] = ()
    actions: tuple[str, ...] = ()
    probabilistic: bool = False
    internal: bool = False
    place: Location | None = None


class Picture(Record, frozen=True):
    """A diagram: its title, nodes and edges."""

    title: str
    nodes: tuple[DiagramNode, ...]
    edges: tuple[DiagramEdge, ...]

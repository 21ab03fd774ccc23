# SPDX-License-Identifier: Apache-2.0
"""The content of a diagram, independent of its rendering.

- The ids of nodes are unique; the ends of every edge, and every parent, are nodes of the diagram.
- The values of the enumerations are part of the protocol between server and client.
"""

from __future__ import annotations

import enum

from roaml.record import Record
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
    GROUP = "group"
    MACHINE = "machine"
    CONTROL = "control"
    DECORATOR = "decorator"
    ACTION = "action"
    CONDITION = "condition"
    SUBTREE = "subtree"
    VARIABLE = "variable"
    NAMESPACE = "namespace"
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


class DetailKind(enum.Enum):
    """What a line below the label of a node describes.

    - `ACTIONS`: the entry or exit actions of a state;
    - `TYPE`: the type of a ROS interface;
    - `COUNT`: a number of action threads, or of nodes that are not shown;
    - `CONSTANT`: a port with a constant value, or a constant that a subtree is given;
    - `REFERENCE`: a port that is bound to the blackboard, or an entry that a subtree is given;
    - `SCRIPT`: a condition or script of a node of the tree, or automatic remapping;
    - `MOCK`: the mock of a leaf;
    - `INTERFACE`: a topic, service or action of a node of ROS.
    """

    ACTIONS = "actions"
    TYPE = "type"
    COUNT = "count"
    CONSTANT = "constant"
    REFERENCE = "reference"
    SCRIPT = "script"
    MOCK = "mock"
    INTERFACE = "interface"


class Change(enum.Enum):
    """What happened to a part of a diagram between two versions of a model."""

    SAME = "same"
    ADDED = "added"
    REMOVED = "removed"
    CHANGED = "changed"


class Detail(Record, frozen=True):
    """A line below the label of a node. `key` is the name of the port or the kind of the interface that it describes;
    "" if it describes none. `change` is `None` if the diagram compares no versions."""

    kind: DetailKind
    text: str
    key: str = ""
    change: Change | None = None


class TreeNodeTitle(Record, frozen=True):
    """The parts of the label of a node of a tree.

    Attributes:
        name: the name of the node or subtree; that of its plugin or tree if it has no other.
        plugin: the plugin of the node, or the tree of the subtree.
        number: the number of the node in the translation; `None` for subtrees.
    """

    name: str
    plugin: str
    number: int | None = None


class DiagramNode(Record, frozen=True):
    """A node of a diagram.

    Attributes:
        details: lines below the label.
        parent: the id of the enclosing node; "" if there is none.
        initial: whether it is an initial state.
        place: the place in a file that the node represents; `None` if there is none. That of a subtree is its
            `<BehaviorTree>`.
        title: the parts of the label, for nodes of trees and subtrees.
        use: the place of the `<SubTree>` of a subtree; `None` for other nodes.
        change: what happened to the node; `None` if the diagram compares no versions.
        hides: the ids of the nodes that it replaces: those in a collapsed group or namespace, or the interfaces in the
            card of a node of ROS; empty for other nodes.
    """

    id: str
    kind: DiagramNodeKind
    label: str
    details: tuple[Detail, ...] = ()
    parent: str = ""
    initial: bool = False
    place: Location | None = None
    title: TreeNodeTitle | None = None
    use: Location | None = None
    change: Change | None = None
    hides: tuple[str, ...] = ()


class DiagramEdge(Record, frozen=True):
    """An edge of a diagram.

    Attributes:
        labels: lines of text. Those of a transition are the trigger, the condition in brackets, and the probability.
            Those of an edge through interfaces that are not shown are their names.
        order: what is written before the condition of a transition if others have the same trigger (`precedence`).
        actions: the texts for the statements that a transition executes.
        probabilistic: whether it is one of several edges of a choice, of which one is chosen at random.
        internal: whether it represents a transition without a target, which does not leave its state.
        place: the place in a file that the edge represents; `None` if there is none.
        change: what happened to the edge; `None` if the diagram compares no versions.
        interface: the kind of the interfaces through which it leads, if their nodes are not shown.
    """

    source: str
    target: str
    kind: EdgeKind
    labels: tuple[str, ...] = ()
    actions: tuple[str, ...] = ()
    probabilistic: bool = False
    internal: bool = False
    place: Location | None = None
    change: Change | None = None
    interface: DiagramNodeKind | None = None
    order: str = ""


class Picture(Record, frozen=True):
    """A diagram: its title, nodes and edges."""

    title: str
    nodes: tuple[DiagramNode, ...]
    edges: tuple[DiagramEdge, ...]

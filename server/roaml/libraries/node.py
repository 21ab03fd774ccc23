# SPDX-License-Identifier: Apache-2.0
"""The declaration of a node type of a behavior tree, from a library or a `<TreeNodesModel>`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

from roaml.record import Record
from roaml.roles import Direction, NodeKind

EVENT_ATTRIBUTE = "_event_probability"
"""The attribute that sets the probability of an event of the world at a tick, for a node that reads such an event. The
libraries ignore it (docs/spec/mocks.md#world)."""


class PortLimits(Record, frozen=True, omit_defaults=True):
    """The numbers that are useful values of a port (docs/spec/lone-trees.md#limits).

    Attributes:
        minimum: the lower bound of the useful numbers; `None` if there is none.
        is_exclusive: whether `minimum` itself is not useful.
        special: the numbers below the minimum that have a special meaning.
        counts_children: whether the number is a number of children: at least 1, or at most -1, where -1 means all
            children, -2 all except one, and so on.
        at_most, less_than: the name of another port whose number is an upper bound, or "".
        magnitude: the greatest absolute value of the useful numbers; `None` if there is none. A greater number is
            probably in another unit.
        distance, speed: the names of the ports whose quotient is the time that the node needs at least, in s, or "".
        effect: what the node does with other numbers, as a sentence without full stop, or "".
    """

    minimum: float | None = None
    is_exclusive: bool = False
    special: frozenset[float] = frozenset()
    counts_children: bool = False
    at_most: str = ""
    less_than: str = ""
    magnitude: float | None = None
    distance: str = ""
    speed: str = ""
    effect: str = ""


class Port(Record, frozen=True, omit_defaults=True):
    """A port of a node.

    Attributes:
        type: the C++ type as written, such as `unsigned int`; "" if it is not known. `script` is the script language.
        default: the value if the port is not set; `None` if the port has no default.
        required: whether the node needs a value; known only for ports of libraries and of subtrees.
        alias_of: the port for which this port is another name in trees of systems, or "".
        system_type, system_direction, system_constant: the properties of the port in trees of systems, if they differ.
        limits: the useful numbers; `None` if all are useful.
        names_entry: whether the value is the name of a blackboard entry even without braces.
        written_by: the nodes whose error codes the node distinguishes; empty if the port takes any value of its type.
    """

    name: str
    direction: Direction
    type: str = ""
    default: str | None = None
    required: bool = False
    text: str = ""
    alias_of: str = ""
    system_type: str = ""
    system_direction: Direction | None = None
    system_constant: bool = False
    limits: PortLimits | None = None
    names_entry: bool = False
    written_by: tuple[str, ...] = ()


class FormerPort(Record, frozen=True, omit_defaults=True):
    """A port that a node had in an earlier release of its library.

    Attributes:
        release: a release of ROS 2 whose library has the port, such as `Humble`.
        now: the port that replaces it, or "".
    """

    name: str
    release: str
    now: str = ""


class Node(Record, frozen=True, dict=True, omit_defaults=True):
    """A node that trees can use.

    Attributes:
        library: the name of its library, "" for nodes of a `<TreeNodesModel>`.
        behaviour: the name of the library that defines the behaviour of the node, even if a `<TreeNodesModel>` declares
            the node; "" if the behaviour is not known.
        children: the minimum and maximum number of children.
        since: the first version of the library that has the node, "" if all supported versions have it.
        until: the first version that no longer has the node, or "".
        succeeds: whether the node always returns SUCCESS in trees that set its ports as the library's own trees do.
        running: whether the first tick returns RUNNING: `True` is always, `False` is never, `None` is not known.
        program_only: whether the translation of the node exists only for trees whose nodes are executed as the library
            executes them (docs/spec/nodes.md#library).
        in_systems: how the node differs in trees of systems, as a sentence, or "".
        former: the ports that only earlier releases of the library have.
    """

    name: str
    kind: NodeKind
    ports: tuple[Port, ...]
    children: tuple[int, int]
    text: str = ""
    library: str = ""
    since: str = ""
    until: str = ""
    running: bool | None = None
    program_only: bool = False
    in_systems: str = ""
    succeeds: bool = False
    behaviour: str = ""
    former: tuple[FormerPort, ...] = ()

    @property
    def is_synchronous(self) -> bool:
        """Whether a leaf of this type is known to return SUCCESS or FAILURE within the tick."""
        return self.kind is NodeKind.CONDITION or self.running is False

    @cached_property
    def port_by_name(self) -> Mapping[str, Port]:
        return {port.name: port for port in self.ports}

    def port(self, name: str) -> Port | None:
        return self.port_by_name.get(name)

    def former_port(self, name: str) -> FormerPort | None:
        return next((port for port in self.former if port.name == name), None)


class Renamed(Record, frozen=True, omit_defaults=True):
    """The name of a node in version 3 of the library, and the name that replaces it in version 4."""

    name: str
    now: str


class Absent(Record, frozen=True, omit_defaults=True):
    """A name that is not a node of the XML format.

    Attributes:
        reason: what the name is, as the end of a sentence.
        instead: the name of the node that is probably intended, or "".
        not_translated: which similar node can be translated into a model of a system, as the end of a sentence.
    """

    name: str
    kind: NodeKind
    reason: str
    instead: str
    not_translated: str


class Library(Record, frozen=True, omit_defaults=True):
    """The nodes of one library, by name.

    Attributes:
        renamed: the names of version 3 that other names replace.
        foreign: the names of nodes in other libraries of behavior trees, with the names of the corresponding nodes in
            this library.
        absent: the names that are known not to be nodes.
        entries: the blackboard entries set by the program that executes a tree.
    """

    name: str
    version: str
    nodes: Mapping[str, Node]
    renamed: Mapping[str, Renamed]
    absent: Mapping[str, Absent]
    entries: tuple[str, ...]
    foreign: Mapping[str, str]

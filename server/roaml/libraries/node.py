# SPDX-License-Identifier: Apache-2.0
"""The declaration of a node of a behavior tree, from a library or a `<TreeNodesModel>`."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

UNBOUNDED = 1_000_000


class NodeKind(enum.Enum):
    CONTROL = "control"
    DECORATOR = "decorator"
    ACTION = "action"
    CONDITION = "condition"
    SUBTREE = "subtree"

    @property
    def children(self) -> tuple[int, int]:
        """The minimum and maximum number of children of a node of this kind."""
        match self:
            case NodeKind.CONTROL:
                return (1, UNBOUNDED)
            case NodeKind.DECORATOR:
                return (1, 1)
            case NodeKind.ACTION | NodeKind.CONDITION | NodeKind.SUBTREE:
                return (0, 0)


class Direction(enum.Enum):
    IN = "in"
    OUT = "out"
    INOUT = "inout"

    @property
    def reads(self) -> bool:
        return self is not Direction.OUT

    @property
    def writes(self) -> bool:
        return self is not Direction.IN


@dataclass(frozen=True, slots=True)
class Port:
    """A port of a node.

    Attributes:
        type: the C++ type as written, such as `unsigned int`; "" if it is not known. `script` is the script language.
        default: None if there is none.
        required: the node needs a value; only known of ports of libraries and of subtrees.
        alias_of: the port of which this is another name in trees of systems, or "".
        system_type, system_direction, system_constant: what the port is in trees of systems, if that differs.
    """

    name: str
    direction: Direction
    type: str = ""
    default: str | None = None
    required: bool = False
    text: str = ""
    alias_of: str = ""
    system_type: str = ""
    system_direction: str = ""
    system_constant: bool = False


@dataclass(frozen=True)
class Node:
    """A node that trees can use.

    Attributes:
        library: the name of the library that has it, "" for nodes of a `<TreeNodesModel>`.
        children: how many it has at least and at most.
        since: the first version of the library that has it, "" if all that are supported have it.
        until: the first version that does not have it any more, or "".
        running: whether its first tick gives RUNNING always (True), never (False), or it is not known (None).
        not_translated: None, or why it cannot be translated into a model of a system (may be "").
        in_systems: what is special about it in systems, or "".
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
    not_translated: str | None = None
    in_systems: str = ""

    @cached_property
    def port_by_name(self) -> Mapping[str, Port]:
        return {port.name: port for port in self.ports}

    def port(self, name: str) -> Port | None:
        return self.port_by_name.get(name)


@dataclass(frozen=True, slots=True)
class Renamed:
    """A name of version 3, and the one that replaces it."""

    name: str
    now: str


@dataclass(frozen=True, slots=True)
class Absent:
    """A name that is not a node of the XML format.

    Attributes:
        reason: what it is, as the end of a sentence.
        instead: the node that is probably meant, or "".
        not_translated: see `Node`.
    """

    name: str
    kind: NodeKind
    reason: str
    instead: str
    not_translated: str


@dataclass(frozen=True)
class Library:
    """The nodes of one library, by name.

    Attributes:
        renamed: names of version 3.
        absent: names that are known not to be nodes.
        entries: blackboard entries that the program which runs a tree sets.
    """

    name: str
    version: str
    nodes: Mapping[str, Node]
    renamed: Mapping[str, Renamed]
    absent: Mapping[str, Absent]
    entries: frozenset[str]

# SPDX-License-Identifier: Apache-2.0
"""The executed tree. It contains a node once for each use of its tree, with the entries to which the names refer
(docs/spec/mocks.md#blackboard)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Protocol

from roaml.forest.names import entry_of
from roaml.forest.ports import ports_of
from roaml.libraries import Node
from roaml.libraries.version import NEWEST_VERSION, Version
from roaml.model.expand import Frame, Instance, NodeSource, Reference, TreeUse, node_at
from roaml.model.tree import TreeFile, TreeNode
from roaml.record import Record
from roaml.scxml.names import NODE_PREFIX
from roaml.text import Location, Span


class Names(Protocol):
    """The mapping of the names in one use of a tree to entries of the blackboard."""

    def entry(self, name: str) -> str:
        """The full name of the entry to which `name` refers."""
        ...


class FrameNames(Record, frozen=True, eq=False):
    """The names in one use of a tree. Entries that a `<SubTree>` sets to constants are added to `initial`, with the
    texts of the constants."""

    frame: Frame
    initial: dict[str, str]

    def entry(self, name: str) -> str:
        value = self.frame.resolve(name)
        if isinstance(value, Reference):
            return value.variable
        variable = identifier(value.variable)
        self.initial[variable] = value.text
        return variable

    def is_initial(self, entry: str) -> bool:
        """Whether a `<SubTree>` sets an entry to a constant."""
        return entry in self.initial


SUBTREE = "SubTree"
"""The type of the nodes that stand for a subtree."""


class ExecutedNode(Record, frozen=True, eq=False):
    """A node of the executed tree.

    Attributes:
        number: that of the translation. Other nodes than `<SubTree>` are numbered in pre-order from 1000 on, as in
            pictures and in trees of systems.
        type: the name of its type; `SubTree` for a subtree.
        name: its name; if it has none, the name of its type or of the subtree.
        known: the declaration of its type; `None` if there is none.
        constants: ports that the tree does not set, with constants.
        own_type: the type in the tree, if the node is executed like one of another type; otherwise "".
        frame: the mapping of names to entries in the use of its tree.
    """

    number: int
    type: str
    name: str
    node: TreeNode
    known: Node | None
    frame: Names
    children: tuple[int, ...]
    origin: Location
    constants: tuple[tuple[str, str], ...] = ()
    own_type: str = ""

    @property
    def is_subtree(self) -> bool:
        return self.type == SUBTREE

    @property
    def automaton(self) -> str:
        return f"{NODE_PREFIX}{self.number}_{self.name}"

    @property
    def like(self) -> str:
        """The type like which the node is executed, with `constants`, as a mock states it."""
        ports = ", ".join(f"{port}={value}" for port, value in self.constants)
        return f"{self.type}({ports})" if ports else self.type

    def ports(self) -> Iterator[tuple[str, str | None, str, Span]]:
        """The ports that the tree sets, then those of `constants`: name, entry to which the port is bound (`None` for a
        constant), text, and position of the text."""
        for setting in ports_of(self.node):
            bound = entry_of(setting)
            entry = None if bound is None else self.frame.entry(bound)
            yield setting.key.value, entry, setting.value.value, setting.value.span
        for port, text in self.constants:
            yield port, None, text, self.node.element.name_span


class ExecutedTree(Record, frozen=True, eq=False):
    """The executed tree.

    Attributes:
        name: the name of the tree.
        nodes: its nodes, in pre-order.
        initial: entry -> the constant text to which an attribute of a `<SubTree>` sets it.
        version: the version of BehaviorTree.CPP that executes the tree.
    """

    name: str
    nodes: tuple[ExecutedNode, ...]
    initial: Mapping[str, str]
    version: Version = NEWEST_VERSION

    @property
    def root(self) -> int:
        """The number of the root, which may be a `<SubTree>`."""
        return self.nodes[0].number


class TreeLinks(Record, frozen=True, eq=False):
    """Binds the nodes of an expanded tree to the elements of its files.

    Attributes:
        files: the tree files, by path. They contain all nodes of the tree.
        initial: the entries that `<SubTree>` nodes set to constants; names are resolved when they are used.
        names: how the names in a use of a tree are resolved.
    """

    files: Mapping[str, TreeFile]
    initial: dict[str, str]
    names: type[FrameNames] = FrameNames

    def source(self, place: NodeSource) -> TreeNode:
        node = node_at(self.files[place.path], place)
        assert node is not None, place
        return node

    def origin(self, place: NodeSource) -> Location:
        return Location(place.path, self.source(place).element.name_span)

    def node(self, instance: Instance, frame: Frame, known: Node | None, children: tuple[int, ...]) -> ExecutedNode:
        source, names, type_ = (
            instance.source,
            self.names(frame, self.initial),
            known.name if known else instance.plugin,
        )
        node = self.source(source)
        return ExecutedNode(instance.number, type_, instance.name, node, known, names, children, self.origin(source))

    def subtree(self, number: int, use: TreeUse, below: int) -> ExecutedNode:
        """The node of a `<SubTree>`; `below` is its child."""
        source, outer = use.frame.use, use.frame.outer
        assert source is not None
        assert outer is not None
        names = self.names(outer, self.initial)
        return ExecutedNode(number, SUBTREE, use.name, self.source(source), None, names, (below,), self.origin(source))


def identifier(name: str) -> str:
    """`name` in the form of the name of a variable: `_` replaces invalid characters."""
    word = re.sub(r"\W", "_", name, flags=re.ASCII)
    return word if word[:1].isalpha() or word[:1] == "_" else f"_{word}"

# SPDX-License-Identifier: Apache-2.0
"""The nodes of the tree that is debugged: those of a system, or those of a tree without a system."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from roaml.jani.node import Origin
from roaml.model.expand import Instance, PortConstant, node_at
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.text import Location

if TYPE_CHECKING:
    from roaml.lower.programs.executed import ExecutedNode, ExecutedTree


class NodePort(NamedTuple):
    """A port that the tree sets, with its text; `entry` is the full name of the blackboard entry to which it is bound,
    "" for a constant."""

    name: str
    text: str
    entry: str


class SourceNode(Record, frozen=True):
    """A node of the tree.

    Attributes:
        number: 1000 for the root of the first tree, then increasing in pre-order.
        type: the name of its type; `SubTree` for a subtree of a tree without a system.
        name: its name; if it has none, the name of its type or of the subtree.
        automaton: the name of its automaton.
        parent: the number of its parent; `None` for the root.
        origin: its element; `None` if it is unknown.
        picture: its id in the picture of the tree.
        tree: the name of its tree in the system; "" if it has none.
    """

    number: int
    type: str
    name: str
    automaton: str
    parent: int | None
    ports: tuple[NodePort, ...]
    origin: Origin | None
    picture: str
    tree: str = ""


def nodes_of_system(analysis: Analysis, path: str) -> Iterator[SourceNode]:
    """The nodes of the tree of a system, in pre-order; none if the path is not that of a system."""
    system = analysis.system(path)
    for instance in () if system is None else system.instances:
        yield _of_instance(analysis, instance)


def _of_instance(analysis: Analysis, instance: Instance) -> SourceNode:
    ports = (
        NodePort(name, port.text, "")
        if isinstance(port, PortConstant)
        else NodePort(name, f"{{{port.variable}}}", port.variable)
        for name, port in instance.ports
    )
    file = analysis.tree(instance.source.path)
    node = None if file is None else node_at(file, instance.source)
    return SourceNode(
        instance.number,
        instance.plugin,
        instance.name,
        instance.automaton,
        instance.parent,
        tuple(ports),
        None if node is None else Location(instance.source.path, node.element.span),
        str(instance.number),
        instance.tree,
    )


def nodes_of_tree(tree: ExecutedTree) -> Iterator[SourceNode]:
    """The nodes of a tree without a system, in pre-order.

    The picture of a tree numbers the subtrees separately, from 1.
    """
    parents = {child: node.number for node in tree.nodes for child in node.children}
    subtrees = 0
    for node in tree.nodes:
        subtrees += node.is_subtree
        picture = f"subtree {subtrees}" if node.is_subtree else str(node.number)
        yield _of_executed(node, parents.get(node.number), picture)


def _of_executed(node: ExecutedNode, parent: int | None, picture: str) -> SourceNode:
    ports = tuple(NodePort(name, text, entry or "") for name, entry, text, _ in node.ports())
    origin = Location(node.origin.path, node.node.element.span)
    type_ = node.own_type or node.type
    return SourceNode(node.number, type_, node.name, node.automaton, parent, ports, origin, picture)

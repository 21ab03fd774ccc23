# SPDX-License-Identifier: Apache-2.0
"""The nodes that a tree can use, with what is necessary to write one of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from xml.sax.saxutils import quoteattr

from roaml.forest.forest import Forest
from roaml.ide.names.frames import Trees
from roaml.ide.names.occurrences import trees_of
from roaml.libraries.scripts import SCRIPT
from roaml.model.outline import MachineOutline
from roaml.model.system import CHILDREN_COUNT
from roaml.model.tree import EXPLICIT, Tree, TreeNode, is_variable_name
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.roles import UNBOUNDED, Direction, NodeKind

_CONSTANT_TYPES = ("int", "double", "float", "bool", "NodeStatus", SCRIPT)
"""Parts of the names of types whose values are usually constants, not entries of the blackboard."""


class NeededPort(Record, frozen=True):
    """A port that a node needs. `proposal` is a likely value; "" if there is none."""

    key: str
    type: str
    proposal: str


class PaletteNode(Record, frozen=True):
    """A node that a tree can use.

    Attributes:
        name: the name of its plugin, or the ID of its tree if it is a subtree.
        children: the minimum and maximum number of children.
        ports: the ports without a default.
        keys: the names of all ports; `None` if it accepts any port.
    """

    name: str
    kind: NodeKind
    children: tuple[int, int]
    ports: tuple[NeededPort, ...] = ()
    keys: frozenset[str] | None = None

    @property
    def answer(self) -> str:
        """The name that identifies the node among all nodes of a palette."""
        return f"SubTree {self.name}" if self.kind is NodeKind.SUBTREE else self.name

    def tag(self, values: Mapping[str, str]) -> str:
        """The start tag without its brackets, in the compact form. `values` are those of ports."""
        head = f"SubTree ID={quoteattr(self.name)}" if self.kind is NodeKind.SUBTREE else self.name
        return " ".join((head, *(f"{key}={quoteattr(value)}" for key, value in values.items())))


class Palette:
    """The nodes that the trees of a file can use."""

    def __init__(self, analysis: Analysis, path: str) -> None:
        system_path = analysis.systems_of(path)[0]
        self._trees = trees_of(analysis, path, system_path)
        system = analysis.system(system_path) if system_path is not None else None
        forest = analysis.forest(path, system_path) or analysis.forest(path)
        found: dict[str, PaletteNode] = {}
        for _, outline in system.plugins if system is not None else ():
            if outline.name:
                found.setdefault(outline.name, _of_plugin(outline, self._trees))
        self._nodes = found | {node.name: node for node in (_of_forest(forest) if forest is not None else ())}

    def nodes(self, inside: Tree) -> tuple[PaletteNode, ...]:
        """The nodes that can be added to a tree, in the order of a list: subtrees first. A tree cannot contain
        itself."""
        own = inside.id.value if inside.id is not None else ""
        subtrees = (PaletteNode(name, NodeKind.SUBTREE, (0, 0)) for name in self._trees.trees if name and name != own)
        return (*subtrees, *self._nodes.values())

    def children(self, node: TreeNode) -> tuple[int, int]:
        """The minimum and maximum number of children that a node may have. A node that is not declared is a control
        node if it has children, otherwise a leaf."""
        if node.is_subtree:
            return NodeKind.SUBTREE.children
        known = self._nodes.get(node.plugin.value) if node.plugin is not None else None
        if known is not None:
            return known.children
        if node.element.name in EXPLICIT:
            return NodeKind(node.element.name.lower()).children
        return NodeKind.CONTROL.children if node.children else NodeKind.ACTION.children


def _of_plugin(outline: MachineOutline, trees: Trees) -> PaletteNode:
    least, any_child = outline.plugin.children, outline.plugin.any_child
    children = (least or int(any_child), UNBOUNDED if any_child else least)
    kind = NodeKind.ACTION if children[1] == 0 else NodeKind.DECORATOR if children[1] == 1 else NodeKind.CONTROL
    defaults = trees.defaults.get(outline.name, {})
    ports = [port for port in outline.ports if port.key != CHILDREN_COUNT]
    needed = tuple(_needed(port.key, port.type, port.direction) for port in ports if port.key not in defaults)
    return PaletteNode(outline.name, kind, children, needed, frozenset(port.key for port in ports))


def _of_forest(forest: Forest) -> Iterator[PaletteNode]:
    for name in dict.fromkeys(forest.names):
        node = forest.node(name)
        if node is not None and not forest.is_machine(node):
            needed = tuple(
                _needed(port.name, port.type, port.direction)
                for port in node.ports
                if port.required and port.default is None and not port.alias_of
            )
            yield PaletteNode(name, node.kind, node.children, needed, frozenset(port.name for port in node.ports))


def _needed(key: str, type_: str, direction: Direction) -> NeededPort:
    is_constant = direction is Direction.IN and any(part in type_ for part in _CONSTANT_TYPES)
    return NeededPort(key, type_, f"{{{key}}}" if is_variable_name(key) and not is_constant else "")

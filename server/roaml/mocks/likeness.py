# SPDX-License-Identifier: Apache-2.0
"""Nodes with children that no library describes, and the nodes of the libraries like which they are executed
(docs/spec/mocks.md#likeness)."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.forest.forest import CPP, Forest
from roaml.libraries import Node, node_in_libraries
from roaml.libraries.programs.assembly import is_executable, programs
from roaml.libraries.scripts import script_ports
from roaml.model.tree import TreeNode
from roaml.record import Record
from roaml.regex import regex
from roaml.roles import NodeKind
from roaml.suggest import close_names, did_you_mean, listing

_FORM = regex(r"(?P<type>\w+)\s*(?:\(\s*(?P<ports>.*?)\s*\))?\Z")
_PORT = regex(r"(?P<port>\w+)\s*=\s*(?:\"(?P<quoted>[^\"]*)\"|(?P<plain>[^\",]*?))\s*(?:,\s*|\Z)")


class LikenessError(ValueError):
    """A likeness is not valid; the message states the reason."""


class Likeness(Record, frozen=True):
    """The node of a library like which a node is executed.

    Attributes:
        type: the type of the node of the library.
        ports: ports of this node that the tree does not set, with constants.
    """

    type: str
    ports: tuple[tuple[str, str], ...] = ()

    @property
    def text(self) -> str:
        """The likeness as `read_likeness` reads it, after the keyword."""
        ports = ", ".join(f"{port}={_quoted(value)}" for port, value in self.ports)
        return f"{self.type}({ports})" if ports else self.type

    @property
    def node(self) -> Node:
        """The declaration of the node of the library."""
        return library_parents()[self.type]


def _quoted(value: str) -> str:
    return f'"{value}"' if not value or any(character in value for character in ' ,()"') else value


def library_parents() -> dict[str, Node]:
    """The nodes of the libraries that have children and whose ports can be constants: type -> declaration."""
    scripts = script_ports()
    return {node.name: node for node in _parents() if node.name not in scripts and node.name in programs()}


def _parents() -> Iterator[Node]:
    for name in programs():
        node = CPP.nodes.get(name) or node_in_libraries(name)
        if node is not None and node.kind in (NodeKind.CONTROL, NodeKind.DECORATOR):
            yield node


def needs_likeness(forest: Forest, node: TreeNode) -> bool:
    """Whether a node of a tree without a system has children, and is not executed by a library."""
    if node.plugin is None or not node.children or forest.calls_tree(node):
        return False
    known = forest.known_node(node)
    return not is_executable(known.name if known else node.plugin.value, known, forest.settings.version)


def read_likeness(text: str) -> Likeness:
    """The likeness in a text such as `ForceSuccess` or `Repeat(num_cycles=3)`.

    Raises:
        LikenessError: the text has another form, or names no node with children or a port that it does not have.
    """
    match = _FORM.match(text.strip())
    if match is None:
        raise LikenessError(f"`{text.strip()}` is not a node of a library; write it as `Repeat(num_cycles=3)`")
    type_, known = match["type"], library_parents()
    if type_ not in known:
        close = did_you_mean(close_names(type_, known)) or "; for example `ForceSuccess`, `Sequence` or `Fallback`"
        kind = "its script cannot be set here" if type_ in script_ports() else "no library has this node with children"
        raise LikenessError(f"a node cannot be executed like `{type_}`: {kind}{close}")
    ports: list[tuple[str, str]] = []
    rest, at = match["ports"] or "", 0
    while at < len(rest):
        port = _PORT.match(rest, at)
        if port is None or port.end() == at:
            raise LikenessError(f"`{rest[at:]}` does not set a port of `{type_}`; write it as `num_cycles=3`")
        name, value = port["port"], port["plain"] if port["quoted"] is None else port["quoted"]
        names = [each.name for each in known[type_].ports]
        if name not in names:
            has = f"; it has {listing(names)}" if names else "; it has no ports"
            raise LikenessError(f"`{type_}` has no port `{name}`{did_you_mean(close_names(name, names)) or has}")
        if "{" in value:
            raise LikenessError(f"the port `{name}` of `{type_}` must be a constant here; set it in the tree instead")
        if any(name == other for other, _ in ports):
            raise LikenessError(f"the port `{name}` of `{type_}` is set twice; remove one of the values")
        ports.append((name, value))
        at = port.end()
    return Likeness(type_, tuple(ports))

# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-port`, which missing_port.md describes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.forest.cpp_types import normal
from roaml.forest.entries import Use
from roaml.forest.forest import CPP, Forest, is_model_of
from roaml.forest.names import is_autoremapped
from roaml.forest.ports import missing_ports, probable_ports
from roaml.libraries import LIBRARIES, Node, Port, library
from roaml.model.tree import Tree, TreeNode
from roaml.regex import regex
from roaml.roles import Direction, NodeKind, SymbolKind
from roaml.rules.rule import Rule, TreeContext, listing
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import trees_of
from roaml.text import Span, TextEdit

_OPTIONAL = regex(r"\boptional|\bif (?:it is |this is )?(?:not|un)|\bdefault|\bempty\b", re.I)
"""Matches descriptions of ports that need not be set, although the model gives them no default."""


def check(context: TreeContext) -> Iterator[Finding]:
    trees = trees_of(context)
    if trees is None:
        return
    for tree, node in trees.own_nodes:
        # In a system, a subtree may itself set the variables of its ports.
        known = trees.declaration(node) if trees.system is None else trees.known_node(node)
        if known is None or (known.kind is NodeKind.SUBTREE and is_autoremapped(node)):
            continue
        if known.library or known.kind is NodeKind.SUBTREE or trees.is_machine(known):
            yield from _needed(trees, tree, node, known, known)
        elif not trees.is_partly_described(known):
            of_libraries = [library(name).nodes.get(known.name) for name in LIBRARIES]
            library_node = next((other for other in of_libraries if other and is_model_of(known, other)), None)
            if library_node:
                yield from _needed(trees, tree, node, known, library_node)
            else:
                yield from _without_value(trees, tree, node, known)


def _needed(trees: Forest, tree: Tree, node: TreeNode, known: Node, needing: Node) -> Iterator[Finding]:
    """Report the ports that the declaration `needing` requires and that the node does not set."""
    probable = _probable(node, known)
    missing = [port for port in missing_ports(node, needing) if port.name not in probable]
    if not missing or node.plugin is None:
        return
    certain = needing.name in CPP.nodes or needing.kind is NodeKind.SUBTREE or trees.system is not None
    ports = "port" if len(missing) == 1 else "ports"
    owner = f"the subtree `{known.name}`" if node.is_subtree else f"`{known.name}`"
    path = trees.system.plugin(known.name)[0] if trees.system is not None else ""
    yield RULE.at(
        node.plugin.span,
        f"the {ports} {listing(port.name for port in missing)} of {owner} must be set",
        _adding(trees, tree, node, missing),
        severity=Severity.ERROR if certain else Severity.WARNING,
        related=[Related(Symbol(path, SymbolKind.PORT, missing[0].name), "declared here")] if path else [],
    )


def _without_value(trees: Forest, tree: Tree, node: TreeNode, known: Node) -> Iterator[Finding]:
    """Report the input ports that are not set and have no default, although the node may work without them."""
    ports_of_attributes = probable_ports(node, known)
    if not all(ports_of_attributes.values()):
        return  # unknown-port reports an attribute that may be a misspelling of any port
    probable = _probable(node, known)
    for port in known.ports:
        if port.name in probable or node.element.get(port.name) is not None or _OPTIONAL.search(port.text):
            continue
        if port.direction is Direction.IN and port.default is None:
            message = f"`{port.name}` of `{known.name}` has no value: it is not set, and its model has no default"
            assert node.plugin is not None
            yield RULE.at(node.plugin.span, message, _adding(trees, tree, node, [port]), severity=Severity.INFORMATION)


def _probable(node: TreeNode, known: Node) -> set[str]:
    """The ports that misspelled attributes are probably intended to set; unknown-port reports these attributes."""
    return {name for names in probable_ports(node, known).values() for name in names}


def _adding(trees: Forest, tree: Tree, node: TreeNode, ports: Sequence[Port]) -> Fix:
    """The fix that sets ports: to an entry that is meant, to a value of their type, or else to an entry with their
    name."""
    title = f"Add the missing {'port' if len(ports) == 1 else 'ports'}"

    def edits() -> tuple[TextEdit, ...]:
        end = node.element.attributes[-1].span.end if node.element.attributes else node.element.name_span.end
        new = "".join(f' {port.name}="{_value(trees, tree, node, port)}"' for port in ports)
        return (TextEdit(Span(end, end), new),)

    return Fix(title, edits, preferred=False)


def _value(trees: Forest, tree: Tree, node: TreeNode, port: Port) -> str:
    entry = _meant_entry(trees, tree, node, port)
    constant = _VALUES.get(normal(port.type)) if entry is None and port.direction is Direction.IN else None
    return f"{{{entry or port.name}}}" if constant is None else constant


def _meant_entry(trees: Forest, tree: Tree, node: TreeNode, port: Port) -> str | None:
    """The entry with the name of an input port if something before the node writes it, or the only entry that an output
    port can write and that is read in the tree although nothing writes it."""
    uses = [use for use in entries_of(trees).uses if tree.id is not None and use.tree == tree.id.value]
    written = {use.name: use.span for use in reversed(uses) if use.writes is not False or use.remaps}
    if port.direction.reads:
        is_before = port.name in written and written[port.name] < node.element.name_span
        return port.name if is_before else None
    needed = {use.name for use in uses if use.reads and use.name not in written and _has_type(trees, use, port.type)}
    return needed.pop() if len(needed) == 1 else None


def _has_type(trees: Forest, use: Use, type_: str) -> bool:
    """Whether a use needs a value of a type, or of a type that is not known."""
    known = trees.known_node(use.node)
    port = known.port(use.port) if known is not None else None
    return port is None or not port.type or not type_ or normal(port.type) == normal(type_)


_VALUES = {
    **dict.fromkeys(("int8", "int16", "int", "int64", "uint8", "uint16", "unsigned", "uint64"), "1"),
    "double": "0.0",
    "float": "0.0",
    "bool": "true",
}
"""Type of a port -> a value with which the port can be set."""


RULE = Rule("missing-port", Severity.ERROR, "A node or subtree does not set a port that it needs.", tree=check)

# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-node-port`, which missing_node_port.md describes."""

from __future__ import annotations

import re
from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.forest.entries import is_autoremapped
from roaml.forest.forest import CPP, is_model_of
from roaml.forest.ports import missing_ports, probable_ports
from roaml.libraries import LIBRARIES, Node, Port, library
from roaml.model.tree import TreeNode
from roaml.roles import Direction, NodeKind
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import forest_of
from roaml.text import Span, TextEdit

_OPTIONAL = re.compile(r"\boptional|\bif (?:it is |this is )?(?:not|un)|\bdefault|\bempty\b", re.I)
"""Matches descriptions of ports that need not be set, although the model gives them no default."""


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    for _, node in forest.own_nodes:
        known = forest.declaration(node)
        if known is None or (known.kind is NodeKind.SUBTREE and is_autoremapped(node)):
            continue
        if known.library or known.kind is NodeKind.SUBTREE:
            yield from _missing(node, known, known)
        elif not forest.is_partly_described(known):
            of_libraries = [library(name).nodes.get(known.name) for name in LIBRARIES]
            library_node = next((other for other in of_libraries if other and is_model_of(known, other)), None)
            yield from _missing(node, known, library_node) if library_node else _without_value(node, known)


def _missing(node: TreeNode, known: Node, needing: Node) -> Iterator[Finding]:
    """Report the ports that the declaration `needing` requires and that the node does not set."""
    certain = needing.name in CPP.nodes or needing.kind is NodeKind.SUBTREE
    probable = _probable(node, known)
    for port in missing_ports(node, needing):
        if port.name not in probable:
            kind_name = "the subtree" if node.is_subtree else "the node"
            message = f"{kind_name} `{known.name}` needs the port `{port.name}`"
            yield _finding(node, port, message, Severity.ERROR if certain else Severity.WARNING)


def _without_value(node: TreeNode, known: Node) -> Iterator[Finding]:
    """Report the input ports that are not set and have no default, although the node may work without them."""
    ports_of_attributes = probable_ports(node, known)
    if not all(ports_of_attributes.values()):
        return  # unknown-node-port reports an attribute that may be a misspelling of any port
    probable = _probable(node, known)
    for port in known.ports:
        if port.name in probable or node.element.get(port.name) is not None or _OPTIONAL.search(port.text):
            continue
        if port.direction is Direction.IN and port.default is None:
            message = f"`{port.name}` of `{known.name}` has no value: it is not set, and its model has no default"
            yield _finding(node, port, message, Severity.INFORMATION)


def _probable(node: TreeNode, known: Node) -> set[str]:
    """The ports that misspelled attributes are probably intended to set; unknown-node-port reports these attributes."""
    return {name for names in probable_ports(node, known).values() for name in names}


def _finding(node: TreeNode, port: Port, message: str, severity: Severity) -> Finding:
    assert node.plugin is not None
    at = node.plugin.span.end if node.compact else node.element.attributes[-1].span.end
    fix = Fix(f"Add `{port.name}`", (TextEdit(Span(at, at), f' {port.name}="{_value(port)}"'),), preferred=False)
    return RULE.at(node.plugin.span, message, fix, severity=severity)


def _value(port: Port) -> str:
    numbers = {"int": "1", "unsigned": "1000"}
    return numbers.get(port.type, f"{{{port.name}}}")


RULE = Rule("missing-node-port", Severity.ERROR, "A node or subtree does not set a required port.", tree=check)

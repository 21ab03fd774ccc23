# SPDX-License-Identifier: Apache-2.0
"""missing-node-port: see missing_node_port.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.forest.entries import is_autoremapped
from roaml.forest.forest import CPP, Forest
from roaml.libraries import Node, Port
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import forest_of
from roaml.suggest import close_names
from roaml.text import Span, TextEdit


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    for _, node in forest.own_nodes():
        known = forest.known_node(node)
        if known is not None and known.library:
            severity = Severity.ERROR if known.name in CPP.nodes else Severity.WARNING
            yield from _check(forest, node, known, severity)
        elif node.plugin is not None and (node.is_subtree or forest.names_tree(node)) and not is_autoremapped(node):
            model = forest.subtree_models.get(node.plugin.value)
            if model is not None:
                yield from _check(forest, node, model, Severity.ERROR)


def _check(forest: Forest, node: TreeNode, known: Node, severity: Severity) -> Iterator[Finding]:
    assert node.plugin is not None
    given = {attribute.name for attribute in node.element.attributes}
    strange = [name for name in given if known.port(name) is None and not name.startswith("_")]
    for port in known.ports:
        if not port.required or port.name in given or any(close_names(name, (port.name,)) for name in strange):
            continue
        at = node.plugin.span.end if node.compact else node.element.attributes[-1].span.end
        fix = Fix(f"Add `{port.name}`", (TextEdit(Span(at, at), f' {port.name}="{_value(port)}"'),), preferred=False)
        kind_name = "the subtree" if node.is_subtree else "the node"
        message = f"{kind_name} `{known.name}` needs the port `{port.name}`"
        yield RULE.at(node.plugin.span, message, fix, severity=severity)


def _value(port: Port) -> str:
    numbers = {"int": "1", "unsigned": "1000"}
    return numbers.get(port.type, f"{{{port.name}}}")


RULE = Rule("missing-node-port", Severity.ERROR, "A node or subtree does not set a port that it needs.", tree=check)

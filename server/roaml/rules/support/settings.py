# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about constants to which ports of nodes are set."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr.infer import constant
from roaml.expr.parse import parse
from roaml.model.expand import PortConstant
from roaml.model.tree import TreeNode, nodes
from roaml.rules.rule import TreeContext
from roaml.rules.support.instances import instances
from roaml.text import Decoded, Span


def constant_settings(context: TreeContext) -> Iterator[tuple[TreeNode, str, str]]:
    """The nodes of a file, each with the name of one of its ports and the constant to which the port is set. Constants
    from subtrees and from defaults of the tree model are included. The settings of nodes that are not executed are
    included as written, with references to the blackboard."""
    executed: set[TreeNode] = set()
    for node, automaton in instances(context):
        executed.add(node)
        for port in automaton.outline.ports:
            value = automaton.port(port.key)
            if isinstance(value, PortConstant):
                yield node, port.key, value.text
    for tree in context.file.trees:
        for node in nodes(tree):
            if node not in executed:
                for setting in node.ports:
                    yield node, setting.key.value, setting.value.value


def place_of(node: TreeNode, port: str) -> Span:
    """The value of a port of a node; the name of the node if the node does not set the port itself."""
    setting = next((setting.value for setting in node.ports if setting.key.value == port), node.plugin)
    assert setting is not None
    return setting.span


def integer_of(text: str) -> int | None:
    """The integer value of a constant; `None` if it is not an integer."""
    tree, findings = parse(Decoded(text.strip(), 0))
    value = None if findings else constant(tree)
    if isinstance(value, float):
        return int(value) if value.is_integer() else None
    return value

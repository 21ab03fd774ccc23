# SPDX-License-Identifier: Apache-2.0
"""The rule `redundant-decorator`, which redundant_decorator.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.forest import CPP, Forest
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import trees_of

_FORCED = ("ForceSuccess", "ForceFailure")


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    for _, node in forest.own_nodes if forest is not None else ():
        if forest is None or len(node.children) != 1 or node.scripts or node.children[0].scripts:
            continue
        outer, inner = _decorator(forest, node), _decorator(forest, node.children[0])
        reason = _reason(outer, inner)
        if reason:
            related = [Related(node.children[0].element.name_span, "the other decorator")]
            yield RULE.at(node.element.name_span, reason, related=related)


def _reason(outer: str, inner: str) -> str:
    """Why one of two decorators has no effect; "" if both have one."""
    if outer == inner == "Inverter":
        return "the second `Inverter` undoes this one; remove one or both of them"
    if outer in _FORCED and inner in _FORCED:
        return f"`{outer}` sets the result, so the `{inner}` below it has no effect; remove one of them"
    return ""


def _decorator(forest: Forest, node: TreeNode) -> str:
    """The name of a node of the library, "" for other nodes."""
    name = node.plugin.value if node.plugin else ""
    return name if len(node.children) == 1 and forest.known_node(node) is CPP.nodes.get(name) else ""


RULE = Rule(
    "redundant-decorator",
    Severity.WARNING,
    "A decorator has no effect, because of the decorator above or below it.",
    tree=check,
)

# SPDX-License-Identifier: Apache-2.0
"""The rule `hidden-failure`, which hidden_failure.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.forest import Forest
from roaml.forest.names import entry_of
from roaml.forest.ports import ports_of
from roaml.forest.scripts import scripts_of
from roaml.forest.statuses import PossibleStatuses
from roaml.libraries import Node
from roaml.model.tree import TreeNode
from roaml.roles import ProtocolPart
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import trees_of
from roaml.script.names import names_in


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None:
        return
    reported: set[TreeNode] = set()
    statuses = PossibleStatuses(forest, exact=True)
    for tree in context.file.trees:
        for root in tree.roots:
            if any(statuses.unreached(root)):
                continue  # another finding states why failures have no effect
            for retrying, hiding in statuses.hidden_failures(root):
                reported.add(hiding)
                message = (
                    f"`{hiding.type_name}` never fails although nodes below it can, so `{retrying.type_name}` above it "
                    f"never ticks its child again; remove `{hiding.type_name}`, or move it above `{retrying.type_name}`"
                )
                related = [Related(retrying.element.name_span, "waits for a failure")]
                yield RULE.at(hiding.element.name_span, message, related=related)
    for _, node in forest.own_nodes:
        if node.type_name in ("ForceSuccess", "ForceFailure") and node not in reported and len(node.children) == 1:
            condition = _condition(forest, node.children[0])
            if condition is not None:
                message = (
                    f"`{node.type_name}` hides what the condition `{condition.type_name}` returns, so it has no effect"
                )
                yield RULE.at(node.element.name_span, f"{message}; remove one of them")


def _condition(forest: Forest, node: TreeNode) -> TreeNode | None:
    """The condition whose result a node returns, unchanged or inverted, if this result is its only effect."""
    while node.type_name == "Inverter" and len(node.children) == 1:
        node = node.children[0]
    known = forest.known_node(node)
    if not forest.is_condition(node) or node.children or node.scripts or _may_write(forest, node, known):
        return None
    return None if _sends(forest, known) else node


def _sends(forest: Forest, known: Node | None) -> bool:
    """Whether a plugin sends messages, goals or events, which is another purpose than its result."""
    if known is None or forest.system is None or not forest.is_machine(known):
        return False
    outline = forest.system.plugin(known.name)[1]
    if outline is None:
        return True
    return bool(outline.sent) or any(
        part in use.sends for use in outline.interfaces for part in (ProtocolPart.MESSAGE, ProtocolPart.GOAL)
    )


def _may_write(forest: Forest, node: TreeNode, known: Node | None) -> bool:
    """Whether a node may write to the blackboard, which is another purpose than its result."""
    for script in scripts_of(forest, node):
        if any(operator != "read" for _, operator in names_in(script.attribute.value)):
            return True
    for setting in ports_of(node):
        port = known.port(setting.attribute.name) if known is not None else None
        if entry_of(setting) is not None and (port is None or port.direction.writes):
            return True
    return False


RULE = Rule(
    "hidden-failure",
    Severity.WARNING,
    "A node hides the failures that a node above it waits for, or the result of a condition.",
    tree=check,
)

# SPDX-License-Identifier: Apache-2.0
"""The rule `unreached-node`, which unreached_node.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity, Tag
from roaml.forest.forest import CPP
from roaml.forest.names import entry_of
from roaml.forest.statuses import statuses_of
from roaml.model.tree import PortSetting, TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import trees_of


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None:
        return
    for _, node in forest.own_nodes:
        if node.plugin is not None and forest.known_node(node) is CPP.nodes.get(node.plugin.value):
            yield from _of_switch(node)
        if node.plugin is not None and node.plugin.value == _RECOVERY and forest.known_node(node) is not None:
            yield from _of_recovery(node)
    possible = statuses_of(forest)
    for tree in context.file.trees:
        for root in tree.roots:
            for node, before, needed in possible.unreached(root):
                message = f"this node is never ticked: `{before.type_name}` before it never returns {needed}"
                related = [Related(before.element.name_span, f"never returns {needed}")]
                yield RULE.at(node.element.name_span, message, related=related, tags=(Tag.UNNECESSARY,))


_RECOVERY = "RecoveryNode"


def _of_recovery(node: TreeNode) -> Iterator[Finding]:
    """Report the recovery of a node that never tries again (docs/spec/nodes.md#control)."""
    for setting in node.ports:
        is_zero = setting.attribute.name == "number_of_retries" and setting.value.value.strip() == "0"
        if is_zero and len(node.children) == 2:
            message = "with 0 retries, the second child, which is the recovery, is never ticked"
            yield RULE.at(
                setting.value.span, message, related=[Related(node.children[1].element.name_span, "never ticked")]
            )


def _of_switch(node: TreeNode) -> Iterator[Finding]:
    """Report children of a `Switch` whose case equals an earlier case (docs/spec/nodes.md#control)."""
    if node.plugin is None or not node.plugin.value.startswith("Switch"):
        return
    first: dict[float | str, PortSetting] = {}
    settings = {setting.attribute.name: setting for setting in node.ports}
    for number, child in enumerate(node.children[:-1], 1):
        setting = settings.get(f"case_{number}")
        if setting is None or entry_of(setting) is not None:
            continue
        earlier = first.setdefault(_case(setting.value.value), setting)
        if earlier is not setting:
            name = earlier.attribute.name
            message = f"this node is never ticked: `case_{number}` equals `{name}`, which is compared first"
            related = [Related(earlier.value.span, "the equal case")]
            yield RULE.at(child.element.name_span, message, related=related, tags=(Tag.UNNECESSARY,))


def _case(text: str) -> float | str:
    """The value that the library compares: a number if the text is a number, otherwise the text."""
    try:
        return float(text)
    except ValueError:
        return text


RULE = Rule("unreached-node", Severity.WARNING, "A node of a tree is never ticked.", tree=check)

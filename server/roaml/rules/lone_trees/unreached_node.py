# SPDX-License-Identifier: Apache-2.0
"""The rule `unreached-node`, which unreached_node.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity, Tag
from roaml.forest.statuses import PossibleStatuses
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import forest_of


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    possible = PossibleStatuses(forest)
    for tree in context.file.trees:
        for root in tree.roots:
            for node, before, needed in possible.unreached(root):
                message = f"this node is never ticked: `{_name(before)}` before it never returns {needed}"
                related = [Related(before.element.name_span, f"never returns {needed}")]
                yield RULE.at(node.element.name_span, message, related=related, tags=(Tag.UNNECESSARY,))


def _name(node: TreeNode) -> str:
    return node.plugin.value if node.plugin else node.element.name


RULE = Rule("unreached-node", Severity.WARNING, "A node of a tree is never ticked.", tree=check)

# SPDX-License-Identifier: Apache-2.0
"""The rule `restarted-node`, which restarted_node.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.forest import Forest
from roaml.forest.statuses import statuses_of
from roaml.libraries.version import ASYNC_SEQUENCES_REFUSED_SINCE
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import trees_of


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None:
        return
    for _, node in forest.own_nodes:
        yield from _refused(forest, node)
        for child, first in statuses_of(forest).restarted(node):
            message = (
                f"this `{child.type_name}` never ends: at the next tick, `{node.type_name}` ticks the earlier "
                f"`{first.type_name}`, which is RUNNING again, and halts this node"
            )
            related = [Related(first.element.name_span, "starts again at every tick")]
            yield RULE.at(child.element.name_span, message, related=related)


def _refused(forest: Forest, node: TreeNode) -> Iterator[Finding]:
    """Report the second `AsyncSequence`, which the library refuses (docs/spec/lone-trees.md#versions)."""
    is_refused = forest.settings.version >= ASYNC_SEQUENCES_REFUSED_SINCE
    asynchronous = [child for child in node.children if child.plugin and child.plugin.value == "AsyncSequence"]
    if node.type_name == "ReactiveSequence" and is_refused and forest.known_node(node):
        for child in asynchronous[1:]:
            message = "BehaviorTree.CPP refuses a second `AsyncSequence` in a `ReactiveSequence`; use only one"
            yield RULE.at(child.element.name_span, message, severity=Severity.ERROR)


RULE = Rule("restarted-node", Severity.WARNING, "A reactive node has two asynchronous children.", tree=check)

# SPDX-License-Identifier: Apache-2.0
"""The rule `restarted-node`, which restarted_node.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.forest import Forest
from roaml.forest.statuses import PossibleStatuses
from roaml.libraries.version import ASYNC_SEQUENCES_REFUSED_SINCE
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import forest_of


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    possible = PossibleStatuses(forest)
    for _, node in forest.own_nodes:
        name = node.plugin.value if node.plugin else ""
        if name in ("ReactiveSequence", "ReactiveFallback") and forest.known_node(node):
            yield from _refused(forest, node, name)
            running = [child for child in node.children if possible.is_running_at_once(child)]
            for child in running[1:]:
                first = running[0]
                message = (
                    f"this `{_name(child)}` never ends: at the next tick, `{name}` ticks the earlier `{_name(first)}`, "
                    "which is RUNNING again, and halts this node"
                )
                related = [Related(first.element.name_span, "starts again at every tick")]
                yield RULE.at(child.element.name_span, message, related=related)


def _refused(forest: Forest, node: TreeNode, name: str) -> Iterator[Finding]:
    is_refused = forest.settings.version >= ASYNC_SEQUENCES_REFUSED_SINCE
    asynchronous = [child for child in node.children if child.plugin and child.plugin.value == "AsyncSequence"]
    if name == "ReactiveSequence" and is_refused:
        for child in asynchronous[1:]:
            message = "BehaviorTree.CPP refuses a second `AsyncSequence` in a `ReactiveSequence`; use only one"
            yield RULE.at(child.element.name_span, message, severity=Severity.ERROR)


def _name(node: TreeNode) -> str:
    return node.plugin.value if node.plugin else node.element.name


RULE = Rule("restarted-node", Severity.WARNING, "A reactive node has two asynchronous children.", tree=check)

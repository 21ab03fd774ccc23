# SPDX-License-Identifier: Apache-2.0
"""The rule `skipped-condition`, which skipped_condition.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.forest.forest import CPP
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import forest_of

_ASKING = ("IfThenElse", "WhileDoElse")


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    for _, node in forest.own_nodes:
        if node.plugin is None or node.plugin.value not in _ASKING or not node.children:
            continue
        if forest.known_node(node) is CPP.nodes[node.plugin.value]:
            condition = node.children[0]
            attribute = next((a for a in ("_skipIf", "_while") if condition.element.get(a) is not None), None)
            if attribute is not None:
                message = (
                    f"`{node.plugin.value}` throws an exception if `{attribute}` skips its condition; remove "
                    f"`{attribute}`"
                )
                yield RULE.at(condition.element.name_span, message)


RULE = Rule("skipped-condition", Severity.WARNING, "The condition of a node may be skipped.", tree=check)

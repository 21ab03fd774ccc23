# SPDX-License-Identifier: Apache-2.0
"""The rule `skipped-condition`, which skipped_condition.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.forest.statuses import statuses_of
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import trees_of


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None or (context.system is not None and context.system.is_as2fm):
        return  # AS2FM has no SKIPPED: untranslatable-tree reports nodes that can be skipped
    possible = statuses_of(forest)
    for _, node in forest.own_nodes:
        for child in possible.must_not_be_skipped(node):
            attribute = next((a for a in ("_skipIf", "_while") if child.element.get(a) is not None), None)
            if attribute is not None and node.plugin is not None:
                message = (
                    f"`{node.plugin.value}` throws an exception if `{attribute}` skips this child; remove `{attribute}`"
                )
                yield RULE.at(child.element.name_span, message)


RULE = Rule("skipped-condition", Severity.WARNING, "The condition of a node may be skipped.", tree=check)

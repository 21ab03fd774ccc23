# SPDX-License-Identifier: Apache-2.0
"""The rule `tree-too-large`, which tree_too_large.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.expand import MAX_NODES, MAX_SUBTREES, extent, node_at
from roaml.rules.rule import Rule, TreeContext


def check(context: TreeContext) -> Iterator[Finding]:
    size = extent(context.files)
    if size.is_expanded:
        return
    path = size.largest.path if size.largest else context.files[0].path
    if path != context.source.path:
        return
    node = node_at(context.file, size.largest) if size.largest else None
    place = node.element.name_span if node else context.file.element.name_span
    if size.nodes > MAX_NODES:
        yield RULE.at(
            place,
            f"with all subtrees expanded, the tree has {_count(size.nodes)} nodes, but at most {MAX_NODES:,} "
            "are executed; use subtrees less often, or divide the tree",
        )
    else:
        message = f"{size.depth:,} subtrees are nested, but at most {MAX_SUBTREES:,} are expanded; nest fewer subtrees"
        yield RULE.at(place, message)


def _count(number: int) -> str:
    return f"{number:,}" if number < 10**15 else "more than 10¹⁵"


RULE = Rule("tree-too-large", Severity.ERROR, "A tree is too large to be executed.", tree=check)

# SPDX-License-Identifier: Apache-2.0
"""The rule `early-read`, which early_read.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.entries import BoundUse, Use
from roaml.forest.forest import Forest
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import trees_of

SEQUENCES = frozenset(
    ("Sequence", "AsyncSequence", "SequenceWithMemory", "SequenceStar", "ReactiveSequence", "PipelineSequence")
)
_CERTAIN = SEQUENCES | {"RetryUntilSuccessful", "Repeat", "KeepRunningUntilFailure", "Timeout", "Delay"}
"""The nodes that tick their first child, and need its result."""


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None:
        return
    above = {child: (node, index) for _, node in forest.own_nodes for index, child in enumerate(node.children)}
    order = {node: number for number, (_, node) in enumerate(forest.own_nodes)}
    reported: set[tuple[TreeNode, str]] = set()
    for uses in entries_of(forest).by_entry.values():
        creators = [bound for bound in uses if bound.use.writes is not False and not _is_update(bound.use)]
        if not creators or _may_be_set(forest, uses):
            continue
        first = creators[0].use
        for bound in uses:
            use = bound.use
            is_here = use.path == context.source.path and use.node in order and bound.executed
            if not is_here or not use.reads or (use.node, use.name) in reported:
                continue
            if all(_is_before(forest, bound, creator, order, above) for creator in creators):
                reported.add((use.node, use.name))
                message = (
                    f"`{use.name}` is read here before `{first.node.type_name}` writes it; move this node behind it"
                )
                related = [Related(first.span, "written here")] if first.path == use.path else []
                yield RULE.at(use.span, message, related=related)


def _may_be_set(forest: Forest, uses: Sequence[BoundUse]) -> bool:
    """Whether something else than nodes and scripts may set an entry: the program, a `<SubTree>`, or an entry of an
    enclosing tree."""
    names = {bound.use.name.removeprefix("@") for bound in uses}
    if names & set(forest.host_entries) or len({id(bound.frame) for bound in uses}) > 1:
        return True
    return any(bound.use.into or bound.use.remaps or bound.use.is_default for bound in uses)


def _is_update(use: Use) -> bool:
    """Whether a script computes the new value of an entry from the old one."""
    return use.script and bool(use.reads)


def _is_before(
    forest: Forest,
    reader: BoundUse,
    creator: BoundUse,
    order: Mapping[TreeNode, int],
    above: Mapping[TreeNode, tuple[TreeNode, int]],
) -> bool:
    """Whether the first pass through a sequence certainly reads an entry before it creates it."""
    node, other = reader.use.node, creator.use.node
    if other not in order or order[other] <= order[node]:
        return False
    around = set(_ancestors(other, above))
    if node in around:
        return False
    while node in above:
        parent, index = above[node]
        name = parent.type_name
        if any(_is_guard(forest, earlier) for earlier in parent.children[:index]) or parent.scripts:
            return False
        if parent in around:
            return name in SEQUENCES
        is_tried = forest.system is not None and name in ("Fallback", "ReactiveFallback") and index == 0
        if name not in _CERTAIN and not is_tried:
            return False
        node = parent
    return False


def _ancestors(node: TreeNode, above: Mapping[TreeNode, tuple[TreeNode, int]]) -> Iterator[TreeNode]:
    while node in above:
        node = above[node][0]
        yield node


def _is_guard(forest: Forest, node: TreeNode) -> bool:
    """Whether a node is, or contains, a condition, after which the reader may be ticked only once the entry is set."""
    return forest.is_condition(node) or bool(node.scripts) or any(_is_guard(forest, child) for child in node.children)


RULE = Rule(
    "early-read",
    Severity.WARNING,
    "A blackboard variable is read before it is written.",
    tree=check,
)

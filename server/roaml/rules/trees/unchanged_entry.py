# SPDX-License-Identifier: Apache-2.0
"""The rule `unchanged-entry`, which unchanged_entry.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.cpp_types import ANY, INTEGER_TYPES, normal
from roaml.forest.entries import BoundUse
from roaml.forest.forest import Forest
from roaml.forest.scripts import parsed, scripts_of
from roaml.forest.statuses import RETRYING
from roaml.libraries.scripts import CONDITIONS
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.constant_entries import ConstantEntry, constant_entries
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import trees_of
from roaml.rules.support.loops import nodes_above, repeats
from roaml.rules.support.unread_entries import unread_entries
from roaml.script.tree import Comparison, Expr, Name, Number, walk
from roaml.text import Decoded, Location

_FIRST = (0, 1)
"""The values with which counters begin. Other constants are usually parameters."""


def check(context: TreeContext) -> Iterator[Finding]:
    """Report entries that are set before a loop like a counter, and that the loop reads but never changes."""
    forest = trees_of(context)
    if forest is None:
        return
    misspelled = {unread.meant for unread in unread_entries(forest).values()}
    for key, constant in constant_entries(forest).items():
        use = constant.writer.use
        uses = entries_of(forest).by_entry[key]
        is_counter = constant.value in _FIRST and isinstance(constant.value, int) and use.name not in misspelled
        if not is_counter or use.path != context.source.path or not _is_like_counter(forest, constant, uses):
            continue
        readers = [bound for bound in uses if bound.use.reads]
        loops = {loop for bound in readers for loop in [_loop(forest, bound, constant.writer)]}
        if readers and None not in loops and len(loops) == 1:
            ((path, loop),) = (place for place in loops if place is not None)
            message = (
                f"`{use.name}` is always {constant.value} in the loop that reads it, because nothing changes it there; "
                f"change it in the loop, or write {constant.value} where it is read"
            )
            related = [
                Related(Location(path, loop.element.name_span), "the loop"),
                Related(Location(readers[0].use.path, readers[0].use.span), "read here"),
            ]
            yield RULE.at(use.span, message, related=related)


def _loop(forest: Forest, reader: BoundUse, writer: BoundUse) -> tuple[str, TreeNode] | None:
    """The innermost loop around `reader` that does not contain `writer`, with the path of its file. To test the same
    value again is in vain also after a failure."""
    around = set(nodes_above(forest, writer))
    for frame, node in nodes_above(forest, reader):
        if (frame, node) in around:
            return None
        if repeats(node) or (reader.use.script and node.type_name in RETRYING):
            return frame.tree.path, node
    return None


def _is_like_counter(forest: Forest, constant: ConstantEntry, uses: Sequence[BoundUse]) -> bool:
    """Whether an entry is used like a counter: only ports for integers and conditions that compare it read it, and the
    script that sets it also sets a counter, or there is such a condition."""
    readers = [bound.use for bound in uses if bound.use.reads]
    scripts = [use for use in readers if use.script]
    types = {normal(use.type) for use in readers if not use.script}
    is_typed = types <= {ANY, *INTEGER_TYPES} and (bool(scripts) or _sets_counter(forest, constant))
    return is_typed and all(_is_compared(forest, use.node, use.name) for use in scripts)


def _sets_counter(forest: Forest, constant: ConstantEntry) -> bool:
    entries, tree = entries_of(forest), constant.writer.use.tree
    others = [entries.by_entry.get(key, ()) for name in constant.names for key in entries.entries(tree, name)]
    return any(bound.use.script and bound.use.reads and bound.use.writes for uses in others for bound in uses)


def _is_compared(forest: Forest, node: TreeNode, name: str) -> bool:
    """Whether all scripts of a node that have a name are ports whose value is a condition that compares it.
    constant-condition reports the conditions of other nodes."""
    for script in scripts_of(forest, node):
        tree, _ = parsed(Decoded(script.attribute.value, 0))
        exprs = list(walk(tree))
        if not any(isinstance(expr, Name) and expr.name == name for expr in exprs):
            continue
        compared = [
            expr.operands for expr in exprs if isinstance(expr, Comparison) and not {"==", "!="} & {*expr.operators}
        ]
        is_operand = any(_is_limited(operands, name) for operands in compared)
        if script.attribute.name in CONDITIONS or not script.is_condition or not is_operand:
            return False
    return True


def _is_limited(operands: Sequence[Expr], name: str) -> bool:
    """Whether a comparison is between an entry and numbers."""
    others = [operand for operand in operands if not (isinstance(operand, Name) and operand.name == name)]
    return len(others) < len(operands) and all(isinstance(operand, Number) for operand in others)


RULE = Rule(
    "unchanged-entry",
    Severity.WARNING,
    "A loop reads a counter that nothing changes.",
    tree=check,
)

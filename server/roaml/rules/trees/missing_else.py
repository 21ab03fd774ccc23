# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-else`, which missing_else.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import after
from roaml.forest.forest import CPP, Forest
from roaml.forest.statuses import statuses_of
from roaml.libraries.programs.statuses import FAILURE
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import trees_of

_NODE = "IfThenElse"
_IN_ORDER = ("Sequence", "AsyncSequence", "SequenceWithMemory")
"""The nodes in which an `IfThenElse` without a third child does the same as its two children alone."""


def check(context: TreeContext) -> Iterator[Finding]:
    """Report an `IfThenElse` without a third child before other children of a sequence."""
    forest = trees_of(context)
    for _, node in forest.own_nodes if forest is not None else ():
        if forest is None or node.type_name not in _IN_ORDER:
            continue
        for child, behind in zip(node.children, node.children[1:], strict=False):
            if _fails_without_else(forest, child):
                message = (
                    f"if the condition of this `{_NODE}` fails, the node fails, because it has no third child, and "
                    f"`{behind.type_name}` is not ticked; add `<AlwaysSuccess />` as its third child, or put its "
                    f"children directly into the `{node.type_name}` if the failure is intended"
                )
                related = [Related(behind.element.name_span, "not ticked if the condition fails")]
                added = after(context.document, child.children[1].element, "<AlwaysSuccess />")
                fix = Fix("Add `<AlwaysSuccess />`", (added,))
                yield RULE.at(child.element.name_span, message, fix, related=related)


def _fails_without_else(forest: Forest, node: TreeNode) -> bool:
    """Whether a node is an `IfThenElse` that fails if its condition does."""
    if node.type_name != _NODE or forest.known_node(node) is not CPP.nodes[_NODE] or len(node.children) != 2:
        return False
    return not node.scripts and FAILURE in statuses_of(forest).statuses(node)[node.children[0]].ever


RULE = Rule(
    "missing-else",
    Severity.WARNING,
    "A condition without an `else` ends the sequence around it.",
    tree=check,
)

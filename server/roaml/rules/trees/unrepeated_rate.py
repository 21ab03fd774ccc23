# SPDX-License-Identifier: Apache-2.0
"""The rule `unrepeated-rate`, which unrepeated_rate.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.forest.statuses import statuses_of
from roaml.libraries import node_in_libraries
from roaml.libraries.programs.statuses import RUNNING
from roaml.model.tree import TreeNode
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import trees_of
from roaml.rules.support.loops import LOOPS

CONTROLLERS = frozenset(("RateController", "DistanceController", "SpeedController"))
"""The nodes of Nav2 that tick their child again after some time or distance."""
_ONCE = frozenset(("Sequence", "AsyncSequence", "SequenceWithMemory"))
"""The nodes that do not tick a child again that has succeeded while a later child is RUNNING."""


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None:
        return
    above = {child: node for _, node in forest.own_nodes for child in node.children}
    for _, node in forest.own_nodes:
        known = forest.known_node(node)
        parent = above.get(node)
        if known is None or parent is None or known.name not in CONTROLLERS or parent.type_name not in _ONCE:
            continue
        is_library = known.behaviour and node_in_libraries(known.name) is not None
        later = parent.children[parent.children.index(node) + 1 :]
        running = next((o for o in later if RUNNING in statuses_of(forest).statuses(o)[o].ever), None)
        if not is_library or running is None or any(outer.type_name in LOOPS for outer in _around(parent, above)):
            continue
        message = (
            f"`{known.name}` has no effect in a `{parent.type_name}`, which does not tick it again while "
            f"`{running.type_name}` is RUNNING; use a `PipelineSequence`"
        )
        related = [Related(parent.element.name_span, "ticks each child until it succeeds")]
        yield RULE.at(node.element.name_span, message, related=related)


def _around(node: TreeNode, above: dict[TreeNode, TreeNode]) -> Iterator[TreeNode]:
    while node in above:
        node = above[node]
        yield node


RULE = Rule(
    "unrepeated-rate",
    Severity.WARNING,
    "A node that limits how often its child is ticked is in a sequence that ticks it once.",
    tree=check,
)

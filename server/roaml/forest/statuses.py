# SPDX-License-Identifier: Apache-2.0
"""The statuses that nodes can return, and the children that are never ticked because of the statuses of earlier
children (docs/spec/lone-trees.md#statuses).

An unknown node may return any status.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import TypeAlias

from roaml.forest.forest import Forest
from roaml.libraries.scripts import CONDITIONS
from roaml.model.tree import TreeNode
from roaml.roles import NodeKind

S, F, R, K = "SUCCESS", "FAILURE", "RUNNING", "SKIPPED"
ANY_STATUS = frozenset((S, F, R, K))

MAX_SUBTREES = 100
"""The maximum nesting depth of subtrees that are analysed. Deeper subtrees are assumed to return any status."""

_SEQUENCES = ("Sequence", "AsyncSequence", "SequenceWithMemory", "ReactiveSequence", "PipelineSequence")
_FALLBACKS = ("Fallback", "AsyncFallback", "ReactiveFallback")
_CHILD_FIRST = (
    *("Sequence", "SequenceWithMemory", "Fallback", "ReactiveSequence", "ReactiveFallback", "IfThenElse"),
    *("WhileDoElse", "PipelineSequence", "RecoveryNode"),
)
"""The nodes that tick their first child at their first tick, and return RUNNING if this child returns RUNNING."""
_TRANSPARENT = (
    *("Inverter", "ForceSuccess", "ForceFailure", "Repeat", "RetryUntilSuccessful", "Timeout"),
    "KeepRunningUntilFailure",
)

Statuses: TypeAlias = "frozenset[str]"


def _ended(statuses: Statuses, success: str, failure: str) -> Statuses:
    """`statuses` with SUCCESS replaced by `success` and FAILURE by `failure`."""
    return frozenset({S: success, F: failure}.get(status, status) for status in statuses)


class PossibleStatuses:
    """The statuses that the nodes of a forest can return. Each tree is analysed once. A recursive tree is assumed to
    return any status."""

    def __init__(self, forest: Forest) -> None:
        self.forest = forest
        self._trees: dict[str, Statuses] = {}
        self._depth = 0

    def statuses(self, root: TreeNode) -> dict[TreeNode, Statuses]:
        """The statuses that a node and all nodes below it can return."""
        statuses: dict[TreeNode, Statuses] = {}
        order, stack = [], [root]
        while stack:
            node = stack.pop()
            order.append(node)
            stack += node.children
        for node in reversed(order):
            statuses[node] = self._conditions(node, self._own(node, [statuses[child] for child in node.children]))
        return statuses

    def _conditions(self, node: TreeNode, own: Statuses) -> Statuses:
        more: Statuses = frozenset()
        for attribute, status in (("_failureIf", F), ("_successIf", S), ("_skipIf", K), ("_while", K)):
            if node.element.get(attribute) is not None:
                more |= {status}
        return own | more

    def _tree(self, name: str) -> Statuses:
        if name not in self._trees:
            self._trees[name] = ANY_STATUS  # used during the analysis, if the tree contains itself
            _, tree = self.forest.trees[name]
            if len(tree.roots) == 1 and self._depth < MAX_SUBTREES:
                self._depth += 1
                # An unreached node in this tree is reported there only, not also where the tree is used.
                if not any(self.unreached(tree.roots[0])):
                    self._trees[name] = self.statuses(tree.roots[0])[tree.roots[0]]
                self._depth -= 1
        return self._trees[name]

    def _own(self, node: TreeNode, below: list[Statuses]) -> Statuses:
        name = node.plugin.value if node.plugin else ""
        if node.is_subtree or self.forest.names_tree(node):
            return self._tree(name) if name in self.forest.trees else ANY_STATUS
        known = self.forest.known_node(node)
        if known is None or not known.behaviour:
            return ANY_STATUS
        if name in _SEQUENCES:
            return _in_turn(below, S, F) | ({R} if name.startswith("Async") else frozenset())
        if name in _FALLBACKS:
            return _in_turn(below, F, S) | ({R} if name.startswith("Async") else frozenset())
        if known.kind is NodeKind.DECORATOR:
            return self._decorator(node, name, below[0] if len(below) == 1 else ANY_STATUS)
        if name in ("AlwaysSuccess", "Script", "UnsetBlackboard"):
            return frozenset((S,))
        if name == "AlwaysFailure":
            return frozenset((F,))
        if name == "Sleep":
            return frozenset((S, R))
        if known.kind is NodeKind.CONDITION or known.running is False:
            return frozenset((S, F))
        return ANY_STATUS - {K} if known.kind is NodeKind.ACTION else ANY_STATUS

    def _decorator(self, node: TreeNode, name: str, child: Statuses) -> Statuses:
        match name:
            case "Inverter":
                return _ended(child, F, S)
            case "ForceSuccess":
                return _ended(child, S, S)
            case "ForceFailure":
                return _ended(child, F, F)
            case "KeepRunningUntilFailure":
                return (child & {F}) | {R}
            case "Repeat":
                endless = (child - {S}) | {R}
                return endless if _number(node, "num_cycles") == "-1" else child | {R, S}
            case "RetryUntilSuccessful":
                endless = (child - {F}) | {R}
                return endless if _number(node, "num_attempts") == "-1" else child | {R, F}
            case "Delay" | "RateController" | "DistanceController" | "SpeedController" | "GoalUpdatedController":
                return child | {R}
            case "Timeout" | "SingleTrigger":
                return child | {F}
            case "PathLongerOnApproach":
                return child | {S}
            case "GoalUpdater":
                return child
        return ANY_STATUS

    def unreached(self, root: TreeNode) -> Iterator[tuple[TreeNode, TreeNode, str]]:
        """The children that are never ticked.

        Each result contains the child, the earlier child after which the node always ends, and the status that this
        earlier child never returns. Of several adjacent children that are never ticked, only the first is returned. If
        the statuses of a child follow from an unreached child inside it, only the inner one is returned.
        """
        statuses = self.statuses(root)
        has_inner: set[TreeNode] = set()
        order, stack = [], [root]
        while stack:
            node = stack.pop()
            order.append(node)
            stack += node.children
        stopped_nodes = []
        for node in reversed(order):  # so that children are visited before their parents
            stopped = self._stopped(node, statuses)
            if stopped is not None and stopped[1] not in has_inner:
                stopped_nodes.append(stopped)
            if stopped is not None or any(child in has_inner for child in node.children):
                has_inner.add(node)
        yield from reversed(stopped_nodes)

    def _stopped(self, node: TreeNode, statuses: dict[TreeNode, Statuses]) -> tuple[TreeNode, TreeNode, str] | None:
        name = node.plugin.value if node.plugin else ""
        needed = S if name in _SEQUENCES else F if name in _FALLBACKS else ""
        if needed and self.forest.known_node(node):
            for before, child in itertools.pairwise(node.children):
                if not statuses[before] & {needed, K}:
                    return child, before, needed
        return None

    def is_running_at_once(self, node: TreeNode) -> bool:
        """Whether the first tick of a node always returns RUNNING."""
        while True:
            name = node.plugin.value if node.plugin else ""
            if any(node.element.get(condition) for condition in CONDITIONS):
                return False
            if node.is_subtree or self.forest.names_tree(node):
                return False
            known = self.forest.known_node(node)
            if known is None:
                return False
            if name in (*_CHILD_FIRST, *_TRANSPARENT) and known.behaviour and node.children:
                node = node.children[0]
                continue
            return known.running is True and not _is_zero(node)


def _in_turn(below: list[Statuses], next_status: str, end_status: str) -> Statuses:
    """The statuses that can be returned by a node that ticks its children in order as long as they return
    `next_status`, and that returns `end_status` as soon as a child returns it. `below` are the statuses that the
    children can return."""
    statuses: set[str] = set()
    all_skip = True
    for child in below:
        statuses |= child & {end_status, R}
        if not child & {next_status, K}:
            return frozenset(statuses)
        all_skip = all_skip and K in child
    may_succeed = any(next_status in child for child in below)
    return frozenset(statuses | ({next_status} if may_succeed else set()) | ({K} if all_skip else set()))


def _number(node: TreeNode, port: str) -> str:
    attribute = node.element.get(port)
    return attribute.value.strip() if attribute else ""


def _is_zero(node: TreeNode) -> bool:
    """Whether the time of a node is 0 or unknown because an entry contains it, so that the node may end at once."""
    return any(_number(node, port).startswith(("0", "{", "=")) for port in ("msec", "delay_msec", "wait_duration"))

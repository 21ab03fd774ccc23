# SPDX-License-Identifier: Apache-2.0
"""The statuses that nodes can return, and the children that are never ticked because of the statuses of earlier
children (docs/spec/lone-trees.md#statuses).

They are computed from the programs of the nodes (`roaml.libraries.programs.effects`). An unknown node may return any
status.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence

from roaml.forest.forest import Forest
from roaml.forest.names import entry_of
from roaml.forest.ports import ports_of
from roaml.forest.scripts import script_attributes
from roaml.libraries import Node
from roaml.libraries.programs.assembly import programs
from roaml.libraries.programs.effects import ANY_ANSWER, effects, effects_on
from roaml.libraries.programs.linked import ANY, OF_MACHINE, LinkedNode, Possible, linked
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SKIPPED, SUCCESS
from roaml.model.tree import TreeNode
from roaml.record import replace
from roaml.roles import UNBOUNDED, NodeKind

MAX_SUBTREES = 100
"""The maximum nesting depth of subtrees that are analysed. Deeper subtrees are assumed to return any status."""

_ENDS = frozenset((SUCCESS, FAILURE))
_BLAMED = {SUCCESS: "SUCCESS", FAILURE: "FAILURE", RUNNING: "RUNNING"}


class PossibleStatuses:
    """The statuses that the nodes of a forest can return. Each tree is analysed once. A recursive tree is assumed to
    return any status."""

    def __init__(self, forest: Forest) -> None:
        self.forest = forest
        self._trees: dict[str, Possible] = {}
        self._known: dict[TreeNode, Possible] = {}
        self._depth = 0

    def statuses(self, root: TreeNode) -> dict[TreeNode, Possible]:
        """The statuses that a node and all nodes below it can return."""
        nodes = _from_leaves(root)
        for node in nodes:
            if node not in self._known:
                self._known[node] = self._linked(node).possible([self._known[child] for child in node.children])
        return {node: self._known[node] for node in nodes}

    def restarted(self, node: TreeNode) -> Iterator[tuple[TreeNode, TreeNode]]:
        """The children that never end, because the node ticks an earlier child again, which then is RUNNING, and halts
        them: each with this earlier child."""
        bound, count = self._linked(node), len(node.children)
        if bound.program is None or count == 1:
            return
        below = [self._statuses_of(child) for child in node.children]
        running = [index for index, statuses in enumerate(below) if statuses.first == {RUNNING}]
        for later in running[1:]:
            earlier = running[0]
            if any(_is_restarted(bound, count, earlier, later, end) for end in below[earlier].ever & _ENDS):
                yield node.children[later], node.children[earlier]

    def _statuses_of(self, node: TreeNode) -> Possible:
        return self._known[node] if node in self._known else self.statuses(node)[node]

    def must_not_be_skipped(self, node: TreeNode) -> Iterator[TreeNode]:
        """The children of a node after whose skipping the library throws an exception."""
        bound = self._linked(node)
        if bound.program is not None:
            fatal = bound.effects([ANY] * len(node.children)).fatal
            yield from (child for index, child in enumerate(node.children) if index in fatal)

    def _tree(self, name: str) -> Possible:
        if name not in self._trees:
            self._trees[name] = ANY  # used during the analysis, if the tree contains itself
            _, tree = self.forest.trees[name]
            if len(tree.roots) == 1 and self._depth < MAX_SUBTREES:
                self._depth += 1
                # An unreached node in this tree is reported there only, not also where the tree is used.
                if not any(self.unreached(tree.roots[0])):
                    self._trees[name] = self.statuses(tree.roots[0])[tree.roots[0]]
                self._depth -= 1
        return self._trees[name]

    def _linked(self, node: TreeNode) -> LinkedNode:
        known, version = self.forest.known_node(node), self.forest.settings.version
        settings = {s.key.value: s.value.value if entry_of(s) is None else None for s in ports_of(node)}
        scripts = [attribute.name for attribute in script_attributes(node)]
        if self.forest.calls_tree(node):
            name = node.plugin.value if node.plugin else ""
            inner = self._tree(name) if name in self.forest.trees else ANY
            return replace(linked(None, {}, scripts, 0, inner, version), conditions=programs(version)["SubTree"])
        return linked(known, settings, scripts, len(node.children), self._leaf(node, known), version)

    def _leaf(self, node: TreeNode, known: Node | None) -> Possible:
        """The statuses of a node without a program."""
        if known is not None and self.forest.is_machine(known):
            return OF_MACHINE
        if known is None or not known.behaviour:
            return ANY
        if known.is_synchronous:
            return Possible(_ENDS, _ENDS)
        if known.kind is not NodeKind.ACTION:
            return ANY
        ends = ANY_ANSWER - {SKIPPED}
        return Possible(ends, frozenset((RUNNING,)) if known.running and not _may_be_zero(node) else ends)

    def _is_in_order(self, node: TreeNode) -> bool:
        """Whether a node may have any number of children, so that each continues after the ones before it."""
        known = self.forest.known_node(node)
        return known is not None and known.children[1] == UNBOUNDED

    def unreached(self, root: TreeNode) -> Iterator[tuple[TreeNode, TreeNode, str]]:
        """The children that are never ticked.

        Each result contains the child, the earlier child after which the node always ends, and the status that this
        earlier child never returns. Of several adjacent children that are never ticked, only the first is returned. If
        the statuses of a child follow from an unreached child inside it, only the inner one is returned.
        """
        statuses = self.statuses(root)
        has_inner: set[TreeNode] = set()
        stopped_nodes = []
        for node in _from_leaves(root):
            stopped = self._stopped(node, [statuses[child] for child in node.children])
            if stopped is not None and stopped[1] not in has_inner:
                stopped_nodes.append(stopped)
            if stopped is not None or any(child in has_inner for child in node.children):
                has_inner.add(node)
        yield from reversed(stopped_nodes)

    def _stopped(self, node: TreeNode, below: Sequence[Possible]) -> tuple[TreeNode, TreeNode, str] | None:
        """The first child of a node that is never ticked because of an earlier child."""
        bound = self._linked(node)
        if bound.program is None or not self._is_in_order(node):
            return None
        setting, ticked = bound.situation(below), bound.effects(below).ticked
        for index in range(1, len(below)):
            for before in reversed(range(index)) if index not in ticked else ():
                for status in (status for status in _BLAMED if status not in setting.answers[before]):
                    answers = list(setting.answers)
                    answers[before] |= {status}
                    if index in effects(bound.program, replace(setting, answers=tuple(answers))).ticked:
                        return node.children[index], node.children[before], _BLAMED[status]
        return None


def _is_restarted(bound: LinkedNode, count: int, earlier: int, later: int, end: int) -> bool:
    """Whether a node ticks a child again that has returned `end`, and halts a later child that is RUNNING if, and only
    if, the earlier one is RUNNING then."""
    assert bound.program is not None
    ended, running = Possible(frozenset((end,)), frozenset((end,))), frozenset((RUNNING,))
    below = [ended] * count
    below[later] = Possible(running, running)
    if RUNNING in effects_on(bound.program, bound.situation(below), later).halts:
        return False
    below[earlier] = Possible(running | {end}, running)
    situation = bound.situation(below)
    is_halted = RUNNING in effects_on(bound.program, situation, later).halts
    return is_halted and effects_on(bound.program, situation, earlier).restarts


def _from_leaves(root: TreeNode) -> list[TreeNode]:
    """A node and all nodes below it, children before their parents."""
    order, stack = [], [root]
    while stack:
        node = stack.pop()
        order.append(node)
        stack += node.children
    return order[::-1]


def _may_be_zero(node: TreeNode) -> bool:
    """Whether the time of an action is 0 or in an entry, so that the action may end at once."""
    time = node.element.get("wait_duration")
    return time is not None and time.value.strip().startswith(("0", "{", "="))


@functools.lru_cache(maxsize=1)
def statuses_of(forest: Forest) -> PossibleStatuses:
    """The statuses of the nodes of a forest, cached for the last forest, because several rules need them."""
    return PossibleStatuses(forest)

# SPDX-License-Identifier: Apache-2.0
"""The statuses that nodes can return, and the children that are never ticked because of the statuses of earlier
children (docs/spec/lone-trees.md#statuses).

They are computed from the programs of the nodes (`roaml.libraries.programs.effects`). An unknown node may return any
status.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence

from roaml.forest.forest import Forest
from roaml.forest.names import entry_of
from roaml.forest.ports import ports_of
from roaml.forest.scripts import script_attributes
from roaml.libraries import Node
from roaml.libraries.programs.assembly import programs
from roaml.libraries.programs.effects import ANY_ANSWER, effects, effects_on
from roaml.libraries.programs.linked import ANY, OF_MACHINE, LinkedNode, Possible, linked
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SKIPPED, STATUS_CODES, SUCCESS
from roaml.model.tree import TreeNode
from roaml.record import replace
from roaml.roles import UNBOUNDED, NodeKind

MAX_SUBTREES = 100
"""The maximum nesting depth of subtrees that are analysed. Deeper subtrees are assumed to return any status."""

RETRYING = ("RetryUntilSuccessful",)
"""The nodes whose only purpose is to tick their child again after a failure."""
_ENDS = frozenset((SUCCESS, FAILURE))
_BLAMED = {SUCCESS: "SUCCESS", FAILURE: "FAILURE", RUNNING: "RUNNING"}


class PossibleStatuses:
    """The statuses that the nodes of a forest can return. Each tree is analysed once. A recursive tree is assumed to
    return any status."""

    def __init__(self, forest: Forest, *, exact: bool = False) -> None:
        self.forest = forest
        self.exact = exact
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
            return self._of_machine(known)
        if known is None or not known.behaviour:
            return ANY
        if known.is_synchronous:
            return Possible(_ENDS, _ENDS)
        if known.kind is not NodeKind.ACTION:
            return ANY
        ends = ANY_ANSWER - {SKIPPED}
        return Possible(ends, frozenset((RUNNING,)) if known.running and not _may_be_zero(node) else ends)

    def _of_machine(self, known: Node) -> Possible:
        """The statuses of a plugin. One that always succeeds, or always fails, is usually a simplification of a node
        that can do both, so unless `self.exact` it may return both."""
        outline = self.forest.system.plugin(known.name)[1] if self.forest.system is not None else None
        if outline is None:
            return OF_MACHINE
        answers = outline.plugin.statuses
        return Possible(self._codes(answers.ever), self._codes(answers.first))

    def _codes(self, names: frozenset[str]) -> frozenset[int]:
        codes = frozenset(STATUS_CODES[name] for name in names)
        return codes if self.exact or codes.isdisjoint(_ENDS) else codes | _ENDS

    def _is_in_order(self, node: TreeNode) -> bool:
        """Whether a node may have any number of children, so that each continues after the ones before it."""
        known = self.forest.known_node(node)
        return known is not None and known.children[1] == UNBOUNDED

    def hidden_failures(self, root: TreeNode) -> Iterator[tuple[TreeNode, TreeNode]]:
        """The nodes that tick their child again after a failure, which never happens although a node below the child
        can fail: each with the node that hides these failures."""
        statuses = self.statuses(root)
        for node in statuses:
            if (
                len(node.children) == 1
                and node.plugin is not None
                and node.plugin.value in RETRYING
                and self._linked(node).program is not None
            ):
                hiding: TreeNode | None = node.children[0]
                if FAILURE in statuses[node.children[0]].ever:
                    continue
                while hiding is not None and self._hides(hiding, statuses):
                    inner = next((child for child in hiding.children if self._hides(child, statuses)), None)
                    if inner is None:
                        yield node, hiding
                    hiding = inner

    def _hides(self, node: TreeNode, statuses: dict[TreeNode, Possible]) -> bool:
        """Whether a node cannot fail although a node below it can."""
        below = _from_leaves(node)[:-1]
        return FAILURE not in statuses[node].ever and any(FAILURE in statuses[inner].ever for inner in below)

    def endless(self, root: TreeNode) -> Iterator[tuple[TreeNode, TreeNode]]:
        """The plugins that never end, because they always return RUNNING and no node above them halts them: each with
        the node above it, if this continues with a running child without ticking earlier children again, and if further
        nodes would follow. An earlier child that takes time is an action; to stay where one has failed may be intended.
        """
        statuses = self.statuses(root)
        above = {child: node for node in statuses for child in node.children}
        for node, possible in statuses.items():
            known = self.forest.known_node(node)
            is_machine = known is not None and self.forest.is_machine(known)
            if (
                is_machine
                and possible.ever == {RUNNING}
                and node in above
                and not self._may_halt(node, above, statuses)
            ):
                parent = above[node]
                before = [statuses[child].ever for child in parent.children[: parent.children.index(node)]]
                waits = any(SUCCESS in ever for ever in before) and not any(RUNNING in ever for ever in before)
                if waits and self._continues(parent, above):
                    yield node, parent

    def _may_halt(
        self, node: TreeNode, above: Mapping[TreeNode, TreeNode], statuses: Mapping[TreeNode, Possible]
    ) -> bool:
        """Whether a node above a running node may halt it, or have a condition that does."""
        child: TreeNode = node
        while True:
            if any(name == "_while" for name in (script.name for script in child.scripts)):
                return True
            if child not in above:
                return False
            parent = above[child]
            bound = self._linked(parent)
            below = [statuses[other] for other in parent.children]
            index = parent.children.index(child)
            if bound.program is None or RUNNING in effects_on(bound.program, bound.situation(below), index).halts:
                return True
            child = parent

    def _continues(self, node: TreeNode, above: Mapping[TreeNode, TreeNode]) -> bool:
        """Whether a node above `node` ticks further children after it."""
        while node in above:
            parent = above[node]
            if self._is_in_order(parent) and parent.children[-1] is not node:
                return True
            node = parent
        return False

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

# SPDX-License-Identifier: Apache-2.0
"""The leaves that guard other nodes: those which a node ticks again while a node behind them is RUNNING, such as the
first child of a ReactiveSequence. If such a leaf took time, it would interrupt the nodes behind it again and again."""

from __future__ import annotations

from roaml.libraries.programs.effects import effects_on
from roaml.libraries.programs.linked import ANY, LinkedNode, Possible, linked
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SUCCESS
from roaml.lower.programs.executed import ExecutedNode, ExecutedTree
from roaml.roles import NodeKind

_ENDS = (SUCCESS, FAILURE)
_RUNNING = Possible(frozenset((RUNNING,)), frozenset((RUNNING,)))


def guards_of(tree: ExecutedTree) -> dict[int, frozenset[int]]:
    """The number of each node that guards others, also below decorators -> the statuses with which it lets them run."""
    found: dict[int, frozenset[int]] = {}
    for node in tree.nodes:  # parents before their children
        bound = _bound(node, tree)
        if bound.program is None and not node.is_subtree:
            continue
        if node.number in found and (node.is_subtree or _is_decorator(node)):
            wanted = found[node.number]
            found[node.children[0]] = wanted if node.is_subtree else _passed_on(bound, wanted)
        elif bound.program is not None:
            for index, number in enumerate(node.children[:-1]):
                continuing = frozenset(end for end in _ENDS if _is_guard(bound, len(node.children), index, end))
                if continuing:
                    found[number] = continuing
    return found


def _bound(node: ExecutedNode, tree: ExecutedTree) -> LinkedNode:
    settings = {port: text if entry is None else None for port, entry, text, _ in node.ports()}
    return linked(node.known, settings, (), len(node.children), ANY, tree.version)


def _is_decorator(node: ExecutedNode) -> bool:
    return node.known is not None and node.known.kind is NodeKind.DECORATOR and len(node.children) == 1


def _ended(status: int) -> Possible:
    return Possible(frozenset((status,)), frozenset((status,)))


def _is_guard(bound: LinkedNode, count: int, index: int, end: int) -> bool:
    """Whether a child that has returned `end` is ticked again while a child behind it is RUNNING."""
    assert bound.program is not None
    below = [_ended(end)] * (index + 1) + [_RUNNING] * (count - index - 1)
    effects = effects_on(bound.program, bound.situation(below), index)
    return effects.ticks_ended or effects.restarts


def _passed_on(bound: LinkedNode, wanted: frozenset[int]) -> frozenset[int]:
    """The statuses of the child of a decorator with which the decorator returns a wanted status."""
    return frozenset(end for end in _ENDS if bound.effects([_ended(end)]).answers & wanted)

# SPDX-License-Identifier: Apache-2.0
"""The leaves that guard other nodes: those which a node ticks again while a node behind them is RUNNING, such as the
first child of a ReactiveSequence. If such a leaf took time, it would interrupt the nodes behind it again and again."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.libraries.programs.effects import effects_on
from roaml.libraries.programs.linked import ANY, LinkedNode, Possible, linked
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SUCCESS
from roaml.lower.programs.executed import ExecutedNode, ExecutedTree

_ENDS = (SUCCESS, FAILURE)
_RUNNING = Possible(frozenset((RUNNING,)), frozenset((RUNNING,)))


def guards_of(tree: ExecutedTree) -> dict[int, frozenset[int]]:
    """The number of each node that guards others, also inside other nodes -> the statuses with which it lets them
    run."""
    found: dict[int, frozenset[int]] = {}
    for node in tree.nodes:  # parents before their children
        wanted = found.get(node.number)
        if node.is_subtree:
            if wanted is not None:
                found[node.children[0]] = wanted
            continue
        bound = _bound(node, tree)
        if bound.program is None:
            continue
        for index, number in enumerate(node.children[:-1]):
            continuing = frozenset(end for end in _ENDS if _is_guard(bound, len(node.children), index, end))
            if continuing:
                found[number] = continuing
        if wanted is not None:
            found.update((node.children[index], ends) for index, ends in _passed_on(bound, len(node.children), wanted))
    return found


def _bound(node: ExecutedNode, tree: ExecutedTree) -> LinkedNode:
    settings = {port: text if entry is None else None for port, entry, text, _ in node.ports()}
    return linked(node.known, settings, (), len(node.children), ANY, tree.version)


def _ended(status: int) -> Possible:
    return Possible(frozenset((status,)), frozenset((status,)))


def _is_guard(bound: LinkedNode, count: int, index: int, end: int) -> bool:
    """Whether a child that has returned `end` is ticked again while a child behind it is RUNNING."""
    assert bound.program is not None
    below = [_ended(end)] * (index + 1) + [_RUNNING] * (count - index - 1)
    effects = effects_on(bound.program, bound.situation(below), index)
    return effects.ticks_ended or effects.restarts


def _passed_on(bound: LinkedNode, count: int, wanted: frozenset[int]) -> Iterator[tuple[int, frozenset[int]]]:
    """The children with which a node decides that it returns a wanted status, if all of them end alike: all children of
    a Sequence that is to succeed, the first one of a Fallback. Each comes with the statuses with which it does so."""
    results = [(end, bound.effects([_ended(end)] * count)) for end in _ENDS]
    for index in range(count):
        ends = frozenset(end for end, effects in results if effects.answers & wanted and index in effects.ticked)
        if ends:
            yield index, ends

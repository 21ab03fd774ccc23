# SPDX-License-Identifier: Apache-2.0
"""Trees as BehaviorTree.CPP itself executes them (4.8, by `behaviortreepy`), beside their translation.

There are wheels of `behaviortreepy` for some platforms only, so callers import it and pass it on.
"""

from __future__ import annotations

import copy
from typing import Any

from random_trees import CONTROLS, DECORATORS, ENTRIES, LEAVES, Drawn, Kinds, Table, as_xml
from translated_trees import Observed, observe, with_mocks
from tree_comparison import difference_of

from roaml.libraries import BEHAVIORTREE_CPP, library
from roaml.libraries.version import Version, first_patch

TICKS = 12
JUDGE = Version(4, 8, 2)
"""The version of BehaviorTree.CPP that `behaviortreepy` binds."""
NOT_RANDOM = (
    *(node.name for node in library(BEHAVIORTREE_CPP).nodes.values() if node.since and first_patch(node.since) > JUDGE),
    *(f"Switch{count}" for count in range(2, 7)),
)
"""The nodes that 4.8 does not have, and nodes that are compared in trees of their own: the library refuses switches on
the integer entries of random trees, because `variable` is a text."""


def without(table: Table, names: tuple[str, ...]) -> Table:
    return {name: ports for name, ports in table.items() if name not in names}


RANDOM = Kinds(without(CONTROLS, NOT_RANDOM), without(DECORATORS, NOT_RANDOM), LEAVES)
"""The nodes of random trees that the library judges: those without clocks."""


class Host:
    """A program that runs a tree with the library. Leaves take their random outcomes from lists."""

    def __init__(self, library: Any, text: str, outcomes: dict[str, list[str]]) -> None:
        self.library, self.outcomes = library, outcomes
        self.calls: list[tuple[str, str]] = []
        self.left: dict[str, int] = {}
        factory = library.BehaviorTreeFactory()
        factory.register_simple_condition("Check", self.answer)
        for duration in range(4):
            factory.register_simple_stateful_action(
                f"Act{duration}", self.starting(duration), self.running, self.halted
            )
        blackboard = library.Blackboard.create()
        for entry, value in ENTRIES.items():
            blackboard.set_int(entry, value)
        factory.register_behavior_tree_from_text(text)
        self.tree = factory.create_tree("Main", blackboard)

    def answer(self, node: Any) -> Any:
        answer = self.outcomes[node.name()].pop(0) if self.outcomes[node.name()] else "FAILURE"
        self.calls.append((node.name(), answer))
        return getattr(self.library.NodeStatus, answer)

    def starting(self, duration: int) -> Any:
        def start(node: Any) -> Any:
            self.left[node.name()] = duration
            return self.going_on(node)

        return start

    def running(self, node: Any) -> Any:
        self.left[node.name()] -= 1
        return self.going_on(node)

    def going_on(self, node: Any) -> Any:
        if self.left[node.name()] > 0:
            self.calls.append((node.name(), "RUNNING"))
            return self.library.NodeStatus.RUNNING
        return self.answer(node)

    def halted(self, node: Any) -> None:
        self.calls.append((node.name(), "halt"))


def by_the_library(library: Any, text: str, seen: Observed) -> Observed:
    host = Host(library, text, copy.deepcopy(seen.outcomes))
    answers: list[str] = []
    is_stuck = False
    for _ in range(len(seen.answers) + seen.is_stuck):
        try:
            answers.append(host.tree.tick_exactly_once().name)
        except RuntimeError:
            is_stuck = True
            break
        if answers[-1] != "RUNNING":
            break
    calls = list(host.calls)  # what follows, as the tree is halted when it is deleted, does not count
    return Observed(answers, calls, seen.outcomes, is_stuck)


def is_refused(drawn: Drawn) -> bool:
    """Whether the library does not create the tree, because a `ReactiveSequence` has two children `AsyncSequence`."""
    asynchronous = sum(child.type == "AsyncSequence" for child in drawn.children)
    return (drawn.type == "ReactiveSequence" and asynchronous > 1) or any(map(is_refused, drawn.children))


def difference_from_library(library: Any, drawn: Drawn, seed: int) -> str:
    """What the translated tree does differently from the library, or nothing."""
    text = as_xml(drawn)
    if is_refused(drawn):
        try:
            Host(library, text, {})
        except RuntimeError as error:
            return "" if "more than one async child" in str(error) else str(error)
        return "the library creates the tree"
    seen = observe(with_mocks(text, {key: str(value) for key, value in ENTRIES.items()}, TICKS, version=JUDGE), seed)
    judged = by_the_library(library, text, seen)
    return difference_of(seen, judged)

# SPDX-License-Identifier: Apache-2.0
"""Comparison with BehaviorTree.CPP itself: the translation and the library (4.8, by `behaviortreepy`) call the same
leaves in the same order, and their roots return the same status, for random trees without clocks.

There are wheels of `behaviortreepy` for some platforms only. Without it, this file reports this and has no test.
"""

from __future__ import annotations

import copy
from importlib import util
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_trees import CONTROLS, DECORATORS, ENTRIES, LEAVES, Drawn, Kinds, Table, as_xml, trees
from translated_trees import Observed, observe, with_mocks

from examples import TIMES, examples
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


def switch(variable: str, cases: tuple[str, ...], *children: Drawn) -> Drawn:
    ports = (("variable", variable), *((f"case_{number}", case) for number, case in enumerate(cases, 1)))
    return Drawn(f"Switch{len(cases)}", ports, children)


CHECK, ACT = Drawn("Check"), Drawn("Act2")
NEXT = Drawn("Script", (("code", "x += 1; s := x; t := y + 1"),))
TYPED = Drawn("Script", (("code", "x += 1; s := x; t := x / 2"),))
SWITCHES = {
    "two cases": switch("{s}", ("1", "2"), CHECK, ACT, CHECK),
    "a case in an entry": switch("{s}", ("1", "{t}", "7"), ACT, CHECK, CHECK, ACT),
    "a child is skipped": switch("{s}", ("1", "2"), Drawn("Check", (("_skipIf", "y == 1"),)), ACT, CHECK),
    "equal cases": switch("{s}", ("1", "2", "2"), CHECK, ACT, CHECK, CHECK),
    "six cases": switch("{s}", ("1", "2", "3", "4", "5", "6"), CHECK, ACT, CHECK, CHECK, ACT, CHECK, ACT),
}


def without(table: Table, names: tuple[str, ...]) -> Table:
    return {name: ports for name, ports in table.items() if name not in names}


TREES = trees(Kinds(without(CONTROLS, NOT_RANDOM), without(DECORATORS, NOT_RANDOM), LEAVES))


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


def compare(library: Any, drawn: Drawn, seed: int) -> None:
    text = as_xml(drawn)
    if is_refused(drawn):
        with pytest.raises(RuntimeError, match="more than one async child"):
            Host(library, text, {})
        return
    seen = observe(with_mocks(text, {key: str(value) for key, value in ENTRIES.items()}, TICKS, version=JUDGE), seed)
    judged = by_the_library(library, text, seen)
    assert (seen.answers, seen.is_stuck) == (judged.answers, judged.is_stuck), text
    if not seen.is_stuck:
        assert seen.calls == judged.calls, text


if util.find_spec("behaviortreepy") is None:
    print("behaviortreepy is not installed: BehaviorTree.CPP itself does not judge the translation of trees")
else:

    @settings(max_examples=examples(30), deadline=None, suppress_health_check=list(HealthCheck), derandomize=not TIMES)
    @given(TREES, st.integers(0, 2**30))
    def test_random_trees_do_what_behaviortree_cpp_does(drawn: Drawn, seed: int) -> None:
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        compare(behaviortreepy, drawn, seed)

    @pytest.mark.parametrize("control", ["Sequence", "Fallback", "AsyncFallback", "SequenceWithMemory"])
    def test_a_node_whose_children_are_skipped_again(control: str) -> None:
        """It stays RUNNING, and is skipped at the next tick, too."""
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        skipped = Drawn("AlwaysSuccess", (("_while", "x == 1"),))
        compare(behaviortreepy, Drawn("KeepRunningUntilFailure", (), (Drawn(control, (), (skipped, skipped)),)), 1)

    @pytest.mark.parametrize("parent", ["Sequence", "ReactiveSequence"])
    @pytest.mark.parametrize("case", SWITCHES)
    def test_switches(case: str, parent: str) -> None:
        """Below a `ReactiveSequence`, another case applies while a child is RUNNING."""
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        tree = Drawn("KeepRunningUntilFailure", (), (Drawn(parent, (), (NEXT, SWITCHES[case])),))
        compare(behaviortreepy, tree, 1)

    @pytest.mark.parametrize("variable", ["{s}", "{t}", "2.5", "1x", ".5", "x"])
    @pytest.mark.parametrize("case", ["1", "2x", "1.5", "0.5", ".5", "x", "-1", "{t}"])
    def test_cases_that_are_not_whole_numbers(variable: str, case: str) -> None:
        """4.8 ignores what follows the number in a text."""
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        chosen = switch(variable, (case, "7"), Drawn("Act1"), Drawn("Act2"), Drawn("Act3"))
        compare(behaviortreepy, Drawn("Repeat", (("num_cycles", "4"),), (Drawn("Sequence", (), (TYPED, chosen)),)), 1)

    @pytest.mark.parametrize(
        "script", ["a == 3", "a == '3'", "a < 4 && b == 0.5", "a != 3 || b > 1", "(b ? 1 : 2) == 1", "x + 2 == a"]
    )
    def test_constants_of_subtrees(script: str) -> None:
        """4.8 stores them as texts."""
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        ports = (("a", "3"), ("b", "0.5"), ("x", "{x}"))
        asked = Drawn("ScriptCondition", (("code", script),))
        body = Drawn("Sequence", (), (Drawn("Script", (("code", "x += 1"),)), Drawn("Inverter", (), (asked,))))
        compare(behaviortreepy, Drawn("Repeat", (("num_cycles", "3"),), (Drawn("SubTree", ports, (body,)),)), 1)

    @pytest.mark.parametrize("if_empty", ["SUCCESS", "FAILURE", "SKIPPED"])
    def test_loops(if_empty: str) -> None:
        """A loop whose elements are skipped, succeed and fail, which starts again, and which is halted."""
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        ports = (("queue", "1;2;3"), ("if_empty", if_empty), ("value", "{x}"))
        body = Drawn("Fallback", (("_skipIf", "x == 2"),), (CHECK, ACT))
        loop = Drawn("ReactiveFallback", (), (Drawn("Check"), Drawn("LoopInt", ports, (body,))))
        for seed in (1, 2):
            compare(behaviortreepy, Drawn("KeepRunningUntilFailure", (), (loop,)), seed)
            compare(behaviortreepy, Drawn("Repeat", (("num_cycles", "3"),), (loop,)), seed)

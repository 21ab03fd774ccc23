# SPDX-License-Identifier: Apache-2.0
"""Comparison with BehaviorTree.CPP itself: the translation and the library (4.8, by `behaviortreepy`) call the same
leaves in the same order, and their roots return the same status, for random trees without clocks.

There are wheels of `behaviortreepy` for some platforms only. Without it, this file reports this and has no test.
"""

from __future__ import annotations

from importlib import util
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_trees import Drawn, as_xml, trees
from real_library import RANDOM, difference_from_library

from examples import TIMES, examples


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


TREES = trees(RANDOM)


def compare(library: Any, drawn: Drawn, seed: int) -> None:
    assert difference_from_library(library, drawn, seed) == "", as_xml(drawn)


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

    @pytest.mark.parametrize(("queue", "cases"), [("hall;attic;7", ("attic", "hall")), ("a b;;c", ("", "a b"))])
    def test_texts_of_a_loop(queue: str, cases: tuple[str, ...]) -> None:
        """A `Switch` and a script read the element."""
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        ports = (("queue", queue), ("if_empty", "SUCCESS"), ("value", "{room}"))
        chosen = switch("{room}", cases, Drawn("Act0"), Drawn("Act1"), Drawn("Act2"))
        body = Drawn("ForceSuccess", (("_skipIf", f"room == '{cases[0]}'"),), (chosen,))
        for seed in (1, 2, 3):
            compare(behaviortreepy, Drawn("LoopString", ports, (chosen,)), seed)
            compare(
                behaviortreepy, Drawn("Repeat", (("num_cycles", "2"),), (Drawn("LoopString", ports, (body,)),)), seed
            )

    def test_a_loop_that_its_condition_has_ended() -> None:
        """`WhileDoElse` does not reset its first child, so the loop is ticked again without taking its queue."""
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        ports = (("queue", "1;2"), ("if_empty", "SUCCESS"), ("value", "{x}"), ("_failureIf", "x < 2"))
        loop = Drawn("LoopInt", ports, (Drawn("Act0", (("_failureIf", "x < 2"),)),))
        tree = Drawn("AsyncFallback", (), (Drawn("WhileDoElse", (), (loop, Drawn("Act0"), Drawn("Act1"))),))
        for seed in (0, 1):
            compare(behaviortreepy, tree, seed)

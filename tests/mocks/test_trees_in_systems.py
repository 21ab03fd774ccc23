# SPDX-License-Identifier: Apache-2.0
"""Trees of systems with conditions, scripts and all nodes behave like the libraries, tick by exact tick."""

from __future__ import annotations

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_trees import ANY, Drawn, as_xml, trees
from tree_comparison import difference_in_system

from examples import TIMES, examples

TICKS = 12


def compare(drawn: Drawn, seed: int) -> None:
    assert difference_in_system(drawn, TICKS, seed) == "", as_xml(drawn)


@settings(max_examples=examples(12), deadline=None, suppress_health_check=list(HealthCheck), derandomize=not TIMES)
@given(trees(ANY), st.integers(0, 2**30))
def test_random_trees_in_systems(drawn: Drawn, seed: int) -> None:
    compare(drawn, seed)


def test_a_plugin_behind_conditions() -> None:
    """The plugin is skipped, and is halted when `_while` becomes false."""
    act = Drawn("Act2", (("_skipIf", "x == 1"), ("_while", "y == 1"), ("_onHalted", "x := 1; y := 1")))
    change = Drawn("Script", (("code", "y := 1 - y"),))
    for seed in range(3):
        compare(Drawn("KeepRunningUntilFailure", (), (Drawn("Parallel", (), (act, change)),)), seed)

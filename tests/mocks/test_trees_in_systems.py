# SPDX-License-Identifier: Apache-2.0
"""Trees of systems with conditions, scripts and all nodes behave like the libraries, tick by exact tick."""

from __future__ import annotations

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_trees import (
    CONTROLS,
    DECORATORS,
    LEAVES,
    NAV2_CONTROLS,
    NAV2_DECORATORS,
    SLEEP,
    TIMED,
    Drawn,
    as_xml,
    trees,
)
from test_mock_library import modelled
from trees_in_systems import FOLDER, files, observe_system

from examples import TIMES, examples
from roaml import api
from roaml.lower.programs.automaton import node_automaton

TICKS = 12
ANY_TREE = trees({**CONTROLS, **NAV2_CONTROLS}, {**DECORATORS, **TIMED, **NAV2_DECORATORS}, {**LEAVES, **SLEEP})


def compare(drawn: Drawn, seed: int) -> None:
    # A script that nothing skips makes every tree one that is executed as by the library.
    tree = Drawn("Sequence", (("_onHalted", "k := k"),), (drawn,))
    try:
        seen = observe_system(tree, TICKS, seed)
    except api.ModelError as error:
        if all(finding.code == "node-configuration" for finding in error.result.diagnostics):
            return  # counts with which the library throws an exception
        raise
    expected = modelled(tree, seen)
    assert (seen.answers, seen.is_stuck) == (expected.answers, expected.is_stuck), as_xml(tree)
    if not seen.is_stuck:
        assert seen.calls == expected.calls, as_xml(tree)


@settings(max_examples=examples(12), deadline=None, suppress_health_check=list(HealthCheck), derandomize=not TIMES)
@given(ANY_TREE, st.integers(0, 2**30))
def test_random_trees_in_systems(drawn: Drawn, seed: int) -> None:
    compare(drawn, seed)


def test_a_plugin_behind_conditions() -> None:
    """The plugin is skipped, and is halted when `_while` becomes false."""
    act = Drawn("Act2", (("_skipIf", "x == 1"), ("_while", "y == 1"), ("_onHalted", "x := 1; y := 1")))
    change = Drawn("Script", (("code", "y := 1 - y"),))
    for seed in range(3):
        compare(Drawn("KeepRunningUntilFailure", (), (Drawn("Parallel", (), (act, change)),)), seed)


@settings(max_examples=examples(12), deadline=None, suppress_health_check=list(HealthCheck), derandomize=not TIMES)
@given(ANY_TREE)
def test_a_parent_knows_the_statuses_of_its_children(drawn: Drawn) -> None:
    """Automata with the same structure are built once. Each node still gets the answers of its own automaton."""
    tree = Drawn("Sequence", (("_onHalted", "k := k"),), (drawn, drawn))
    analysis = api.check([f"{FOLDER}/main.xml"], texts=files(tree, TICKS)).snapshot.analysis
    library = analysis.library_tree(f"{FOLDER}/main.xml")
    assert library is not None
    codes = {code.address: code for parts in library.codes.values() for code in parts}
    recorded = [child for code in codes.values() for child in code.children if child.address in codes]
    assert recorded
    for child in recorded:
        built = node_automaton(codes[child.address]).child
        assert (built.answers, built.is_stateless) == (child.answers, child.is_stateless), as_xml(tree)

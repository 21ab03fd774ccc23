# SPDX-License-Identifier: Apache-2.0
"""Trees of systems with conditions, scripts and all nodes behave like the libraries, tick by exact tick."""

from __future__ import annotations

import itertools
from collections import Counter

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from random_trees import ANY, ENTRIES, Drawn, as_xml, trees
from translated_trees import observe, with_mocks
from tree_comparison import difference_in_system, difference_with_mocks
from trees_in_systems import FOLDER, files, translated

from examples import TIMES, examples
from roaml import api
from roaml.lower.programs.automaton import NodeAutomaton, node_automaton
from roaml.lower.programs.code import NodeCode
from roaml.model.expand import ROOT_NUMBER
from roaml.record import replace
from roaml.scxml.names import sent_by
from roaml.smc.model import ModelChecker
from roaml.smc.record import Recorder, Recording
from roaml.verification.tree_outcome import tree_properties

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


def test_an_action_that_its_condition_has_ended() -> None:
    """The action returns the same status until it is reset, although its parent ticks it again. A condition is
    evaluated again."""
    for leaf, condition in itertools.product(("Act2", "Check"), ("_successIf", "_skipIf")):
        ended, running = Drawn(leaf, ((condition, "y == 1"),)), Drawn("Act3")
        again = Drawn("NonblockingSequence" if condition == "_successIf" else "PipelineSequence", (), (ended, running))
        for seed in range(3):
            compare(Drawn("KeepRunningUntilFailure", (), (again,)), seed)


def test_a_condition_ends_an_action_that_was_halted_before() -> None:
    """The plugin is ticked and halted in the first round. In the second one, the condition ends the action at once, and
    the plugin is not ticked when its parent ticks the action again."""
    ended, running = Drawn("Act3", (("_successIf", "x == 1"),)), Drawn("Act3")
    timed = Drawn("Timeout", (("msec", "200"),), (Drawn("NonblockingSequence", (), (ended, running)),))
    rounds = (Drawn("ForceSuccess", (), (timed,)), Drawn("Script", (("code", "x := 1"),)))
    for seed in range(3):
        compare(Drawn("KeepRunningUntilFailure", (), (Drawn("Sequence", (), rounds),)), seed)


def test_an_action_that_ended_by_itself_is_ticked_again() -> None:
    """Its plugin is a machine, which decides what it answers. Only the end by a condition is kept."""
    ended, running = Drawn("Act0", (("_skipIf", "x == 1"),)), Drawn("Act3")
    model = translated(Drawn("NonblockingSequence", (), (ended, running)), TICKS)
    checker = ModelChecker(replace(model, properties=tree_properties(ROOT_NUMBER)))
    for seed in range(3):
        walk = Recorder(checker, checker.compiled_properties[0], seed, 40_000).walk(Recording(0))
        sent = Counter(sent_by(step.action or "") for step in walk)
        assert sent["bt_1001_tick"] == sent["bt_1001_inner_tick"]


@settings(max_examples=examples(12), deadline=None, suppress_health_check=list(HealthCheck), derandomize=not TIMES)
@given(trees(ANY))
def test_a_parent_knows_the_statuses_of_its_children(drawn: Drawn) -> None:
    """Automata with the same structure are built once. Each node still gets the answers of its own automaton."""
    tree = Drawn("Sequence", (("_onHalted", "k := k"),), (drawn, drawn))
    analysis = api.check([f"{FOLDER}/main.xml"], texts=files(tree, TICKS)).snapshot.analysis
    library = analysis.library_tree(f"{FOLDER}/main.xml")
    assert library is not None
    codes = {code.address: code for parts in library.codes.values() for code in parts}
    recorded = [child for code in codes.values() for child in code.children if child.address in codes]
    assume(recorded)  # a tree of plugins only has no such child
    for child in recorded:
        built = node_automaton(codes[child.address]).child
        assert (built.answers, built.is_stateless) == (child.answers, child.is_stateless), as_xml(tree)


def test_nodes_are_explored_once_for_all_versions_of_a_system(monkeypatch: pytest.MonkeyPatch) -> None:
    main, texts = f"{FOLDER}/main.xml", files(Drawn("Sequence", (), (Drawn("Act1"), Drawn("Act2"))), TICKS)
    snapshot = api.check([main], texts=texts).snapshot
    explored = []

    def explore(code: NodeCode) -> NodeAutomaton:
        explored.append(code.program.name)
        return node_automaton(code)

    monkeypatch.setattr("roaml.lower.library_tree.node_automaton", explore)
    longer = {path: text.replace('unit="ms"', 'unit="s"') for path, text in texts.items()}
    assert snapshot.with_texts(longer).analysis.library_tree(main) is not None
    assert not explored
    reactive = {path: text.replace("Sequence", "ReactiveSequence") for path, text in texts.items()}
    assert snapshot.with_texts(reactive).analysis.library_tree(main) is not None
    assert explored[0] == "ReactiveSequence"


def test_a_subtree_resets_a_child_that_has_ended() -> None:
    """The condition of `WhileDoElse` is asked at each tick, although it has ended before."""
    for parent in ("WhileDoElse", "ReactiveFallback"):
        asked = Drawn("SubTree", (("_autoremap", "true"),), (Drawn("Act1"),))
        tree = Drawn("KeepRunningUntilFailure", (), (Drawn(parent, (), (asked, Drawn("Act3"), Drawn("Act2"))),))
        for seed in range(4):
            compare(tree, seed)


def test_a_write_after_the_check_for_writes() -> None:
    """A node that follows the check writes the entry again, at once; the next check sees that write."""
    asked = Drawn("WasEntryUpdated", (("entry", "x"), ("_post", "x := 0")))
    tree = Drawn("KeepRunningUntilFailure", (), (Drawn("Sequence", (), (asked, Drawn("Check"))),))
    for seed in range(4):
        compare(tree, seed)
        assert difference_with_mocks(tree, TICKS, seed) == ""


def test_a_real_number_in_a_port_that_needs_an_integer() -> None:
    """The library throws an exception if the number is not an integer."""
    for value, is_stuck in (("1.0 + y", False), ("y / 2", True)):
        change = Drawn("Script", (("code", f"x := {value}"),))
        ports = (("success_count", "{x}"), ("failure_count", "3"))
        counted = Drawn("Parallel", ports, (Drawn("Act0"), Drawn("Act1"), Drawn("Act3")))
        tree = Drawn("Sequence", (), (Drawn("Script", (("code", "x := 0.5"),)), change, counted))
        seen = observe(with_mocks(as_xml(tree), {key: str(start) for key, start in ENTRIES.items()}, TICKS), 1)
        assert seen.is_stuck is is_stuck
        if not is_stuck:
            compare(tree, 1)


def test_a_switch_without_its_ports() -> None:
    """A missing port is an error in the tree, not one of the tool."""
    for ports in ((), (("variable", "{x}"),), (("case_1", "1"),)):
        tree = Drawn("Switch2", ports, (Drawn("Check"), Drawn("Act1"), Drawn("Act2", (("_skipIf", "x == 1"),))))
        diagnostics = api.check([f"{FOLDER}/main.xml"], texts=files(tree, TICKS)).diagnostics
        assert {d.code for d in diagnostics if d.severity is api.Severity.ERROR} == {"missing-port"}, diagnostics


def test_a_constant_that_two_subtrees_share() -> None:
    """A constant that a `<SubTree>` gives stays one variable where another `<SubTree>` takes it over."""
    change = Drawn("SubTree", (("x", "{y}"), ("y", "{x}")), (Drawn("Script", (("code", "y := 2"),)),))
    asked = Drawn("ScriptCondition", (("code", "x == 2"),))
    compare(Drawn("Sequence", (), (change, asked, Drawn("Check"))), 0)


ACT, CHECK = Drawn("Act1"), Drawn("Check")
SISTERS = [
    *(Drawn(kind, (), (ACT,)) for kind in ("RunOnce", "Inverter", "ForceSuccess", "ForceFailure")),
    Drawn("KeepRunningUntilFailure", (), (ACT,)),
    Drawn("Repeat", (("num_cycles", "2"),), (CHECK,)),
    Drawn("RetryUntilSuccessful", (("num_attempts", "2"),), (CHECK,)),
    Drawn("Delay", (("delay_msec", "200"),), (ACT,)),
    Drawn("Timeout", (("msec", "100"),), (Drawn("Act2"),)),
    *(Drawn(kind, (), (CHECK, ACT)) for kind in ("Sequence", "Fallback", "SequenceWithMemory", "AsyncSequence")),
    *(Drawn(kind, (), (CHECK, ACT)) for kind in ("ReactiveSequence", "ReactiveFallback", "ParallelAll")),
    Drawn("Parallel", (("success_count", "1"), ("failure_count", "2")), (CHECK, ACT)),
    *(Drawn(kind, (), (CHECK, ACT, Drawn("Act2"))) for kind in ("IfThenElse", "WhileDoElse")),
    Drawn("Switch2", (("variable", "1"), ("case_1", "1"), ("case_2", "2")), (ACT, CHECK, Drawn("Act2"))),
]


@pytest.mark.parametrize("inner", SISTERS, ids=lambda drawn: drawn.type)
def test_an_unrelated_node_changes_nothing(inner: Drawn) -> None:
    """A node behaves as in the library, with and without a node that only the library has."""
    outer = Drawn("Sequence", (), (Drawn("Fallback", (), (inner, Drawn("Act0"))),))
    tree = Drawn("KeepRunningUntilFailure", (), (outer,))
    unrelated = Drawn("Script", (("code", "k := 1"),))
    for seed in range(2):
        compare(tree, seed)
        compare(Drawn("Sequence", (), (unrelated, tree)), seed)

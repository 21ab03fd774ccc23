# SPDX-License-Identifier: Apache-2.0
"""With the semantics of AS2FM, the nodes do what the specification says: translated, they take the same steps as a
plain model of it."""

from __future__ import annotations

import itertools

import bt_model
import bt_runs
import pytest
from bt_cases import cases, gated, setups, trees, ungated
from bt_model import NeverEnds, Node, Step
from bt_trees import LEAF, WRITER, Setup, Tree, leaf, node, plugin_name, system
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from translating import lowered, translated

from examples import examples
from roaml.model.system import builtin_plugins
from roaml.scxml.model import Network

CASES = list(cases())
ONE_OF_EACH = list({tree.kind: tree for tree in CASES}.values())


def name(tree: Tree) -> str:
    settings = "".join(f",{key}={text}" for key, text in tree.ports)
    return f"{tree.kind}({len(tree.children)}{settings})"


def check(network: Network, tree: Tree, expected: list[Step], seed: int) -> None:
    steps, end = bt_runs.of_network(network, seed)
    assert steps == expected
    for i, part in enumerate(tree.walk()):
        if part.kind == LEAF:
            data = bt_runs.data_of(network, end, f"BT_plugin_{1000 + i}_{plugin_name(part)}")
            assert data["ticks"] == expected.count((1000 + i, "tick"))
            assert data["halts"] == expected.count((1000 + i, "halt"))


def test_all_are_modelled() -> None:
    shown = {part.kind for tree in CASES for part in tree.walk()}
    assert builtin_plugins().keys() == Node.kinds.keys() - {LEAF, WRITER} == shown - {LEAF}


@pytest.mark.parametrize("tree", CASES, ids=name)
def test_node(tree: Tree) -> None:
    tree, setup = ungated(tree), Setup(20)
    check(lowered(system(tree, setup)), tree, bt_model.run(tree, setup), seed=1)


@pytest.mark.parametrize("tree", CASES, ids=name)
def test_node_that_is_halted(tree: Tree) -> None:
    tree, setup = gated(tree), Setup(30)
    expected = bt_model.run(tree, setup)
    check(lowered(system(tree, setup)), tree, expected, seed=1)
    number = 1000 + len(list(tree.walk())) - len(list(tree.children[-1].walk()))
    of_node = [what for where, what in expected if where == number]
    assert "halt" in of_node
    if "RUNNING" in of_node:
        assert ("RUNNING", "halt") in itertools.pairwise(of_node)


@pytest.mark.parametrize("tree", ONE_OF_EACH, ids=name)
def test_node_in_jani(tree: Tree) -> None:
    tree, setup = gated(tree), Setup(6)
    assert bt_runs.of_model(translated(system(tree, setup)), seed=1) == bt_model.run(tree, setup)


@pytest.mark.parametrize(
    "tree",
    [
        node("ReactiveFallback", leaf("FFR"), node("Sequence", leaf("SR"), leaf("RSF"))),
        node("Parallel", node("Repeat", leaf("SRF"), num_cycles=2), leaf("RF"), success_count=1, failure_count=2),
        node(
            "Parallel",
            node("SetBlackboard", value=1, output_key="{n}"),
            node("BlackboardCheckInt", leaf("RS"), value_A="{n}", value_B=1, return_on_mismatch=3),
        ),
    ],
    ids=name,
)
def test_in_any_order(tree: Tree) -> None:
    """What happens to the nodes does not depend on who comes first where that is left open."""
    setup = Setup(3)
    bt_runs.of_model_in_any_order(translated(system(tree, setup)), bt_model.run(tree, setup), limit=5000)


@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck))
@given(trees, setups, st.integers(0, 99))
def test_any_tree(tree: Tree, setup: Setup, seed: int) -> None:
    try:
        expected = bt_model.run(tree, setup)
    except NeverEnds:
        assume(False)
    check(lowered(system(tree, setup)), tree, expected, seed)


def test_tick_that_never_ends() -> None:
    tree, setup = node("Repeat", leaf("S"), num_cycles=-1), Setup(2)
    with pytest.raises(NeverEnds):
        bt_model.run(tree, setup)
    steps, _ = bt_runs.of_network(lowered(system(tree, setup)), seed=1, most=100)
    assert len(steps) == 100
    assert steps.count((1000, "tick")) == 1


@pytest.mark.parametrize(("goes_on", "ticks"), [(False, 3), (True, 6)])
def test_root_that_has_answered(goes_on: bool, ticks: int) -> None:
    """Without `bt_tick_if_not_running` the root is not ticked again after SUCCESS or FAILURE
    (docs/spec/trees.md#root)."""
    tree, setup = leaf("RRF"), Setup(6, goes_on=goes_on)
    steps, _ = bt_runs.of_network(lowered(system(tree, setup)), seed=1)
    assert steps == bt_model.run(tree, setup)
    assert steps.count((1000, "tick")) == ticks

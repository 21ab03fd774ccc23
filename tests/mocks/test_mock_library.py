# SPDX-License-Identifier: Apache-2.0
"""Translated trees behave like the libraries in each tick. `library_model` is a second implementation of each node."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_trees import COUNTS, OF_OLD_VERSIONS, WITH_WORLD, Drawn, Kinds, as_xml, trees
from translated_trees import with_mocks
from tree_comparison import difference_with_mocks

from examples import TIMES, examples
from roaml.libraries import BEHAVIORTREE_CPP, LIBRARIES, library, library_node
from roaml.libraries.programs.assembly import programs
from roaml.libraries.version import NEWEST_VERSION, Version, read_version
from roaml.lower.programs.refusal import TreeRefusal

TICKS = 14
DECORATED = WITH_WORLD.decorators
NODES = {**WITH_WORLD.controls, **DECORATED}


VERSIONS = ("4.6", "4.8.2", "4.9")
"""Versions of BehaviorTree.CPP between which nodes changed."""


def compare(drawn: Drawn, seed: int, *, happens: bool = False, version: Version = NEWEST_VERSION) -> None:
    assert difference_with_mocks(drawn, TICKS, seed, happens=happens, version=version) == "", as_xml(drawn)


@settings(max_examples=examples(40), deadline=None, suppress_health_check=list(HealthCheck), derandomize=not TIMES)
@given(trees(WITH_WORLD), st.integers(0, 2**30), st.booleans())
def test_random_trees_do_what_the_libraries_do(drawn: Drawn, seed: int, happens: bool) -> None:
    compare(drawn, seed, happens=happens)


@settings(max_examples=examples(40), deadline=None, suppress_health_check=list(HealthCheck), derandomize=not TIMES)
@given(trees(OF_OLD_VERSIONS), st.integers(0, 2**30), st.sampled_from(VERSIONS))
def test_random_trees_do_what_older_versions_do(drawn: Drawn, seed: int, version: str) -> None:
    compare(drawn, seed, version=read_version(version) or NEWEST_VERSION)


def compare_node(name: str, nodes: Kinds, version: Version = NEWEST_VERSION) -> None:
    """Compare a node with children whose answers are random, with several values of its ports."""
    ports_of = {**nodes.controls, **nodes.decorators}[name]
    count = 1 if name in nodes.decorators else COUNTS.get(name, (3, 3))[1]
    leaves = [Drawn(f"Act{number % 4}") for number in range(count)]
    for number in range(max(2, *map(len, ports_of.values()), 2)):
        ports = tuple((key, values[number % len(values)]) for key, values in ports_of.items())
        compare(Drawn(name, ports, tuple(leaves)), number, happens=number % 2 == 1, version=version)


@pytest.mark.parametrize("name", sorted(NODES))
def test_each_node_does_what_the_library_does(name: str) -> None:
    compare_node(name, WITH_WORLD)


@pytest.mark.parametrize("name", sorted(NODES))
def test_each_node_does_what_the_library_does_if_children_are_skipped(name: str) -> None:
    """All of them at first; `Act0` counts the ticks in `x`, of which the last children are skipped until the third."""
    count = 1 if name in DECORATED else COUNTS.get(name, (3, 3))[1]
    skipped = tuple(Drawn(f"Act{number + 1}", (("_skipIf", "x < 2"),)) for number in range(count))
    ticks = Drawn("ForceSuccess", (), (Drawn("Act0", (("_onSuccess", "x += 1"), ("_onFailure", "x += 1"))),))
    for number in range(max(1, *map(len, NODES[name].values()), 1)):
        ports = tuple((key, values[number % len(values)]) for key, values in NODES[name].items())
        compare(Drawn("Sequence", (), (ticks, Drawn(name, ports, skipped))), number)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", sorted({**OF_OLD_VERSIONS.controls, **OF_OLD_VERSIONS.decorators}))
def test_each_node_does_what_older_versions_do(name: str, version: str) -> None:
    """Random trees contain each change of a node in each version only by chance."""
    compare_node(name, OF_OLD_VERSIONS, read_version(version) or NEWEST_VERSION)


DEFAULTS = {
    node.name: {port.name for port in node.ports if port.default is not None}
    for node in filter(None, map(library_node, sorted(NODES)))
    if any(port.default is not None for port in node.ports)
}


@pytest.mark.parametrize("name", DEFAULTS)
def test_each_node_has_the_defaults_of_the_library(name: str) -> None:
    """Each node without the ports that have a default, when it ends, and when it is halted while it is RUNNING."""
    ports = tuple((key, values[0]) for key, values in NODES[name].items() if key not in DEFAULTS[name])
    count = 1 if name in DECORATED else COUNTS.get(name, (3, 3))[1]
    node = Drawn(name, ports, tuple(Drawn(f"Act{2 - number % 3}") for number in range(count)))
    tree = Drawn("KeepRunningUntilFailure", (), (Drawn("ReactiveFallback", (), (Drawn("Check"), node)),))
    for seed in range(4):
        compare(tree, seed)


SKIPPED = Drawn("Act1", (("_skipIf", "x != 1"),))
HELD = Drawn("Sequence", (), (SKIPPED, SKIPPED))
"""A node that stays RUNNING when all its children are skipped."""


@pytest.mark.parametrize("child", [SKIPPED, HELD], ids=["skipped", "held"])
@pytest.mark.parametrize("name", sorted(NODES))
def test_each_node_does_what_the_library_does_with_skipped_children(name: str, child: Drawn) -> None:
    """The children are not skipped at the second tick."""
    ports = tuple((key, values[0]) for key, values in NODES[name].items())
    count = 1 if name in DECORATED else COUNTS.get(name, (3, 3))[1]
    node = Drawn(name, ports, (child,) * count)
    again = Drawn("KeepRunningUntilFailure", (), (Drawn("ForceSuccess", (), (node,)),))
    change = Drawn("Repeat", (("num_cycles", "4"),), (Drawn("Script", (("code", "x += 1"),)),))
    tree = Drawn("Parallel", (("failure_count", "2"),), (again, change))
    assert difference_with_mocks(tree, 6, 1, happens=True) == "", as_xml(tree)


CHOICES = [
    (node.name, port.name)
    for node in filter(None, map(library_node, sorted(NODES)))
    for port in node.ports
    if port.type in ("bool", "NodeStatus") and not port.direction.writes
]


@pytest.mark.parametrize(("name", "chosen"), CHOICES)
def test_a_choice_in_an_entry_is_refused(name: str, chosen: str) -> None:
    """The translation of a node has only the branches of one choice."""
    ports = {key: values[0] for key, values in NODES[name].items()} | {chosen: "{choice}"}
    leaves = [Drawn(f"Act{number}") for number in range(1 if name in DECORATED else COUNTS.get(name, (3, 3))[1])]
    write = Drawn("Script", (("code", "choice := 1"),))
    tree = Drawn("Sequence", (), (write, Drawn(name, tuple(ports.items()), tuple(leaves))))
    with pytest.raises(TreeRefusal) as refused:
        with_mocks(as_xml(tree), {}, 3)
    assert f"`{chosen}` must be a constant" in refused.value.reason


def test_every_node_with_children_has_a_program() -> None:
    declared = [node for name in (BEHAVIORTREE_CPP, *LIBRARIES) for node in library(name).nodes.values()]
    with_children = {node.name for node in declared if node.children[1] and not node.until}
    assert with_children <= programs().keys()


@pytest.mark.parametrize("parent", ["Sequence", "Fallback", "PipelineSequence", "PersistentSequence"])
def test_a_leaf_that_is_halted_by_its_own_condition(parent: str) -> None:
    """`_while` halts a running leaf once; its parent does not halt it again."""
    ports = (("current_child_idx", "{k}"),) if parent == "PersistentSequence" else ()
    count = Drawn("Script", (("code", "x += 1"),))
    leaf = Drawn("Act2", (("_while", "x < 2"), ("_onHalted", "y := 7")))
    after = Drawn("ScriptCondition", (("code", "y == 7"),))
    tree = Drawn("ReactiveSequence", (), (count, Drawn(parent, ports, (leaf, Drawn("Act1"))), after))
    for seed in range(4):
        compare(tree, seed)


def test_an_entry_that_is_only_observed() -> None:
    """The value of the entry is never read, but a node depends on whether it was written."""
    write = Drawn("SetBlackboard", (("value", "{x}"), ("output_key", "y")))
    asked = Drawn("WasEntryUpdated", (("entry", "{y}"),))
    tree = Drawn("KeepRunningUntilFailure", (), (Drawn("Sequence", (), (asked, write, Drawn("Check"))),))
    for seed in range(3):
        compare(tree, seed)


@pytest.mark.parametrize("kind", ["Sequence", "Fallback", "AsyncSequence", "AsyncFallback"])
def test_skipped_children_of_a_condition_that_is_not_reset(kind: str) -> None:
    """A `WhileDoElse` evaluates a condition that has ended again without a reset. The condition then also counts the
    children that were skipped before."""
    skipped = Drawn("Precondition", (("if", "x == 7"), ("else", "SKIPPED")), (Drawn("Act0"),))
    tree = Drawn("WhileDoElse", (), (Drawn(kind, (), (skipped, Drawn("Act1"))), Drawn("Act3"), Drawn("Act2")))
    for seed in range(12):
        compare(tree, seed)

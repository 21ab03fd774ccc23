# SPDX-License-Identifier: Apache-2.0
"""Translated trees behave like the libraries in each tick. `library_model` is a second implementation of each node."""

from __future__ import annotations

import copy

import library_model
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_trees import (
    CONTROLS,
    COUNTS,
    DECORATORS,
    ENTRIES,
    LEAVES,
    NAV2_CONTROLS,
    NAV2_DECORATORS,
    SLEEP,
    TIMED,
    Drawn,
    as_nodes,
    as_xml,
    trees,
)
from translated_trees import Observed, observe, with_mocks

from examples import TIMES, examples
from roaml.libraries import BEHAVIORTREE_CPP, LIBRARIES, library
from roaml.lower.programs.assembly import programs

TICKS = 14
DECORATED = {**DECORATORS, **TIMED, **NAV2_DECORATORS}
NODES = {**CONTROLS, **NAV2_CONTROLS, **DECORATED}
ANY_TREE = trees({**CONTROLS, **NAV2_CONTROLS}, DECORATED, {**LEAVES, **SLEEP})


def modelled(drawn: Drawn, seen: Observed) -> Observed:
    """The same run in the model of the library, with the same random outcomes."""
    world = library_model.World(dict(ENTRIES), copy.deepcopy(seen.outcomes))
    root = as_nodes(drawn, world)
    answers: list[str] = []
    is_stuck = False
    for _ in range(len(seen.answers) + seen.is_stuck):
        try:
            answers.append(root.execute())
        except library_model.LibraryError:
            is_stuck = True
            break
        if answers[-1] != "RUNNING":
            break
    return Observed(answers, world.calls, seen.outcomes, is_stuck)


def compare(drawn: Drawn, seed: int) -> None:
    text = as_xml(drawn)
    seen = observe(with_mocks(text, {key: str(value) for key, value in ENTRIES.items()}, TICKS), seed)
    expected = modelled(drawn, seen)
    assert (seen.answers, seen.is_stuck) == (expected.answers, expected.is_stuck), text
    if not seen.is_stuck:
        assert seen.calls == expected.calls, text


@settings(max_examples=examples(40), deadline=None, suppress_health_check=list(HealthCheck), derandomize=not TIMES)
@given(ANY_TREE, st.integers(0, 2**30))
def test_random_trees_do_what_the_libraries_do(drawn: Drawn, seed: int) -> None:
    compare(drawn, seed)


@pytest.mark.parametrize("name", sorted(NODES))
def test_each_node_does_what_the_library_does(name: str) -> None:
    """Each node with children whose answers are random."""
    leaves = [Drawn(f"Act{number}") for number in range(1 if name in DECORATED else COUNTS.get(name, (3, 3))[1])]
    for number in range(max(map(len, NODES[name].values()), default=1)):
        ports = tuple((key, values[number % len(values)]) for key, values in NODES[name].items())
        compare(Drawn(name, ports, tuple(leaves)), number)


def test_every_node_with_children_has_a_program() -> None:
    declared = [node for name in (BEHAVIORTREE_CPP, *LIBRARIES) for node in library(name).nodes.values()]
    with_children = {node.name for node in declared if node.children[1] and not node.until}
    assert with_children <= programs().keys()


def test_an_entry_that_is_only_observed() -> None:
    """The value of the entry is never read, but a node depends on whether it was written."""
    write = Drawn("SetBlackboard", (("value", "{x}"), ("output_key", "y")))
    asked = Drawn("WasEntryUpdated", (("entry", "{y}"),))
    tree = Drawn("KeepRunningUntilFailure", (), (Drawn("Sequence", (), (asked, write, Drawn("Check"))),))
    for seed in range(3):
        compare(tree, seed)

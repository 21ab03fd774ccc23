# SPDX-License-Identifier: Apache-2.0
"""Translated trees behave like the libraries, tick by exact tick: `library_model` says each node a second time."""

from __future__ import annotations

import copy

import library_model
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_trees import (
    CONTROLS,
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

TICKS = 14
ANY_TREE = trees({**CONTROLS, **NAV2_CONTROLS}, {**DECORATORS, **TIMED, **NAV2_DECORATORS}, {**LEAVES, **SLEEP})


def modelled(drawn: Drawn, seen: Observed) -> Observed:
    """The same run by the model of the library, with what chance has decided."""
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


def test_an_entry_that_is_only_observed() -> None:
    """Nothing reads the value of the entry; that it was written is seen."""
    write = Drawn("SetBlackboard", (("value", "{x}"), ("output_key", "y")))
    asked = Drawn("WasEntryUpdated", (("entry", "{y}"),))
    tree = Drawn("KeepRunningUntilFailure", (), (Drawn("Sequence", (), (asked, write, Drawn("Check"))),))
    for seed in range(3):
        compare(tree, seed)

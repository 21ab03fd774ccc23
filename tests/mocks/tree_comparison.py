# SPDX-License-Identifier: Apache-2.0
"""Translated random trees beside `library_model`, which says each node a second time."""

from __future__ import annotations

import copy
from collections.abc import Callable

import library_model
from random_trees import ENTRIES, Drawn, as_nodes, as_xml
from translated_trees import Observed, observe, with_mocks
from trees_in_systems import observe_system, translated

from roaml import api
from roaml.libraries.version import NEWEST_VERSION, Version


def difference_with_mocks(
    drawn: Drawn, ticks: int, seed: int, *, happens: bool = False, version: Version = NEWEST_VERSION
) -> str:
    """What the tree with mocks does differently, or nothing. `happens`: whether events of the world always occur."""
    entries = {key: str(value) for key, value in ENTRIES.items()}
    seen = observe(with_mocks(as_xml(drawn), entries, ticks, happens=happens, version=version), seed)
    return _difference(drawn, seen, happens=happens, version=version)


def difference_in_system(
    drawn: Drawn, ticks: int, seed: int, when_translated: Callable[[], None] = lambda: None
) -> str:
    """The same for the tree of a system whose leaves are plugins.

    Args:
        when_translated: called between the translation and the run.
    """
    # A script that nothing skips makes every tree one that is executed as by the library.
    tree = Drawn("Sequence", (("_onHalted", "k := k"),), (drawn,))
    try:
        model = translated(tree, ticks)
    except api.ModelError as error:
        if all(finding.code == "node-configuration" for finding in error.result.diagnostics):
            return ""  # counts with which the library throws an exception
        raise
    when_translated()
    return _difference(tree, observe_system(tree, model, seed))


def modelled(drawn: Drawn, seen: Observed, *, happens: bool = False, version: Version = NEWEST_VERSION) -> Observed:
    """The same run by the model of the library, with what chance has decided."""
    world = library_model.World(dict(ENTRIES), copy.deepcopy(seen.outcomes), happens=happens, version=version)
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


def difference_of(seen: Observed, expected: Observed) -> str:
    if (seen.answers, seen.is_stuck) != (expected.answers, expected.is_stuck):
        return f"the root answers {seen.answers}{_stuck(seen)}, the library {expected.answers}{_stuck(expected)}"
    if not seen.is_stuck and seen.calls != expected.calls:
        return f"the leaves are called {seen.calls}, by the library {expected.calls}"
    return ""


def _difference(drawn: Drawn, seen: Observed, *, happens: bool = False, version: Version = NEWEST_VERSION) -> str:
    try:
        expected = modelled(drawn, seen, happens=happens, version=version)
    except library_model.OutOfOutcomesError:
        return f"the library calls a leaf that is not called: {seen.answers}, {seen.calls}"
    return difference_of(seen, expected)


def _stuck(run: Observed) -> str:
    return " and an exception" if run.is_stuck else ""

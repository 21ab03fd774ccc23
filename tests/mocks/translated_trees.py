# SPDX-License-Identifier: Apache-2.0
"""Runs of translated trees, as observations of the leaves and of the root."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from random_trees import WORLD_CONTROLS, WORLD_DECORATORS

from roaml.forest.forest import Forest
from roaml.forest.settings import NEWEST
from roaml.jani.typecheck import check_model
from roaml.libraries.version import NEWEST_VERSION, Version
from roaml.mocks.mock import Mock
from roaml.mocks.network import MockedTree, MockOptions, mocked
from roaml.model.tree import build_tree_file
from roaml.record import replace
from roaml.scxml.names import MOCK_FAILURES, MOCK_SUCCESSES, sent_by
from roaml.smc.model import ModelChecker
from roaml.smc.record import Recorder, Recording
from roaml.to_jani import translate
from roaml.verification.tree_outcome import tree_properties
from roaml.xml_syntax import parse

CODES = {1: "SUCCESS", 2: "FAILURE", 3: "RUNNING", 4: "SKIPPED", 5: "SKIPPED"}
PATH = "/trees/tree.xml"
_EVENT = re.compile(r"bt_(\d+)_(tick|response|halt|halt_response)")


@dataclass
class Observed:
    """The observations of a run.

    Attributes:
        answers: the answers of the root, one for each tick.
        calls: leaf and answer for each call of a leaf of the program, and (leaf, "halt").
        outcomes: leaf -> its random outcomes.
        is_stuck: whether the last tick has no answer.
    """

    answers: list[str]
    calls: list[tuple[str, str]]
    outcomes: dict[str, list[str]]
    is_stuck: bool


def forest_of(text: str, version: Version = NEWEST_VERSION) -> Forest:
    file = build_tree_file(parse(text))
    assert file is not None
    return Forest(PATH, ((PATH, file),), replace(NEWEST, libraries=("nav2",), version=version))


def with_mocks(
    text: str,
    entries: dict[str, str],
    ticks: int,
    *,
    happens: bool = False,
    version: Version = NEWEST_VERSION,
    more: tuple[Mock, ...] = (),
) -> MockedTree:
    """A tree ticked at 10 Hz; `Act<n>` is RUNNING for n ticks.

    Args:
        happens: whether events of the world always occur.
        version: the version of BehaviorTree.CPP that executes the tree.
        more: further mocks.
    """
    acts = [Mock(f"Act{n}", 0.6, Fraction(100 * n)) for n in range(4)]
    world = [Mock(node, float(happens)) for node in (*WORLD_CONTROLS, *WORLD_DECORATORS)]
    options = MockOptions(
        (*acts, *world, *more, Mock("*", 0.6)), entries, max_time=ticks * 10**8 + 5 * 10**7, counts=True
    )
    return mocked(forest_of(text, version), options)


def observe(tree: MockedTree, seed: int) -> Observed:
    """One run of the translated tree."""
    model = translate(tree.network)
    assert list(check_model(model)) == []
    model = replace(model, properties=tree_properties(tree.tree.root))
    never = model.properties[:1]
    checker = ModelChecker(model, never)
    recorder = Recorder(checker, checker.compiled_properties[0], seed, 20_000)
    status = {storage.name: storage for storage in recorder.shared if storage.name.endswith("_response__status")}
    leaves = {leaf.node.number: leaf.node.name for leaf in tree.leaves}
    drawn: set[int] = set()
    state = dict.fromkeys(leaves, "IDLE")
    seen = Observed([], [], {name: [] for name in leaves.values()}, False)
    pending = False
    for step in recorder.walk(Recording(0)):
        if any(change.variable.name in (MOCK_SUCCESSES, MOCK_FAILURES) for change in step.changes):
            drawn |= {
                int(part.automaton.split("_")[2]) for part in step.parts if part.automaton.startswith("BT_plugin_")
            }
        match = _EVENT.fullmatch(sent_by(step.action or ""))
        if match is None:
            continue
        number, what = int(match[1]), match[2]
        if number == tree.tree.root and what == "tick":
            pending = True
        answer = ""
        if what == "response":
            code = recorder.values([status[f"bt_{number}_response__status"]])[0]
            assert isinstance(code, int)
            answer = CODES[code]
        if number in leaves:
            if what == "halt":
                if state[number] == "RUNNING":
                    seen.calls.append((leaves[number], "halt"))
                state[number] = "IDLE"
            elif what == "response":
                if number in drawn or answer == "RUNNING":
                    seen.calls.append((leaves[number], answer))
                    if answer != "RUNNING":
                        seen.outcomes[leaves[number]].append(answer)
                elif answer == "SKIPPED" and state[number] == "RUNNING":
                    seen.calls.append((leaves[number], "halt"))  # its own `_while` halts it, so no parent does
                    state[number] = "IDLE"
                drawn.discard(number)
                if answer != "SKIPPED":
                    state[number] = answer
        if number == tree.tree.root and what == "response":
            seen.answers.append(answer)
            pending = False
    seen.is_stuck = pending
    return seen

# SPDX-License-Identifier: Apache-2.0
"""The tables about nodes that are written by hand agree with the declarations and programs of the nodes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from roaml.forest import forest
from roaml.libraries import LIBRARIES, library, library_node
from roaml.libraries.programs.assembly import programs
from roaml.libraries.programs.effects import Situation, effects
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SUCCESS
from roaml.model.system import builtin_plugins
from roaml.rules.support.node_calls import WITHOUT_RESETS
from roaml.rules.trees import tree_semantics

MACHINES = Path(__file__).parents[2] / "server" / "roaml" / "lower" / "nodes"
ENDED = frozenset((SUCCESS, FAILURE))
RUNNING_FOR_OTHER_REASONS = {"Parallel", "BlackboardCheckInt"}
"""Whether `Parallel` returns RUNNING depends on counts that are not known, and a mismatch may be RUNNING."""


def is_running_although_children_end(name: str) -> bool:
    node = library_node(name)
    assert node is not None
    children = (ENDED,) * min(max(node.children[0], 2), node.children[1])
    return RUNNING in effects(programs()[node.name], Situation(children, children)).answers


def test_nodes_that_continue_at_the_next_tick() -> None:
    running = {name for name in builtin_plugins() if is_running_although_children_end(name)}
    assert running - RUNNING_FOR_OTHER_REASONS == set(tree_semantics.CONTINUING)


def test_ports_with_times() -> None:
    timed = {(name, port) for name in programs() for port in programs()[name].timed_ports}
    assert timed == {("Delay", "delay_msec"), ("Timeout", "msec"), ("Sleep", "msec")}


def test_nodes_that_do_not_reset_their_child() -> None:
    """Their machines with the meaning of AS2FM halt a child only when they are halted."""
    machines = {path.stem: path.read_text("utf-8") for path in MACHINES.glob("*.ascxml")}
    with_children = {name: text for name, text in machines.items() if "<bt_tick_child" in text}
    own = {name: re.sub(r"<bt_halt .*?</bt_halt>", "", text, flags=re.DOTALL) for name, text in with_children.items()}
    assert {name for name, text in own.items() if "<bt_halt_child" not in text} == WITHOUT_RESETS


@pytest.mark.parametrize("name", sorted(forest._COMMON_NAMES))
def test_common_names(name: str) -> None:
    assert any(name in library(known).nodes for known in LIBRARIES), "a common name is that of a node of a library"

# SPDX-License-Identifier: Apache-2.0
"""Traces of `verify` on conformance systems in the debugger; `replay.py` replays those of all systems."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from dap_client import Client
from replay import replay, sources_of

from conformance import ROOT, label, systems
from roaml import api
from roaml.debugging.breakpoints import WatchedVariable
from roaml.debugging.by_hand import sendable, sending
from roaml.debugging.frames import Frame, FrameRole
from roaml.debugging.start import Start, start

NAV2 = sorted(path for path in (ROOT / "trees/nav2").glob("*.xml") if path.name != "nav2_tree_nodes.xml")
MAX_SINGLE_STEPS, MAX_STEPS = 80, 2_000


@pytest.mark.parametrize("path", systems(), ids=label)
def test_traces_are_the_same_forwards_and_backwards(path: Path) -> None:
    """A trace of each property; `python tests/debug/replay.py` replays 20 of each, without these limits."""
    sources = sources_of(path)
    checker = api.checker(sources.target.model)
    for property_ in checker.compiled_properties:
        differences = list(replay(sources, checker, property_, 0, MAX_SINGLE_STEPS, MAX_STEPS))
        assert differences == [], property_.question.name


@pytest.mark.parametrize("path", NAV2, ids=lambda path: path.stem)
def test_every_tree_of_nav2_runs_with_its_proposals(path: Path, tmp_path: Path) -> None:
    """As F5 in an editor, which writes the proposed mocks beside the tree."""
    tree = Path(shutil.copy(path, tmp_path))
    tree.with_suffix(".mocks").write_text(api.proposed_text(path.name, api.propose_mocks(str(tree))), encoding="utf-8")
    with Client() as client:
        assert client.begin(tree)["reason"] == "entry"
        entered = client.step()
        assert [choice["text"] for choice in client.ask("choices")["choices"] if choice["isNext"]] == [
            "the tree begins its next tick"
        ]
        client.move("next")
        assert client.step() > entered


@pytest.mark.parametrize("folder", ["array_of_strings", "array_of_data_structs", "ros_add_int_srv_example"])
def test_every_event_is_sent_by_hand_and_received(folder: str) -> None:
    sources = sources_of(next(path for path in systems() if path.parent == ROOT / "models" / folder))
    debugger = start(sources, Start(), lambda *_: None)
    session = debugger.session
    events = list(sendable(session, sources))
    assert events
    for form in events:
        debugger.intervene(sending(session, sources, form.event, dict(form.template)))
        assert session.is_changed
        for _ in range(3):
            session.step()
        before = session.state()
        debugger.go_to(session.position)
        assert session.state() == before
        debugger.go_to(0)


def test_an_expression_denotes_the_variable_of_the_frame_before_the_blackboard(tmp_path: Path) -> None:
    """The blackboard entry has the same name as the variable of a node."""
    folder = tmp_path / "blackboard_test"
    shutil.copytree(ROOT / "models" / "blackboard_test", folder)
    tree = folder / "bt.xml"
    tree.write_text(tree.read_text(encoding="utf-8").replace("{counter}", "{bb_var}"), encoding="utf-8")
    debugger = start(sources_of(folder / "main.xml"), Start(), lambda *_: None)
    session, values = debugger.session, debugger.values
    node = session.automata.index("BT_plugin_1002_ReadBB")
    frame = Frame(1, "", None, node, 1002, FrameRole.NODE)
    scopes = {scope.name: {entry.name: entry for entry in scope.entries} for scope in values.scopes(frame)}
    assert scopes["Variables"]["bb_var"].expression == "bb_var"
    assert scopes["Blackboard"]["bb_var"].expression == ""
    blackboard = scopes["Blackboard"]["bb_var"].variable
    assert (values.entry("bb_var", None) or scopes["Variables"]["bb_var"]).variable == blackboard
    own = values.entry("bb_var", frame)
    assert own is not None
    assert own.variable == WatchedVariable(node, "bb_var") != blackboard

# SPDX-License-Identifier: Apache-2.0
"""Mocks that are proposed for the leaves of a tree: what they say, and where they are kept."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from as2fm_lsp.cli.exit_status import USAGE
from as2fm_lsp.cli.main import run
from examples import TIMES, examples
from roaml import api
from roaml.libraries import LIBRARIES, library
from roaml.libraries.programs.assembly import programs
from roaml.mocks.assumptions import assumption
from roaml.mocks.mock import Mock, mock_for, mock_spans
from roaml.roles import NodeKind
from roaml.xml_syntax.escapes import escape

MODELS = '<TreeNodesModel><Condition ID="Clear"/></TreeNodesModel>'


def tree(folder: Path, content: str, models: str = "") -> Path:
    path = folder / "tree.xml"
    path.write_text(
        f'<root BTCPP_format="4"><BehaviorTree ID="Main">{content}</BehaviorTree>{models}</root>', encoding="utf-8"
    )
    return path


def lines(path: Path) -> list[str]:
    return [leaf.line for leaf in api.propose_mocks(str(path))]


def values(path: Path) -> dict[str, str]:
    return {leaf.proposed.pattern: leaf.proposed.behaviour() for leaf in api.propose_mocks(str(path))}


def test_every_leaf_of_nav2_has_an_assumption() -> None:
    leaves = [
        node
        for name in LIBRARIES
        for node in library(name).nodes.values()
        if node.kind in (NodeKind.ACTION, NodeKind.CONDITION) and not node.succeeds and node.name not in programs()
    ]
    assert len(leaves) > 40
    for node in leaves:
        assumed = assumption(node.name, lambda _: None)
        assert assumed is not None, node.name
        assert assumed.reason
        assert 0 < assumed.probability <= 1
        assert assumed.duration == 0 or not node.is_synchronous, node.name


@pytest.mark.parametrize("condition", ["IsBatteryLow", "IsStuck"])
def test_a_drive_usually_succeeds_behind_a_guard_against_what_is_rare(condition: str, tmp_path: Path) -> None:
    guard = f"<Inverter><{condition}/></Inverter>"
    path = tree(tmp_path, f'<ReactiveSequence>{guard}<NavigateToPose goal="{{goal}}"/></ReactiveSequence>')
    rare = next(leaf.proposed for leaf in api.propose_mocks(str(path)) if leaf.proposed.pattern == condition)
    drive = next(leaf.proposed for leaf in api.propose_mocks(str(path)) if leaf.proposed.pattern == "NavigateToPose")
    checks = int(drive.duration / 1000 * 10)
    assert checks >= 100
    assert (1 - rare.probability) ** checks > 0.8


def test_durations_come_from_the_ports(tmp_path: Path) -> None:
    content = """<Sequence>
      <Spin spin_dist="-3.14"/> <Wait wait_duration="2.5"/> <BackUp backup_dist="0.3" backup_speed="0.1"/>
      <DriveOnHeading name="far" dist_to_travel="4" speed="0.5"/>
      <DriveOnHeading name="near" dist_to_travel="1" speed="0.5"/>
      <DriveOnHeading name="any" dist_to_travel="{way}" speed="0"/></Sequence>"""
    assert values(tree(tmp_path, content)) == {
        "Spin": "0.95 in 3.14 s",
        "Wait": "1 in 2.5 s",
        "BackUp": "0.9 in 3 s",
        "far": "0.9 in 8 s",
        "near": "0.9 in 2 s",
        "any": "0.9 in 3 s",
    }


def test_leaves_of_which_nothing_is_known(tmp_path: Path) -> None:
    content = (
        "<Sequence><Clear/><IsOpen/><Grasp name='a'/><Grasp name='b'/><Sleep msec='10'/><AlwaysSuccess/></Sequence>"
    )
    assert lines(tree(tmp_path, content, MODELS)) == [
        "Clear: 0.5  # condition: no library describes it: both outcomes are as likely",
        "IsOpen: 0.5  # action: its name reads as a condition: both outcomes are as likely",
        "Grasp: 0.9 in 1 s  # action: no library describes it: a common action",
    ]


GUARDED = """
<ReactiveSequence>
    <Ready/>
    <Inverter><Blocked/></Inverter>
    <SubTree ID="Safe"/>
    <Sequence><Move/><Sequence><Open/></Sequence></Sequence>
</ReactiveSequence>
"""
SAFE = f'<BehaviorTree ID="Safe"><IsCalm/></BehaviorTree>{MODELS}'


@pytest.mark.parametrize(
    ("content", "proposed"),
    [
        (
            GUARDED,
            {"Ready": "0.999", "Blocked": "0.001", "IsCalm": "0.999", "Move": "0.9 in 1 s", "Open": "0.9 in 1 s"},
        ),
        ("<ReactiveFallback><There/><Clear/><Go/></ReactiveFallback>", {"There": "0.001", "Clear": "0.001"}),
        ("<WhileDoElse><Ask/><Then/><Else/></WhileDoElse>", {"Ask": "0.999", "Then": "0.9 in 1 s"}),
        (
            "<ReactiveSequence><Sequence><Ready/><Inverter><Blocked/></Inverter></Sequence><Go/></ReactiveSequence>",
            {"Ready": "0.999", "Blocked": "0.001", "Go": "0.9 in 1 s"},
        ),
        (
            "<ReactiveSequence><Fallback><Charged/><Charge/></Fallback><Go/></ReactiveSequence>",
            {"Charged": "0.999", "Charge": "0.9 in 1 s"},
        ),
        (
            "<ReactiveFallback><Sequence><Fallback><Low/><Inverter><Linked/></Inverter></Fallback><Land/></Sequence><Go/>"
            "</ReactiveFallback>",
            {"Low": "0.001", "Linked": "0.999", "Land": "0.9 in 1 s"},
        ),
        (
            "<ReactiveSequence><ReactiveSequence><A/><B/></ReactiveSequence><Go/></ReactiveSequence>",
            {"A": "0.999", "B": "0.999"},
        ),
        ("<Sequence><First/><Second/></Sequence>", {"First": "0.9 in 1 s"}),
        ("<Parallel><First/><Second/></Parallel>", {"First": "0.9 in 1 s"}),
    ],
)
def test_leaves_that_guard_others_take_no_time_and_let_them_run(
    tmp_path: Path, content: str, proposed: dict[str, str]
) -> None:
    """Otherwise hardly any tree with a ReactiveSequence would succeed with its proposal."""
    path = tree(tmp_path, content, SAFE)
    text = path.read_text(encoding="utf-8").replace("<root ", '<root main_tree_to_execute="Main" ')
    path.write_text(text, encoding="utf-8")
    leaves = dict(line.partition("  #")[0].split(": ", 1) for line in lines(path))
    assert {name: leaves[name] for name in proposed} == proposed


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("<WhileDoElse><Ready/><Go/><Dock/></WhileDoElse>", "and selects that node: mostly the one for SUCCESS"),
        ("<WhileDoElse><Ready/><Go/></WhileDoElse>", "and mostly lets it run"),
        ("<ReactiveSequence><Ready/><Go/></ReactiveSequence>", "and mostly lets it run"),
    ],
)
def test_a_guard_that_selects_a_node_stops_none(tmp_path: Path, content: str, reason: str) -> None:
    ready = next(line for line in lines(tree(tmp_path, content)) if line.startswith("Ready: 0.999 "))
    assert ready.endswith(f"  # action: it is ticked again while a node behind it runs, {reason}")


def test_events_of_the_world_are_proposed_unless_the_tree_sets_them(tmp_path: Path) -> None:
    nodes = "<GoalUpdatedController><Grasp/></GoalUpdatedController>"
    assert list(values(tree(tmp_path, nodes))) == ["GoalUpdatedController", "Grasp"]
    set_ = '<GoalUpdatedController _event_probability="0.2"><Grasp/></GoalUpdatedController>'
    assert list(values(tree(tmp_path, set_))) == ["Grasp"]


def test_existing_mocks_are_shown_and_only_missing_ones_are_added(tmp_path: Path) -> None:
    path = tree(tmp_path, "<Sequence><Grasp/><Grasp name='last'/><Look/></Sequence>")
    path.with_suffix(".mocks").write_text("last: 0.3\nGrasp: 0.4 in 2 s", encoding="utf-8")
    leaves = api.propose_mocks(str(path))
    found = [(leaf.proposed.pattern, leaf.mock.probability if leaf.mock else None) for leaf in leaves]
    assert found == [("Grasp", 0.4), ("last", 0.3), ("Look", None)]
    assert [leaf.is_missing for leaf in leaves] == [False, False, True]


@settings(max_examples=examples(60), deadline=None, derandomize=not TIMES)
@given(st.text(st.characters(codec="utf-8", exclude_categories=["Cc", "Cs", "Cn"]), min_size=1, max_size=8))
def test_a_proposal_applies_to_leaves_with_any_name(name: str) -> None:
    """Also if names contain what separates the parts of a mock, or begins a comment."""
    path = os.path.abspath("tree.xml")
    spins = f'<Spin name="{escape(name, chr(34))}" spin_dist="1"/><Spin name="other one" spin_dist="2"/>'
    nodes = f"<Sequence>{spins}</Sequence>"
    text = f'<root BTCPP_format="4"><BehaviorTree ID="Main">{nodes}</BehaviorTree></root>'
    leaves = api.propose_mocks(path, texts={path: text})
    mocks = api.read_mocks(api.proposed_text("tree.xml", leaves))
    assert len(mocks) == len(leaves)
    for leaf in leaves:
        for node in leaf.nodes:
            chosen = mock_for(mocks, node.name, node.type)
            assert chosen is not None
            assert chosen.probability == leaf.proposed.probability


@pytest.fixture
def nav2(tmp_path: Path) -> Path:
    path = tree(tmp_path, "<PipelineSequence><ComputePathToPose/><FollowPath/></PipelineSequence>")
    return path.rename(tmp_path / "navigate.xml")


def test_the_command_writes_a_proposal_and_says_how_to_go_on(nav2: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["verify", str(nav2)]) == USAGE
    message = capsys.readouterr().err
    beside = nav2.with_suffix(".mocks")
    assert "its 2 leaves need mocks; a proposal is in" in message
    assert "navigate.mocks, with a reason for each: review it and repeat the command" in message
    assert "FollowPath: 0.9 in 10 s  # action: driving takes seconds" in beside.read_text("utf-8")
    assert run(["verify", str(nav2), "--max-traces", "20", "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["tree"]["success"]["value"] > 0


def test_the_command_says_how_many_leaves_share_a_mock(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, "<Sequence><ComputePathToPose/><FollowPath/><FollowPath/></Sequence>")
    assert run(["verify", str(path)]) == USAGE
    assert "its 3 leaves of 2 kinds need mocks; a proposal is in" in capsys.readouterr().err
    lines = path.with_suffix(".mocks").read_text("utf-8").splitlines()
    assert sum(not line.startswith("#") for line in lines) == 2


def test_the_command_says_how_many_events_have_a_proposal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tree(tmp_path, '<DistanceController distance="1.0"><FollowPath/></DistanceController>')
    assert run(["verify", str(path)]) == USAGE
    message = capsys.readouterr().err
    assert "its leaf needs a mock; a proposal, with 1 more for random events, is in" in message


def test_the_command_changes_no_file_with_mocks(nav2: Path, capsys: pytest.CaptureFixture[str]) -> None:
    beside = nav2.with_suffix(".mocks")
    beside.write_text("FollowPath: 1\n", encoding="utf-8")
    assert run(["simulate", str(nav2)]) == USAGE
    message = capsys.readouterr().err
    assert "leaves have no mock; add lines for them, for example\n  ComputePathToPose: 0.95 in 200 ms  #" in message
    assert beside.read_text("utf-8") == "FollowPath: 1\n"


def test_a_proposal_that_cannot_be_written_is_shown(
    nav2: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(path: str, *_: object) -> None:
        raise PermissionError(13, "Permission denied", path)

    monkeypatch.setattr("as2fm_lsp.atomic_write.write_file", fails)
    assert run(["verify", str(nav2)]) == USAGE
    message = capsys.readouterr().err
    assert "could not be written into" in message
    assert "Permission denied; write these lines into a file and name it with --mocks" in message
    assert "\n  FollowPath: 0.9 in 10 s" in message


@pytest.mark.parametrize("place", ["a read-only folder", "an installed package"])
def test_nothing_is_written_into_folders_of_others(
    place: str, nav2: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also not by a user who may write everywhere."""
    folder = nav2.parent
    if place == "an installed package":
        monkeypatch.setenv("AMENT_PREFIX_PATH", f"/opt/ros/none{os.pathsep}{folder.parent}")
    else:
        folder.chmod(0o555)
    try:
        assert run(["verify", str(nav2)]) == USAGE
        message = capsys.readouterr().err
        reason = "the folder is read-only" if place == "a read-only folder" else "the folder belongs to an installed"
        assert reason in message
        assert "; write these lines into a file and name it with --mocks\n" in message
        assert not nav2.with_suffix(".mocks").exists()
    finally:
        folder.chmod(0o755)


def test_mocks_of_the_command_line_are_not_completed(nav2: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["verify", str(nav2), "--mock", "FollowPath: 1"]) == USAGE
    assert "these leaves need mocks: ComputePathToPose" in capsys.readouterr().err
    assert not nav2.with_suffix(".mocks").exists()


def test_a_proposed_mock_is_a_mock() -> None:
    assert api.read_mocks("Spin: 0.95 in 1.57 s  # action: a reason") == (Mock("Spin", 0.95, 1570),)  # type: ignore[arg-type]


def test_a_comment_begins_outside_of_quotes() -> None:
    lines = (
        "A: 1 in histogram('times #1.csv', s) # it's 'measured'",
        "Don't: 0.5 # it's a guess",
        "# B: 1",
        'C: as Repeat(num_cycles="#")',
    )
    text = "\n".join(lines)
    assert [text[span.start : span.end] for span in mock_spans(text)] == [
        "A: 1 in histogram('times #1.csv', s)",
        "Don't: 0.5",
        'C: as Repeat(num_cycles="#")',
    ]

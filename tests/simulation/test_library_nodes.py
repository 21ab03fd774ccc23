# SPDX-License-Identifier: Apache-2.0
"""Runs name the nodes of libraries and mocks by their statuses, not by the states of their automata, which no user has
written."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.api.trees import load_tree
from roaml.mocks.mock import read_mock
from roaml.mocks.network import MockOptions
from roaml.views.story import as_text

TREE = """<root BTCPP_format="4" main_tree_to_execute="Main">
    <BehaviorTree ID="Main">
        <Sequence>
            <Drive result="{code}" />
            <ScriptCondition code="code == 3 || load == 1" />
            <IsOpen _skipIf="load > 2" />
        </Sequence>
    </BehaviorTree>
    <TreeNodesModel>
        <Action ID="Drive"><output_port name="result" /></Action>
        <Condition ID="IsOpen" />
    </TreeNodesModel>
</root>
"""
OPTIONS = MockOptions((read_mock("*: 0.5 in 200 ms"),), {"load": "1"})
GENERATED = re.compile(r"\b(?:deciding|asking|ticking|halting|idle|running|success|failure)(?:_\d+)?\b|entry[._]")


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    path = tmp_path / "tree.xml"
    path.write_text(TREE, encoding="utf-8")
    return path


def test_outcomes_are_statuses(tree: Path) -> None:
    """An outcome after which chance decides about the value of an output port is described by the status, too."""
    session, texts = api.session(load_tree(str(tree), OPTIONS).target), set()
    while session.end is None:
        for choice in session.choices():
            texts.update(outcome.text for outcome in choice.outcomes if outcome.text)
        session.step()
    assert not [text for text in texts if GENERATED.search(text)]
    assert {text for text in texts if text.startswith("Drive")} >= {
        "Drive returns SUCCESS",
        "Drive returns FAILURE",
    }
    assert "nothing changes" not in texts


def test_stories_show_statuses_and_entries(tree: Path) -> None:
    target = load_tree(str(tree), OPTIONS).target
    for trace in range(40):
        session = api.session(target, trace=trace)
        session.until_decided()
        text = as_text(session.story(), lambda _: "")
        assert not GENERATED.search(text), text
        if "IsOpen" in text:
            break
    assert "IsOpen" in text
    assert re.search(r"Drive +is ticked: RUNNING\n", text)
    assert re.search(r"ScriptCondition +receives the blackboard .*: SUCCESS\n", text)
    assert "{load}" not in text, "a node that reads an entry does not change it"


WRITES = """<root BTCPP_format="4">
    <BehaviorTree ID="Main">
        <Sequence>
            <Script code="battery := 100; mode := 'idle'" />
            <RetryUntilSuccessful num_attempts="2">
                <Script code="battery -= 10; mode := 'drive'; fails := 0" _onSuccess="battery -= 1" />
            </RetryUntilSuccessful>
            <Work _skipIf="battery == 3 || mode == 'stop'" _post="battery := 89" />
            <Work _skipIf="battery == 3 || fails == 2" />
        </Sequence>
    </BehaviorTree>
</root>
"""


def test_a_story_shows_each_change_of_an_entry_once_at_its_writer(tmp_path: Path) -> None:
    path = tmp_path / "tree.xml"
    path.write_text(WRITES, encoding="utf-8")
    session = api.session(load_tree(str(path), MockOptions((read_mock("*: 1"),))).target)
    session.until_decided()
    text = as_text(session.story(), lambda _: "")
    assert re.findall(r"\{\w+\}: .* → .*", text) == [
        "{battery}: 0 → 100",
        "{mode}: '' → 'idle'",
        "{battery}: 100 → 90",
        "{mode}: 'idle' → 'drive'",
        "{battery}: 90 → 89",
    ]
    assert re.findall(r"sends the blackboard entry .*", text) == [
        "sends the blackboard entry fails (value: 0)",
        "sends the blackboard entry battery (value: 89)",
    ], "the writes that change nothing"


def test_the_state_shows_each_node_once(
    tree: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("t\ns\nq\n"))
    assert run(["simulate", str(tree), "-i", "--mock", "*: 0.5 in 200 ms", "--entry", "load=1"]) == 0
    lines = [line.strip() for line in capsys.readouterr().out.splitlines() if "Drive:" in line]
    assert lines == ["Drive: RUNNING (ticks_left: 2, {code}: 0)"]

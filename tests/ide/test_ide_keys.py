# SPDX-License-Identifier: Apache-2.0
"""Findings and values while a user types are equal to newly computed ones, and what is replaced leaves the memory."""

from __future__ import annotations

import gc
import re
from collections import Counter
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ide_models import system_file

from bench.generate import FIRST, write_system
from fuzz import damage
from roaml.model.behavior import explore
from roaml.model.machine import Machine
from roaml.model.values.analyse import MachineValues
from roaml.project.analysis import values as analysis_values
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace

HERE, OTHER = "/robot/here.ascxml", "/robot/other.ascxml"
MAIN = system_file("node_models node-ascxml here.ascxml", "node_models node-ascxml other.ascxml")
MACHINE = """\
<ascxml name="NAME" version="1.0" initial="s0">
  <datamodel>
    <data id="n" type="int32" expr="0"/>
    <data id="m" type="int32" expr="3"/>
    <data id="go" type="bool" expr="false"/>
    <data id="list" type="int32[5]" expr="[]"/>
  </datamodel>
  <ros_topic_publisher name="out" topic="/OUT" type="std_msgs/Int32"/>
  <ros_topic_subscriber name="in" topic="/IN" type="std_msgs/Int32"/>
  <ros_time_rate name="clock" rate_hz="1"/>
  <state id="s0">
    <ros_rate_callback name="clock" target="s1" cond="n &lt; 7">
      <assign location="n" expr="n + 1"/>
      <ros_topic_publish name="out"><field name="data" expr="n"/></ros_topic_publish>
    </ros_rate_callback>
    <ros_rate_callback name="clock" target="s0"><assign location="n" expr="0"/></ros_rate_callback>
    <ros_topic_callback name="in" target="s2"><assign location="m" expr="_msg.data"/></ros_topic_callback>
  </state>
  <state id="s1">
    <onexit><assign location="go" expr="!go"/></onexit>
    <ros_rate_callback name="clock" target="s2">
      <if cond="m &gt; n"><assign location="m" expr="m - 1"/>
      <elseif cond="go"/><assign location="list[0]" expr="n"/>
      <else/><assign location="n" expr="n - 1"/></if>
    </ros_rate_callback>
  </state>
  <state id="s2">
    <onentry><assign location="m" expr="Math.min(m, 9)"/></onentry>
    <ros_rate_callback name="clock" target="s0" cond="go &amp;&amp; list.length &lt; 3"/>
    <ros_rate_callback name="clock" target="s1"/>
  </state>
</ascxml>
"""
WORDS = (
    "n",
    "m",
    "go",
    "list",
    "list[1]",
    "0",
    "1",
    "7",
    "2",
    "+",
    "-",
    "&lt;",
    "&gt;",
    "==",
    "s0",
    "s1",
    "s2",
    "true",
)
WORD = re.compile(r"\b(?:n|m|go|list|true|\d|s\d)\b|&lt;|&gt;|(?<= )[+-](?= )")


def machine(name: str, sent: str, received: str) -> str:
    return MACHINE.replace("NAME", name).replace("OUT", sent).replace("IN", received)


def workspace(texts: dict[str, str]) -> Workspace:
    opened = Workspace([], Settings(), ["/robot/main.xml"])
    for path, text in texts.items():
        opened.open(path, text)
    return opened


def results(snapshot: Snapshot) -> dict[str, object]:
    """The diagnostics of each file, and the values in each machine."""
    found: dict[str, object] = {path: snapshot.checker.diagnostics(path) for path in snapshot.files()}
    for path in (HERE, OTHER):
        if snapshot.analysis.machine(path) is not None:
            values = snapshot.analysis.values_in(path, "/robot/main.xml")
            charts = {s: (c.states, c.conditions, c.seen) for s, c in values.charts.items()}
            found[f"values in {path}"] = (charts, values.sent)
            found[f"complete {path}"] = values.complete
    return found


@settings(deadline=None, max_examples=40)
@given(st.lists(st.tuples(st.integers(0, 10_000), st.sampled_from(WORDS), st.booleans()), min_size=1, max_size=6))
def test_what_is_kept_equals_what_is_new(edits: list[tuple[int, str, bool]]) -> None:
    texts = {"/robot/main.xml": MAIN, HERE: machine("here", "a", "b"), OTHER: machine("other", "b", "a")}
    kept = workspace(texts)
    before = results(kept.snapshot())
    assert before[HERE] == ()
    assert before[f"complete {HERE}"] is True
    for number, word, is_here in edits:
        path = HERE if is_here else OTHER
        places = list(WORD.finditer(texts[path]))
        place = places[number % len(places)]
        texts[path] = texts[path][: place.start()] + word + texts[path][place.end() :]
        kept.open(path, texts[path])
        assert results(kept.snapshot()) == results(workspace(texts).snapshot())


def test_replaced_versions_are_no_garbage(tmp_path: Path) -> None:
    """Models contain no cycles of references, so the collector need not run between two keys."""
    write_system(tmp_path, files=5, lines=120)
    path = tmp_path / FIRST
    text = path.read_text(encoding="utf-8")
    edited = Workspace([str(tmp_path)], Settings())
    versions = [text.replace("counter + 1", f"counter + {number}") for number in range(6)]
    versions += [text.replace("<assign ", "<assig ", 1), text.replace("state_1", "state_2", 1), text]

    def check(version: str) -> None:
        edited.open(str(path), version)
        snapshot = edited.snapshot()
        for file in snapshot.files():
            snapshot.checker.diagnostics(file)

    check(text)
    gc.collect()
    gc.disable()
    try:
        for version in versions:
            check(version)
        unreachable = gc.collect()
    finally:
        gc.enable()
    assert unreachable < 100


class Analysed:
    """Counts the analyses of each machine, by its name: of its values, and of its steps."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.values: Counter[str] = Counter()
        self.steps: Counter[str] = Counter()
        analyse, run = analysis_values.analyse, explore._Explorer.run

        def counted(machine: Machine, *arguments: Any, **named: Any) -> MachineValues:
            self.values[_name(machine)] += 1
            return analyse(machine, *arguments, **named)

        def counted_steps(explorer: Any) -> explore.Behavior | None:
            self.steps[_name(explorer.machine)] += 1
            return run(explorer)

        monkeypatch.setattr(analysis_values, "analyse", counted)
        monkeypatch.setattr(explore._Explorer, "run", counted_steps)

    def after(self, edited: Workspace, path: Path, text: str) -> tuple[Counter[str], Counter[str]]:
        """The analyses of values and of steps in a complete check after an edit."""
        self.values.clear()
        self.steps.clear()
        edited.open(str(path), text)
        snapshot = edited.snapshot()
        for file in snapshot.files():
            snapshot.checker.diagnostics(file)
        return self.values, self.steps


def _name(machine: Machine) -> str:
    return machine.name.value if machine.name else ""


def test_only_changed_machines_are_analysed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An edit that changes nothing that is sent analyses one machine again, once for each round. If other values are
    sent analyse those that receive them, and in the next round perhaps their receivers, but never others.
    """
    write_system(tmp_path, files=11, lines=100)
    path, analysed = tmp_path / FIRST, Analysed(monkeypatch)
    text = path.read_text(encoding="utf-8")
    edited = Workspace([str(tmp_path)], Settings())
    values, steps = analysed.after(edited, path, text)
    assert values.keys() == steps.keys() == {f"Machine{number}" for number in range(8)}

    rounds, sent = analysis_values.ROUNDS + 1, '<field name="b" expr="1"'
    for same in (text.replace("<state ", "<state  ", 1), text.replace("values.length &gt; 3", "values.length &gt; 4")):
        values, steps = analysed.after(edited, path, same)
        assert values.keys() == steps.keys() == {"Machine0"}
        assert values["Machine0"] <= rounds
        assert steps["Machine0"] <= 2
    speed = 'name="linear.x" expr="speed"'
    for old, new, receiver in ((sent, f'{sent[:-1]}00"', "Machine1"), (speed, speed.replace("speed", "7"), "Machine7")):
        values, steps = analysed.after(edited, path, text.replace(old, new))
        assert values.keys() == {"Machine0", receiver}
        assert steps.keys() == {"Machine0"}
        analysed.after(edited, path, text)

    random, near = Random(31), {f"Machine{number % 8}" for number in range(-2, 3)}
    for _ in range(15):
        text = random.choice((damage.rename, damage.change_words, damage.change_expressions))(random, text, (text,))
        values, steps = analysed.after(edited, path, text)
        assert values.keys() <= near
        assert steps.keys() <= {"Machine0"}

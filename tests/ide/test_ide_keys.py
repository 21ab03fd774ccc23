# SPDX-License-Identifier: Apache-2.0
"""Findings and values while a user types are equal to newly computed ones, and what is replaced leaves the memory."""

from __future__ import annotations

import gc
import re
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st
from ide_models import system_file

from bench.generate import FIRST, write_system
from roaml.project.settings import Settings
from roaml.project.values import values_in
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
            values = values_in(snapshot.analysis, path, "/robot/main.xml")
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

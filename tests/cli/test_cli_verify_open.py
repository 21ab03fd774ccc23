# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp verify`: properties whose deadline is later than the end of the time."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command import Command

_MAIN = """\
<roaml>
    <parameters><max_time value="5" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="sensor.ascxml" /></node_models>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>
"""
_SENSOR = """\
<ascxml name="Sensor" version="1.0" initial="run">
    <datamodel><data id="level" type="int32" expr="100" /></datamodel>
    <ros_time_rate name="tick" rate_hz="1" />
    <ros_topic_publisher name="level" topic="/level" type="std_msgs/Int32" />
    <state id="run">
        <ros_rate_callback name="tick" target="run" cond="level &gt; 10">
            <assign location="level" expr="level - (Math.random() &lt; 0.5 ? 10 : 20)" />
            <ros_topic_publish name="level"><field name="data" expr="level" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>
"""
_PROPERTIES = """\
<properties>
    <ports>
        <ros_topic topic_name="/level" type="std_msgs/Int32" event="publish">
            <state_var id="level" type="int32" field="data" expr="100" />
        </ros_topic>
    </ports>
    <guarantees>
        <property id="soon_low" pattern="existence" expect="{expected}">
            <event>level &lt;= 20</event>
            <scope type="globally" />
            <time_interval time="20" time_unit="s" />
        </property>
    </guarantees>
</properties>
"""


def write(folder: Path, expected: str = "&gt;= 0.9") -> str:
    (folder / "main.xml").write_text(_MAIN, encoding="utf-8")
    (folder / "sensor.ascxml").write_text(_SENSOR, encoding="utf-8")
    (folder / "properties.xml").write_text(_PROPERTIES.format(expected=expected), encoding="utf-8")
    return "main.xml"


@pytest.mark.parametrize(
    ("expected", "words"),
    [
        ("&gt;= 0.9", "undecided under uniform choices, because it depends on the undecided traces"),
        ("&lt;= 0.9", "undecided under uniform choices, because it depends on the undecided traces"),
        ("== 1", "undecided under uniform choices, because it depends on the undecided traces"),
        ("== 0", "NOT MET"),
        ("&lt;= 0.01", "NOT MET"),
        ("&gt;= 0.01", "met"),
    ],
)
def test_an_expectation_is_undecided_if_open_traces_decide_it(
    command: Command, tmp_path: Path, expected: str, words: str
) -> None:
    done = command("verify", write(tmp_path, expected))
    line = next(line for line in done.out.splitlines() if line.startswith("  expected "))
    assert line.partition(": ")[2].startswith(words)
    assert done.status == (0 if words == "met" else 1)


def test_the_advice_does_not_go_in_a_circle(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path)
    by_default, exhaustive = command("verify", name).out, command("verify", name, "--exhaustive").out
    assert "too many states" not in by_default
    assert "help: use --exhaustive" not in by_default
    assert "--exhaustive does not decide these either" in by_default
    for text in (by_default, exhaustive):
        assert "raise max_time, which does not help where what starts the deadline keeps happening" in text
    assert "traces with uniform choices instead" not in exhaustive
    longer = command("verify", name, "--max-time", "1 min")
    assert (longer.status, "undecided" in longer.out) == (0, False)


def test_programs_get_the_same_verdict(command: Command, tmp_path: Path) -> None:
    name = write(tmp_path)
    (row,) = json.loads(command("verify", name, "--format", "json").out)["results"]
    assert (row["verdict"], row["expectations"][0]["open"]) == ("undecided", True)
    assert 'type="undecided"' in command("verify", name, "--format", "junit").out


@pytest.mark.parametrize(("time", "seconds"), [("1 h", 3600), ("2min", 120), ("4000 ms", 4)])
def test_times_have_all_units(command: Command, tmp_path: Path, time: str, seconds: int) -> None:
    done = command("verify", write(tmp_path), "--max-time", time)
    assert done.status in (0, 1), done.err
    assert (seconds < 10) is ("undecided" in done.out)

# SPDX-License-Identifier: Apache-2.0
"""`verify` warns about values that are correct, but say little about the system."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest
from command import Command

SYSTEM = """\
<roaml>
  <parameters><max_time value="20" unit="s" /></parameters>
  <node_models>
    <input type="node-ascxml" src="one.ascxml" />
    <input type="node-ascxml" src="two.ascxml" />
  </node_models>
  <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
"""
LEVEL = {
    "one.ascxml": """\
<ascxml name="Battery" version="1.0" initial="s">
  <datamodel><data id="level" type="int16" expr="100" /></datamodel>
  <ros_topic_publisher name="level" topic="/level" type="std_msgs/Int16" />
  <ros_time_rate name="tick" rate_hz="1" />
  <state id="s">
    <ros_rate_callback name="tick" target="s">
      <assign location="level" expr="level - 1" />
      <ros_topic_publish name="level"><field name="data" expr="level" /></ros_topic_publish>
    </ros_rate_callback>
  </state>
</ascxml>
""",
    "two.ascxml": """\
<ascxml name="Charger" version="1.0" initial="s">
  <ros_topic_subscriber name="level" topic="/level" type="std_msgs/Int16" />
  <state id="s"><ros_topic_callback name="level" target="s" /></state>
</ascxml>
""",
}
ECHO = """\
<ascxml name="{name}" version="1.0" initial="s">
  <ros_topic_publisher name="out" topic="/{out}" type="std_msgs/Int16" />
  <ros_topic_subscriber name="in" topic="/{into}" type="std_msgs/Int16" />
  {timer}
  <state id="s">
    {callback}
    <ros_topic_callback name="in" target="s">
      <ros_topic_publish name="out"><field name="data" expr="1" /></ros_topic_publish>
    </ros_topic_callback>
  </state>
</ascxml>
"""
ENDLESS = {
    "one.ascxml": ECHO.format(
        name="Ping",
        out="ping",
        into="pong",
        timer='<ros_time_rate name="tick" rate_hz="1" />',
        callback='<ros_rate_callback name="tick" target="s"><ros_topic_publish name="out">'
        '<field name="data" expr="1" /></ros_topic_publish></ros_rate_callback>',
    ),
    "two.ascxml": ECHO.format(name="Pong", out="pong", into="ping", timer="", callback=""),
}
CLIENT = """\
<ascxml name="{name}" version="1.0" initial="idle">
  <ros_service_client name="theirs" service_name="/{theirs}" type="std_srvs/Empty" />
  <ros_service_server name="own" service_name="/{own}" type="std_srvs/Empty" />
  <ros_topic_publisher name="done" topic="/{name}" type="std_msgs/Bool" />
  <ros_time_rate name="tick" rate_hz="1" />
  <state id="idle">
    <ros_rate_callback name="tick" target="waiting"><ros_service_send_request name="theirs" /></ros_rate_callback>
    <ros_service_handle_request name="own" target="idle"><ros_service_send_response name="own" />
    </ros_service_handle_request>
  </state>
  <state id="waiting">
    <ros_service_handle_response name="theirs" target="idle">
      <ros_topic_publish name="done"><field name="data" expr="true" /></ros_topic_publish>
    </ros_service_handle_response>
  </state>
</ascxml>
"""
STUCK = {
    "one.ascxml": CLIENT.format(name="A", own="a", theirs="b"),
    "two.ascxml": CLIENT.format(name="B", own="b", theirs="a"),
}


def write(folder: Path, files: dict[str, str], goal: Any) -> None:
    filtered = {"op": "filter", "fun": "values", "states": {"op": "initial"}}
    property_ = {"name": "p", "expression": {**filtered, "values": {"op": "Pmin", "exp": {"op": "F", "exp": goal}}}}
    texts = {**files, "main.xml": SYSTEM, "properties.jani": json.dumps({"properties": [property_]})}
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")


def low(limit: int) -> dict[str, Any]:
    return {"op": "<", "left": "topic_level_msg__ros_fields__data", "right": limit}


@pytest.mark.parametrize("options", [[], ["--exhaustive"], ["--method", "adaptive"]])
def test_a_property_that_the_initial_state_decides(command: Command, tmp_path: Path, options: list[str]) -> None:
    """The field is 0 before the first message."""
    write(tmp_path, LEVEL, low(30))
    done = command("verify", "main.xml", *options)
    assert (
        "  warning: the initial state decides the property, before any step; fields have default values until the "
        "first message, so the property may have to require `topic_level_msg.valid` as well\n"
    ) in done.out
    (row,) = json.loads(command("verify", "main.xml", *options, "--format", "json").out)["results"]
    assert row["warning"].startswith("the initial state decides the property")
    write(tmp_path, LEVEL, {"op": "∧", "left": "topic_level_msg.valid", "right": low(95)})
    assert "initial state decides" not in command("verify", "main.xml", *options).out


def test_a_property_that_checks_for_a_message_gets_no_advice(command: Command, tmp_path: Path) -> None:
    write(tmp_path, LEVEL, {"op": "∨", "left": "topic_level_msg.valid", "right": low(30)})
    assert "  warning: the initial state decides the property, before any step\n" in command("verify", "main.xml").out


@pytest.mark.parametrize("options", [[], ["--exhaustive"], ["--method", "adaptive"]])
def test_time_stops_while_machines_exchange_events(command: Command, tmp_path: Path, options: list[str]) -> None:
    write(tmp_path, ENDLESS, {"op": "=", "left": "topic_ping_msg__ros_fields__data", "right": 7})
    done = command("verify", "main.xml", *options)
    assert re.search(
        r"^  warning: time stops in 200 of 200 traces, in trace 0 at \d\.\d{3} s: `Pong` and `Ping` take steps for "
        "ever that need no time, so no timer ticks after that, and what has not happened by then never happens; let "
        "one of these steps wait for a timer, or for an event of another machine$",
        done.out,
        re.MULTILINE,
    )
    (row,) = json.loads(command("verify", "main.xml", *options, "--format", "json").out)["results"]
    assert row["warning"].startswith("time stops in 200 of 200 traces")


def test_a_simulation_ends_where_time_stops(command: Command, tmp_path: Path) -> None:
    write(tmp_path, ENDLESS, {"op": "=", "left": "topic_ping_msg__ros_fields__data", "right": 7})
    out = command("simulate", "main.xml").out
    assert re.search(
        r", 10,000 steps, \d s, time stops at \d s: `P.ng` and `P.ng` take steps for ever, so no timer ticks any more$",
        out,
        re.MULTILINE,
    )


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("Battery.level", "a property reads messages and events, not the variables of machines, such as "),
        ("Battery.level", "`topic_level_msg.valid` (true after the first one) and `topic_level_msg__ros_fields__data`"),
        ("topic_dock_msg.valid", "because nothing in the system sends a message on the topic `dock`"),
        ("topic_levl_msg.valid", "did you mean `topic_level_msg.valid`?"),
    ],
)
def test_a_property_with_an_unknown_variable(command: Command, tmp_path: Path, name: str, hint: str) -> None:
    write(tmp_path, LEVEL, low(30))
    done = command("verify", "main.xml", "--property", f"P=? [ F {name} ]")
    assert done.status == 2
    assert f"there is no variable `{name}`" in done.err
    assert hint in done.err


def test_endless_traces_are_not_said_to_be_missing(command: Command, tmp_path: Path) -> None:
    write(tmp_path, ENDLESS, {"op": "=", "left": "topic_ping_msg__ros_fields__data", "right": 7})
    done = command("verify", "main.xml", "--explain")
    assert (
        done.err == "p: every trace in which it fails repeats some states for ever, so none can be shown to its end\n"
    )


def test_all_states_show_that_the_system_gets_stuck(command: Command, tmp_path: Path) -> None:
    write(tmp_path, STUCK, {"op": "∧", "left": "topic_A_msg.valid", "right": "topic_B_msg.valid"})
    warning = (
        "the system can get stuck before the property is decided; what has not happened by then "
        "counts as never happening"
    )
    done = command("verify", "main.xml", "--exhaustive")
    assert done.status == 0
    assert f"  warning: {warning}; `verify` without --exhaustive shows where\n" in done.out
    done = command("verify", "main.xml", "--exhaustive", "--stuck", "error")
    assert done.status == 1
    assert f"  error: {warning}" in done.out
    (row,) = json.loads(command("verify", "main.xml", "--exhaustive", "--format", "json").out)["results"]
    assert row["warning"].startswith(warning)
    junit = ET.fromstring(command("verify", "main.xml", "--exhaustive", "--format", "junit").out)
    (shown,) = [p.get("value", "") for p in junit.iter("property") if p.get("name") == "warning"]
    assert shown.startswith(warning)
    assert "gets stuck" in command("verify", "main.xml").out
    assert "can get stuck" not in command("verify", "main.xml", "--exhaustive", "--property", "stuck").out

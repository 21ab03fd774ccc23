# SPDX-License-Identifier: Apache-2.0
"""Rules whose severity depends on the model; models without errors are translated."""

from __future__ import annotations

from pathlib import Path

import pytest

from checked import check_text
from fixture import split_files
from roaml import api
from roaml.diagnostics import Severity
from rule_files import cases_of_rules

SYSTEM = """
-- main.xml --
<roaml>
    <parameters><max_time value="5" unit="s" /></parameters>
    <node_models>
        <input type="node-ascxml" src="robot.ascxml" />
        <input type="node-ascxml" src="lamp.ascxml" />
    </node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- properties.jani --
{"properties": []}
-- lamp.ascxml --
<ascxml name="Lamp" version="1.0" initial="a">
    <ros_topic_publisher name="light" topic="/light" type="std_msgs/Bool" />
    <ros_time_rate name="second" rate_hz="1" />
    <state id="a">
        <ros_rate_callback name="second" target="a">
            <ros_topic_publish name="light"><field name="data" expr="true" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>
-- robot.ascxml --
<ascxml name="Robot" version="1.0" initial="a">
    <datamodel><data id="fast" type="bool" expr="false" /></datamodel>
    <ros_topic_subscriber name="input" topic="TOPIC" type="std_msgs/Bool" />
    <ros_topic_subscriber name="light" topic="/light" type="std_msgs/Bool" />
    <state id="a">
        <ros_topic_callback name="input" target="a"><assign location="fast" expr="_msg.data" /></ros_topic_callback>
        <ros_topic_callback name="light" target="TARGET"><log expr="fast" /></ros_topic_callback>
    </state>
    <state id="b">
        <ros_topic_callback name="input" target="a" />
    </state>
</ascxml>
"""


def check(folder: Path, topic: str, target: str) -> list[tuple[str, Severity]]:
    text = SYSTEM.replace("TOPIC", topic).replace("TARGET", target)
    diagnostics, _ = check_text(folder, text)
    return [(d.code, d.severity) for d in diagnostics if d.code in ("topic-without-publisher", "ignored-element")]


@pytest.mark.parametrize(
    ("topic", "target", "severity"),
    [
        pytest.param("/joystick", "a", Severity.WARNING, id="the node always has something else to do"),
        pytest.param("/joystick", "b", Severity.ERROR, id="the node waits for the message alone"),
        pytest.param("/lihgt", "a", Severity.ERROR, id="the name is like that of another topic"),
    ],
)
def test_topic_without_publisher(topic: str, target: str, severity: Severity, tmp_path: Path) -> None:
    rows = check(tmp_path, topic, target)
    assert rows == [("topic-without-publisher", severity), ("ignored-element", Severity.HINT)]


def test_what_is_a_warning_is_translated(tmp_path: Path) -> None:
    check(tmp_path, "/joystick", "a")
    system = api.load(str(tmp_path / "main.xml"))
    assert [automaton.name for automaton in api.to_jani(system).automata][:2] == ["Robot", "Lamp"]


def test_an_optional_input_is_marked_by_a_comment(tmp_path: Path) -> None:
    marked = '<!-- as2fm: ignore[topic-without-publisher] -->\n    <ros_topic_subscriber name="input"'
    text = SYSTEM.replace('<ros_topic_subscriber name="input"', marked)
    text = text.replace("TOPIC", "/joystick").replace("TARGET", "a")
    assert set(split_files(text)) == {"main.xml", "properties.jani", "lamp.ascxml", "robot.ascxml"}
    diagnostics, _ = check_text(tmp_path, text)
    assert {d.code for d in diagnostics} == {"unreachable-state", "unused-variable", "ignored-element"}


@pytest.mark.parametrize(
    ("start", "end", "flag", "count", "severity"),
    [
        ("closed", "open", "busy", "seconds", Severity.WARNING),
        ("closed", "emergency_stop", "has_failed", "floor", Severity.INFORMATION),
        ("waiting_for_light", "open", "ever_lit", "robot_x", Severity.INFORMATION),
        ("closed", "docked", "has_failed", "floor", Severity.INFORMATION),
    ],
)
def test_names_say_that_a_state_is_an_end_and_that_a_variable_keeps_its_value(
    start: str, end: str, flag: str, count: str, severity: Severity, tmp_path: Path
) -> None:
    text = SYSTEM[: SYSTEM.index("-- robot.ascxml")] + ROBOT
    for name, value in {"START": start, "END": end, "FLAG": flag, "COUNT": count}.items():
        text = text.replace(name, value)
    diagnostics, _ = check_text(tmp_path, text)
    rows = [(d.code, d.severity) for d in diagnostics if d.code in ("never-reset", "trapping-state")]
    assert sorted(rows) == [("never-reset", severity)] * 2 + [("trapping-state", severity)]


ROBOT = """
-- robot.ascxml --
<ascxml name="Robot" version="1.0" initial="START">
    <datamodel>
        <data id="FLAG" type="bool" expr="false" />
        <data id="COUNT" type="int32" expr="0" />
    </datamodel>
    <ros_topic_subscriber name="light" topic="/light" type="std_msgs/Bool" />
    <ros_time_rate name="second" rate_hz="1" />
    <state id="START">
        <ros_topic_callback name="light" cond="_msg.data" target="moving">
            <assign location="FLAG" expr="true" />
        </ros_topic_callback>
        <ros_topic_callback name="light" target="END" />
    </state>
    <state id="moving">
        <ros_rate_callback name="second" cond="COUNT == 5" target="START">
            <assign location="FLAG" expr="true" />
        </ros_rate_callback>
        <ros_rate_callback name="second" target="moving">
            <assign location="COUNT" expr="COUNT + 1" />
        </ros_rate_callback>
    </state>
    <state id="END">
        <ros_rate_callback name="second" target="END" />
    </state>
</ascxml>
"""


@pytest.mark.parametrize(
    ("declaration", "severity"),
    [
        ('<ros_time_rate name="t" rate_hz="1" />', Severity.ERROR),
        ('<ros_topic_publisher name="t" topic="/t" type="std_msgs/Empty" />', Severity.WARNING),
    ],
)
def test_only_timers_may_not_be_declared_twice_in_the_same_way(
    declaration: str, severity: Severity, tmp_path: Path
) -> None:
    text = f'<ascxml name="A" version="1.0" initial="a">{declaration * 2}<state id="a" /></ascxml>'
    diagnostics, _ = check_text(tmp_path, text)
    assert [d.severity for d in diagnostics if d.code == "duplicate-handle"] == [severity]


@pytest.mark.parametrize(
    ("number", "severity"),
    [("300", Severity.WARNING), (str(2**63 - 1), Severity.WARNING), (str(2**63), Severity.ERROR)],
)
def test_a_port_with_a_number_that_no_model_can_have(tmp_path: Path, number: str, severity: Severity) -> None:
    text = f"""
-- main.xml --
<roaml>
    <parameters><max_time value="5" unit="s" /><bt_tick_rate value="1.0" /></parameters>
    <behavior_tree tree-semantics="as2fm"><input type="bt.cpp-xml" src="tree.xml" /></behavior_tree>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- properties.jani --
{{"properties": []}}
-- tree.xml --
<root BTCPP_format="4">
    <BehaviorTree ID="Main"><Repeat num_cycles="{number}"><AlwaysSuccess /></Repeat></BehaviorTree>
</root>
"""
    diagnostics, _ = check_text(tmp_path, text)
    assert [(d.code, d.severity) for d in diagnostics] == [("port-value", severity)]


@pytest.mark.parametrize(
    ("value", "severity"),
    [("_msg.data", Severity.HINT), ("n + _msg.data", Severity.WARNING), ("_msg.data == 1 ? 1 : 2", Severity.WARNING)],
)
def test_a_variable_that_counts_and_is_never_read(value: str, severity: Severity, tmp_path: Path) -> None:
    text = f"""
-- main.xml --
<roaml>
    <parameters><max_time value="10" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="a.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- a.ascxml --
<ascxml name="A" version="1.0" initial="a">
    <datamodel><data id="n" type="int32" expr="0" /></datamodel>
    <ros_topic_subscriber name="t" topic="/t" type="std_msgs/Int32" />
    <state id="a">
        <ros_topic_callback name="t" target="a"><assign location="n" expr="{value}" /></ros_topic_callback>
    </state>
</ascxml>
-- properties.jani --
{{"properties": []}}
"""
    diagnostics, _ = check_text(tmp_path, text)
    assert [d.severity for d in diagnostics if d.code == "unused-variable"] == [severity]


def severities(folder: Path, text: str, code: str) -> list[Severity]:
    diagnostics, _ = check_text(folder, text)
    return [d.severity for d in diagnostics if d.code == code]


OVERWRITTEN = """
<ascxml name="M" version="1.0" initial="a">
    <datamodel><data id="x" type="int32" expr="0" /></datamodel>
    <state id="a"><onentry><assign location="x" expr="{}" /><assign location="x" expr="{}" /></onentry></state>
</ascxml>
"""


@pytest.mark.parametrize(
    ("first", "second", "severity"),
    [("0", "3", Severity.INFORMATION), ("1", "3", Severity.WARNING), ("0", "0", Severity.WARNING)],
)
def test_another_value_may_replace_the_initial_one(tmp_path: Path, first: str, second: str, severity: Severity) -> None:
    assert severities(tmp_path, OVERWRITTEN.format(first, second), "overwritten-value") == [severity]


MEETING = """
<root BTCPP_format="4"><BehaviorTree ID="A"><Sequence>
    <Look {0}="{{{0}}}" {1}="{{{1}}}"/><Meet robot_{0}="{{{0}}}" robot_{1}="{{{0}}}"/>
</Sequence></BehaviorTree></root>
"""


@pytest.mark.parametrize(
    ("names", "severity"), [(("place1", "place2"), Severity.INFORMATION), (("x", "y"), Severity.WARNING)]
)
def test_two_ports_may_get_the_same_of_several_numbered_entries(
    tmp_path: Path, names: tuple[str, str], severity: Severity
) -> None:
    assert severities(tmp_path, MEETING.format(*names), "copied-value") == [severity]


TWINS = """
-- main.xml --
<roaml>
    <parameters><max_time value="5" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="world.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- properties.jani --
{{"properties": []}}
-- world.ascxml --
<ascxml name="World" version="1.0" initial="a">
    <datamodel>
        <data id="place_id" type="int32" expr="0" />
        <data id="block_id" type="int32" expr="0" />
        <data id="at" type="int32" expr="0" />
    </datamodel>
    <ros_topic_subscriber name="go" topic="/go" type="std_msgs/Int32" />
    <ros_topic_subscriber name="pick" topic="/pick" type="std_msgs/Int32" />
    <state id="a">
        <ros_topic_callback name="go" target="a">
            <assign location="place_id" expr="_msg.data" />
            <assign location="at" expr="{}" />
        </ros_topic_callback>
        <ros_topic_callback name="pick" cond="at == block_id" target="a">
            <assign location="block_id" expr="_msg.data" />{}
        </ros_topic_callback>
    </state>
</ascxml>
"""


@pytest.mark.parametrize(
    ("read", "more", "expected"),
    [
        ("block_id", "", [Severity.WARNING]),
        ("place_id", "", []),
        ("block_id", '<assign location="place_id" expr="0" />', [Severity.HINT]),
    ],
)
def test_unread_data_beside_data_that_another_handler_receives(
    read: str, more: str, expected: list[Severity], tmp_path: Path
) -> None:
    assert severities(tmp_path, TWINS.format(read, more), "unused-variable") == expected


@pytest.mark.parametrize(
    ("title", "severity"),
    [
        ("a number that no request has, beside a limit", Severity.WARNING),
        ("a server that tests the range of what it receives, at information", Severity.INFORMATION),
    ],
)
def test_protection_against_wrong_requests(title: str, severity: Severity, tmp_path: Path) -> None:
    """A test of a range that all present clients keep to is no fault."""
    [case] = [case for case in cases_of_rules() if (case.subject, case.title) == ("constant-condition", title)]
    diagnostics, _ = check_text(tmp_path, case.text)
    assert {d.severity for d in diagnostics if d.code == "constant-condition"} == {severity}


ONCE = """
-- main.xml --
<roaml>
    <parameters><max_time value="5" unit="s" /></parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
        <input type="bt-plugin-ascxml" src="once.ascxml" />
    </behavior_tree>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- properties.jani --
{"properties": []}
-- tree.xml --
<root BTCPP_format="4"><BehaviorTree ID="Main"><Once><AlwaysSuccess /></Once></BehaviorTree></root>
-- once.ascxml --
<ascxml name="Once" version="1.0" initial="configured">
    <bt_declare_port_in key="CHILDREN_COUNT" type="int8" />
    <datamodel><data id="count" type="int8"><expr><bt_get_input key="CHILDREN_COUNT" /></expr></data></datamodel>
    <state id="configured"><transition cond="CONDITION" target="ready" /><transition target="wrong" /></state>
    <state id="wrong"><transition target="dead" /></state>
    <state id="dead" />
    <state id="ready">
        <bt_tick target="ticked"><bt_tick_child id="0" /></bt_tick>
        <bt_halt target="halting"><bt_halt_child id="0" /></bt_halt>
    </state>
    <state id="ticked">
        <bt_child_status id="0" cond="_bt.status == SUCCESS" target="ready">
            <bt_return_status status="SUCCESS" />
        </bt_child_status>
        <bt_child_status id="0" target="ready"><bt_return_status status="RUNNING" /></bt_child_status>
    </state>
    <state id="halting"><bt_child_halted id="0" target="ready"><bt_return_halted /></bt_child_halted></state>
</ascxml>
"""


@pytest.mark.parametrize(
    ("old", "new", "severity"),
    [
        pytest.param(
            "CONDITION", "count == 1", Severity.WARNING, id="a condition decides whether the state is entered"
        ),
        pytest.param('<transition cond="CONDITION" target="ready" />', "", Severity.ERROR, id="it is always entered"),
    ],
)
def test_a_tick_in_a_dead_state(old: str, new: str, severity: Severity, tmp_path: Path) -> None:
    diagnostics, _ = check_text(tmp_path, ONCE.replace(old, new))
    assert [d.severity for d in diagnostics if d.code == "unanswered-tick"] == [severity]


def test_a_halt_before_the_response(tmp_path: Path) -> None:
    """The response of a server that answers at once is there before the tree can halt the node."""
    case = next(c for c in cases_of_rules() if c.subject == "outstanding-response" and c.title == "a halt")
    slow = "\n".join(line for line in case.text.splitlines() if "^" not in line)
    at_once = slow.replace(
        'name="motor" target="ready"><ros_service_send_response name="open" /></ros_rate_callback>',
        'name="motor" target="opening" />',
    ).replace(
        'name="open" target="opening" />',
        'name="open" target="ready"><ros_service_send_response name="open" /></ros_service_handle_request>',
    )
    severities = {}
    for name, text in (("slow", slow), ("at once", at_once)):
        (tmp_path / name).mkdir()
        diagnostics, _ = check_text(tmp_path / name, text)
        severities[name] = [d.severity for d in diagnostics if d.code == "outstanding-response"]
    assert severities == {"slow": [Severity.WARNING], "at once": [Severity.INFORMATION]}

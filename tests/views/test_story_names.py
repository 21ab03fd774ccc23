# SPDX-License-Identifier: Apache-2.0
"""Stories contain the names that users have chosen for timers, clients and goals, not those of the translation."""

from __future__ import annotations

from pathlib import Path

from roaml import api
from roaml.scxml.names import InterfaceEvent, InterfaceEventKind, client_of, read_interface_event
from roaml.verification.counterexample import counterexample
from roaml.views.event_words import event_phrase, goal_phrases

ACTION = 'name="drive" action_name="/arm/drive" type="example_interfaces/Fibonacci"'
FILES = {
    "main.xml": """<roaml>
    <parameters><max_time value="5" unit="s" /></parameters>
    <node_models>
        <input type="node-ascxml" src="operator.ascxml" />
        <input type="node-ascxml" src="robot.ascxml" />
    </node_models>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>""",
    "operator.ascxml": f"""<ascxml name="Operator 1" version="1.0" initial="starting">
    <ros_action_client {ACTION} />
    <ros_time_rate name="second" rate_hz="1" />
    <state id="starting">
        <transition target="asking">
            <ros_action_send_goal name="drive"><field name="order" expr="1" /></ros_action_send_goal>
        </transition>
    </state>
    <state id="asking"><ros_action_handle_goal_response name="drive" accept="waiting" reject="done" /></state>
    <state id="waiting">
        <ros_rate_callback name="second" target="stopping"><ros_action_cancel_goal name="drive" /></ros_rate_callback>
    </state>
    <state id="stopping"><ros_action_handle_canceled_result name="drive" target="done" /></state>
    <state id="done" />
</ascxml>""",
    "robot.ascxml": f"""<ascxml name="Robot" version="1.0" initial="standing">
    <datamodel>
        <data id="goal" type="int32" expr="0" />
        <data id="executes_second_0" type="int32" expr="0" />
    </datamodel>
    <ros_action_server {ACTION} />
    <ros_topic_publisher name="beat" topic="/beat" type="std_msgs/Empty" />
    <ros_time_rate name="second" rate_hz="1" />
    <state id="standing">
        <ros_action_handle_goal name="drive" target="driving">
            <assign location="goal" expr="_action.goal_id" />
            <ros_action_accept_goal name="drive" goal_id="goal" />
        </ros_action_handle_goal>
    </state>
    <state id="driving">
        <ros_rate_callback name="second" target="driving">
            <assign location="executes_second_0" expr="executes_second_0 + 1" />
            <ros_topic_publish name="beat" />
        </ros_rate_callback>
        <ros_action_handle_cancel_goal name="drive" target="standing">
            <ros_action_canceled name="drive" goal_id="goal" />
        </ros_action_handle_cancel_goal>
    </state>
</ascxml>""",
    "properties.xml": f"""<properties>
    <ports>
        <ros_action {ACTION.replace('name="drive" ', "")} event="result"><event_var id="result" /></ros_action>
        <ros_topic topic_name="/beat" type="std_msgs/Empty" event="publish"><event_var id="beat" /></ros_topic>
    </ports>
    <guarantees>
        <property id="no_result" pattern="absence"><event>result</event><scope type="globally" /></property>
        <property id="no_beat" pattern="absence"><event>beat</event><scope type="globally" /></property>
    </guarantees>
</properties>""",
}


def story(folder: Path, name: str) -> list[str]:
    """The lines and details of the shortest trace in which a property fails."""
    for file, text in FILES.items():
        (folder / file).write_text(text, encoding="utf-8")
    options = api.Options(method=api.EstimationMethod.FIXED, max_traces=20)
    (result,) = api.verify(api.load(str(folder / "main.xml")), [name], options, only_uniform=True)
    failed = counterexample(result)
    assert failed is not None
    return [text for line in failed.lines for text in (f"{line.who} {line.what}", *line.details)]


def test_a_timer_has_its_handle(tmp_path: Path) -> None:
    lines = story(tmp_path, "no_result")
    assert "Operator 1 receives the tick of its timer `second` in waiting → stopping" in lines
    assert not [line for line in lines if "ros_time_rate" in line]


def test_a_server_executes_a_goal(tmp_path: Path) -> None:
    """A variable of the machine with a similar name keeps its name."""
    lines = story(tmp_path, "no_result")
    assert "executes goal 0 of /arm/drive: false → true" in lines
    assert "executes goal 0 of /arm/drive: true → false" in lines
    assert "executes_second_0: 0 → 1" in story(tmp_path, "no_beat")


def test_a_variable_of_the_machine_with_the_name_of_the_translation() -> None:
    variables = ["executes_drive_0", "executes_drive_0_", "executes_other_0", "goal"]
    assert goal_phrases(variables, {"cancel_action_drive"}.__contains__) == {
        "executes_drive_0_": "executes goal 0 of /drive"
    }


def test_a_client_has_its_name(tmp_path: Path) -> None:
    """Events contain the names of clients without characters that are not allowed there."""
    lines = story(tmp_path, "no_result")
    assert any(line.startswith("sends action_arm__drive_goal_req(") for line in lines)
    assert not [line for line in lines if "Operator_1" in line]
    event = "action_arm__drive_goal_req_client_Operator_1"
    goal = InterfaceEvent(InterfaceEventKind.GOAL, "arm__drive")
    assert read_interface_event(event, {"Robot", "Operator 1"}) == goal
    assert read_interface_event(event, {"Operator_1"}) == goal
    assert event_phrase(event, ["Operator 1"]) == "a goal of the action `/arm/drive`"


def test_an_interface_and_a_client_contain_the_separator() -> None:
    event = "srv_a_client_b_req_client_x_client_y"
    assert client_of(event, ["y", "x client y"]) == "x client y"
    request = InterfaceEvent(InterfaceEventKind.REQUEST, "a_client_b")
    assert read_interface_event(event, ["y", "x client y"]) == request
    assert client_of("srv_a_client_b_request", ["b"]) == ""

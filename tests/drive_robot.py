# SPDX-License-Identifier: Apache-2.0
"""A robot that executes goals of an action, and an operator that cancels them; with properties in XML."""

from __future__ import annotations

from pathlib import Path

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


def written(folder: Path) -> Path:
    """Write the files into a folder; return the system file."""
    for file, text in FILES.items():
        (folder / file).write_text(text, encoding="utf-8")
    return folder / "main.xml"

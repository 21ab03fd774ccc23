# SPDX-License-Identifier: Apache-2.0
"""Models in the older dialect leave fields out: these are sent with the defaults of ROS
(docs/spec/files.md#dialects)."""

from __future__ import annotations

import re

from translating import loaded, translated

from fixture import split_files
from roaml import api
from roaml.jani.typecheck import check_model
from roaml.jani.writer import write

FILES = split_files("""\
-- main.xml --
<convince_mc_tc>
    <mc_parameters><max_time value="9" unit="s" /><max_array_size value="4" /></mc_parameters>
    <node_models>
        <input type="ros-scxml" src="a.scxml" />
        <input type="ros-scxml" src="b.scxml" />
    </node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</convince_mc_tc>
-- a.scxml --
<scxml name="a" version="1.0" initial="s">
    <datamodel><data id="told" type="bool" expr="true" /></datamodel>
    <ros_time_rate name="t" rate_hz="1" />
    <ros_topic_publisher name="level" topic="level" type="std_msgs/Int32" />
    <ros_topic_publisher name="scan" topic="scan" type="sensor_msgs/JointState" />
    <ros_service_client name="lamp" service_name="/lamp" type="std_srvs/SetBool" />
    <state id="s">
        <ros_rate_callback name="t" target="s">
            <ros_topic_publish name="level"><field name="data" expr="0" /></ros_topic_publish>
            <ros_service_send_request name="lamp"><field name="data" expr="false" /></ros_service_send_request>
        </ros_rate_callback>
        <ros_service_handle_response name="lamp" target="s">
            <assign location="told" expr="_res.success" />
        </ros_service_handle_response>
    </state>
</scxml>
-- b.scxml --
<scxml name="b" version="1.0" initial="s">
    <datamodel><data id="n" type="int32" expr="7" /><data id="on" type="bool" expr="true" /></datamodel>
    <ros_topic_subscriber name="level" topic="level" type="std_msgs/Int32" />
    <ros_service_server name="lamp" service_name="/lamp" type="std_srvs/SetBool" />
    <state id="s">
        <ros_topic_callback name="level" target="s"><assign location="n" expr="_msg.data" /></ros_topic_callback>
        <ros_service_handle_request name="lamp" target="s">
            <assign location="on" expr="_req.data" />
            <ros_service_send_response name="lamp">
                <field name="success" expr="false" />
                <field name="message" expr="''" />
            </ros_service_send_response>
        </ros_service_handle_request>
    </state>
</scxml>
-- properties.jani --
{"properties": [{"name": "p", "expression": {"op": "filter", "fun": "values", "states": {"op": "initial"}, "values":
    {"op": "Pmin", "exp": {"op": "F", "exp": {"op": "=", "left": "topic_level_msg__ros_fields__data", "right": 0}}}}}]}
""")


def without_fields(text: str) -> str:
    return re.sub(r"<field [^>]*>", "", text)


def test_fields_that_are_not_set_have_their_defaults() -> None:
    model = translated({name: without_fields(text) for name, text in FILES.items()})
    assert check_model(model) == ()
    assert list(write(model)) == list(write(translated(FILES)))


def test_defaults_of_every_kind() -> None:
    publish = '<ros_topic_publish name="scan" />'
    a = FILES["a.scxml"].replace('<ros_topic_publish name="level">', f'{publish}<ros_topic_publish name="level">')
    system = loaded({**FILES, "a.scxml": a})
    model = api.to_jani(system)
    assert check_model(model) == ()
    names = {variable.name for variable in model.variables}
    assert set(system.analysis.globals(system.path)) == names
    sent = {name.removeprefix("topic_scan_msg__ros_fields__") for name in names if name.startswith("topic_scan_msg__")}
    assert {"header__stamp__sec", "header__stamp__nanosec", "position", "position.d1_len"} <= sent

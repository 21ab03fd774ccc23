# SPDX-License-Identifier: Apache-2.0
"""Models for tests of the editor's features, written as one string (`fixture.split_files`)."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from fixture import split_files
from marked import Case
from roaml import api
from roaml.ide.names.occurrence import Access, Occurrence
from roaml.project.analysis import Analysis
from roaml.project.explored_findings import CODES
from roaml.project.settings import Settings

WORDS = {Access.TEXT: "names", Access.READ: "reads", Access.WRITE: "writes"}


def system_file(*inputs: str) -> str:
    """A system file; each input is `SECTION TYPE SRC`."""
    sections: dict[str, list[str]] = {}
    for section, type_, src in map(str.split, inputs):
        sections.setdefault(section, []).append(f'<input type="{type_}" src="{src}"/>')
    body = "".join(f"<{name}>{''.join(texts)}</{name}>" for name, texts in sections.items())
    return f'<roaml><parameters><max_time value="1" unit="s"/></parameters>{body}</roaml>'


def load(folder: Path, files: dict[str, str]) -> Analysis:
    """Write files and analyse the folder."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="")
    return api.check([str(folder)], settings=Settings(ignore=CODES)).snapshot.analysis


def load_marked(folder: Path, written: str) -> tuple[Analysis, dict[str, Case]]:
    """Files with carets below their lines."""
    cases = {name: Case(text) for name, text in split_files(written).items()}
    return load(folder, {name: case.text for name, case in cases.items()}), cases


def found(occurrences: Iterable[Occurrence]) -> list[tuple[int, int, str]]:
    """Occurrences in the form of `Case.found`."""
    return sorted((occurrence.span.start, occurrence.span.end, _words(occurrence)) for occurrence in occurrences)


def _words(occurrence: Occurrence) -> str:
    verb = "defines" if occurrence.defines else WORDS[occurrence.access]
    scope = f" in {occurrence.symbol.scope}" if occurrence.symbol.scope else ""
    return f"{verb} {occurrence.symbol.kind.value} {occurrence.symbol.name}{scope}"


ROBOT = (
    "-- main.xml --\n"
    + system_file(
        "data_declarations xml types.xml",
        "behavior_tree bt.cpp-xml tree.xml",
        "behavior_tree bt-plugin-ascxml plugin.ascxml",
        "node_models node-ascxml a.ascxml",
        "properties jani properties.jani",
    )
    + """
-- types.xml --
<types><struct id="Pose"><member id="x" type="float64"/></struct></types>
-- a.ascxml --
<ascxml name="A" version="1.0" initial="s">
  <datamodel><data id="p" type="Pose" expr="{'x': 1.0}"/><data id="n" type="int32" expr="0"/></datamodel>
  <ros_topic_subscriber name="input" topic="/a/b" type="std_msgs/Int32"/>
  <state id="s">
    <onentry><send event="go"><param name="to" expr="p"/></send></onentry>
    <transition event="go" target="s"><assign location="p.x" expr="_event.data.to.x"/></transition>
    <ros_topic_callback name="input" target="s"><assign location="n" expr="_msg.data"/></ros_topic_callback>
  </state>
</ascxml>
-- plugin.ascxml --
<ascxml name="Walk" version="1.0" initial="s">
  <bt_declare_port_in key="goal" type="int32"/>
  <bt_declare_port_in key="topic" type="string"/>
  <bt_declare_port_out key="out" type="int32"/>
  <datamodel><data id="n" type="int32" expr="0"/></datamodel>
  <ros_topic_publisher name="pub" type="std_msgs/Int32"><topic><bt_get_input key="topic"/></topic></ros_topic_publisher>
  <state id="s">
    <bt_tick target="s">
      <assign location="n"><expr><bt_get_input key="goal"/></expr></assign>
      <bt_set_output key="out" expr="n"/>
      <ros_topic_publish name="pub"><field name="data" expr="n"/></ros_topic_publish>
      <bt_return_status status="SUCCESS"/>
    </bt_tick>
    <bt_halt target="s"><bt_return_halted/></bt_halt>
  </state>
</ascxml>
-- tree.xml --
<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Sequence>
      <!-- Twice: here, and as a part of another tree. -->
      <Walk goal="{g}" out="{g}" topic=" /a/b "/>
      <SubTree ID="Sub" t="/c" g="{g}" _autoremap="true"/>
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Sub">
    <Action ID="Walk" name="w" goal="{g}" out="{own}" topic="{t}"/>
  </BehaviorTree>
</root>
-- properties.jani --
{"properties": [{"name": "p", "expression": {"op": "∧", "left": "go.valid", "right":
  {"op": "<", "left": "go__to__x", "right": {"op": "+", "left": "topic_a__b_msg__ros_fields__data", "right":
  {"op": "+", "left": "bt_blackboard_get__Sub__own", "right": "bt_blackboard_set_g__value"}}}}}]}
"""
)


CORNERS = (
    "-- main.xml --\n"
    + system_file(
        "data_declarations json shape.json",
        "behavior_tree bt.cpp-xml tree.xml",
        "behavior_tree bt-plugin-ascxml put.ascxml",
        "behavior_tree bt-plugin-ascxml ask.ascxml",
        "node_models node-ascxml server.ascxml",
        "properties jani properties.jani",
    )
    + """
-- shape.json --
{"type": "object", "title": "Shape", "properties": {
  "at": {"type": "object", "properties": {"x": {"type": "number"}}},
  "ends": {"type": "array", "items": {"$ref": "#/$defs/End"}}},
 "$defs": {"End": {"type": "object", "properties": {"k": {"type": "integer"}}}}}
-- put.ascxml --
<ascxml name="Put" version="1.0" initial="s">
  <bt_declare_port_in key="value" type="int32"/>
  <bt_declare_port_out key="to" type="int32"/>
  <datamodel><data id="n" type="int32" expr="0"/></datamodel>
  <state id="s">
    <bt_tick target="s">
      <assign location="n"><expr><bt_get_input key="value"/></expr></assign>
      <bt_set_output key="to" expr="n"/>
      <bt_return_status status="SUCCESS"/>
    </bt_tick>
    <bt_halt target="s"><bt_return_halted/></bt_halt>
  </state>
</ascxml>
-- ask.ascxml --
<ascxml name="Ask" version="1.0" initial="s">
  <bt_declare_port_in key="which" type="string"/>
  <ros_service_client name="calc" type="example_interfaces/AddTwoInts">
    <service_name><bt_get_input key="which"/></service_name>
  </ros_service_client>
  <state id="s">
    <bt_tick target="w">
      <ros_service_send_request name="calc">
        <field name="a" expr="1"/><field name="b" expr="2"/>
      </ros_service_send_request>
    </bt_tick>
    <bt_halt target="s"><bt_return_halted/></bt_halt>
  </state>
  <state id="w">
    <ros_service_handle_response name="calc" target="s">
      <bt_return_status status="SUCCESS"/>
    </ros_service_handle_response>
  </state>
</ascxml>
-- server.ascxml --
<ascxml name="Server" version="1.0" initial="idle">
  <datamodel>
    <!-- the sum, TYPE sum:int64 -->
    <data id="sum" expr="0"/>
    <data id="shape" type="Shape" expr="{'at': {'x': 1.0}, 'ends': [{'k': 1}]}"/>
  </datamodel>
  <ros_service_server service_name="/calc" type="example_interfaces/AddTwoInts"/>
  <state id="idle">
    <ros_service_handle_request name="/calc" target="idle">
      <assign location="sum" expr="_req.a + _req.b"/>
      <assign location="shape.ends[0].k" expr="shape.ends[0].k + 1"/>
      <if cond="sum &lt; 3 &amp;&amp; shape.at.x &gt; 0.5">
        <send event="small.sum"><param name="of" expr="shape"/><param name="n" expr="sum"/></send>
      </if>
      <ros_service_send_response name="/calc"><field name="sum" expr="sum"/></ros_service_send_response>
    </ros_service_handle_request>
    <transition event="small.sum" cond="_event.data.of.at.x &gt; 0.0 &amp;&amp; _event.data.n &gt; 0" target="idle"/>
  </state>
</ascxml>
-- tree.xml --
<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Sequence>
      <Put value="1" to="{v}"/>
      <SubTree ID="Auto" _autoremap="true"/>
      <SubTree ID="Same" v="{=}" service="/calc"/>
      <SubTree ID="Same" name="again" v="{v}" service="/calc"/>
      <SubTree ID="Same" name="third" v="{w}" service="/calc"/>
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Auto"><Sequence><Put to="{own}"/><Put value="{own}" to="{v}"/></Sequence></BehaviorTree>
  <BehaviorTree ID="Same">
    <Sequence><Put value="{v}" to="{inner}"/><Put value="{inner}" to="{v}"/><Ask which="{service}"/></Sequence>
  </BehaviorTree>
  <TreeNodesModel>
    <Action ID="Put"><input_port name="value" default="{own}"/><output_port name="to"/></Action>
    <Action ID="Ask"><input_port name="which"/></Action>
    <SubTree ID="Same"><input_port name="v"/></SubTree>
  </TreeNodesModel>
</root>
-- properties.jani --
{"properties": [{"name": "p", "expression": {"op": "filter", "fun": "values", "states": {"op": "initial"}, "values":
  {"op": "Pmin", "exp": {"op": "F", "exp": {"op": "∧", "left": "srv_calc_response.valid", "right": {"op": "∧",
  "left": {"op": ">", "left": "srv_calc_req_client_BT_plugin_1016_Ask__ros_fields__a", "right": 0}, "right": {"op": "∧",
  "left": {"op": ">", "left": "small.sum__of__at__x", "right": 0}, "right":
  {"op": ">", "left": "bt_blackboard_get__again__inner", "right": "bt_blackboard_set_v__value"}}}}}}}}]}
"""
)

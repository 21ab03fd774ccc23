# SPDX-License-Identifier: Apache-2.0
"""A system whose property file in XML has ports of every kind."""

from __future__ import annotations

PROPERTIES = """\
<properties>
  <ports>
    <ros_topic topic_name="/battery/level" type="std_msgs/Int32" event="publish">
      <state_var id="level" type="int32" field="data" expr="100"/>
      <event_var id="measured"/>
    </ros_topic>
    <ros_topic topic_name="/pose" type="std_msgs/Header" event="publish">
      <state_var id="x" type="int32" field="stamp.sec" expr="0"/>
    </ros_topic>
    <ros_service service_name="/charge" type="std_srvs/SetBool" event="request" origin="Battery">
      <event_var id="asked"/>
    </ros_service>
    <ros_service service_name="/charge" type="std_srvs/SetBool" event="response" target="Battery">
      <event_var id="answered"/>
      <state_var id="success" type="bool" field="success" expr="false"/>
    </ros_service>
    <ros_action action_name="/count" type="example_interfaces/Fibonacci" event="goal_response" target="right_pick">
      <goal_id id="goal" expr="0"/>
      <accepted id="taken" expr="false"/>
    </ros_action>
    <ros_action action_name="/count" type="example_interfaces/Fibonacci" event="result">
      <result_code id="code" expr="0"/>
      <event_var id="counted"/>
    </ros_action>
    <bt_node node="Left/pick" event="response">
      <state_var id="status" type="int32" field="status" expr="0"/>
      <event_var id="picked"/>
    </bt_node>
    <bt_node node="Main/Other/right_pick" event="tick">
      <event_var id="ticked"/>
    </bt_node>
    <scxml_event_send event="full">
      <state_var id="amount" type="int32" param="amount" expr="0"/>
      <event_var id="filled"/>
    </scxml_event_send>
    <scxml_event_send event="topic_battery__level_msg">
      <state_var id="again" type="int32" param="ros_fields__data" expr="0"/>
    </scxml_event_send>
  </ports>
  <guarantees>
    <property id="charges" pattern="response">
      <events><event>level &lt; 30</event><event>asked</event></events>
      <scope type="globally"/>
      <time_interval within="10" time_unit="s"/>
    </property>
    <property id="polite" pattern="precedence">
      <events><event>asked</event><event>answered</event></events>
      <scope type="after" event="filled || amount &gt; 3"/>
    </property>
    <property id="counts" pattern="existence">
      <event>counted &amp;&amp; code == 4 &amp;&amp; taken &amp;&amp; goal == 0</event>
      <scope type="between" event="ticked" until="picked &amp;&amp; status == 1"/>
    </property>
    <property id="steady" logic="pmtl" expr="H ({ measured } -&gt; O[:3] { success || x &gt; 1 || again == 3 })"/>
  </guarantees>
</properties>
"""

ROBOT = f"""\
-- main.xml --
<roaml>
  <parameters><max_time value="20" unit="s"/><bt_tick_rate value="2"/></parameters>
  <behavior_tree>
    <input type="bt.cpp-xml" src="tree.xml"/>
    <input type="bt-plugin-ascxml" src="pick.ascxml"/>
  </behavior_tree>
  <node_models>
    <input type="node-ascxml" src="battery.ascxml"/>
    <input type="node-ascxml" src="charger.ascxml"/>
    <input type="node-ascxml" src="arm.ascxml"/>
  </node_models>
  <properties>
    <input type="xml" src="properties.xml"/>
    <input type="jani" src="more.jani"/>
  </properties>
</roaml>
-- tree.xml --
<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <KeepRunningUntilFailure>
      <Sequence>
        <SubTree ID="Fetch" name="Left"/>
        <SubTree ID="Other"/>
      </Sequence>
    </KeepRunningUntilFailure>
  </BehaviorTree>
  <BehaviorTree ID="Fetch"><Sequence name="steps"><Pick name="pick"/></Sequence></BehaviorTree>
  <BehaviorTree ID="Other">
    <Sequence><SubTree ID="Fetch" name="again"/><Pick name="right_pick"/></Sequence>
  </BehaviorTree>
</root>
-- pick.ascxml --
<ascxml name="Pick" version="1.0" initial="ready">
  <ros_action_client name="count" action_name="/count" type="example_interfaces/Fibonacci"/>
  <state id="ready">
    <bt_tick target="asked"><ros_action_send_goal name="count"><field name="order" expr="1"/></ros_action_send_goal>
    </bt_tick>
    <bt_halt target="ready"><bt_return_halted/></bt_halt>
  </state>
  <state id="asked">
    <ros_action_handle_goal_response name="count" accept="counting" reject="rejected"/>
  </state>
  <state id="rejected"><transition target="ready"><bt_return_status status="FAILURE"/></transition></state>
  <state id="counting">
    <ros_action_handle_success_result name="count" target="ready"><bt_return_status status="SUCCESS"/>
    </ros_action_handle_success_result>
  </state>
</ascxml>
-- battery.ascxml --
<ascxml name="Battery" version="1.0" initial="drain">
  <datamodel><data id="level" type="int32" expr="40"/></datamodel>
  <ros_time_rate name="step" rate_hz="1"/>
  <ros_topic_publisher name="level" topic="/battery/level" type="std_msgs/Int32"/>
  <ros_service_client name="charge" service_name="/charge" type="std_srvs/SetBool"/>
  <state id="drain">
    <ros_rate_callback name="step" cond="level &gt; 25" target="drain">
      <assign location="level" expr="level - 5"/>
      <ros_topic_publish name="level"><field name="data" expr="level"/></ros_topic_publish>
    </ros_rate_callback>
    <ros_rate_callback name="step" target="waiting">
      <ros_service_send_request name="charge"><field name="data" expr="true"/></ros_service_send_request>
    </ros_rate_callback>
  </state>
  <state id="waiting">
    <ros_service_handle_response name="charge" target="drain">
      <assign location="level" expr="40"/><send event="full"><param name="amount" expr="level"/></send>
    </ros_service_handle_response>
  </state>
</ascxml>
-- arm.ascxml --
<ascxml name="Arm" version="1.0" initial="ready">
  <datamodel><data id="goal" type="int32" expr="0"/></datamodel>
  <ros_action_server name="count" action_name="/count" type="example_interfaces/Fibonacci"/>
  <ros_topic_publisher name="pose" topic="/pose" type="std_msgs/Header"/>
  <state id="ready">
    <ros_action_handle_goal name="count" target="moving">
      <assign location="goal" expr="_action.goal_id"/><ros_action_accept_goal name="count" goal_id="goal"/>
    </ros_action_handle_goal>
  </state>
  <state id="moving">
    <transition target="ready">
      <ros_topic_publish name="pose">
        <field name="stamp.sec" expr="2"/><field name="stamp.nanosec" expr="0"/><field name="frame_id" expr="''"/>
      </ros_topic_publish>
      <ros_action_succeed name="count" goal_id="goal"><field name="sequence" expr="[]"/></ros_action_succeed>
    </transition>
  </state>
</ascxml>
-- charger.ascxml --
<ascxml name="Charger" version="1.0" initial="idle">
  <ros_service_server name="charge" service_name="/charge" type="std_srvs/SetBool"/>
  <state id="idle">
    <ros_service_handle_request name="charge" target="idle">
      <ros_service_send_response name="charge">
        <field name="success" expr="true"/><field name="message" expr="''"/>
      </ros_service_send_response>
    </ros_service_handle_request>
    <transition event="full" target="idle"/>
  </state>
</ascxml>
-- more.jani --
{{"properties": [{{"name": "fills", "expression": {{"op": "filter", "fun": "values", "states": {{"op": "initial"}},
  "values": {{"op": "Pmin", "exp": {{"op": "F", "exp": {{"op": "∧", "left": "full.valid",
    "right": {{"op": "=", "left": "bt_1003_response__status", "right": 1}}}}}}}}}}}}]}}
-- properties.xml --
{PROPERTIES}"""

# SPDX-License-Identifier: Apache-2.0
"""Models for the benchmark `asked`: a robot whose action server may be delayed, and a model whose traces are often
cut."""

from __future__ import annotations

import json

ACTION = """\
-- main.xml --
<roaml>
  <parameters><max_time value="20" unit="s"/></parameters>
  <node_models>
    <input type="node-ascxml" src="client.ascxml"/>
    <input type="node-ascxml" src="arm.ascxml"/>
  </node_models>
  <properties><input type="xml" src="properties.xml"/></properties>
</roaml>
-- client.ascxml --
<ascxml name="Client" version="1.0" initial="idle">
  <ros_time_rate name="step" rate_hz="1"/>
  <ros_action_client name="count" action_name="/count" type="example_interfaces/Fibonacci"/>
  <state id="idle">
    <ros_rate_callback name="step" target="waiting">
      <ros_action_send_goal name="count"><field name="order" expr="1"/></ros_action_send_goal>
    </ros_rate_callback>
  </state>
  <state id="waiting">
    <ros_action_handle_goal_response name="count" accept="counting" reject="idle"/>
    <ros_rate_callback name="step" target="waiting"/>
  </state>
  <state id="counting">
    <ros_action_handle_success_result name="count" target="done"/>
    <ros_rate_callback name="step" target="counting"/>
  </state>
  <state id="done"/>
</ascxml>
-- arm.ascxml --
<ascxml name="Arm" version="1.0" initial="ready">
  <datamodel><data id="goal" type="int32" expr="0"/></datamodel>
  <ros_action_server name="count" action_name="/count" type="example_interfaces/Fibonacci"/>
  <state id="ready">
    <ros_action_handle_goal name="count" target="moving">
      <assign location="goal" expr="_action.goal_id"/><ros_action_accept_goal name="count" goal_id="goal"/>
    </ros_action_handle_goal>
  </state>
  <state id="moving">
    <transition target="ready">
      <ros_action_succeed name="count" goal_id="goal"><field name="sequence" expr="[]"/></ros_action_succeed>
    </transition>
  </state>
</ascxml>
-- properties.xml --
<properties>
  <ports>
    <ros_action action_name="/count" type="example_interfaces/Fibonacci" event="result">
      <event_var id="counted"/>
    </ros_action>
  </ports>
  <guarantees>
    <property id="result" pattern="existence">
      <event>counted</event><scope type="globally"/><time_interval within="5" time_unit="s"/>
    </property>
  </guarantees>
</properties>
"""
"""The end of the action may be delayed for more than 5 s, unless machines react at once."""

_COUNT = {"op": "+", "left": "n", "right": 1}
CUT = json.dumps(
    {
        "jani-version": 1,
        "name": "cut",
        "type": "dtmc",
        "variables": [
            {"name": "done", "type": "bool", "initial-value": False},
            {
                "name": "n",
                "type": {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 99},
                "initial-value": 0,
            },
        ],
        "automata": [
            {
                "name": "a",
                "locations": [{"name": "begin"}, {"name": "wait"}, {"name": "end"}],
                "initial-locations": ["begin"],
                "edges": [
                    {
                        "location": "begin",
                        "destinations": [
                            {
                                "location": "end",
                                "probability": {"exp": 0.22},
                                "assignments": [{"ref": "done", "value": True}],
                            },
                            {"location": "wait", "probability": {"exp": 0.78}},
                        ],
                    },
                    {
                        "location": "wait",
                        "guard": {"exp": {"op": "<", "left": "n", "right": 99}},
                        "destinations": [{"location": "wait", "assignments": [{"ref": "n", "value": _COUNT}]}],
                    },
                ],
            }
        ],
        "system": {"elements": [{"automaton": "a"}]},
        "properties": [
            {
                "name": "done",
                "expression": {
                    "op": "filter",
                    "fun": "values",
                    "states": {"op": "initial"},
                    "values": {"op": "Pmin", "exp": {"op": "F", "exp": {"op": "=", "left": "done", "right": True}}},
                },
            }
        ],
    }
)
"""22 of 100 traces with the seed 7 pass, and the others are longer than 50 steps."""

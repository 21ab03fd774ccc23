# SPDX-License-Identifier: Apache-2.0
"""Generates systems of any size without findings. Equal arguments give equal systems.

`write_system` writes a ring of machines. Each publishes on its own topics and subscribes to those of its neighbours,
serves one service and calls another one, sends plain events, and computes with structs and arrays. The length of the
first machine is given.
"""

from __future__ import annotations

from pathlib import Path

FIRST = "machine_0.ascxml"
"""The name of the long machine."""

_SHARED_FILES = 3
"""`main.xml`, `types.xml` and `properties.jani`."""


def write_system(folder: Path, files: int = 30, lines: int = 700, small_lines: int = 120) -> Path:
    """Write a system with a given number of files; return its system file. `FIRST` has about `lines` lines, the others
    have `small_lines`."""
    folder.mkdir(parents=True, exist_ok=True)
    machines = files - _SHARED_FILES
    for number in range(machines):
        text = machine(number, machines, lines if number == 0 else small_lines)
        (folder / f"machine_{number}.ascxml").write_text(text, encoding="utf-8")
    (folder / "types.xml").write_text(TYPES, encoding="utf-8")
    (folder / "properties.jani").write_text(properties(machines), encoding="utf-8")
    main = folder / "main.xml"
    main.write_text(system(machines), encoding="utf-8")
    return main


def machine(number: int, machines: int, lines: int) -> str:
    """One machine of the ring."""
    before, after = (number - 1) % machines, (number + 1) % machines
    head = declarations(number, before, after)
    height = state(0, 0, number, before).count("\n")
    count = max(2, round((lines - head.count("\n")) / height))
    states = "".join(state(i, (i + 1) % count, number, before) for i in range(count))
    return f"{head}{states}</ascxml>\n"


def system(machines: int) -> str:
    inputs = "\n".join(f'        <input type="node-ascxml" src="machine_{n}.ascxml" />' for n in range(machines))
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<roaml>
    <parameters>
        <max_time value="100" unit="s" />
        <max_array_size value="10" />
    </parameters>
    <data_declarations>
        <input type="xml" src="types.xml" />
    </data_declarations>
    <node_models>
{inputs}
    </node_models>
    <properties>
        <input type="jani" src="properties.jani" />
    </properties>
</roaml>
"""


TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<types>
    <struct id="Pose">
        <member id="x" type="float64" />
        <member id="y" type="float64" />
        <member id="heading" type="float64" />
    </struct>
    <struct id="Goal">
        <member id="pose" type="Pose" />
        <member id="weight" type="int32" />
    </struct>
</types>
"""


def declarations(number: int, before: int, after: int) -> str:
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<ascxml name="Machine{number}" version="1.0" initial="state_0" xmlns="http://www.w3.org/2005/07/scxml">
    <datamodel>
        <data id="counter" type="int32" expr="0" />
        <data id="speed" type="float64" expr="0.0" />
        <data id="turn" type="float64" expr="0.0" />
        <data id="ready" type="bool" expr="false" />
        <data id="values" type="int32[10]" expr="[]" />
        <data id="sum" type="int64" expr="0" />
        <data id="here" type="Pose" expr="{{'x': 0.0, 'y': 0.0, 'heading': 0.0}}" />
        <data id="goal" type="Goal" expr="{{'pose': {{'x': 1.0, 'y': 2.0, 'heading': 0.0}}, 'weight': 1}}" />
        <data id="route" type="Pose[5]" expr="[]" />
    </datamodel>

    <ros_topic_publisher name="out" topic="/ring/topic_{number}" type="std_msgs/Int32" />
    <ros_topic_subscriber name="in" topic="/ring/topic_{before}" type="std_msgs/Int32" />
    <ros_topic_publisher name="twist" topic="/ring/twist_{number}" type="geometry_msgs/Twist" />
    <ros_topic_subscriber name="other_twist" topic="/ring/twist_{after}" type="geometry_msgs/Twist" />
    <ros_service_client name="add" service_name="/ring/add_{after}" type="example_interfaces/AddTwoInts" />
    <ros_service_server name="serve" service_name="/ring/add_{number}" type="example_interfaces/AddTwoInts" />
    <ros_time_rate name="t{number}" rate_hz="10" />
"""


def state(number: int, following: int, machine_number: int, before: int) -> str:
    return f"""
    <state id="state_{number}">
        <onentry>
            <ros_topic_publish name="out">
                <field name="data" expr="counter" />
            </ros_topic_publish>
        </onentry>
        <ros_rate_callback name="t{machine_number}" target="state_{following}" cond="counter &lt; 99 &amp;&amp; !ready">
            <assign location="counter" expr="counter + 1" />
            <assign location="here.x" expr="here.x + 0.1 * speed * Math.cos(here.heading)" />
            <assign location="here.y" expr="here.y + 0.1 * speed * Math.sin(here.heading)" />
            <assign location="route[{number % 5}]" expr="here" />
            <assign location="speed" expr="Math.min(speed + 0.1 * goal.weight, 2.5)" />
            <ros_topic_publish name="twist">
                <field name="linear.x" expr="speed" />
                <field name="linear.y" expr="0.5" />
                <field name="linear.z" expr="0.5" />
                <field name="angular.x" expr="0.5" />
                <field name="angular.y" expr="0.5" />
                <field name="angular.z" expr="speed * 0.5 + turn" />
            </ros_topic_publish>
        </ros_rate_callback>
        <ros_rate_callback name="t{machine_number}" target="state_{number}">
            <assign location="counter" expr="0" />
            <assign location="goal.pose" expr="route[{number % 5}]" />
        </ros_rate_callback>
        <ros_topic_callback name="in" target="state_{following}">
            <assign location="counter" expr="_msg.data % 100" />
            <if cond="counter == {number}">
                <ros_service_send_request name="add">
                    <field name="a" expr="counter" />
                    <field name="b" expr="{number}" />
                </ros_service_send_request>
            <elseif cond="counter &gt; 50 || values.length &gt; 3" />
                <assign location="values[{number % 10}]" expr="counter" />
                <send event="ring_{machine_number}_event_{number % 2}">
                    <param name="value" expr="counter * 2 + values[{number % 10}]" />
                    <param name="pose" expr="here" />
                </send>
            <else />
                <assign location="ready" expr="!ready" />
            </if>
        </ros_topic_callback>
        <ros_topic_callback name="other_twist" target="state_{number}">
            <assign location="turn" expr="_msg.linear.x * 0.5 + _msg.angular.z" />
        </ros_topic_callback>
        <ros_service_handle_request name="serve" target="state_{number}">
            <assign location="sum" expr="_req.a + _req.b" />
            <ros_service_send_response name="serve">
                <field name="sum" expr="sum" />
            </ros_service_send_response>
        </ros_service_handle_request>
        <ros_service_handle_response name="add" target="state_{following}">
            <assign location="sum" expr="_res.sum" />
        </ros_service_handle_response>
        <transition event="ring_{before}_event_{number % 2}" cond="_event.data.value &gt; 10" target="state_{number}">
            <assign location="goal.pose" expr="_event.data.pose" />
        </transition>
    </state>
"""


def properties(machines: int) -> str:
    rows = ",\n".join(
        f"""    {{
      "name": "reaches_{number}",
      "expression": {{
        "op": "filter", "fun": "values", "states": {{"op": "initial"}},
        "values": {{"op": "Pmin", "exp": {{"op": "F", "exp": {{
          "op": "=", "left": "topic_ring__topic_{number}_msg__ros_fields__data", "right": 10}}}}}}
      }}
    }}"""
        for number in range(machines)
    )
    return f'{{\n  "properties": [\n{rows}\n  ]\n}}\n'

# SPDX-License-Identifier: Apache-2.0
"""Properties in XML that read elements of arrays, before the first message and after it."""

from __future__ import annotations

from translating import loaded

from roaml import api

MACHINE = """<ascxml name="Arm" version="1.0" initial="moving">
    <ros_topic_publisher name="joints" topic="/joints" type="sensor_msgs/JointState" />
    <ros_time_rate name="tick" rate_hz="1" />
    <state id="moving">
        <ros_rate_callback name="tick" target="moving">
            <ros_topic_publish name="joints">
                <field name="header.stamp.sec" expr="0" />
                <field name="header.stamp.nanosec" expr="0" />
                <field name="header.frame_id" expr="''" />
                <field name="name" expr="['base', 'elbow']" />
                <field name="position" expr="[0.25, 0.75]" />
                <field name="velocity" expr="[]" />
                <field name="effort" expr="[]" />
            </ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>"""
PORTS = """<ports><ros_topic topic_name="/joints" type="sensor_msgs/JointState" event="publish">
    <event_var id="sent" />
    <state_var id="names" type="string[]" field="name" expr="[]" />
    <state_var id="first" type="string[]" field="name" expr="['arm', 'hand']" />
    <state_var id="places" type="float64[]" field="position" expr="[]" />
    <state_var id="speeds" type="float64[]" field="velocity" expr="[1, 2.5]" />
</ros_topic></ports>"""

VALUES = {
    "names[0] == ''": 1,  # at first
    "names[0] == 'base'": 1,
    "names.length == 2 &amp;&amp; names[1] == 'elbow'": 1,
    "names[1] == 'base'": 0,
    "names[1].length == 5": 1,
    "names[1][4] == 119": 1,
    "first[0] == 'arm'": 1,  # at first
    "sent &amp;&amp; first[1] == 'hand'": 0,
    "first[1] == 'elbow'": 1,
    "places[1] &lt; 0.5": 1,  # at first
    "sent &amp;&amp; places[1] &lt; 0.5": 0,
    "places[1] == 0.75": 1,
    "speeds[1] == 2.5": 1,  # at first
    "sent &amp;&amp; speeds[1] == 2.5": 0,
}
"""A condition -> the probability that it holds at some time."""


def test_elements_of_arrays_in_conditions() -> None:
    guarantees = "".join(
        f'<property id="p{number}" pattern="existence"><event>{condition}</event><scope type="globally" /></property>'
        for number, condition in enumerate(VALUES)
    )
    system = loaded(
        {
            "main.xml": """<roaml><parameters><max_time value="3" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="arm.ascxml" /></node_models>
    <properties><input type="xml" src="properties.xml" /></properties></roaml>""",
            "arm.ascxml": MACHINE,
            "properties.xml": f"<properties>{PORTS}<guarantees>{guarantees}</guarantees></properties>",
        }
    )
    results = api.verify(system)
    found = {result.name: result.answer.value for result in results if result.answer is not None}
    assert found == {f"p{number}": value for number, value in enumerate(VALUES.values())}

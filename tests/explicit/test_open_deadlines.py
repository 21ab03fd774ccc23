# SPDX-License-Identifier: Apache-2.0
"""A property whose deadline may be after the end of time has no minimum and maximum; traces estimate its value."""

from __future__ import annotations

from pathlib import Path

import pytest

from roaml import api
from roaml.explicit.space import StateLimits
from roaml.verification.exhaustive import UndecidedError, exact_values

FILES = {
    "main.xml": """<roaml>
    <parameters><max_time value="2" unit="s" /></parameters>
    <node_models>
        <input type="node-ascxml" src="operator.ascxml" />
        <input type="node-ascxml" src="robot.ascxml" />
    </node_models>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>""",
    "operator.ascxml": """<ascxml name="Operator" version="1.0" initial="start">
    <ros_topic_publisher name="job" topic="/job" type="std_msgs/Empty" />
    <state id="start">
        <transition target="end"><ros_topic_publish name="job" /></transition>
    </state>
    <state id="end" />
</ascxml>""",
    "robot.ascxml": """<ascxml name="Robot" version="1.0" initial="rest">
    <ros_topic_subscriber name="job" topic="/job" type="std_msgs/Empty" />
    <ros_topic_publisher name="done" topic="/done" type="std_msgs/Empty" />
    <ros_time_rate name="second" rate_hz="1" />
    <state id="rest"><ros_topic_callback name="job" target="work" /></state>
    <state id="work">
        <ros_rate_callback name="second" target="rest"><ros_topic_publish name="done" /></ros_rate_callback>
    </state>
</ascxml>""",
    "properties.xml": """<properties>
    <ports>
        <ros_topic topic_name="/job" type="std_msgs/Empty" event="publish"><event_var id="job" /></ros_topic>
        <ros_topic topic_name="/done" type="std_msgs/Empty" event="publish"><event_var id="done" /></ros_topic>
    </ports>
    <guarantees>
        <property id="soon" pattern="response">
            <events><event>job</event><event>done</event></events>
            <scope type="globally" /><time_interval within="1" time_unit="s" />
        </property>
    </guarantees>
</properties>""",
}


def test_the_reason_and_the_remedy(tmp_path: Path) -> None:
    """A scheduler may publish the job at the end of time."""
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    checker = api.checker(api.as_target(api.load(str(tmp_path / "main.xml"))).model, ["soon"])
    (soon,) = checker.compiled_properties
    with pytest.raises(UndecidedError) as error:
        exact_values(checker, soon, StateLimits())
    assert str(error.value) == (
        "in traces with a probability of up to 1, the time ends (`max_time`) before a deadline of the property; "
        "raise max_time, which does not help where what starts the deadline keeps happening"
    )

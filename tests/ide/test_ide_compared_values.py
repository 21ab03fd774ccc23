# SPDX-License-Identifier: Apache-2.0
"""Completion offers the values that a field of event data can be compared with."""

from __future__ import annotations

from pathlib import Path

import pytest

from fixture import split_files
from roaml.ide.completion import complete
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace

MODEL = """
-- main.xml --
<roaml>
    <parameters><max_time value="10" unit="s" /></parameters>
    <node_models>
        <input type="node-ascxml" src="battery.ascxml" />
        <input type="node-ascxml" src="robot.ascxml" />
    </node_models>
</roaml>
-- battery.ascxml --
<ascxml name="Battery" version="1.0" initial="a">
    <ros_topic_publisher name="mode" topic="/mode" type="std_msgs/String" />
    <ros_time_rate name="t" rate_hz="1" />
    <state id="a">
        <ros_rate_callback name="t" target="b">
            <ros_topic_publish name="mode"><field name="data" expr="'charging'" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
    <state id="b">
        <ros_rate_callback name="t" target="a">
            <ros_topic_publish name="mode"><field name="data" expr="'full'" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>
-- robot.ascxml --
<ascxml name="Robot" version="1.0" initial="a">
    <ros_topic_subscriber name="mode" topic="/mode" type="std_msgs/String" />
    <ros_topic_subscriber name="status" topic="/status" type="action_msgs/GoalStatus" />
    <state id="a">
        <ros_topic_callback name="mode" target="a" cond="_msg.data == MODE" />
        <ros_topic_callback name="status" target="a" cond="_msg.status == STATUS" />
    </state>
</ascxml>
"""


@pytest.mark.parametrize(
    ("slot", "expected"),
    [
        ("MODE", {"'charging'": "is sent", "'full'": "is sent"}),
        ("STATUS", {"4": "STATUS_SUCCEEDED", "5": "STATUS_CANCELED", "6": "STATUS_ABORTED"}),
    ],
)
def test_values(slot: str, expected: dict[str, str]) -> None:
    folder = Path("/project")
    workspace = Workspace((str(folder),), Settings())
    texts = split_files(MODEL.strip() + "\n")
    caret = texts["robot.ascxml"].index(slot)
    texts["robot.ascxml"] = texts["robot.ascxml"].replace(slot, "")
    for name, text in texts.items():
        workspace.open(str(folder / name), text)
    completions = complete(workspace.snapshot(), str(folder / "robot.ascxml"), caret)
    assert completions is not None
    details = {item.label: item.detail for item in completions.items}
    assert expected.items() <= details.items(), details

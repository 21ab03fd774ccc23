# SPDX-License-Identifier: Apache-2.0
"""What `not-checked` says at a node of the tree whose plugin may be in a file that cannot be read."""

from __future__ import annotations

from pathlib import Path

from checked import check_text

SYSTEM = """-- main.xml --
<roaml>
    <parameters><max_time value="10" unit="s" /></parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" /><input type="bt-plugin-ascxml" src="nameless.ascxml" />
    </behavior_tree>
    <node_models><input type="node-ascxml" src="listener.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- tree.xml --
<root BTCPP_format="4"><BehaviorTree ID="Main"><Move /></BehaviorTree></root>
-- nameless.ascxml --
<ascxml version="1.0" initial="a">
    <state id="a">
        <bt_tick target="a"><bt_return_status status="SUCCESS" /></bt_tick>
        <bt_halt target="a"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
-- listener.ascxml --
<ascxml name="Listener" version="1.0" initial="a">
    <ros_topic_subscriber name="x" topic="/x" type="std_msgs/Empty" />
    <state id="a"><ros_topic_callback name="x" target="a" /></state>
</ascxml>
-- properties.jani --
{"properties": []}
"""


def test_a_node_without_an_error_is_not_blamed(tmp_path: Path) -> None:
    """No rule reports an error at the node, so the message names the file of the plugin instead."""
    diagnostics, _ = check_text(tmp_path, SYSTEM)
    messages = {Path(d.path).name: d.message for d in diagnostics if d.code == "not-checked"}
    assert messages == {
        "tree.xml": "not checked, because a listed plugin cannot be read: whether the plugin `Move` exists and which "
        "machine publishes on the topic `x`; fix the errors of that plugin first",
        "nameless.ascxml": "not checked because of this error: whether the plugin `Move` exists; fix the error first",
    }

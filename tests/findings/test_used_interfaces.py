# SPDX-License-Identifier: Apache-2.0
"""The check of a system file includes the definition files that its machines use."""

from __future__ import annotations

from pathlib import Path

from fixture import write_files
from roaml import api

SYSTEM = """\
-- main.xml --
<roaml>
    <parameters><max_time value="10" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="a.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- properties.jani --
{"properties": []}
-- a.ascxml --
<ascxml name="A" version="1.0" initial="s">
    <ros_topic_publisher name="t" topic="/t" type="my_msgs/Outer" />
    <ros_time_rate name="r" rate_hz="1" />
    <state id="s"><ros_rate_callback name="r" target="s" /></state>
</ascxml>
-- package.xml --
<package format="3"><name>my_msgs</name></package>
-- my_msgs/package.xml --
<package format="3"><name>my_msgs</name></package>
-- my_msgs/msg/Outer.msg --
Inner inner
-- my_msgs/msg/Inner.msg --
int33 x
-- my_msgs/msg/Unused.msg --
int33 x
"""


def test_used_definitions_are_checked_and_others_are_not(tmp_path: Path) -> None:
    write_files(tmp_path, SYSTEM)
    result = api.check([str(tmp_path / "main.xml")])
    reported = {Path(d.path).name for d in result.diagnostics if d.code == "interface-syntax"}
    assert reported == {"Inner.msg"}
    assert {Path(file).name for file in result.files} >= {"Outer.msg", "Inner.msg"}
    assert not [file for file in result.files if "standard" in Path(file).parts]

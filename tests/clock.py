# SPDX-License-Identifier: Apache-2.0
"""A small system without findings, a clock that publishes a counter; and changes that cause findings."""

from __future__ import annotations

from pathlib import Path

from fixture import split_files

FILES = split_files(
    """\
-- main.xml --
<roaml>
    <parameters>
        <max_time value="10" unit="s" />
    </parameters>
    <node_models>
        <input type="node-ascxml" src="clock.ascxml" />
    </node_models>
    <properties>
        <input type="jani" src="properties.jani" />
    </properties>
</roaml>
-- clock.ascxml --
<ascxml name="Clock" version="1.0" initial="on">
    <datamodel>
        <data id="count" type="uint8" expr="0" />
    </datamodel>
    <ros_time_rate name="second" rate_hz="1" />
    <ros_topic_publisher name="ticks" topic="/ticks" type="std_msgs/UInt8" />
    <state id="on">
        <ros_rate_callback name="second" target="on">
            <assign location="count" expr="(count + 1) % 10" />
            <ros_topic_publish name="ticks"><field name="data" expr="count" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>
-- properties.jani --
{"properties": [{"name": "ticks", "expression": {"op": "filter", "fun": "values", "states": {"op": "initial"},
  "values": {"op": "Pmin", "exp": {"op": "F", "exp": {
    "op": "=", "left": "topic_ticks_msg__ros_fields__data", "right": 3}}}}}]}
"""
)

MAIN, CLOCK, PROPERTIES = FILES.values()

WRONG_CLOCK = CLOCK.replace('location="count"', 'location="coutn"')
"""One error: `undeclared-variable` at 9:31 to 9:36."""

UNHEARD_CLOCK = (
    CLOCK.replace("</ascxml>", "")
    .replace(
        '    <state id="on">',
        '    <ros_topic_publisher name="bell" topic="/bell" type="std_msgs/Empty" />\n    <state id="on">',
    )
    .replace("</ros_rate_callback>", '    <ros_topic_publish name="bell" />\n        </ros_rate_callback>')
    + "</ascxml>\n"
)
"""One hint: `topic-without-subscriber` at 7:45 to 7:50."""


def write(folder: Path, **changed: str) -> Path:
    """Write the system; return its system file. `clock="…"` and similar arguments replace the text of a file."""
    names = {name.partition(".")[0]: name for name in FILES}
    assert changed.keys() <= names.keys()
    folder.mkdir(parents=True, exist_ok=True)
    for stem, name in names.items():
        (folder / name).write_text(changed.get(stem, FILES[name]), encoding="utf-8")
    return folder / "main.xml"

# SPDX-License-Identifier: Apache-2.0
"""The message about a variable that is assigned, but not read elsewhere, says whether its own assignments read it."""

from __future__ import annotations

from pathlib import Path

import pytest

from checked import check_text

SYSTEM = """-- main.xml --
<roaml>
    <parameters><max_time value="5" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="arm.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- properties.jani --
{"properties": []}
-- arm.ascxml --
<ascxml name="Arm" version="1.0" initial="a">
    <datamodel>
        <data id="k" type="int32" expr="0" />
        <data id="grid" type="int32[2]" expr="[1, 0]" />
    </datamodel>
    <ros_time_rate name="t" rate_hz="1" />
    <state id="a">
        <ros_rate_callback name="t" target="a"><assign location="LOCATION" expr="VALUE" /></ros_rate_callback>
    </state>
</ascxml>
"""


@pytest.mark.parametrize(
    ("location", "value", "end"),
    [
        ("grid[k]", "grid[0] * 10", "never read except in its own assignments"),
        ("grid[grid[0]]", "3", "never read except in its own assignments"),
        ("grid[k]", "k * 10", "never read"),
    ],
)
def test_own_assignments_that_read_a_variable_are_named(tmp_path: Path, location: str, value: str, end: str) -> None:
    diagnostics, _ = check_text(tmp_path, SYSTEM.replace("LOCATION", location).replace("VALUE", value))
    [message] = [d.message for d in diagnostics if d.code == "unused-variable" and "grid" in d.message]
    assert message.endswith(end)

# SPDX-License-Identifier: Apache-2.0
"""The entry or value to which the fix of missing-port sets a port."""

from __future__ import annotations

from pathlib import Path

import pytest

from fixture import write_files
from mending import offered, workspace_of

SYSTEM = """
-- main.xml --
<roaml>
    <parameters><max_time value="5" unit="s" /></parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
        <input type="bt-plugin-ascxml" src="find.ascxml" />
        <input type="bt-plugin-ascxml" src="go.ascxml" />
    </behavior_tree>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- properties.jani --
{"properties": []}
-- find.ascxml --
<ascxml name="Find" version="1.0" initial="a">
    <bt_declare_port_out key="found" type="int8" />
    <bt_declare_port_out key="place" type="int8" />
    <state id="a">
        <bt_tick target="a">
            <bt_set_output key="found" expr="1" /><bt_set_output key="place" expr="2" />
            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="a"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
-- go.ascxml --
<ascxml name="Go" version="1.0" initial="a">
    <bt_declare_port_in key="place" type="int8" />
    <datamodel><data id="goal" type="int8" expr="0" /></datamodel>
    <state id="a">
        <bt_tick target="a">
            <assign location="goal"><expr><bt_get_input key="place" /></expr></assign>
            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="a"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
-- tree.xml --
<root BTCPP_format="4">
    <BehaviorTree ID="Main"><Sequence>NODES</Sequence></BehaviorTree>
</root>
"""


@pytest.mark.parametrize(
    ("nodes", "added"),
    [
        pytest.param('<Find place="{a}"/><Go place="{goal}"/>', 'found="{goal}"', id="what another node needs"),
        pytest.param('<Find place="{a}"/><Go place="{a}"/>', 'found="{found}"', id="nothing needs it"),
        pytest.param('<Find place="{place}" found="{a}"/><Go/>', 'place="{place}"', id="written before"),
        pytest.param('<Go/><Find place="{place}" found="{a}"/>', 'place="1"', id="written later"),
    ],
)
def test_value_of_a_missing_port(tmp_path: Path, nodes: str, added: str) -> None:
    write_files(tmp_path, SYSTEM.replace("NODES", nodes))
    snapshot = workspace_of(tmp_path).snapshot()
    ((_, action),) = offered(snapshot, "missing-port")
    tree = str(tmp_path / "tree.xml")
    (edit,) = action.make().edits[tree]
    assert edit.new_text.strip() == added

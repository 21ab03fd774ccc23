# SPDX-License-Identifier: Apache-2.0
"""Assignments of structs whose leaves are read by their own indices. The values are computed by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run

START = "{'a': 7, 'b': 5, 'list': [8, 9]}"
ITEMS = "[{'a': 1, 'b': 2, 'list': [3]}, {'a': 2, 'b': 0, 'list': [4, 5]}, {'a': 9, 'b': 6, 'list': []}]"


def assign(*pairs: tuple[str, str]) -> str:
    return "".join(f'<assign location="{location}" expr="{value}" />' for location, value in pairs)


APPEND = ("v[v.length]", "s")


@pytest.mark.parametrize(
    ("statements", "value", "result"),
    [
        ([APPEND], "v[3].a * 10000 + v[3].b * 1000 + v[3].list[1] * 100 + v[3].list.length * 10 + v.length", 75924),
        ([APPEND, ("s.b", "4"), APPEND], "v[3].b * 1000 + v[4].b * 100 + v[4].a * 10 + v.length", 5475),
        ([("v.length", "v.length - 1"), APPEND], "v[2].a * 1000 + v[2].b * 100 + v[2].list[0] * 10 + v.length", 7583),
        ([("s", "v[0]"), ("s", "v[s.a]"), ("s", "v[s.a]")], "s.a * 100 + s.b * 10 + s.list.length", 960),
        ([("s", "v[0]"), ("s", "v[s.b - s.a]")], "s.a * 100 + s.b * 10 + s.list[1]", 205),
        ([("v[v[0].a - v[0].b + 1]", "s")], "v[0].a * 100 + v[0].b * 10 + v[0].list[1]", 759),
        ([("v[v[0].a]", "v[v[1].a]")], "v[1].a * 100 + v[1].b * 10 + v[1].list.length", 960),
    ],
)
def test_value(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    statements: list[tuple[str, str]],
    value: str,
    result: int,
) -> None:
    (tmp_path / "types.xml").write_text(
        '<types><struct id="Item"><member id="a" type="int32" /><member id="b" type="int32" />'
        '<member id="list" type="int32[3]" /></struct></types>'
    )
    (tmp_path / "m.ascxml").write_text(f"""\
<ascxml name="M" version="1.0" initial="a">
    <datamodel>
        <data id="s" type="Item" expr="{START}" />
        <data id="v" type="Item[6]" expr="{ITEMS}" />
    </datamodel>
    <ros_topic_publisher name="out" topic="/out" type="std_msgs/Int32" />
    <state id="a"><transition target="b">
        {assign(*statements)}
        <ros_topic_publish name="out"><field name="data" expr="{value}" /></ros_topic_publish>
    </transition></state>
    <state id="b" />
</ascxml>
""")
    (tmp_path / "p.xml").write_text(f"""\
<properties>
    <ports><ros_topic topic_name="/out" type="std_msgs/Int32" event="publish">
        <state_var id="out" type="int32" field="data" expr="0" />
    </ros_topic></ports>
    <guarantees><property id="right" pattern="existence">
        <event>out == {result}</event><scope type="globally" />
    </property></guarantees>
</properties>
""")
    (tmp_path / "main.xml").write_text(
        '<roaml><parameters><max_time value="1" unit="s" /></parameters>'
        '<data_declarations><input type="xml" src="types.xml" /></data_declarations>'
        '<node_models><input type="node-ascxml" src="m.ascxml" /></node_models>'
        '<properties><input type="xml" src="p.xml" /></properties></roaml>'
    )
    assert run(["verify", str(tmp_path / "main.xml"), "--exhaustive"]) == 0
    assert "right: = 1 for all schedulers" in capsys.readouterr().out

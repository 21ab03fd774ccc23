# SPDX-License-Identifier: Apache-2.0
"""Hints and lenses of files that several systems share: one for all systems if they agree, otherwise one for each."""

from __future__ import annotations

import pytest
from ide_case import path_of
from ide_models import system_file

from roaml.ide.code_lens import counted, lenses
from roaml.ide.inlay_hints import inlay_hints
from roaml.ide.system_names import grouped, system_names
from roaml.project.analysis import Analysis
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace
from roaml.text import Span

DRIVER = """\
<ascxml name="Driver" version="1.0" initial="s">
  <ros_topic_subscriber name="in" topic="/command" type="std_msgs/Int32"/>
  <state id="s">
    <ros_topic_callback name="in" target="s"/>
    <transition event="go" target="s"/>
  </state>
</ascxml>
"""
SENDER = """\
<ascxml name="Sender" version="1.0" initial="s">
  <ros_topic_publisher name="out" topic="/command" type="std_msgs/Int32"/>
  <state id="s"><transition target="s">
    <ros_topic_publish name="out"><field name="data" expr="1"/></ros_topic_publish>
    <send event="go"><param name="speed" expr="EXPR"/></send>
  </transition></state>
</ascxml>
"""
PLUGIN = """\
<ascxml name="Move" version="1.0" initial="s">
  <bt_declare_port_in key="topic" type="string"/>
  <ros_topic_publisher name="out" type="std_msgs/Int32"><topic><bt_get_input key="topic"/></topic></ros_topic_publisher>
  <state id="s">
    <bt_tick target="s"><ros_topic_publish name="out"><field name="data" expr="1"/></ros_topic_publish>
      <bt_return_status status="SUCCESS"/></bt_tick>
    <bt_halt target="s"><bt_return_halted/></bt_halt>
  </state>
</ascxml>
"""
LEAVES = '<BehaviorTree ID="Main"><Sequence>LEAVES</Sequence></BehaviorTree>'
TREE = f'<root BTCPP_format="4" main_tree_to_execute="Main">{LEAVES}</root>'


def system(tree: str, *nodes: str) -> str:
    return system_file(
        *(f"node_models node-ascxml ../{name}" for name in nodes),
        f"behavior_tree bt.cpp-xml {tree}",
        "behavior_tree bt-plugin-ascxml ../move.ascxml",
        "properties jani ../properties.jani",
    )


def tree(*topics: str) -> str:
    return TREE.replace("LEAVES", "".join(f'<Move topic="{topic}"/>' for topic in topics))


PROPERTIES = '{"properties": [{"name": "p", "expression": {"op": "F", "exp": "bt_1001_response.valid"}}]}'
SAME = {
    "arm/main.xml": system("tree.xml", "driver.ascxml", "sender.ascxml"),
    "base/main.xml": system("tree.xml", "driver.ascxml", "sender.ascxml"),
    "arm/tree.xml": tree("/command"),
    "base/tree.xml": tree("/command"),
    "driver.ascxml": DRIVER,
    "sender.ascxml": SENDER.replace("EXPR", "1"),
    "move.ascxml": PLUGIN,
    "properties.jani": PROPERTIES,
}
DIFFERENT = {
    **SAME,
    "base/main.xml": system("tree.xml", "driver.ascxml", "other.ascxml"),
    "base/tree.xml": tree("/command", "/wheels"),
    "other.ascxml": SENDER.replace("EXPR", "true").replace("/command", "/speed"),
}


def moment(files: dict[str, str]) -> Analysis:
    systems = [path_of(name) for name in files if name.endswith("main.xml")]
    workspace = Workspace((), Settings(), systems)
    for name, text in files.items():
        workspace.open(path_of(name), text)
    return workspace.snapshot().analysis


def hints(files: dict[str, str], name: str) -> list[str]:
    return [hint.text for hint in inlay_hints(moment(files), path_of(name), Span(0, 10_000))]


def titles(files: dict[str, str], name: str) -> list[str]:
    analysis, path = moment(files), path_of(name)
    return [counted(analysis, lens.symbol, path).title for lens in lenses(analysis, path)]


def test_equal_texts_are_shown_once() -> None:
    assert hints(SAME, "driver.ascxml") == [" → /command", "(speed : int)"]
    assert hints(SAME, "move.ascxml") == [" : string", " = /command", " → /command", " : int32"]
    assert hints(SAME, "properties.jani") == [" Main/Move"]
    assert titles(SAME, "driver.ascxml") == ["2 publishers · 1 subscriber", "sent once · received once"]
    assert titles(SAME, "move.ascxml") == ["1 use in trees", "set once in trees", "2 publishers · 1 subscriber"]


def test_different_texts_are_shown_for_each_system() -> None:
    both = "/command in arm/main.xml; /command, /wheels in base/main.xml"
    assert hints(DIFFERENT, "driver.ascxml") == [
        " → /command",
        "(speed : int) in arm/main.xml; (speed : bool) in base/main.xml",
    ]
    assert hints(DIFFERENT, "move.ascxml") == [" : string", f" = {both}", f" → {both}", " : int32"]
    assert titles(DIFFERENT, "driver.ascxml") == [
        "arm/main.xml: 2 publishers · 1 subscriber / base/main.xml: 1 publisher · 1 subscriber",
        "sent once · received once",
    ]
    assert titles(DIFFERENT, "move.ascxml") == [
        "arm/main.xml: 1 use in trees / base/main.xml: 2 uses in trees",
        "arm/main.xml: set once in trees / base/main.xml: set twice in trees",
        "arm/main.xml: 2 publishers · 1 subscriber / "
        "base/main.xml: 2 topics: 1 publisher · 1 subscriber / 1 publisher · no subscribers",
    ]


def test_a_shared_tree_is_numbered_once() -> None:
    files = {**SAME, "base/main.xml": SAME["base/main.xml"].replace('src="tree.xml"', 'src="../arm/tree.xml"')}
    assert hints(files, "arm/tree.xml") == [" bt_1000", " bt_1001", " : string"]


@pytest.mark.parametrize(
    ("paths", "names"),
    [
        (["/a/main.xml"], ["main.xml"]),
        (["/a/one.xml", "/a/two.xml"], ["one.xml", "two.xml"]),
        (["/a/x/main.xml", "/b/x/main.xml", "/b/other.xml"], ["a/x/main.xml", "b/x/main.xml", "other.xml"]),
        (["/main.xml", "/a/main.xml"], ["/main.xml", "a/main.xml"]),
    ],
)
def test_names_of_systems(paths: list[str], names: list[str]) -> None:
    assert list(system_names(paths).values()) == names


def test_groups() -> None:
    assert grouped({"/a.xml": 1, "/b.xml": 1}) == [(1, "")]
    assert grouped({"/a.xml": 1, "/b.xml": 2, "/c.xml": 1}) == [(1, "a.xml, c.xml"), (2, "b.xml")]
    many = {f"/{number}.xml": number == 0 for number in range(6)}
    assert grouped(many) == [(True, "0.xml"), (False, "1.xml, 2.xml, 3.xml and 2 more")]

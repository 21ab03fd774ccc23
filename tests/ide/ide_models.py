# SPDX-License-Identifier: Apache-2.0
"""Models that tests of the editor's features are about, written as one string (`fixture.split_files`)."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from fixture import split_files
from marked import Case
from roaml import api
from roaml.ide.occurrence import Access, Occurrence
from roaml.project.analysis import Analysis
from roaml.project.settings import Settings

WORDS = {Access.TEXT: "names", Access.READ: "reads", Access.WRITE: "writes"}


def system_file(*inputs: str) -> str:
    """A system file; each input is `SECTION TYPE SRC`."""
    sections: dict[str, list[str]] = {}
    for section, type_, src in map(str.split, inputs):
        sections.setdefault(section, []).append(f'<input type="{type_}" src="{src}"/>')
    body = "".join(f"<{name}>{''.join(found)}</{name}>" for name, found in sections.items())
    return f'<roaml><parameters><max_time value="1" unit="s"/></parameters>{body}</roaml>'


def load(folder: Path, files: dict[str, str]) -> Analysis:
    """Write files and analyse the folder."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="")
    return api.check([str(folder)], settings=Settings()).snapshot.analysis


def load_marked(folder: Path, written: str) -> tuple[Analysis, dict[str, Case]]:
    """Files with carets below their lines."""
    cases = {name: Case(text) for name, text in split_files(written).items()}
    return load(folder, {name: case.text for name, case in cases.items()}), cases


def found(occurrences: Iterable[Occurrence]) -> list[tuple[int, int, str]]:
    """Occurrences in the form of `Case.found`."""
    return sorted((each.span.start, each.span.end, _words(each)) for each in occurrences)


def _words(each: Occurrence) -> str:
    verb = "defines" if each.defines else WORDS[each.access]
    scope = f" in {each.symbol.scope}" if each.symbol.scope else ""
    return f"{verb} {each.symbol.kind} {each.symbol.name}{scope}"


ROBOT = (
    "-- main.xml --\n"
    + system_file(
        "data_declarations xml types.xml",
        "behavior_tree bt.cpp-xml tree.xml",
        "behavior_tree bt-plugin-ascxml plugin.ascxml",
        "node_models node-ascxml a.ascxml",
        "properties jani properties.jani",
    )
    + """
-- types.xml --
<types><struct id="Pose"><member id="x" type="float64"/></struct></types>
-- a.ascxml --
<ascxml name="A" version="1.0" initial="s">
  <datamodel><data id="p" type="Pose" expr="{'x': 1.0}"/><data id="n" type="int32" expr="0"/></datamodel>
  <ros_topic_subscriber name="input" topic="/a/b" type="std_msgs/Int32"/>
  <state id="s">
    <onentry><send event="go"><param name="to" expr="p"/></send></onentry>
    <transition event="go" target="s"><assign location="p.x" expr="_event.data.to.x"/></transition>
    <ros_topic_callback name="input" target="s"><assign location="n" expr="_msg.data"/></ros_topic_callback>
  </state>
</ascxml>
-- plugin.ascxml --
<ascxml name="Walk" version="1.0" initial="s">
  <bt_declare_port_in key="goal" type="int32"/>
  <bt_declare_port_in key="topic" type="string"/>
  <bt_declare_port_out key="out" type="int32"/>
  <datamodel><data id="n" type="int32" expr="0"/></datamodel>
  <ros_topic_publisher name="pub" type="std_msgs/Int32"><topic><bt_get_input key="topic"/></topic></ros_topic_publisher>
  <state id="s">
    <bt_tick target="s">
      <assign location="n"><expr><bt_get_input key="goal"/></expr></assign>
      <bt_set_output key="out" expr="n"/>
      <ros_topic_publish name="pub"><field name="data" expr="n"/></ros_topic_publish>
      <bt_return_status status="SUCCESS"/>
    </bt_tick>
    <bt_halt target="s"><bt_return_halted/></bt_halt>
  </state>
</ascxml>
-- tree.xml --
<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Sequence>
      <!-- Twice: here, and as a part of another tree. -->
      <Walk goal="{g}" out="{g}" topic=" /a/b "/>
      <SubTree ID="Sub" t="/c" g="{g}" _autoremap="true"/>
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Sub">
    <Action ID="Walk" name="w" goal="{g}" out="{own}" topic="{t}"/>
  </BehaviorTree>
</root>
-- properties.jani --
{"properties": [{"name": "p", "expression": {"op": "∧", "left": "go.valid", "right":
  {"op": "<", "left": "go__to__x", "right": {"op": "+", "left": "topic_a__b_msg__ros_fields__data", "right":
  {"op": "+", "left": "bt_blackboard_get__Sub__own", "right": "bt_blackboard_set_g__value"}}}}}]}
"""
)

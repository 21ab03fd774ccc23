# SPDX-License-Identifier: Apache-2.0
"""Rename: the edits, the refusals, and the invariant that only the name changes."""

from __future__ import annotations

from pathlib import Path

import pytest
from ide_models import CORNERS, ROBOT, load, system_file
from ide_sweep import System
from test_ide_navigate import caret

from fixture import split_files
from roaml.ide.rename import Prepared, RenameRefusal, Renaming, prepare, rename
from roaml.text import apply_edits

ROOT = Path(__file__).resolve().parents[2]

# file, a piece with a caret, the new name, then the pieces that stand in the files afterwards
EDITS = """
a.ascxml  version="1.0" initial="|s"  t  a.ascxml: initial="t"  a.ascxml: id="t"  plugin.ascxml: id="s"
a.ascxml  id="|p" type  q  a.ascxml: id="q"  a.ascxml: expr="q"  a.ascxml: "q.x"
a.ascxml  event="|go"><param  went  a.ascxml: event="went" target  properties.jani: "went__to
a.ascxml  name="|to"  by  a.ascxml: data.by.x  properties.jani: "go__by__x"
a.ascxml  topic="/|a/b"  /c/d  a.ascxml: "/c/d"  tree.xml: " /c/d "  properties.jani: topic_c__d_msg
types.xml  id="|x"  z  a.ascxml: {'z': 1.0}  a.ascxml: "p.z" expr="_event.data.to.z"  properties.jani: __to__z
types.xml  id="|Pose"  Place  a.ascxml: type="Place"
tree.xml  <|Walk goal  Go  plugin.ascxml: name="Go"  tree.xml: <Go goal  tree.xml: ID="Go"
tree.xml  ID="|Sub" t  Low  tree.xml: ID="Low" t  tree.xml: ID="Low">  properties.jani: get__Low__own
tree.xml  out="{|own}"  mine  tree.xml: "{mine}"  properties.jani: get__Sub__mine
tree.xml  Walk |goal=  end  plugin.ascxml: key="end" type  plugin.ascxml: key="end"/>  tree.xml: end="{g}"
properties.jani  set_|g__v  h  tree.xml: goal="{h}" out="{h}"  tree.xml: g="{h}"  properties.jani: set_h__v
"""

REFUSALS = """
a.ascxml         _msg.|data              x         `data` is defined by ROS
a.ascxml         std_msgs/|Int32         x         is defined by ROS
tree.xml         |Sequence>              x         is a node of BehaviorTree.CPP
a.ascxml         |transition             x         there is no name at this position
a.ascxml         id="|p" type            n         a variable `n` already exists
a.ascxml         id="|p" type            p         the name is already `p`
a.ascxml         id="|p" type            _msg      the name of an event variable
a.ascxml         id="|p" type            a b       not a valid variable name
a.ascxml         id="|p" type            var       word of ECMAScript
a.ascxml         id="|p" type            a__b      separates the parts of names
a.ascxml         event="|go" target      topic_x   the translation uses this name for an event that it generates
types.xml        id="|Pose"              int32     is not a valid name of a struct
types.xml        id="|Pose"              true      is not a valid name of a struct
types.xml        id="|x"                 false     is not a valid name of a member
tree.xml         <|Walk                  Sequence  is the name of a node of BehaviorTree.CPP
tree.xml         <|Walk                  A         a state machine `A` already exists
tree.xml         ID="|Sub"               Main      a behavior tree `Main` already exists
tree.xml         {|own}"                 true      is not a valid name of a blackboard variable
tree.xml         {|own}"                 g         a blackboard variable `g` already exists
plugin.ascxml    key="|goal"             out       a port `out` already exists
plugin.ascxml    key="|goal"             ID        is not a valid name of a port
a.ascxml         topic="/|a/b"           /c        a topic `c` already exists
a.ascxml         topic="/|a/b"           c d       is not a valid name of a topic
"""


def edit_rows() -> list[tuple[str, str, str, list[str]]]:
    rows = (line.split("  ") for line in EDITS.strip().splitlines())
    return [(file, piece, new, expected) for file, piece, new, *expected in rows]


@pytest.mark.parametrize(("file", "piece", "new", "expected"), edit_rows())
def test_edits(file: str, piece: str, new: str, expected: list[str], tmp_path: Path) -> None:
    files = split_files(ROBOT)
    analysis = load(tmp_path, files)
    renaming = rename(analysis, *caret(tmp_path, file, piece), new)
    assert isinstance(renaming, Renaming), renaming
    texts = {name: apply_edits(text, renaming.edits.get(str(tmp_path / name), ())) for name, text in files.items()}
    for name, text in (row.split(": ", 1) for row in expected):
        assert text in texts[name], texts[name]


@pytest.mark.parametrize("row", REFUSALS.strip().splitlines())
def test_refusals(row: str, tmp_path: Path) -> None:
    file, piece, new, reason = (row[:17].strip(), row[17:41].strip(), row[41:51].strip(), row[51:])
    analysis = load(tmp_path, split_files(ROBOT))
    renaming = rename(analysis, *caret(tmp_path, file, piece), new)
    assert isinstance(renaming, RenameRefusal)
    assert reason in renaming.reason


def test_prepared(tmp_path: Path) -> None:
    analysis = load(tmp_path, split_files(ROBOT))
    path, offset = caret(tmp_path, "a.ascxml", 'topic="/a|/b"')
    prepared = prepare(analysis, path, offset)
    assert isinstance(prepared, Prepared)
    assert (prepared.name, prepared.span.start) == ("a/b", offset - 1)


def test_a_file_of_two_systems(tmp_path: Path) -> None:
    """Two systems share a file with an event, so both are changed."""
    machine = """<ascxml name="{0}" version="1.0" initial="s">
<state id="s"><onentry><send event="{1}"/></onentry><transition event="{2}" target="s"/></state></ascxml>"""
    files = {
        "one.xml": system_file("node_models node-ascxml a.ascxml", "node_models node-ascxml shared.ascxml"),
        "two.xml": system_file("node_models node-ascxml b.ascxml", "node_models node-ascxml shared.ascxml"),
        "a.ascxml": machine.format("A", "e", "e"),
        "b.ascxml": machine.format("B", "e", "taken"),
        "shared.ascxml": machine.format("S", "e", "e"),
        "other.ascxml": machine.format("O", "e", "e"),
    }
    analysis = load(tmp_path, files)
    place = caret(tmp_path, "a.ascxml", 'event="|e"')
    renaming = rename(analysis, *place, "f")
    assert isinstance(renaming, Renaming)
    assert {Path(path).name: len(edits) for path, edits in renaming.edits.items()} == {
        "a.ascxml": 2,
        "b.ascxml": 1,
        "shared.ascxml": 2,
    }
    assert isinstance(rename(analysis, *place, "taken"), RenameRefusal)


def test_an_interface_that_is_its_own_handle(tmp_path: Path) -> None:
    text = """<ascxml name="A" version="1.0" initial="s">
<ros_topic_subscriber topic="/x" type="std_msgs/Empty"/><ros_topic_publisher name="y" topic="z" type="std_msgs/Empty"/>
<state id="s"><ros_topic_callback name="/x" target="s"><ros_topic_publish name="y"/></ros_topic_callback></state>
</ascxml>"""
    analysis = load(tmp_path, {"a.ascxml": text})
    place = caret(tmp_path, "a.ascxml", 'callback name="/|x"')
    renaming = rename(analysis, *place, "w")
    assert isinstance(renaming, Renaming)
    assert apply_edits(text, renaming.edits[place[0]]) == text.replace("/x", "/w")
    assert isinstance(rename(analysis, *place, "y"), RenameRefusal)
    assert isinstance(rename(analysis, *place, "z"), RenameRefusal)
    assert isinstance(rename(analysis, *caret(tmp_path, "a.ascxml", 'publish name="|y"'), "/x"), RenameRefusal)


@pytest.mark.parametrize("main", sorted((ROOT / "examples").glob("*/main.xml")), ids=lambda main: main.parent.name)
def test_examples(main: Path) -> None:
    system = System(str(main))
    for case in system.cases():
        assert list(system.failures(case)) == [], case.name


@pytest.mark.parametrize("robot", [ROBOT, CORNERS], ids=["robot", "corners"])
def test_all_of_a_small_system(robot: str, tmp_path: Path) -> None:
    load(tmp_path, split_files(robot))
    system = System(str(tmp_path / "main.xml"))
    cases = list(system.cases())
    assert len(cases) > 20
    for case in cases:
        assert list(system.failures(case)) == [], case.name

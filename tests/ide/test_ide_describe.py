# SPDX-License-Identifier: Apache-2.0
"""Descriptions of symbols in Markdown: whole texts, as a user sees them."""

from __future__ import annotations

from pathlib import Path

import pytest
from ide_models import ROBOT, load

from fixture import split_files
from roaml.diagnostics import Symbol
from roaml.expr.operators import FUNCTIONS, Operator, UnaryOperator
from roaml.ide.describe import describe
from roaml.ide.describe import language as describe_language
from roaml.ide.describe.comment import remark
from roaml.ide.describe.markdown import file, name, names, plain, prose
from roaml.language import BEHAVIOR_TREE, HL_SCXML, STRUCTS, SYSTEM
from roaml.roles import SymbolKind
from roaml.xml_syntax import parse

FILES = split_files(ROBOT)

CASES = """
a.ascxml variable p
  p : Pose
  Starts as {'x': 1.0}
  Gets _event.data.to.x
  Read once, written once
  In JANI p__x of A
plugin.ascxml variable n
  n : int32
  From −2 147 483 648 to 2 147 483 647 · starts as 0
  Gets port goal
  Read twice, written once
  In JANI n of BT_plugin_1001_Walk, BT_plugin_1002_w
a.ascxml state s
  initial state s
  From s on go, a message on input
  To s on go, a message on input
  In JANI location s of A
a.ascxml subscriber input
  subscriber input : std_msgs/Int32
  Topic /a/b
  Published by Walk · subscribed to by A
  In plain SCXML event topic_a__b_msg
  In properties topic_a__b_msg.valid, topic_a__b_msg__ros_fields__data
plugin.ascxml publisher pub
  publisher pub : std_msgs/Int32
  Its name comes from port topic
  Topic /a/b
  Published by Walk · subscribed to by A
  In plain SCXML event topic_a__b_msg
  In properties topic_a__b_msg.valid, topic_a__b_msg__ros_fields__data
  Topic /c
  Published by Walk · subscribed to by nobody
  In plain SCXML event topic_c_msg
  In properties topic_c_msg.valid, topic_c_msg__ros_fields__data
plugin.ascxml port goal
  in goal : int32
  Port of Walk
  Holds {g} in bt_1001, bt_1002
plugin.ascxml machine Walk
  plugin Walk
    in goal : int32
    in topic : string
    out out : int32
  Publishes port topic
  2 nodes in Main, Sub: BT_plugin_1001_Walk, BT_plugin_1002_w
  plugin.ascxml
a.ascxml machine A
  node A
  Listens to /a/b
  Sends go
  Receives go
  In JANI automaton A
  a.ascxml
main.xml event go
  event go(to : Pose)
  Sent by A · received by A
  In properties go.valid, go__to__x
main.xml parameter to go
  to : Pose
  Parameter of event go
  Sent by A · read by A
  In properties go__to__x
main.xml struct Pose
  struct Pose
    x : float64
  types.xml
main.xml member x Pose
  x : float64
  Member of struct Pose
main.xml tree Sub
  tree Sub
  One node · tree.xml
  Used once
tree.xml blackboard own Sub
  {own} : int32
  Blackboard variable of tree Sub
  Written by Walk.out · read by nobody
  In properties bt_blackboard_set_Sub__own.valid, bt_blackboard_set_Sub__own__value, bt_blackboard_get__Sub__own
main.xml plugin Nobody
  plugin Nobody
  No plugin of the system has this name
"""


def cases() -> list[tuple[str, list[str]]]:
    rows: list[tuple[str, list[str]]] = []
    for line in CASES.strip().splitlines():
        if line.startswith("  "):
            rows[-1][1].append(line[2:])
        else:
            rows.append((line, []))
    return rows


@pytest.mark.parametrize(("asked", "expected"), cases())
def test_names(tmp_path: Path, asked: str, expected: list[str]) -> None:
    analysis = load(tmp_path, FILES)
    file, kind, called, *scope = asked.split()
    text = describe(analysis, Symbol(str(tmp_path / file), SymbolKind(kind), called, " ".join(scope)))
    shown = [line for line in plain(text).replace("\u202f", " ").splitlines() if line]
    assert shown == expected


def test_ros_definitions(tmp_path: Path) -> None:
    analysis = load(tmp_path, FILES)
    text = describe(analysis, Symbol("", SymbolKind.ROS_TYPE, "std_msgs/Int32", "msg"))
    assert text.startswith("```rosmsg\n# std_msgs/Int32\n")
    assert "\nint32 data\n```" in text
    assert describe(analysis, Symbol("", SymbolKind.ROS_TYPE, "std_msgs/Nothing", "msg")) == ""
    field = describe(analysis, Symbol("", SymbolKind.FIELD, "data", "std_msgs/Int32"))
    assert plain(field).splitlines() == ["int32 data", "", "Field of std_msgs/Int32"]


def test_every_entry_of_the_languages_is_described() -> None:
    for grammar in (HL_SCXML, SYSTEM, BEHAVIOR_TREE, STRUCTS):
        for element in grammar.elements.values():
            text = describe_language.element(element)
            assert element.documentation in text
            for attribute in element.attributes.values():
                assert attribute.documentation in describe_language.attribute(attribute)
                for choice in attribute.simple.choices:
                    assert choice.documentation in describe_language.choice(choice)


def test_every_function_and_operator_is_described() -> None:
    for function in FUNCTIONS.values():
        assert describe_language.function(function).startswith(f"```\nMath.{function.name}(")
    for operator in (*Operator, *UnaryOperator):
        assert operator.symbol in describe_language.operator(operator)
    assert describe_language.signature(FUNCTIONS["log"]) == "Math.log(x, base?) : float"


REMARKS = """<a><!-- of b --><b/>
  <!-- no remark: an empty line follows -->

  <c/> <!-- behind c -->
  <!-- SPDX-License-Identifier: none -->
  <d/>
  <!-- the level, TYPE e:int8 -->
  <e/>
  <f/><!-- behind f --><g/>
</a>"""


def test_remarks() -> None:
    document = parse(REMARKS)
    assert document.root is not None
    texts = {element.name: remark(document, element) for element in document.root.elements}
    expected = {"b": "of b", "c": "behind c", "d": "", "e": "the level", "f": "behind f", "g": ""}
    assert texts == expected


def test_pieces() -> None:
    assert name("a`b") == "``a`b``"
    assert name("`") == "`` ` ``"
    assert names("abc") == "`a`, `b`, `c`"
    assert names(map(str, range(20)), 2) == "`0`, `1` and 18 more"
    assert prose("One\nline.\n\n<b>") == "One line.\n\n&lt;b>"
    assert plain("**Bold** `code`  \n[link](x) \\<b>\n\n---\n\n```xml\n<a **b**>\n```\n\nend") == (
        "Bold code\nlink <b>\n\n<a **b**>\n\nend"
    )
    assert file("/a/b_c*d.xml") == r"*b\_c\*d.xml*"
    assert plain(file("a/b_c*d.xml")) == "b_c*d.xml"
    assert plain("``a`b`` and 2 * 3 * 4") == "a`b and 2 * 3 * 4"

# SPDX-License-Identifier: Apache-2.0
"""Hover texts."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from ide_case import analysis_of, one_file, path_of
from ide_models import CORNERS, ROBOT, load

from fixture import split_files
from fuzz.corpus import systems
from roaml import api
from roaml.ide.describe import language as describe_language
from roaml.ide.describe.markdown import plain
from roaml.ide.hover import hover
from roaml.language import HL_SCXML
from roaml.language.json_schema import PROPERTIES
from roaml.project.settings import SETTING_DOCUMENTATION, TABLES_OF_SETTINGS, VALUES_OF_SETTINGS, Settings

MODELS = {"robot": split_files(ROBOT), "corners": split_files(CORNERS)}

# model, file, a piece of its text with a caret, what is among the text that is shown
CASES = """
robot  a.ascxml  <sta|te id  a state of the machine
robot  a.ascxml  </sta|te>  a state of the machine
robot  a.ascxml  id="|p" type  p : Pose
robot  a.ascxml  type="P|ose"  struct Pose | x : float64
robot  a.ascxml  type="in|t32"  From −2
robot  a.ascxml  event="g|o" target  event go(to : Pose) | Sent by A · received by A
robot  a.ascxml  topic="/|a/b"  topic a/b : std_msgs/Int32 | Published by Walk | topic_a__b_msg.valid
robot  a.ascxml  type="std_msgs/|Int32"  # std_msgs/Int32 | int32 data
robot  a.ascxml  target="|s"><assign  state s | From s | To s
robot  a.ascxml  _m|sg.data  _msg : std_msgs/Int32 | The message that has arrived
robot  a.ascxml  _event.da|ta.to  _event.data | to : Pose
robot  a.ascxml  _event.data.t|o.x  to : Pose | Parameter of event go
robot  a.ascxml  data.to.|x  x : float64 | Member of struct Pose
robot  a.ascxml  _msg.d|ata  int32 data | Field of std_msgs/Int32
robot  a.ascxml  versi|on=  version="…" | always 1.0
robot  tree.xml  goal="{|g}" out  {g} : int32 | Written by Walk.out · read by Walk.goal
robot  tree.xml  <W|alk  plugin Walk | in goal : int32 | BT_plugin_1001_Walk | goal ← {g}
robot  tree.xml  <S|equence>  control node Sequence | Ticks its children | BT_plugin_1000_Sequence
robot  tree.xml  name="|w"  node w | BT_plugin_1002_w
robot  tree.xml  go|al="{g}"  in goal : int32 | Holds {g} in bt_1001, bt_1002
robot  tree.xml  <Act|ion  A leaf that executes an action
robot  plugin.ascxml  <bt_ti|ck  the parent ticks this node | In plain SCXML bt_1001_tick, bt_1002_tick
robot  plugin.ascxml  <bt_return_|halted  In plain SCXML bt_1001_halt_response, bt_1002_halt_response
robot  main.xml  max_time value="|1"  1 s: 1 000 000 000 ns of the clock
robot  main.xml  unit="|s"  Seconds
robot  main.xml  src="a|.ascxml"  node A
robot  main.xml  src="tree|.xml"  Behavior trees Main, Sub
robot  main.xml  src="prop|erties.jani"  p: go.valid ∧ (go__to__x <
robot  main.xml  src="ty|pes.xml"  Structs Pose
robot  properties.jani  "|go.valid  go.valid : bool | has been sent | event go
robot  properties.jani  go__to__|x  go__to__x : float64 | member of struct Pose
robot  properties.jani  ros_fields__d|ata  int32 data | Field of std_msgs/Int32
robot  properties.jani  "|∧"  go.valid ∧ | Both operands hold
robot  properties.jani  "na|me"  Name of the property
robot  properties.jani  "name": "|p"  go.valid ∧ (
robot  properties.jani  "|op"  Operator
robot  properties.jani  blackboard_get|__Sub  bt_blackboard_get__Sub__own : int
corners  server.ascxml  id="s|um" expr  sum : int64 | the sum | Gets _req.a + _req.b
corners  server.ascxml  service_name="/c|alc"  service /calc | Served by Server · called by Ask
corners  server.ascxml  sum &lt; 3 &|amp;&amp;  bool && bool | both
corners  server.ascxml  sum &l|t; 3  number < number
corners  tree.xml  ID="Sa|me" v="{=}"  tree Same | 4 nodes
corners  properties.jani  "op": "Pm|in"  Pmin(F ( | minimum probability
"""


COMPARISON = '{"op": "OP", "left": "bt_1001_response__status", "right": NUMBER}'


def hover_in(text: str, at: str, name: str = "properties.jani") -> str | None:
    analysis = analysis_of({name: text})
    actual_hover = hover(analysis, path_of(name), text.index(at))
    return plain(actual_hover.text) if actual_hover else None


@pytest.mark.parametrize(("number", "name"), [("1", "SUCCESS"), ("2", "FAILURE"), ("3", "RUNNING")])
def test_numbers_of_status(number: str, name: str) -> None:
    for op in ("=", "≠", "=="):
        formula = COMPARISON.replace("OP", op).replace("NUMBER", number)
        text = '{"properties": [{"name": "p", "expression": {"op": "F", "exp": FORMULA}}]}'
        shown = hover_in(text.replace("FORMULA", formula), f"{number}}}")
        assert shown is not None
        assert shown.startswith(f"{number} = {name}\n")
        assert "1 = SUCCESS, 2 = FAILURE, 3 = RUNNING" in shown
    other = text.replace("FORMULA", formula.replace("bt_1001_response__status", "level"))
    assert hover_in(other, f"{number}}}") is None
    turned = text.replace("FORMULA", f'{{"op": "=", "left": {number}, "right": "act_result_handle_client_a__code"}}')
    assert "4 = STATUS_SUCCEEDED" in (hover_in(turned, f'{number}, "right"') or "")


@pytest.mark.parametrize(
    ("name", "text", "at", "expected"),
    [
        ("as2fm.toml", '[verify]\nuniform = "fail"\n', "form", "Values: accept, warn, fail"),
        ("as2fm.toml", '[verify]\nexpect.alarm = ">= 0.9"\n', "expect", "The expected values of properties"),
        ("as2fm.toml", 'verify.scheduler = "uniform"\n', "scheduler", "only uniform choices are considered"),
        ("pyproject.toml", '[tool.as2fm]\ntree-semantics = "as2fm"\n', "semantics", "Values: behaviortree-cpp, as2fm"),
        ("pyproject.toml", '[project]\nroots = "as2fm"\n', "roots", None),
        ("as2fm.toml", "[verify]\nuniform = \n", "form", None),
        ("as2fm.toml", "[severity]\nshort-time = 'hint'\n", "time", None),
    ],
)
def test_settings(name: str, text: str, at: str, expected: str | None) -> None:
    shown = hover_in(text, at, name)
    assert shown is None if expected is None else expected in (shown or "")


@pytest.mark.parametrize(
    ("text", "at", "expected"),
    [
        ("Own: as Repeat(num_cycles=3)  # ours", "Repeat", "num_cycles"),
        ("Own: as Repeat(num_cycles=3)", "Own", None),
        ("Own: 0.5 in 2 s", "0.5", None),
        ("Own: as Nothing", "Nothing", None),
    ],
)
def test_mocks(text: str, at: str, expected: str | None) -> None:
    shown = hover_in(text, at, "tree.mocks")
    assert shown is None if expected is None else expected in (shown or "")


def test_every_setting_has_documentation() -> None:
    names = {f"{table}.{name}" if table else name for table, names in TABLES_OF_SETTINGS.items() for name in names}
    assert set(SETTING_DOCUMENTATION) == names
    assert set(VALUES_OF_SETTINGS) <= names


def test_every_operator_is_explained_in_models_too() -> None:
    for symbol, _ in PROPERTIES.operators("formula"):
        formula = f'{{"op": "{symbol}", "left": "a", "right": 1, "exp": "a"}}'
        model = f'{{"jani-version": 1, "automata": [{{"edges": [{{"guard": {{"exp": {formula}}}}}]}}]}}'
        for name, text in (("m.jani", model), ("p.jani", f'{{"properties": [{{"expression": {formula}}}]}}')):
            shown = hover_in(text, f'{symbol}", "left"', name)
            assert shown, (symbol, name)


@pytest.mark.parametrize("case", CASES.strip().splitlines())
def test_text(tmp_path: Path, case: str) -> None:
    model, name, marked, expected = case.split("  ")
    analysis = load(tmp_path, MODELS[model])
    before, _, after = marked.partition("|")
    path = str(tmp_path / name)
    source = analysis.source(path)
    assert source is not None
    at = source.text.index(before + after) + len(before)
    actual_hover = hover(analysis, path, at)
    assert actual_hover is not None
    assert actual_hover.span.start <= at <= actual_hover.span.end
    text = plain(actual_hover.text).replace("\u202f", " ")
    for part in expected.split(" | "):
        assert part.lower() in text.lower(), text


MACHINE = """<ascxml name="M" version="1.0" initial="s">
  <datamodel>
    <data id="a" type="int32[3]" expr="[]"/>
    <data id="b" type="float64" lower_bound_incl="0.0" upper_bound_incl="9.0" expr="0.5"/>
  </datamodel>
  <ros_time_rate name="t" rate_hz="20"/>
  <state id="s">
    <transition cond="a.length &gt; 1" target="s">
      <assign location="d" expr="-Math.pow(b, a[0] % 2) + (b &gt; 1 ? 2 : 7)"/>
      <assign location="b" expr="Math.abs(b) + 1"/>
      <assign location="c" expr="1 + a[0]"/>
    </transition>
    <bt_child_status id="0" cond="_bt.status == SUCCESS" target="s"/>
    <ros_rate_callback name="t" target="done"/>
  </state>
</ascxml>"""

# a piece of the machine with a caret, the text that is shown
ALONE = """
rate_hz="|20  20 Hz: every 50 ms
name="|t" rate  timer t|20 Hz: every 50 ms
M|ath.pow  Math|Functions: abs, ceil, cos, floor, log, max, min, pow, random, sin
Math.p|ow  Math.pow(x, y) : float|x to the power of y.
"|-Math  -number : int or float|The negative.
a[0] |% 2  number % number : int or float|The remainder of the division.
1 |? 2  bool ? x : y|The first value if the condition holds, otherwise the second.
a.l|ength  length : int|The current number of elements of a. A smaller number shortens the array, and 0 empties it.
SUCC|ESS  SUCCESS = 1|The status of a tree node.
_b|t.status  _bt|  status : int8|The status that the child has returned.
"|b" t  b : float64|Intended range 0.0 to 9.0 · starts as 0.5|Gets Math.abs(b) + 1|Read 3 times, written once
id="|a" type  a : int32[3]|From −2 147 483 648 to 2 147 483 647 · at most 3 elements · starts as []|Read 3 times
n="|c" expr  c : int|Not declared|Gets 1 + a[0]|Written once
target="|done  state done|Not defined|From s on the timer t|No transition leads away
"""


@pytest.mark.parametrize("case", ALONE.strip().splitlines())
def test_a_machine_alone(case: str) -> None:
    marked, expected = case.split("  ", 1)
    analysis, path = one_file(MACHINE)
    before, _, after = marked.partition("|")
    actual_hover = hover(analysis, path, MACHINE.index(before + after) + len(before))
    assert actual_hover is not None
    shown = [line for line in plain(actual_hover.text).replace("\u202f", " ").splitlines() if line]
    assert shown == expected.split("|")


def test_every_event_variable_is_explained() -> None:
    for element in HL_SCXML.elements.values():
        for binding in element.binds:
            assert binding.name in describe_language.EVENT_VARIABLES


def test_every_operator_and_key_of_properties_is_called_something() -> None:
    operators = dict(PROPERTIES.operators("formula"))
    assert {"filter", "Pmin", "U", "∧", "sin", "ite", "initial", "aa"} <= operators.keys()
    assert operators.keys() >= dict(PROPERTIES.operators("expression")).keys()
    for name, definition in PROPERTIES.root["$defs"].items():
        if "properties" in definition:
            assert PROPERTIES.title(definition), name
            untitled = {key for key, schema in definition["properties"].items() if not PROPERTIES.title(schema)}
            assert untitled <= {"op", "var"}, name


def test_every_place_of_some_systems() -> None:
    """No place causes an exception or a range outside of the file, and many places have a hover text."""
    hovers = 0
    for model in systems()[-3:]:
        analysis = api.check([model.main], model.ros_paths, Settings(), model.texts).snapshot.analysis
        for path, text in model.texts.items():
            for offset in range(0, len(text) + 1, 7):
                actual_hover = hover(analysis, path, offset)
                if actual_hover is not None:
                    assert 0 <= actual_hover.span.start <= offset <= actual_hover.span.end <= len(text)
                    hovers += 1
    assert hovers > 100


def test_half_typed(tmp_path: Path) -> None:
    """Any prefix of a file, and any file with a part removed, can be requested at any place."""
    choose = random.Random(7)
    for name, text in MODELS["corners"].items():
        for _ in range(6):
            cut, length = choose.randrange(len(text)), choose.choice((1, 5, 10**6))
            broken = text[:cut] + text[cut + length :]
            files = {**MODELS["corners"], name: broken}
            analysis = load(tmp_path, files)
            for offset in {cut, *(choose.randrange(len(broken) + 1) for _ in range(10))}:
                actual_hover = hover(analysis, str(tmp_path / name), min(offset, len(broken)))
                assert actual_hover is None or (actual_hover.span.end <= len(broken) and plain(actual_hover.text))

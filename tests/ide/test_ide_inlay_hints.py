# SPDX-License-Identifier: Apache-2.0
"""Inlay hints, lenses and signatures, each as one string."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from ide_case import analysis_of, marked, one_file, path_of
from ide_models import CORNERS, ROBOT, load

from fixture import split_files
from roaml.ide.code_lens import counted, lenses
from roaml.ide.describe.markdown import plain
from roaml.ide.hierarchy.types import holders_of, members_of, types_at
from roaml.ide.inlay_hints import ALL_HINTS, HintKind, explain, inlay_hints
from roaml.ide.signature_help import signature_help
from roaml.project.analysis import Analysis
from roaml.text import Span

MODELS = {"robot": split_files(ROBOT), "corners": split_files(CORNERS)}


def shown(analysis: Analysis, path: str, kinds: frozenset[HintKind] = ALL_HINTS, within: Span | None = None) -> str:
    """A file with its hints in it."""
    source = analysis.source(path)
    assert source is not None
    text = source.text
    for hint in reversed(inlay_hints(analysis, path, within or Span(0, len(text)), kinds)):
        text = f"{text[: hint.offset]}«{hint.text}»{text[hint.offset :]}"
    return text


HINTS = {
    ("robot", "a.ascxml"): [
        '<param name="to"« : Pose» expr="p"/>',
        '<transition event="go"«(to : Pose)» target="s">',
        '<ros_topic_callback name="input"« → /a/b» target="s">',
    ],
    ("robot", "plugin.ascxml"): [
        '<topic><bt_get_input key="topic"« : string»« = /a/b, /c»/></topic>',
        '<expr><bt_get_input key="goal"« : int32»/></expr>',
        '<bt_set_output key="out"« : int32» expr="n"/>',
        '<ros_topic_publish name="pub"« → /a/b, /c»><field name="data"« : int32» expr="n"/>',
    ],
    ("robot", "tree.xml"): [
        "<Sequence« bt_1000»>",
        '<Walk« bt_1001» goal="{g}"« : int32» out="{g}"« : int32» topic=" /a/b "« : string»/>',
        '<Action ID="Walk"« bt_1002» name="w"',
    ],
    ("corners", "server.ascxml"): [
        '<data id="sum"« : int64» expr="0"/>',
        '<param name="of"« : Shape» expr="shape"/><param name="n"« : int64» expr="sum"/>',
        '<transition event="small.sum"«(of : Shape, n : int64)» cond=',
        '<ros_service_handle_request name="/calc" target="idle">',
        '<field name="sum"« : int64» expr="sum"/>',
    ],
    ("corners", "ask.ascxml"): [
        '<bt_get_input key="which"« : string»« = /calc»/>',
        '<ros_service_send_request name="calc">',
        '<field name="a"« : int64» expr="1"/><field name="b"« : int64» expr="2"/>',
    ],
    ("corners", "tree.xml"): ['<Put« bt_1006, bt_1010, bt_1014» value="{v}"'],
}


@pytest.mark.parametrize(("model", "name"), HINTS)
def test_hints(tmp_path: Path, model: str, name: str) -> None:
    text = shown(load(tmp_path, MODELS[model]), str(tmp_path / name))
    for line in HINTS[model, name]:
        assert line in text, text


def test_hints_of_properties(tmp_path: Path) -> None:
    text = '{"properties": [{"name": "p", "expression": {"op": "=", "left": "bt_1001_response__status", "right": 1}}]}'
    analysis = load(tmp_path, {**MODELS["robot"], "properties.jani": text})
    assert '"bt_1001_response__status"« Main/Walk»,' in shown(analysis, str(tmp_path / "properties.jani"))


def test_only_the_requested_hints(tmp_path: Path) -> None:
    analysis, path = load(tmp_path, MODELS["robot"]), str(tmp_path / "a.ascxml")
    whole = Span(0, 10**6)
    for kind in HintKind:
        assert {hint.kind for hint in inlay_hints(analysis, path, whole, frozenset([kind]))} <= {kind}
    all_hints = inlay_hints(analysis, path, whole)
    assert {hint.kind for hint in all_hints} == {HintKind.TYPES, HintKind.TOPICS, HintKind.EVENTS}
    for first in range(0, len(MODELS["robot"]["a.ascxml"]), 50):
        within = Span(first, first + 50)
        expected = [hint for hint in all_hints if within.start <= hint.offset <= within.end]
        assert list(inlay_hints(analysis, path, within)) == expected


def test_what_hints_name(tmp_path: Path) -> None:
    analysis = load(tmp_path, MODELS["robot"])
    descriptions = []
    for name in ("a.ascxml", "tree.xml"):
        for hint in inlay_hints(analysis, str(tmp_path / name), Span(0, 10**6)):
            for part in hint.parts:
                if part.symbol is not None:
                    explanation = explain(analysis, part.symbol)
                    place = Path(explanation.location.path).name if explanation.location else ""
                    descriptions.append(f"{part.text}: {plain(explanation.text).splitlines()[0]} ({place})")
    assert "Pose: struct Pose (types.xml)" in descriptions
    assert "/a/b: topic a__b : std_msgs/Int32 (a.ascxml)" in descriptions
    assert "bt_1000: In JANI automaton BT_plugin_1000_Sequence (behaviortree_cpp.txt)" in descriptions
    assert "bt_1002: In JANI automaton BT_plugin_1002_w (plugin.ascxml)" in descriptions


LENSES = """
robot a.ascxml
  3 subscriber input: 1 publisher · 1 subscriber
  5 event go: sent once · received once
robot plugin.ascxml
  1 machine Walk: 2 uses in trees
  2 port goal: set twice in trees
  3 port topic: set twice in trees
  4 port out: set twice in trees
  6 publisher pub: 2 topics: 1 publisher · 1 subscriber / 1 publisher · no subscribers
robot tree.xml
  2 tree Main: executed · 1 use
  9 tree Sub: 1 use
robot types.xml
  1 struct Pose: 1 use
corners server.ascxml
  7 service-server /calc: 1 server · 3 clients
  13 event small.sum: sent once · received once
corners ask.ascxml
  1 machine Ask: 2 uses in trees
  2 port which: set twice in trees
  3 service-client calc: 1 server · 3 clients
"""


def lens_cases() -> list[tuple[str, str, list[str]]]:
    rows: list[tuple[str, str, list[str]]] = []
    for line in LENSES.strip().splitlines():
        if line.startswith("  "):
            rows[-1][2].append(line[2:])
        else:
            model, name = line.split()
            rows.append((model, name, []))
    return rows


@pytest.mark.parametrize(("model", "name", "expected"), lens_cases())
def test_lenses(tmp_path: Path, model: str, name: str, expected: list[str]) -> None:
    analysis, path = load(tmp_path, MODELS[model]), str(tmp_path / name)
    source = analysis.source(path)
    assert source is not None
    rows = []
    for lens in lenses(analysis, path):
        line = source.lines.position(lens.span.start).line + 1
        uses = counted(analysis, lens.symbol, path)
        rows.append(f"{line} {lens.symbol.kind.value} {lens.symbol.name}: {uses.title}")
        assert all(analysis.source(place.path) is not None for place in uses.places)
        assert uses.places == tuple(sorted(set(uses.places)))
    assert rows == expected


# an expression with the caret, and what is called there: the active parameter in brackets
SIGNATURES = """
Math.max(‸a, b)  Math.max([a], b, …) : int or float
Math.max(a,‸ b)  Math.max(a, [b], …) : int or float
Math.max(a‸  Math.max([a], b, …) : int or float
Math.max(a, ‸  Math.max(a, [b], …) : int or float
Math.max(a, b, ‸  Math.max(a, [b], …) : int or float
Math.max(Math.pow(1, ‸2), b)  Math.pow(x, [y]) : float
Math.max(Math.pow(1, 2), ‸b)  Math.max(a, [b], …) : int or float
Math.max((1 + ‸  Math.max([a], b, …) : int or float
Math.max([1, 2][‸0], 3)  Math.max([a], b, …) : int or float
Math.max('(,', ‸  Math.max(a, [b], …) : int or float
Math . log (8, ‸  Math.log(x, [base]?) : float
1 &lt; Math.min(a &amp;&amp; b, ‸  Math.min(a, [b], …) : int or float
Math.random(‸)  Math.random() : float
Math.max(1, 2)‸
‸Math.max(1, 2)
Math.nothing(‸
f(‸
(1, ‸
"""


@pytest.mark.parametrize("case", SIGNATURES.strip("\n").splitlines())
@pytest.mark.parametrize("end", ['"/></state></ascxml>', '"', ""])
def test_signatures(case: str, end: str) -> None:
    expression, _, expected = case.partition("  ")
    head = '<ascxml name="M" version="1.0" initial="s"><state id="s"><transition target="s" cond="'
    text, (caret,), _ = marked(f"{head}{expression}{end}")
    analysis, path = one_file(text)
    signature = signature_help(analysis, path, caret)
    if not expected:
        assert signature is None
        return
    assert signature is not None
    label = signature.label
    if signature.active is not None:
        start, stop = signature.parameters[signature.active]
        label = f"{label[:start]}[{label[start:stop]}]{label[stop:]}"
    assert label == expected
    assert signature.documentation


STRUCTS = {
    "main.xml": MODELS["robot"]["main.xml"],
    "types.xml": """<types><struct id="Point"><member id="x" type="int32"/></struct>
<struct id="Line"><member id="a" type="Point"/><member id="b" type="Point"/></struct>
<struct id="Shape"><member id="sides" type="Line[]"/><member id="at" type="Point"/></struct></types>""",
    "a.ascxml": """<ascxml name="A" version="1.0" initial="s">
<ros_topic_publisher name="p" topic="t" type="geometry_msgs/Twist"/>
<datamodel><data id="l" type="Line" expr="{'a': {'x': 1}, 'b': {'x': 1}}"/></datamodel>
<state id="s"/></ascxml>""",
}

# file, a piece of it with a caret, the types there, their parts, what holds them
HIERARCHY = """
types.xml  id="|Point"  Point: struct    Line: a, b; Shape: at
types.xml  id="L|ine"  Line: struct  Point: a, b  Shape: sides
a.ascxml  "|l" type  Line: struct  Point: a, b  Shape: sides
a.ascxml  Tw|ist  geometry_msgs/Twist: message  geometry_msgs/Vector3: linear, angular  
types.xml  |types
"""  # noqa: W291 - nothing holds a Twist


@pytest.mark.parametrize("case", HIERARCHY.strip("\n").splitlines())
def test_what_types_are_made_of(tmp_path: Path, case: str) -> None:
    name, piece, *expected = case.split("  ")
    analysis = load(tmp_path, STRUCTS)
    before, _, after = piece.partition("|")
    path = str(tmp_path / name)
    at = types_at(analysis, path, STRUCTS[name].index(before + after) + len(before))
    texts = [
        "; ".join(f"{item.symbol.name}: {item.detail}" for item in items)
        for items in (at, *((ask(analysis, at[0].symbol) for ask in (members_of, holders_of)) if at else ()))
    ]
    assert texts == (expected or [""])


def test_holders_of_messages(tmp_path: Path) -> None:
    analysis = load(tmp_path, STRUCTS)
    (twist,) = types_at(analysis, str(tmp_path / "a.ascxml"), STRUCTS["a.ascxml"].index("Twist"))
    (vector,) = members_of(analysis, twist.symbol)
    assert [(item.symbol.name, item.detail) for item in holders_of(analysis, vector.symbol)] == [
        ("geometry_msgs/Twist", "linear, angular")
    ]


def test_damaged_documents() -> None:
    """Any prefix, and any text with a part removed: no failure, and no place outside of the text."""
    choose = random.Random(11)
    for files in MODELS.values():
        for name, text in files.items():
            for _ in range(5):
                cut, length = choose.randrange(len(text)), choose.choice((1, 6, 10**6))
                broken = text[:cut] + text[cut + length :]
                analysis = analysis_of({**files, name: broken})
                path = path_of(name)
                for hint in inlay_hints(analysis, path, Span(0, len(broken))):
                    assert 0 <= hint.offset <= len(broken) + 1
                for lens in lenses(analysis, path):
                    assert 0 <= lens.span.start <= lens.span.end <= len(broken)
                    assert counted(analysis, lens.symbol, path).title
                signature_help(analysis, path, min(cut, len(broken)))
                types_at(analysis, path, min(cut, len(broken)))

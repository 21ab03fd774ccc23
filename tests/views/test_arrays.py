# SPDX-License-Identifier: Apache-2.0
"""Arrays are shown as the sources declare them: without unused elements, and with the changes of their lengths."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

import pytest

from as2fm_lsp.cli.interactive import Terminal
from as2fm_lsp.outputs import OutputFiles
from roaml import api
from roaml.jani.expressions import ArrayValue, Integer
from roaml.jani.model import Automaton, Variable
from roaml.jani.types import INT, ArrayType
from roaml.smc.record import Plain, RecordedVariable, TraceStep, VariableChange
from roaml.views.arrays import ArrayReader, DeclaredValue, declared, without_lengths
from roaml.views.story import as_text

COLLECTOR = """<ascxml name="Collector" version="1.0" initial="ask">
    <datamodel>
        <data id="levels" type="int32[5]" expr="[7, 8]" />
        <data id="grid" type="int32[2][3]" expr="[]" />
    </datamodel>
    <state id="ask">
        <transition target="full">
            <assign location="levels[3]" expr="9" />
            <assign location="grid[1][0]" expr="4" />
            <send event="levels"><param name="values" expr="levels" /></send>
        </transition>
    </state>
    <state id="full">
        <transition event="levels" target="empty">
            <assign location="levels.length" expr="0" />
        </transition>
    </state>
    <state id="empty" />
</ascxml>"""
MAIN = """<roaml>
    <parameters><max_time value="1" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="collector.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>"""
PROPERTIES = """{"properties": [{"name": "sent", "expression": {"op": "filter", "fun": "values",
    "values": {"op": "Pmin", "exp": {"op": "F", "exp": {"op": "=", "left": "levels__values", "right": {"op": "av",
    "elements": [1]}}}}, "states": {"op": "initial"}}}]}"""


@pytest.fixture
def main(tmp_path: Path) -> Path:
    files = {"main.xml": MAIN, "properties.jani": PROPERTIES, "collector.ascxml": COLLECTOR}
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path / "main.xml"


def test_a_story_shows_used_elements(main: Path) -> None:
    session = api.session(api.load(str(main)))
    while session.step() is not None:
        pass
    text = as_text(session.story(), lambda _: "")
    assert "levels: [7, 8] → [7, 8, 0, 9]" in text
    assert "grid: [] → [[], [4]]" in text
    assert "levels: [7, 8, 0, 9] → []" in text
    assert "sends levels (values: [7, 8, 0, 9])" in text
    assert "_len" not in text


def test_the_terminal_shows_used_elements(main: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = api.as_target(api.load(str(main)))
    Terminal(api.session(target), target, OutputFiles(target.files)).run(StringIO("t\ns\nt\ns\nq\n"))
    text = capsys.readouterr().out
    assert "levels: [7, 8] → [7, 8, 0, 9], grid: [] → [[], [4]]" in text
    assert "Collector: full (levels: [7, 8, 0, 9], grid: [[], [4]])" in text
    assert "levels: [7, 8, 0, 9] → []" in text
    assert "Collector: empty (levels: [], grid: [[], [4]])" in text
    assert "(values: [7, 8, 0, 9])" in text


def test_lengths_of_rows() -> None:
    stored: dict[str, Plain] = {"a": [[1, 2], [3, 4], [5, 6]], "a.d1_len": 2, "a.d2_len": [0, 1, 2], "b": [1, 0]}
    assert without_lengths(stored) == {"a": [[], [3]], "b": [1, 0]}
    assert declared("a", [[9, 9], [8, 8], [7, 7]], stored) == [[], [8]]


def test_a_change_of_a_length_is_one_of_its_array() -> None:
    """The first change of an array may be that of its length; elements beyond the length are not shown."""
    variables = (
        Variable("a", ArrayType(INT), ArrayValue((Integer(5), Integer(6), Integer(0)))),
        Variable("a.d1_len", INT, Integer(2)),
    )
    reader = ArrayReader([Automaton("A", (), (), (), variables)], {"n": 3})

    def read(*changes: tuple[int, str, Plain, Plain]) -> list[tuple[str, DeclaredValue, DeclaredValue]]:
        step = TraceStep(
            1, None, (), tuple(VariableChange(RecordedVariable(i, name), old, new) for i, name, old, new in changes)
        )
        return [(change.variable.name, change.before, change.after) for change in reader.read(step)]

    assert read((0, "a.d1_len", 2, 1)) == [("a", [5, 6], [5])]
    assert read((0, "a", [5, 6, 0], [5, 7, 0])) == []
    assert read((0, "a.d1_len", 1, 3), (0, "a", [5, 7, 0], [4, 7, 8])) == [("a", [5], [4, 7, 8])]
    assert read((-1, "n", 3, 4), (-1, "list", [1, 2], [2, 2])) == [("n", 3, 4), ("list", [1, 2], [2, 2])]

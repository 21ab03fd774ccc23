# SPDX-License-Identifier: Apache-2.0
"""Strings are shown as texts and arrays of integers as arrays, according to their declared types."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

import pytest

from as2fm_lsp.cli.interactive import Terminal
from as2fm_lsp.outputs import OutputFiles
from roaml import api
from roaml.debugging.values import shown
from roaml.jani.types import element_of, is_text
from roaml.jani.writer import write
from roaml.simulation.session import Session
from roaml.smc.record import StoredText
from roaml.views.arrays import declared
from roaml.views.story import as_text
from roaml.views.values import shown_value

FILES = {
    "main.xml": """<roaml>
    <parameters><max_time value="1" unit="s" /></parameters>
    <data_declarations><input type="xml" src="tags.xml" /></data_declarations>
    <behavior_tree>
        <input type="bt.cpp-xml" src="bt.xml" />
        <input type="bt-plugin-ascxml" src="write.ascxml" />
        <input type="bt-plugin-ascxml" src="read.ascxml" />
    </behavior_tree>
    <node_models><input type="node-ascxml" src="sign.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>""",
    "tags.xml": """<types>
    <struct id="Tag">
        <member id="label" type="string" />
        <member id="codes" type="int32[3]" />
    </struct>
</types>""",
    "bt.xml": """<root BTCPP_format="4">
    <BehaviorTree ID="Main">
        <Sequence>
            <Write room="{room}" />
            <Read room="{room}" />
        </Sequence>
    </BehaviorTree>
</root>""",
    "write.ascxml": """<ascxml name="Write" version="1.0" initial="idle">
    <bt_declare_port_out key="room" type="string" />
    <state id="idle">
        <bt_tick target="idle">
            <bt_set_output key="room" expr="'Büro'" />
            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="idle"><bt_return_halted /></bt_halt>
    </state>
</ascxml>""",
    "read.ascxml": """<ascxml name="Read" version="1.0" initial="idle">
    <bt_declare_port_in key="room" type="string" />
    <datamodel><data id="seen" type="string" expr="''" /></datamodel>
    <state id="idle">
        <bt_tick target="idle">
            <assign location="seen"><expr><bt_get_input key="room" /></expr></assign>
            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="idle"><bt_return_halted /></bt_halt>
    </state>
</ascxml>""",
    "sign.ascxml": """<ascxml name="Sign" version="1.0" initial="start">
    <datamodel>
        <data id="angles" type="int32[3]" expr="[]" />
        <data id="room" type="string" expr="'Küche €'" />
        <data id="door" type="string" expr="'x'" />
        <data id="names" type="string[2]" expr="[]" />
        <data id="rows" type="int32[2][3]" expr="[]" />
        <data id="tag" type="Tag" expr="{'label': '', 'codes': []}" />
    </datamodel>
    <state id="start">
        <transition target="sent">
            <assign location="angles" expr="[90, 45, 60]" />
            <assign location="door" expr="''" />
            <assign location="names" expr="['Zoë', '']" />
            <assign location="rows" expr="[[72, 105], []]" />
            <assign location="tag.label" expr="'hall'" />
            <assign location="tag.codes" expr="[72, 105]" />
            <send event="shown">
                <param name="angles" expr="angles" />
                <param name="room" expr="room" />
                <param name="door" expr="door" />
                <param name="names" expr="names" />
            </send>
        </transition>
    </state>
    <state id="sent"><transition event="shown" target="done" /></state>
    <state id="done"><transition event="shown" target="done" /></state>
</ascxml>""",
    "properties.jani": '{"properties": []}',
}
PARAMETERS = "angles: [90, 45, 60], room: 'Küche €', door: '', names: ['Zoë', '']"


@pytest.fixture
def main(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path / "main.xml"


def finished(session: Session) -> Session:
    while session.step() is not None:
        pass
    return session


def unwrapped(text: str) -> str:
    return " ".join(text.split())


def test_a_story_uses_declared_types(main: Path) -> None:
    text = unwrapped(as_text(finished(api.session(api.load(str(main)))).story(), lambda _: ""))
    for change in (
        "angles: [] → [90, 45, 60]",
        "door: 'x' → ''",
        "names: [] → ['Zoë', '']",
        "rows: [] → [[72, 105], []]",
        "tag.label: '' → 'hall'",
        "tag.codes: [] → [72, 105]",
        "seen: '' → 'Büro'",
    ):
        assert change in text
    assert "sends shown (angles: [90, 45, 60], room: 'Küche €', door: ''" in text


def test_the_terminal_uses_declared_types(main: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = api.as_target(api.load(str(main)))
    Terminal(api.session(target), target, OutputFiles(target.files)).run(StringIO("s\ng 100000\ns\nq\n"))
    before, after = capsys.readouterr().out.split("Sign: start", 1)[1].split("Sign: done", 1)
    assert "angles: [], room: 'Küche €', door: 'x', names: [], rows: [], tag.label: '', tag.codes: []" in before
    assert "angles: [90, 45, 60], room: 'Küche €', door: '', names: ['Zoë', ''], rows: [[72, 105], []]" in after
    assert f"({PARAMETERS})" in after
    assert "room: 'Büro'" in after


def test_choices_use_declared_types(main: Path) -> None:
    session = api.session(api.load(str(main)))
    texts = set()
    while session.step() is not None:
        texts |= {choice.text for choice in session.choices()}
    assert any(text.endswith(f"({PARAMETERS})") for text in texts)


def test_parameters_of_events_are_declared_values(main: Path) -> None:
    session = finished(api.session(api.load(str(main))))
    assert session.parameters("shown") == {
        "angles": [90, 45, 60],
        "room": "Küche €",
        "door": "",
        "names": ["Zoë", ""],
    }


def test_a_jani_file_has_no_strings(main: Path) -> None:
    """A JANI file does not contain the mark; its strings are arrays of integers."""
    model = api.to_jani(api.load(str(main)))
    path = main.with_name("model.jani")
    path.write_text("".join(write(model)), encoding="utf-8")
    read, _ = api.read_jani(str(path))
    assert [variable.type for variable in read.variables] == [variable.type for variable in model.variables]
    (sign,) = (automaton for automaton in read.automata if automaton.name == "Sign")
    assert not any(is_text(variable.type) for variable in (*read.variables, *sign.variables))
    assert finished(api.session(read)).parameters("shown")["room"] == list("Küche €".encode())


def test_only_the_innermost_dimension_is_a_text(main: Path) -> None:
    model = api.to_jani(api.load(str(main)))
    types = {variable.name: variable.type for variable in model.variables}
    assert is_text(types["shown__room"])
    assert not is_text(types["shown__names"])
    assert is_text(element_of(types["shown__names"]))
    assert not is_text(types["shown__angles"])
    assert not is_text(types["shown__names.d2_len"])


def test_bytes_beyond_the_length_and_invalid_bytes() -> None:
    stored = StoredText([97, 98, 99, 0])
    assert declared("a", stored, {"a.d1_len": 2}) == "ab"
    assert declared("a", stored, {}) == "abc"
    assert declared("a", StoredText([97, 0, 98]), {"a.d1_len": 3}) == "a\0b"
    assert declared("a", StoredText([75, 252, 99]), {"a.d1_len": 3}) == "K\ufffdc"
    assert declared("a", [90, 45, 60], {"a.d1_len": 3}) == [90, 45, 60]


def test_the_debugger_uses_the_same_notation() -> None:
    for value in ("", "Küche €", "it's", "a\nb", 7, 1.5, True, ["a", ""]):
        assert shown(value) == shown_value(value)

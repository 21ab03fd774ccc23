# SPDX-License-Identifier: Apache-2.0
"""Properties in XML about the texts that plain events contain, alone, in structs and in arrays."""

from __future__ import annotations

from pathlib import Path

import pytest

from roaml import api

FILES = {
    "main.xml": """<roaml>
    <parameters><max_time value="1" unit="s" /></parameters>
    <data_declarations><input type="xml" src="types.xml" /></data_declarations>
    <node_models>
        <input type="node-ascxml" src="speaker.ascxml" />
        <input type="node-ascxml" src="listener.ascxml" />
    </node_models>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>""",
    "types.xml": """<types>
    <struct id="Sign"><member id="label" type="string" /><member id="size" type="int32" /></struct>
</types>""",
    "speaker.ascxml": """<ascxml name="Speaker" version="1.0" initial="first">
    <datamodel>
        <data id="sign" type="Sign" expr="{'label': 'stop', 'size': 3}" />
        <data id="levels" type="int32[3]" expr="[103, 111]" />
    </datamodel>
    <state id="first">
        <transition target="second">
            <send event="say">
                <param name="word" expr="'go'" /><param name="sign" expr="sign" />
                <param name="levels" expr="levels" />
            </send>
        </transition>
    </state>
    <state id="second" />
</ascxml>""",
    "listener.ascxml": """<ascxml name="Listener" version="1.0" initial="listen">
    <datamodel><data id="n" type="int32" expr="0" /></datamodel>
    <state id="listen">
        <transition event="say" target="listen" cond="_event.data.word == 'go'">
            <assign location="n" expr="_event.data.sign.size" />
        </transition>
    </state>
</ascxml>""",
    "properties.xml": """<properties>
    <ports>
        <scxml_event_send event="say">
            <state_var id="value" type="{type}" param="{param}" expr="{initial}" />
        </scxml_event_send>
    </ports>
    <guarantees>
        <property id="heard" pattern="existence"><event>value == {expected}</event><scope type="globally" /></property>
    </guarantees>
</properties>""",
}


def written(folder: Path, **replaced: str) -> str:
    for name, text in FILES.items():
        filled = text.format(**replaced) if name == "properties.xml" else text
        (folder / name).write_text(filled, encoding="utf-8")
    return str(folder / "main.xml")


@pytest.mark.parametrize(
    ("param", "expected", "value"),
    [
        ("word", "'go'", 1.0),
        ("word", "'gone'", 0.0),
        ("sign__label", "'stop'", 1.0),
        ("sign__label", "'go'", 0.0),
    ],
)
def test_a_text_is_compared(tmp_path: Path, param: str, expected: str, value: float) -> None:
    system = api.load(written(tmp_path, type="string", param=param, initial="''", expected=expected))
    (result,) = api.verify(system, exact_if_small=True)
    assert result.exact is not None
    assert (result.exact.minimum.lower, result.exact.maximum.upper) == (value, value)


def test_an_array_is_not_a_text(tmp_path: Path) -> None:
    main = written(tmp_path, type="string", param="levels", initial="''", expected="'go'")
    messages = [finding.message for finding in api.check([main]).diagnostics]
    assert "the type of `levels` is `int32[3]`, not `string`" in messages

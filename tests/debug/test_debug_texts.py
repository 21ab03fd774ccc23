# SPDX-License-Identifier: Apache-2.0
"""Strings are their UTF-8 bytes in the model (docs/spec/types.md#strings), and texts for the user."""

from __future__ import annotations

from pathlib import Path

import pytest
from dap_client import Client

FILES = {
    "main.xml": """<roaml>
    <parameters><max_time value="1" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="sign.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>""",
    "sign.ascxml": """<ascxml name="Sign" version="1.0" initial="start">
    <datamodel>
        <data id="room" type="string" expr="'Küche €'" />
        <data id="isKitchen" type="bool" expr="false" />
    </datamodel>
    <state id="start">
        <transition target="compared"><assign location="isKitchen" expr="room == 'Büro'" /></transition>
    </state>
    <state id="compared" />
</ascxml>""",
    "properties.jani": '{"properties": []}',
}


@pytest.fixture
def main(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path / "main.xml"


def test_a_string_is_decoded(main: Path) -> None:
    with Client() as client:
        client.begin(main)
        results = {
            text: client.ask("evaluate", expression=text)["result"]
            for text in ("Sign.room", "Sign.room.length", "Sign.room[1]", "Sign.room == 'Küche €'")
        }
    assert results == {
        "Sign.room": "'Küche €'",
        "Sign.room.length": "10",
        "Sign.room[1]": "195",
        "Sign.room == 'Küche €'": "true",
    }


def test_a_string_is_set(main: Path) -> None:
    """A string that is set equals the same string of the model."""
    with Client() as client:
        client.begin(main)
        thread = next(thread["id"] for thread in client.ask("threads")["threads"] if thread["name"].startswith("Sign"))
        frame = client.stack(thread)[0]["id"]
        reference = client.ask("scopes", frameId=frame)["scopes"][0]["variablesReference"]
        set_ = client.ask("setVariable", variablesReference=reference, name="room", value="'Büro'")
        assert set_["value"] == "'Büro'"
        client.event("stopped")
        while client.ask("choices")["end"] is None:
            client.move()
        assert client.ask("evaluate", expression="Sign.isKitchen")["result"] == "true"

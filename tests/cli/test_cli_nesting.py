# SPDX-License-Identifier: Apache-2.0
"""Formulas that are nested as deeply as JSON files may be, and more deeply."""

from __future__ import annotations

from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run

LAMP = """\
<ascxml name="Lamp" version="1.0" initial="off">
    <ros_time_rate name="blink" rate_hz="1" />
    <ros_topic_publisher name="light" topic="/light" type="std_msgs/Int32" />
    <state id="off">
        <ros_rate_callback name="blink" target="off">
            <ros_topic_publish name="light"><field name="data" expr="3" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>
"""
NOT = '{"op":"¬","exp":'
OR = '{"left":{"op":"=","left":"topic_light_msg__ros_fields__data","right":2},"op":"∨","right":'
COMMANDS = {
    "check": ("--check", "main.xml"),
    "verify": ("verify", "main.xml", "--explain"),
    "exhaustive": ("verify", "main.xml", "--exhaustive"),
    "simulate": ("simulate", "main.xml", "--max-steps", "9"),
    "translate": ("translate", "main.xml", "-o", "model.jani"),
    "draw": ("draw", "main.xml", "-o", "network.svg"),
}


def write(folder: Path, part: str, depth: int) -> None:
    (folder / "lamp.ascxml").write_text(LAMP)
    (folder / "main.xml").write_text(
        '<roaml><parameters><max_time value="3" unit="s" /></parameters>'
        '<node_models><input type="node-ascxml" src="lamp.ascxml" /></node_models>'
        '<properties><input type="jani" src="p.jani" /></properties></roaml>'
    )
    formula = part * depth + "true" + "}" * depth
    (folder / "p.jani").write_text(
        '{"properties": [{"name":"a","expression":{"op":"filter","fun":"values","states":{"op":"initial"},'
        f'"values":{{"op":"Pmin","exp":{{"op":"F","exp":{formula}}}}}}}}}]}}',
        encoding="utf-8",
    )


@pytest.mark.parametrize("part", [NOT, OR], ids=["not", "or"])
@pytest.mark.parametrize("command", COMMANDS)
def test_a_formula_as_deep_as_json_may_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str, part: str
) -> None:
    write(tmp_path, part, 985)
    monkeypatch.chdir(tmp_path)
    assert run(COMMANDS[command]) == 0
    text = "".join(capsys.readouterr())
    assert "internal error" not in text
    assert "internal-error" not in text


def test_a_deeper_file_has_one_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    write(tmp_path, NOT, 1500)
    monkeypatch.chdir(tmp_path)
    assert run(["--check", "p.jani"]) == 1
    assert capsys.readouterr().out.rstrip().endswith("1 file checked: 1 error")

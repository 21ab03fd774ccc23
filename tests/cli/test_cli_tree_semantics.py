# SPDX-License-Identifier: Apache-2.0
"""What states the meaning of the nodes of a tree: the option, the system file, the setting."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run

PLUGIN = """<ascxml name="A" version="1.0" initial="s"><datamodel><data id="n" type="int16" expr="0"/></datamodel>
<state id="s">
    <bt_tick target="s"><bt_return_status status="FAILURE"/></bt_tick>
    <bt_halt target="s"><assign location="n" expr="n + 1"/><bt_return_halted/></bt_halt>
</state></ascxml>"""
MAIN = """<roaml><parameters><max_time value="5" unit="s"/></parameters>
<behavior_tree ATTRIBUTE><input type="bt.cpp-xml" src="tree.xml"/><input type="bt-plugin-ascxml" src="a.ascxml"/>
</behavior_tree><properties><input type="jani" src="p.jani"/></properties></roaml>"""
TREE = '<root BTCPP_format="4"><BehaviorTree ID="T"><Sequence><A/><A/></Sequence></BehaviorTree></root>'


def system(folder: Path, attribute: str, setting: str) -> str:
    texts = {"main.xml": MAIN.replace("ATTRIBUTE", attribute), "tree.xml": TREE, "a.ascxml": PLUGIN}
    texts |= {"p.jani": '{"properties": []}', "as2fm.toml": setting}
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    return str(folder / "main.xml")


@pytest.mark.parametrize(
    ("attribute", "setting", "option", "is_as2fm"),
    [
        ("", "", "", False),
        ("", "", "as2fm", True),
        ("", 'tree-semantics = "as2fm"', "", True),
        ('tree-semantics="as2fm"', "", "", True),
        ('tree-semantics="behaviortree-cpp"', 'tree-semantics = "as2fm"', "", False),
        ('tree-semantics="as2fm"', 'tree-semantics = "as2fm"', "behaviortree-cpp", False),
    ],
)
def test_who_states_the_meaning(attribute: str, setting: str, option: str, is_as2fm: bool, tmp_path: Path) -> None:
    """As in the library, a node begins in the status IDLE. The option may precede the sub-command."""
    main, out = system(tmp_path, attribute, setting), tmp_path / "out.jani"
    given = ["--tree-semantics", option] if option else []
    for arguments in ([*given, "translate", main], ["translate", main, *given]):
        assert run([*arguments, "-o", str(out)]) == 0
        automata = json.loads(out.read_text(encoding="utf-8"))["automata"]
        (sequence,) = [automaton for automaton in automata if automaton["name"].startswith("BT_plugin_1000_")]
        names = [location["name"] for location in sequence["locations"]]
        assert any(name.startswith("idle") for name in names) is not is_as2fm, names


def test_the_check_says_where_it_matters(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main = system(tmp_path, "", "")
    assert run(["--check", main]) == 0
    assert "[tree-semantics]" in capsys.readouterr().out
    for given in ("as2fm", "behaviortree-cpp"):
        assert run(["--tree-semantics", given, "--check", main]) == 0
        assert "[tree-semantics]" not in capsys.readouterr().out


def test_an_unknown_meaning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main = system(tmp_path, "", 'tree-semantics = "as2fn"')
    assert run(["--check", main]) == 1
    assert "`tree-semantics` must be" in capsys.readouterr().out

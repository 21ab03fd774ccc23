# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp format`."""

from __future__ import annotations

from pathlib import Path

import pytest
from command import Command

import clock

UGLY = '<ascxml name="A">\n<state id="🤖é"/>   \n</ascxml>'
NEAT = '<ascxml name="A">\n    <state id="🤖é" />\n</ascxml>\n'
PAGE = "<html>\n<p/></html>"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "models").mkdir()
    for name, text in {"b.ascxml": UGLY, "a.scxml": NEAT, "page.xml": PAGE, "p.jani": '{ "properties":[]}'}.items():
        (tmp_path / "models" / name).write_text(text, encoding="utf-8", newline="")
    (tmp_path / "models" / "model.jani").write_text('{"jani-version":1,"automata":[]}')
    return tmp_path / "models"


def test_files_are_rewritten(command: Command, folder: Path) -> None:
    assert command("format", "models") == (0, "formatted models/b.ascxml\nformatted models/p.jani\n", "")
    assert (folder / "b.ascxml").read_text(encoding="utf-8") == NEAT
    assert (folder / "p.jani").read_text() == '{ "properties": [] }\n'
    assert (folder / "page.xml").read_text() == PAGE
    assert (folder / "model.jani").read_text() == '{"jani-version":1,"automata":[]}'
    assert command("format", "models", "models/b.ascxml") == (0, "", "")
    assert command("format", "models/model.jani").out == "formatted models/model.jani\n"


PLAIN = '<scxml xmlns="http://www.w3.org/2005/07/scxml" version="1.0">\n<state id="a"/></scxml>'
OLDER = '<scxml name="A" version="1.0">\n<ros_topic_publisher topic="/a" type="std_msgs/Empty"/><state id="a"/></scxml>'


@pytest.mark.parametrize(
    "text",
    [
        PLAIN,
        PLAIN.replace("<state", '<state type="x"'),
        '<scxml><state id="a">\n<transition cond="_event.origin"/></state></scxml>',
        '<types xmlns="urn:other">\n<type name="a"/></types>',
        "<statechart>\n<state/></statechart>",
        PAGE,
    ],
    ids=["plain", "plain with more", "foreign", "types", "another root", "page"],
)
@pytest.mark.parametrize("name", ["x.scxml", "x.xml"])
def test_other_files_are_not_changed(command: Command, tmp_path: Path, text: str, name: str) -> None:
    path = tmp_path / name
    path.write_text(text)
    for arguments in (["."], [".", "--check"], [tmp_path, "--diff"]):
        assert command("format", *arguments) == (0, "", "")
    assert path.read_text() == text


def test_plain_scxml_that_is_named_or_listed_is_formatted(command: Command, tmp_path: Path) -> None:
    for name, text in {"plain.scxml": PLAIN, "listed.scxml": PLAIN, "older.scxml": OLDER}.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "main.xml").write_text(
        '<roaml>\n    <node_models>\n        <input type="node-ascxml" src="listed.scxml" />\n'
        "    </node_models>\n</roaml>\n"
    )
    assert command("format", ".", "--check").out == "listed.scxml\nolder.scxml\n"
    assert command("format", "plain.scxml").out == "formatted plain.scxml\n"
    assert command("format", "plain.scxml", "--check").status == 0


def test_check_names_what_would_change(command: Command, folder: Path) -> None:
    assert command("format", "--check", "models") == (1, "models/b.ascxml\nmodels/p.jani\n", "")
    assert command("format", "--check", "models/a.scxml") == (0, "", "")
    assert (folder / "b.ascxml").read_text(encoding="utf-8") == UGLY


def test_diff(command: Command, folder: Path) -> None:
    done = command("format", "--diff", folder / "b.ascxml")
    assert done.status == 1
    assert done.out == (
        "--- models/b.ascxml\n+++ models/b.ascxml\n@@ -1,3 +1,3 @@\n"
        ' <ascxml name="A">\n'
        '-<state id="🤖é"/>   \n'
        "-</ascxml>\n\\ No newline at end of file\n"
        '+    <state id="🤖é" />\n'
        "+</ascxml>\n"
    )
    assert (folder / "b.ascxml").read_text(encoding="utf-8") == UGLY


def test_encoding_and_mark_are_kept(command: Command, folder: Path) -> None:
    path = folder / "b.ascxml"
    path.write_bytes(b"\xff\xfe" + UGLY.replace("\n", "\r\n").encode("utf-16-le"))
    assert command("format", path).status == 0
    assert path.read_bytes() == b"\xff\xfe" + NEAT.replace("\n", "\r\n").encode("utf-16-le")


@pytest.mark.parametrize("data", [b'<ascxml name="A>\n<state/></ascxml>', b'<ascxml name="\xff">\n<state/></ascxml>'])
def test_files_that_are_not_well_formed_are_not_changed(command: Command, folder: Path, data: bytes) -> None:
    (folder / "b.ascxml").write_bytes(data)
    done = command("format", "models")
    assert done.status == 1
    assert done.out == "formatted models/p.jani\n"
    assert done.err == "as2fm-lsp: models/b.ascxml: not well-formed, so it is not changed\n"
    assert (folder / "b.ascxml").read_bytes() == data


@pytest.mark.parametrize("arguments", [(), ("none.ascxml",), ("models/page.xml",), ("--check", "--diff", "models")])
def test_wrong_use(command: Command, folder: Path, arguments: tuple[str, ...]) -> None:
    before = {path: path.read_bytes() for path in folder.iterdir()}
    assert command("format", *arguments).status == 2
    assert before == {path: path.read_bytes() for path in folder.iterdir()}


def test_excluded_files_are_not_looked_for(command: Command, folder: Path) -> None:
    (folder / "as2fm.toml").write_text('exclude = ["b.*"]\n')
    assert command("format", "--check", "models").out == "models/p.jani\n"


def test_a_system_means_the_same(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    command("translate", "main.xml", "-o", "before.json")
    assert "formatted properties.jani" in command("format", ".").out
    command("translate", "main.xml", "-o", "after.json")
    assert (tmp_path / "before.json").read_bytes() == (tmp_path / "after.json").read_bytes()

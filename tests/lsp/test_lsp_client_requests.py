# SPDX-License-Identifier: Apache-2.0
"""Custom requests of the VS Code client: about, pictures, plain SCXML, migration."""

from __future__ import annotations

import re
from base64 import b64decode
from pathlib import Path
from typing import Any

import pytest
from client import Client, RawServer, connect, start_raw
from lsprotocol import types

import clock
from as2fm_lsp.cli import draw
from as2fm_lsp.cli.init import template

OLD_MAIN = """\
<convince_mc_tc>
    <mc_parameters><max_time value="10" unit="s" /></mc_parameters>
    <node_models><input type="ros-scxml" src="clock.scxml" /></node_models>
</convince_mc_tc>
"""
LONG_PORTS = """<root BTCPP_format="4"><BehaviorTree ID="Drive">
    <ComputePathToPose goal="{the_place_of_the_shelf}" path="{the_path_to_the_shelf}" planner_id="GridBased" />
</BehaviorTree></root>"""
SPARE = '<input type="bt-plugin-ascxml" src="plugins/spare.ascxml" />'
OLD_CLOCK = clock.CLOCK.replace("<ascxml", "<scxml").replace("</ascxml", "</scxml")


async def asked(folder: Path, method: str, *files: str, **more: object) -> list[Any]:
    """The answers for some files, sent as bytes, because the library of the client would convert them to objects."""
    server = await start_raw()
    folders = [{"uri": folder.as_uri(), "name": "robot"}]
    server.send("initialize", {"processId": None, "capabilities": {}, "workspaceFolders": folders}, 1)
    server.send("initialized", {})
    for number, name in enumerate(files):
        server.send(method, {"textDocument": {"uri": (folder / name).as_uri()}, **more}, 10 + number)
    return await answers(server, len(files))


async def answers(server: RawServer, count: int) -> list[Any]:
    server.send("shutdown", None, 2)
    server.send("exit")
    _, said, _ = await server.end()
    by_id = {message["id"]: message for message in said if "id" in message and "method" not in message}
    return [by_id[10 + number]["result"] for number in range(count)]


def write_example(folder: Path) -> None:
    for name, text in template("delivery_robot"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")


async def test_about(tmp_path: Path) -> None:
    write_example(tmp_path)
    (tmp_path / "other.xml").write_text("<html/>")
    files = ("main.xml", "tree.xml", "nodes/battery.ascxml", "properties.jani", "other.xml", "none.xml")
    main = (tmp_path / "main.xml").as_uri()
    inside = {"systems": [main], "hasTree": True}
    nothing = {"kind": "", "systems": [], "hasTree": False}
    assert await asked(tmp_path, "as2fm/about", *files) == [
        {"kind": "system", **inside},
        {"kind": "tree", **inside},
        {"kind": "machine", **inside},
        {"kind": "properties", **inside},
        nothing,
        nothing,
    ]


async def test_pictures(tmp_path: Path) -> None:
    write_example(tmp_path)
    (machine,) = await asked(tmp_path, "as2fm/picture", "nodes/battery.ascxml", kind="machine")
    uri = (tmp_path / "nodes/battery.ascxml").as_uri()
    assert (machine["kind"], machine["title"]) == ("machine", "Battery")
    assert machine["nodes"][0] == {
        "id": "/driving",
        "kind": "state",
        "label": "driving",
        "details": [],
        "parent": "",
        "hides": [],
        "initial": True,
        "place": {"uri": uri, "range": {"start": {"line": 14, "character": 4}, "end": {"line": 24, "character": 12}}},
        "actions": ["addState", "addTransition", "rename", "deleteTransition", "delete"],
        "use": None,
        "useActions": [],
    }
    assert machine["edges"][1] == {
        "source": "/driving",
        "target": "/charging",
        "kind": "ros",
        "labels": ["/dock", "/ docked := _msg.data"],
        "probabilistic": False,
        "interface": "",
        "place": {"uri": uri, "range": {"start": {"line": 21, "character": 8}, "end": {"line": 23, "character": 29}}},
        "actions": ["delete"],
    }
    assert [drawing["scene"].count("data-node=") for drawing in machine["drawings"]] == [2, 2]
    assert all(box["width"] > 0 for drawing in machine["drawings"] for box in drawing["nodes"])
    (tree,) = await asked(tmp_path, "as2fm/picture", "main.xml", kind="tree")
    assert [node["label"] for node in tree["nodes"]][:3] == ["ReactiveSequence", "ReactiveFallback", "BatteryAbove"]
    assert [drawing["scene"].count("data-node=") for drawing in tree["drawings"]] == [len(tree["nodes"])] * 4
    (top,) = await asked(tmp_path, "as2fm/picture", "main.xml", kind="tree", collapsed=["1000"])
    assert [node["label"] for node in top["nodes"]] == ["ReactiveSequence"]
    ros, none = await asked(tmp_path, "as2fm/picture", "main.xml", "tree.xml", kind="ros")
    assert "/hand_over" in [node["label"] for node in ros["nodes"]]
    assert none is None
    assert await asked(tmp_path, "as2fm/picture", "main.xml", kind="cake") == [None]


async def test_picture_edits(tmp_path: Path) -> None:
    write_example(tmp_path)
    name, uri = "nodes/battery.ascxml", (tmp_path / "nodes/battery.ascxml").as_uri()
    (machine,) = await asked(tmp_path, "as2fm/picture", name, kind="machine")
    part = {"range": machine["nodes"][0]["place"]["range"], "action": "rename"}
    (question,) = await asked(tmp_path, "as2fm/pictureEdit", name, **part, answers=[])
    asks = {"text": "The new name of `driving`", "options": [], "proposal": "driving"}
    assert question == {"edit": None, "question": asks, "problem": ""}
    (answer,) = await asked(tmp_path, "as2fm/pictureEdit", name, **part, answers=["going"])
    assert {edit["newText"] for edit in answer["edit"]["changes"][uri]} == {"going"}
    (refused,) = await asked(tmp_path, "as2fm/pictureEdit", name, **part, answers=["charging"])
    assert refused == {"edit": None, "question": None, "problem": "A state `charging` already exists."}
    (tree,) = await asked(tmp_path, "as2fm/picture", "tree.xml", kind="tree")
    deliver = next(node["place"] for node in tree["nodes"] if node["label"] == "Deliver")
    (choice,) = await asked(
        tmp_path, "as2fm/pictureEdit", "tree.xml", range=deliver["range"], action="wrap", answers=[]
    )
    assert {"label": "Inverter", "answer": "Inverter", "description": "decorator"} in choice["question"]["options"]
    (whole,) = await asked(tmp_path, "as2fm/pictureEdit", name, action="addState", answers=["third"])
    assert '<state id="third" />' in whole["edit"]["changes"][uri][0]["newText"]
    (gone,) = await asked(tmp_path, "as2fm/pictureEdit", "none.ascxml", action="addState", answers=[])
    assert gone["problem"] == "The file does not exist any more."


async def test_picture_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The file is equal to that of the command line."""
    write_example(tmp_path)
    for theme, direction in (("light", "down"), ("dark", "right")):
        options = {"kind": "machine", "theme": theme, "direction": direction}
        (file,) = await asked(tmp_path, "as2fm/pictureFile", "nodes/battery.ascxml", **options)
        arguments = (str(tmp_path / "nodes/battery.ascxml"), "--theme", theme, "--direction", direction)
        draw.run((*arguments, "-o", "-"))
        assert file["svg"] == capsys.readouterr().out
        assert "pdf" not in file
        (both,) = await asked(tmp_path, "as2fm/pictureFile", "nodes/battery.ascxml", **options, format="pdf")
        draw.run((*arguments, "-o", str(tmp_path / "battery.pdf")))
        capsys.readouterr()
        assert both["svg"] == file["svg"]
        assert b64decode(both["pdf"]) == (tmp_path / "battery.pdf").read_bytes()
    (outline,) = await asked(tmp_path, "as2fm/pictureFile", "main.xml", kind="tree", direction="outline", theme="light")
    (tmp_path / "lone.xml").write_text(LONG_PORTS)
    heights = []
    for direction in ("outline", "wide-outline"):
        options = {"kind": "tree", "direction": direction, "theme": "light"}
        (file,) = await asked(tmp_path, "as2fm/pictureFile", "lone.xml", **options)
        heights.append(_height(file["svg"]))
    assert heights[1] < heights[0]
    draw.run((str(tmp_path / "main.xml"), "--tree", "--outline", "-o", "-"))
    assert outline["svg"] == capsys.readouterr().out
    assert await asked(tmp_path, "as2fm/pictureFile", "main.xml", kind="machine") == [None]


async def test_plain_scxml(tmp_path: Path) -> None:
    clock.write(tmp_path)
    plain, no_machine = await asked(tmp_path, "as2fm/plainScxml", "clock.ascxml", "main.xml")
    lines = plain["text"].splitlines()
    assert plain["problem"] == ""
    assert lines[0].startswith('<scxml xmlns="http://www.w3.org/2005/07/scxml" version="1.0" name="Clock"')
    assert [place["line"] for place in plain["lines"]] == list(range(len(lines)))
    at = next(i for i, line in enumerate(lines) if '<assign location="count"' in line)
    source = clock.CLOCK.splitlines()
    written = next(i for i, line in enumerate(source) if '<assign location="count"' in line)
    assert plain["lines"][at]["uri"] == (tmp_path / "clock.ascxml").as_uri()
    assert plain["lines"][at]["range"]["start"]["line"] == written
    assert no_machine == {"text": "", "lines": [], "problem": "This is not a machine of a system."}


async def test_plain_scxml_of_plugins(tmp_path: Path) -> None:
    """If the tree uses a plugin twice, one of the two machines is shown."""
    write_example(tmp_path)
    tree = tmp_path / "tree.xml"
    tree.write_text(tree.read_text().replace("<Charge />", '<Charge /><Charge name="again" />'))
    (plain,) = await asked(tmp_path, "as2fm/plainScxml", "plugins/charge.ascxml")
    assert plain["text"].count("<scxml ") == 1
    assert 'name="BT_plugin_1003_Charge"' in plain["text"]
    charge, main = (tmp_path / "plugins/charge.ascxml").read_text(), tmp_path / "main.xml"
    (tmp_path / "plugins/spare.ascxml").write_text(charge.replace('name="Charge"', 'name="Spare"'))
    main.write_text(main.read_text().replace("</behavior_tree>", f"{SPARE}</behavior_tree>"))
    (unused,) = await asked(tmp_path, "as2fm/plainScxml", "plugins/spare.ascxml")
    assert unused["problem"] == "The behavior tree does not use this plugin."


async def test_plain_scxml_of_a_broken_system(tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    (plain,) = await asked(tmp_path, "as2fm/plainScxml", "clock.ascxml")
    assert plain["text"] == ""
    assert plain["problem"] == "The system has 1 error, so it has no plain SCXML."


async def test_migrate(tmp_path: Path) -> None:
    (tmp_path / "main.xml").write_text(OLD_MAIN)
    (tmp_path / "clock.scxml").write_text(OLD_CLOCK)
    (migrated,) = await asked(tmp_path, "as2fm/migrate", "main.xml")
    assert (migrated["files"], migrated["problem"]) == (["main.xml", "clock.scxml → clock.ascxml"], "")
    changes = migrated["edit"]["documentChanges"]
    old, new = (tmp_path / "clock.scxml").as_uri(), (tmp_path / "clock.ascxml").as_uri()
    assert {"kind": "rename", "oldUri": old, "newUri": new} in changes
    texts = {change["textDocument"]["uri"]: change["edits"][0]["newText"] for change in changes if "edits" in change}
    assert texts[(tmp_path / "main.xml").as_uri()].startswith("<roaml>")
    assert texts[old].startswith("<ascxml")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["clock.scxml", "main.xml"]


async def test_files_that_cannot_be_migrated(tmp_path: Path) -> None:
    clock.write(tmp_path)
    current, no_system = await asked(tmp_path, "as2fm/migrate", "main.xml", "clock.ascxml")
    assert current == {"edit": None, "files": [], "problem": ""}
    assert no_system["problem"].endswith("neither a system file nor a tree; name one of these")
    (tmp_path / "main.xml").write_text(OLD_MAIN)
    (tmp_path / "clock.scxml").write_text(OLD_CLOCK)
    (taken,) = await asked(tmp_path, "as2fm/migrate", "main.xml")
    assert taken["edit"] is None
    assert taken["problem"].endswith("clock.ascxml already exists")


async def test_unsaved_text_is_drawn(tmp_path: Path) -> None:
    clock.write(tmp_path)
    async with connect(tmp_path) as client:
        path = tmp_path / "clock.ascxml"
        client.open(path, clock.CLOCK.replace('<state id="on">', '<state id="off"/><state id="on">'))
        picture = await _picture(client, path)
    assert [node.label for node in picture.nodes] == ["off", "on"]


async def _picture(client: Client, path: Path) -> Any:
    params = {"kind": "machine", "textDocument": types.TextDocumentIdentifier(path.as_uri())}
    return await client.protocol.send_request_async("as2fm/picture", params)


def _height(svg: str) -> float:
    found = re.search(r'<svg [^>]* height="([\d.]+)"', svg)
    assert found is not None
    return float(found[1])

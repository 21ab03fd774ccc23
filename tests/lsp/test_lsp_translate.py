# SPDX-License-Identifier: Apache-2.0
"""The command `as2fm.translateToJani`, with the code lens and the code action that call it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from client import Client, connect, start_raw
from lsprotocol import types

import clock
from as2fm_lsp.cli.main import run

COMMAND = "as2fm.translateToJani"


async def translate(client: Client, *arguments: str) -> object:
    return await client.workspace_execute_command_async(types.ExecuteCommandParams(COMMAND, list(arguments)))


def shown_messages(client: Client) -> list[tuple[types.MessageType, str]]:
    return [(message.type, message.message) for message in client.messages]


async def test_same_as_the_command_line(tmp_path: Path) -> None:
    clock.write(tmp_path)
    run(["translate", str(tmp_path / "main.xml"), "-o", str(tmp_path / "expected.jani")])
    async with connect(tmp_path) as client:
        answer = await translate(client, (tmp_path / "main.xml").as_uri())
        written = tmp_path / "main.jani"
        assert written.read_bytes() == (tmp_path / "expected.jani").read_bytes()
        size = "4 automata, 14 edges, 5 global variables, 1 property"
        assert answer == {"uri": written.as_uri(), "summary": size}
        assert shown_messages(client) == [(types.MessageType.Info, f"Wrote main.jani: {size}.")]


async def test_an_omitted_property_is_reported(tmp_path: Path) -> None:
    clock.write(tmp_path)
    written = json.loads((tmp_path / "properties.jani").read_text())
    written["properties"][0]["expression"]["values"]["exp"]["time-bounds"] = {"upper": 3}
    (tmp_path / "properties.jani").write_text(json.dumps(written))
    name = written["properties"][0]["name"]
    async with connect(tmp_path) as client:
        await translate(client, (tmp_path / "main.xml").as_uri())
        (kind, text), _ = shown_messages(client)
    assert kind is types.MessageType.Warning
    assert text.startswith(f"the property `{name}` is left out of the JANI file: bounds on time ")
    assert text.endswith(" [ignored-bounds]")
    assert json.loads((tmp_path / "main.jani").read_text())["properties"] == []


async def test_the_text_of_the_editor_is_translated(tmp_path: Path) -> None:
    clock.write(tmp_path)
    main, output = (tmp_path / "main.xml").as_uri(), tmp_path / "elsewhere.jani"
    async with connect(tmp_path) as client:
        await translate(client, main, output.as_uri())
        saved = output.read_text()
        client.open(tmp_path / "clock.ascxml", clock.CLOCK.replace("% 10", "% 7"))
        await translate(client, main, output.as_uri())
        modulo = '"op":"%","left":{"op":"+","left":"count","right":1},"right":'
        assert output.read_text() == saved.replace(f"{modulo}10", f"{modulo}7") != saved
        client.close(tmp_path / "clock.ascxml")
        await translate(client, main, output.as_uri())
        assert output.read_text() == saved
        assert not (tmp_path / "main.jani").exists()


async def test_errors_are_reported_and_nothing_is_written(tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    main = tmp_path / "main.xml"
    async with connect(tmp_path) as client:
        assert await translate(client, main.as_uri()) is None
        assert await translate(client, (tmp_path / "clock.ascxml").as_uri()) is None
        assert await translate(client, (tmp_path / "none.xml").as_uri()) is None
        client.open(tmp_path / "clock.ascxml", clock.CLOCK)
        assert await translate(client, main.as_uri(), (tmp_path / "properties.jani").as_uri()) is None
        assert await translate(client, main.as_uri(), (tmp_path / "no/folder/x.jani").as_uri()) is None
        texts = [text for kind, text in shown_messages(client) if kind is types.MessageType.Error]
    expected = (
        "main.xml has 1 error and was not translated.",
        "clock.ascxml: not a system file",
        "none.xml: not a system file",
        "properties.jani cannot be written: this file is an input of the command; write the output to another file",
        "x.jani cannot be written: No such file or directory",
    )
    assert len(texts) == len(expected)
    assert all(text.endswith(end) for text, end in zip(texts, expected, strict=True))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["clock.ascxml", "main.xml", "properties.jani"]


async def test_progress(tmp_path: Path) -> None:
    clock.write(tmp_path)
    capabilities = types.ClientCapabilities(window=types.WindowClientCapabilities(work_done_progress=True))
    async with connect(tmp_path, capabilities=capabilities) as client:
        await translate(client, (tmp_path / "main.xml").as_uri())
        (reports,) = client.progress_reports.values()
    begin, *steps, end = reports
    assert isinstance(begin, types.WorkDoneProgressBegin)
    assert (begin.title, begin.cancellable) == ("Translating main.xml", True)
    assert [step.message for step in steps] == ["checking", "translating", "writing"]
    assert isinstance(end, types.WorkDoneProgressEnd)


async def test_lens(tmp_path: Path) -> None:
    clock.write(tmp_path)
    main = (tmp_path / "main.xml").as_uri()
    async with connect(tmp_path) as client:
        params = types.CodeLensParams(types.TextDocumentIdentifier(main))
        lens, verify_all = await client.text_document_code_lens_async(params) or ()
        assert lens.command == types.Command("Translate to JANI", COMMAND, arguments=(main,))
        assert lens.range == types.Range(types.Position(0, 1), types.Position(0, 6))
        assert verify_all.command
        assert verify_all.command.title == "Verify all"
        params = types.CodeLensParams(types.TextDocumentIdentifier((tmp_path / "clock.ascxml").as_uri()))
        assert not any(lens.command for lens in await client.text_document_code_lens_async(params) or ())


async def test_actions(tmp_path: Path) -> None:
    """The request is sent as bytes, because the library of the client parses a code action with a command as the
    command itself."""
    clock.write(tmp_path)
    main = (tmp_path / "main.xml").as_uri()
    folders = [{"uri": tmp_path.as_uri(), "name": "robot"}]
    server = await start_raw()
    server.send("initialize", {"processId": None, "capabilities": {}, "workspaceFolders": folders}, 1)
    server.send("initialized", {})
    asked = [(name, kind) for name in ("main.xml", "clock.ascxml") for kind in ("source", "quickfix")]
    start = {"line": 0, "character": 0}
    for number, (name, kind) in enumerate(asked):
        params = {
            "textDocument": {"uri": (tmp_path / name).as_uri()},
            "range": {"start": start, "end": start},
            "context": {"diagnostics": [], "only": [kind]},
        }
        server.send("textDocument/codeAction", params, 10 + number)
    server.send("shutdown", id_=2)
    server.send("exit")
    _, messages, _ = await server.end()
    answers = {message["id"]: message["result"] for message in messages if "result" in message}

    def action(title: str) -> dict[str, object]:
        return {"title": title, "kind": "source", "command": {"title": title, "command": COMMAND, "arguments": [main]}}

    actions = {asking: answers[10 + number] for number, asking in enumerate(asked)}
    assert actions == {
        ("main.xml", "source"): [action("Translate to JANI")],
        ("main.xml", "quickfix"): [],
        ("clock.ascxml", "source"): [action("Translate main.xml to JANI")],
        ("clock.ascxml", "quickfix"): [],
    }


@pytest.mark.parametrize("arguments", [(), (1,), ({},), ("untitled:1",)], ids=str)
async def test_odd_arguments(tmp_path: Path, arguments: tuple[object, ...]) -> None:
    clock.write(tmp_path)
    async with connect(tmp_path) as client:
        params = types.ExecuteCommandParams(COMMAND, list(arguments))
        assert await client.workspace_execute_command_async(params) is None
        assert await translate(client, (tmp_path / "main.xml").as_uri()) is not None


async def test_the_readable_view(tmp_path: Path) -> None:
    """The file on the disk stays compact. Its view is formatted, and has the outline."""
    clock.write(tmp_path)
    async with connect(tmp_path) as client:
        assert await translate(client, (tmp_path / "main.xml").as_uri()) is not None
        file = tmp_path / "main.jani"
        compact = file.read_text(encoding="utf-8")
        assert len(compact.splitlines()) == 1
        params = {"textDocument": {"uri": file.as_uri()}}
        view = await client.protocol.send_request_async("as2fm/janiView", params)
        assert json.loads(view.text) == json.loads(compact)
        assert len(view.text.splitlines()) > 20
        names = [symbol.name for symbol in view.symbols]
        assert {"variables", "automata", "properties"} <= set(names)
        assert view.problem == ""
        automata = view.symbols[names.index("automata")]
        first = view.text.splitlines()[automata.selectionRange.start.line]
        assert first.strip().startswith('"automata"')
        params = {"textDocument": {"uri": (tmp_path / "none.jani").as_uri()}}
        missing = await client.protocol.send_request_async("as2fm/janiView", params)
        assert missing.problem == "This file cannot be shown: there is no such file."

# SPDX-License-Identifier: Apache-2.0
"""Start and end of a server, and its reaction to bytes that are not messages."""

from __future__ import annotations

import asyncio
import sys

import pytest
from client import STARTED, frame, start_raw
from lsprotocol import types

INITIALIZE: dict[str, object] = {"processId": None, "rootUri": None, "capabilities": {}}


async def test_shutdown_and_exit() -> None:
    server = await start_raw(command=STARTED)
    server.send("initialize", INITIALIZE, 1)
    server.send("initialized", {})
    server.send("shutdown", id_=2)
    server.send("exit")
    status, messages, log = await server.end()
    assert (status, log) == (0, "")
    assert {"jsonrpc": "2.0", "id": 2, "result": None} in messages


async def test_exit_without_shutdown() -> None:
    server = await start_raw("--stdio", command=STARTED)
    server.send("initialize", INITIALIZE, 1)
    server.send("exit")
    status, messages, log = await server.end()
    assert (status, log) == (1, "")
    assert [message.get("id") for message in messages] == [1]


@pytest.mark.parametrize(
    "data",
    [
        frame({"jsonrpc": "2.0", "id": 1, "method": "initialize", "params": INITIALIZE}),
        b"Content-Length: 1000\r\n\r\n{",
        b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n" + bytes(range(256)) * 20 + b"Content-Length: 10",
    ],
    ids=["initialize", "half a message", "noise"],
)
async def test_the_input_ends(data: bytes) -> None:
    """If the input ends, as after a crash of the editor, the process ends."""
    server = await start_raw(command=STARTED)
    server.send_bytes(data)
    status, _, _ = await server.end()
    assert status == 1


GARBAGE = [
    b"Content-Length: 5\r\n\r\n{bad}",
    b"Content-Length: 2\r\n\r\n[]",
    b"Content-Length: 4\r\n\r\nnull",
    b"Content-Length: 4\r\n\r\n\xff\xfe\x00\x01",
    b"no header at all\n",
    frame({"jsonrpc": "2.0", "method": "textDocument/didOpen", "params": {"wrong": 1}}),
    frame({"jsonrpc": "2.0", "method": "textDocument/didOpen"}),
    frame({"jsonrpc": "2.0", "method": "$/unknown", "params": {}}),
    frame({"jsonrpc": "2.0", "method": "$/cancelRequest", "params": {"id": 98}}),
    frame({"jsonrpc": "2.0", "id": 7, "method": "no/such", "params": {}}),
    frame({"jsonrpc": "2.0", "id": 8, "result": None}),
    frame(
        {
            "jsonrpc": "2.0",
            "method": "textDocument/didChange",
            "params": {
                "textDocument": {"uri": "file:///nowhere/x.ascxml", "version": 1},
                "contentChanges": [{"text": "<a"}],
            },
        }
    ),
    frame(
        {
            "jsonrpc": "2.0",
            "method": "textDocument/didClose",
            "params": {"textDocument": {"uri": "file:///nowhere/x.ascxml"}},
        }
    ),
    frame({"jsonrpc": "2.0", "method": "workspace/didChangeConfiguration", "params": {"settings": [1]}}),
    frame({"jsonrpc": "2.0", "method": "workspace/didChangeConfiguration", "params": {"settings": {"as2fm": 5}}}),
    frame(
        {
            "jsonrpc": "2.0",
            "method": "workspace/didChangeConfiguration",
            "params": {"settings": {"as2fm": {"ignore": {"a": []}, "severity": {"xml-syntax": ["error"]}}}},
        }
    ),
]


async def test_invalid_messages_do_not_end_the_server() -> None:
    """After each invalid piece, the server still answers as before."""
    server = await start_raw()
    server.send("initialize", INITIALIZE, 1)
    server.send("initialized", {})
    opened = {"uri": "untitled:1", "languageId": "ascxml", "version": 1, "text": "<ascxml"}
    server.send("textDocument/didOpen", {"textDocument": opened})
    server.send("textDocument/codeAction", request("untitled:1"), 99)
    for number, garbage in enumerate(GARBAGE):
        server.send_bytes(garbage)
        server.send("textDocument/codeAction", request("untitled:1"), 100 + number)
    server.send("shutdown", id_=2)
    server.send("exit")
    status, messages, _ = await server.end()
    assert status == 0
    answers = {message["id"]: message for message in messages if "id" in message and "method" not in message}
    for number, garbage in enumerate(GARBAGE):
        assert answers[100 + number]["result"] == answers[99]["result"], garbage
    assert [action["title"] for action in answers[99]["result"]] == ["Insert `>`"]


def request(uri: str) -> dict[str, object]:
    place = {"line": 0, "character": 0}
    return {"textDocument": {"uri": uri}, "range": {"start": place, "end": place}, "context": {"diagnostics": []}}


@pytest.mark.parametrize("options", [{"settings": [1], "diagnostics": 5}, [7]], ids=["object", "list"])
async def test_odd_initialization_options(options: object) -> None:
    server = await start_raw()
    server.send("initialize", {**INITIALIZE, "initializationOptions": options}, 1)
    server.send("shutdown", id_=2)
    server.send("exit")
    status, messages, _ = await server.end()
    assert status == 0
    assert "error" not in messages[0]


async def test_capabilities() -> None:
    server = await start_raw()
    server.send("initialize", {**INITIALIZE, "capabilities": {"textDocument": {"diagnostic": {}}}}, 1)
    server.send("shutdown", id_=2)
    server.send("exit")
    _, messages, _ = await server.end()
    result = messages[0]["result"]
    assert isinstance(result, dict)
    assert result["serverInfo"]["name"] == "as2fm-lsp"
    capabilities = result["capabilities"]
    assert capabilities["positionEncoding"] == "utf-16"
    assert capabilities["textDocumentSync"]["change"] == types.TextDocumentSyncKind.Incremental
    assert capabilities["textDocumentSync"]["openClose"] is True
    assert capabilities["diagnosticProvider"] == {
        "identifier": "as2fm",
        "interFileDependencies": True,
        "workspaceDiagnostics": True,
    }
    assert capabilities["codeActionProvider"] == {
        "codeActionKinds": ["quickfix", "refactor.extract", "refactor.rewrite", "source.fixAll.as2fm", "source"],
        "resolveProvider": True,
    }
    assert capabilities["codeLensProvider"] == {"resolveProvider": True}
    assert capabilities["executeCommandProvider"] == {
        "commands": ["as2fm.showFirstError", "as2fm.translateToJani", "as2fm.verify"]
    }
    assert capabilities["workspace"]["workspaceFolders"] == {"supported": True, "changeNotifications": True}


async def test_it_imports_nothing_but_what_it_needs() -> None:
    """The import of `xmlschema` alone takes a quarter of a second, which would delay the start."""
    code = "import sys; import as2fm_lsp.server; print(*{'xmlschema', 'numpy', 'rosbags'} & sys.modules.keys())"
    process = await asyncio.create_subprocess_exec(sys.executable, "-c", code, stdout=asyncio.subprocess.PIPE)
    out, _ = await process.communicate()
    assert out.split() == []

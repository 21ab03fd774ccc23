# SPDX-License-Identifier: Apache-2.0
"""Messages that are invalid or not allowed at a time, and the end of the client's process."""

from __future__ import annotations

import gc
import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from io import BufferedReader, BytesIO, RawIOBase
from pathlib import Path
from typing import Any

import pytest
from client import STARTED, RawServer, frame, start_raw

import clock
from as2fm_lsp import inbox, parent_process
from as2fm_lsp.inbox import bodies
from as2fm_lsp.server import create
from as2fm_lsp.transport import Protocol

INITIALIZE: dict[str, object] = {"processId": None, "rootUri": None, "capabilities": {}}
PARSE_ERROR, INVALID_REQUEST, METHOD_NOT_FOUND, INVALID_PARAMS = -32700, -32600, -32601, -32602
NOT_INITIALIZED = -32002


COLLAPSED = {"kind": "tree", "textDocument": {"uri": "file:///tree.xml"}, "collapsed": [1]}


def framed(body: bytes) -> bytes:
    return b"Content-Length: %d\r\n\r\n%b" % (len(body), body)


async def finish(server: RawServer) -> tuple[int, dict[object, dict[str, Any]], str]:
    """Shut the server down; return its exit status, its answers by their ids, and its log."""
    server.send("shutdown", id_=1000)
    server.send("exit")
    status, messages, log = await server.end()
    return status, {message["id"]: message for message in messages if "method" not in message}, log


def code(answers: dict[object, dict[str, Any]], id_: object) -> object:
    return answers[id_].get("error", {}).get("code")


# ------------------------------------------------------------------------ time


async def test_requests_before_initialize() -> None:
    """Requests get the error that the protocol defines; notifications are ignored."""
    server = await start_raw()
    server.send("textDocument/hover", {"textDocument": 5}, 10)
    server.send("no/such", {}, 11)
    server.send("shutdown", None, 12)
    server.send("textDocument/didOpen", {"wrong": 1})
    server.send("initialized", {})
    server.send("initialize", INITIALIZE, 13)
    status, answers, log = await finish(server)
    assert [code(answers, id_) for id_ in (10, 11, 12, 13)] == [NOT_INITIALIZED] * 3 + [None]
    assert (status, log) == (0, "")


async def test_exit_before_initialize() -> None:
    server = await start_raw()
    server.send("exit")
    assert (await server.end())[0] == 1


async def test_a_second_initialize() -> None:
    """It is rejected and has no effect."""
    server = await start_raw()
    server.send("initialize", INITIALIZE, 10)
    encodings = {"general": {"positionEncodings": ["utf-8"]}}
    server.send("initialize", {**INITIALIZE, "capabilities": encodings}, 11)
    document = {"uri": "untitled:1", "languageId": "ascxml", "version": 1, "text": "<!--é--><ascxml"}
    server.send("textDocument/didOpen", {"textDocument": document})
    server.send("textDocument/documentSymbol", {"textDocument": {"uri": "untitled:1"}}, 12)
    _, answers, _ = await finish(server)
    assert [code(answers, id_) for id_ in (10, 11, 12)] == [None, INVALID_REQUEST, None]
    assert answers[12]["result"][0]["location"]["range"]["start"]["character"] == 8


@pytest.mark.parametrize(
    "folders", [{"rootUri": "file://["}, {"workspaceFolders": [{"uri": "file://[", "name": "robot"}]}]
)
async def test_initialize_with_an_invalid_uri(folders: dict[str, object]) -> None:
    """It is rejected; a valid `initialize` is possible afterwards."""
    server = await start_raw()
    server.send("initialize", {**INITIALIZE, **folders}, 10)
    server.send("initialize", INITIALIZE, 11)
    _, answers, log = await finish(server)
    assert [code(answers, id_) for id_ in (10, 11)] == [INVALID_PARAMS, None]
    assert log == ""


async def test_requests_for_an_empty_document() -> None:
    server = await start_raw()
    server.send("initialize", INITIALIZE, 10)
    server.send("textDocument/didOpen", {"textDocument": {"uri": "untitled:1", "languageId": "ascxml", "version": 1,
        "text": ""}})  # fmt: skip
    place = {"textDocument": {"uri": "untitled:1"}, "positions": [{"line": 0, "character": 0}]}
    server.send("textDocument/selectionRange", place, 11)
    _, answers, _ = await finish(server)
    nowhere = {"line": 0, "character": 0}
    assert answers[11]["result"] == [{"range": {"start": nowhere, "end": nowhere}}]


async def test_after_shutdown() -> None:
    """Requests are rejected and notifications ignored, except `exit`."""
    server = await start_raw()
    server.send("initialize", INITIALIZE, 10)
    server.send("shutdown", None, 11)
    server.send("textDocument/hover", {}, 12)
    server.send("shutdown", None, 13)
    server.send("initialize", INITIALIZE, 14)
    server.send("textDocument/didOpen", {"wrong": 1})
    server.send("exit")
    status, messages, log = await server.end()
    assert (status, log) == (0, "")
    answers = {message["id"]: message for message in messages}
    assert [code(answers, id_) for id_ in (10, 11, 12, 13, 14)] == [None, None] + [INVALID_REQUEST] * 3


# ------------------------------------------------------------------------ form

DEEP = 200_000
BROKEN: list[tuple[bytes, object, int | None]] = [
    # what is sent, the id of the answer ("-" if there is none), its code
    (framed(b"[" * DEEP), None, PARSE_ERROR),
    (framed(b"[" * DEEP + b"]" * DEEP), None, PARSE_ERROR),
    (framed(b'{"jsonrpc": "2.0", "id": 5, "method": "x", "params": ' + b'{"a":' * 400 + b"1" + b"}" * 401), 5, -32601),
    (framed(b"{bad}"), None, PARSE_ERROR),
    (framed(b'"text"'), None, INVALID_REQUEST),
    (framed(b"[]"), None, INVALID_REQUEST),
    (framed(b'{"id": 1' + b"0" * 4301 + b"}"), None, PARSE_ERROR),
    (b"Content-Length: " + b"9" * 4301 + b"\r\n\r\n{}", "-", None),
    (b"Content-Length: 999999999999\r\n\r\n{}", "-", None),
    (b"Content-Length: -5\r\n\r\n{}", "-", None),
    (b"noise without an end of its line", "-", None),
    (frame({"id": 6, "method": "shutdown"}), 6, INVALID_REQUEST),
    (frame({"jsonrpc": "1.0", "id": 7, "method": "shutdown"}), 7, INVALID_REQUEST),
    (frame({"jsonrpc": "2.0", "id": 8, "method": 5}), 8, INVALID_REQUEST),
    (frame({"jsonrpc": "2.0", "id": [8], "method": "shutdown"}), None, INVALID_REQUEST),
    (frame({"jsonrpc": "2.0", "id": None, "method": "shutdown"}), None, INVALID_REQUEST),
    (frame({"jsonrpc": "2.0", "id": True, "method": "shutdown"}), None, INVALID_REQUEST),
    (frame({"jsonrpc": "2.0", "id": 9, "method": "textDocument/hover"}), 9, INVALID_PARAMS),
    (frame({"jsonrpc": "2.0", "id": 10, "method": "textDocument/hover", "params": [1]}), 10, INVALID_PARAMS),
    (frame({"jsonrpc": "2.0", "id": 11, "method": "as2fm/about", "params": {}}), 11, INVALID_PARAMS),
    (frame({"jsonrpc": "2.0", "id": 12, "method": "as2fm/about", "params": {"type_name": 5}}), 12, INVALID_PARAMS),
    (frame({"jsonrpc": "2.0", "id": 13, "method": "as2fm/picture"}), 13, INVALID_PARAMS),
    (frame({"jsonrpc": "2.0", "id": 14, "method": "as2fm/picture", "params": COLLAPSED}), 14, INVALID_PARAMS),
    (frame({"jsonrpc": "2.0", "id": 14, "method": "no/such"}), 14, METHOD_NOT_FOUND),
    (frame({"jsonrpc": "2.0", "id": 15, "error": {"code": 1, "message": "?"}}), "-", None),
    (frame({"jsonrpc": "2.0", "id": [], "result": 5}), "-", None),
    (frame({"jsonrpc": "2.0", "method": "window/workDoneProgress/cancel", "params": {"token": []}}), "-", None),
    (frame({"jsonrpc": "2.0", "method": "$/cancelRequest", "params": {"id": {}}}), "-", None),
    (frame({"jsonrpc": "2.0", "method": "textDocument/didOpen", "params": {"wrong": 1}}), "-", None),
]


@pytest.mark.parametrize(("data", "id_", "expected"), BROKEN, ids=[str(data[:60]) for data, *_ in BROKEN])
def test_invalid_messages(data: bytes, id_: object, expected: int | None) -> None:
    """They are answered as JSON-RPC defines, and the next message is handled as usual."""
    answers = responses_to(data + frame({"jsonrpc": "2.0", "id": 99, "method": "as2fm/properties", "params": {}}))
    assert answers.pop() == {"jsonrpc": "2.0", "id": 99, "result": []}
    assert [(answer["id"], answer["error"]["code"]) for answer in answers] == ([] if id_ == "-" else [(id_, expected)])
    assert all("\n" not in answer["error"]["message"] for answer in answers)


def responses_to(data: bytes) -> list[dict[str, Any]]:
    """The output of a server in this process for some bytes, after it was initialized."""
    source = BytesIO(frame({"jsonrpc": "2.0", "id": 0, "method": "initialize", "params": INITIALIZE}) + data)
    target = _Kept()
    create().serve(source, target)
    first, *others = (json.loads(body) for body in bodies(BytesIO(target.getvalue())))
    assert "error" not in first
    return others


class _Kept(BytesIO):
    """A stream whose content can be read after it was closed."""

    def close(self) -> None:
        pass


def test_memory_is_allocated_only_for_received_bytes() -> None:
    """Memory is not allocated for the announced length."""

    class Announced(BytesIO):
        def read(self, size: int | None = -1) -> bytes:
            assert size is not None
            assert size <= inbox.MAX_MESSAGE_BYTES // 100
            return super().read(size)

    assert list(bodies(Announced(b"Content-Length: 200000000\r\n\r\n{}"))) == []


# ----------------------------------------------------------------- odd documents

ODD = [
    "file:///a/%00b.ascxml",
    "file:///a/%ED%A0%80.ascxml",
    "file://[/x.ascxml",
    "file:",
    "file:relative.ascxml",
    "file:///" + "a/" * 3000 + "b.ascxml",
    "file:///" + "n" * 300 + ".ascxml",
    "\0",
    "",
    "untitled:\0",
]


@pytest.mark.parametrize("uri", ODD, ids=[repr(uri[:30]) for uri in ODD])
async def test_an_odd_uri(tmp_path: Path, uri: str) -> None:
    """The document works with its own features, and other documents work as before."""
    main = clock.write(tmp_path)
    server = await start_raw()
    server.send("initialize", {**INITIALIZE, "workspaceFolders": [{"uri": tmp_path.as_uri(), "name": "robot"}]}, 10)
    document = {"uri": uri, "languageId": "ascxml", "version": 1, "text": clock.CLOCK}
    server.send("textDocument/didOpen", {"textDocument": document})
    of_it = {"textDocument": {"uri": uri}}
    server.send("workspace/symbol", {"query": "count"}, 11)
    server.send("textDocument/documentSymbol", of_it, 12)
    server.send("textDocument/codeLens", of_it, 13)
    server.send("as2fm/about", of_it, 14)
    server.send("workspace/executeCommand", {"command": "as2fm.translateToJani", "arguments": [uri]}, 15)
    server.send("as2fm/migrate", of_it, 16)
    server.send("textDocument/didClose", of_it)
    server.send("workspace/symbol", {"query": "count"}, 17)
    status, answers, log = await finish(server)
    assert (status, log) == (0, "")
    assert [code(answers, id_) for id_ in (*range(10, 18), 1000)] == [None] * 9
    assert len(answers[11]["result"]) == 2 * len(answers[17]["result"]) > 0
    assert answers[12]["result"][0]["name"] == "Clock"
    assert not main.with_suffix(".jani").exists()


# --------------------------------------------------------------------- its parent


async def test_it_ends_with_the_process_of_its_client() -> None:
    """The server ends although its input stays open, as when another process has inherited it."""
    other = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    server = await start_raw(command=STARTED)
    server.send("initialize", {**INITIALIZE, "processId": other.pid}, 1)
    await server.read_log("capabilities")
    other.kill()  # nobody asks for its status: it stays as a zombie
    assert await server.ended() == 1
    other.wait()


def test_the_end_of_a_process_is_seen_without_help_of_the_system(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parent_process, "POLL_INTERVAL_S", 0.01)
    other = subprocess.Popen([sys.executable, "-c", ""])
    other.wait()
    parent_process._poll(other.pid)
    parent_process.wait_for_end(other.pid)


# ------------------------------------------------------------------------ memory


def test_nothing_is_kept_of_notifications() -> None:
    """The server stores neither a future for each notification nor a second copy of the documents."""
    server = create()
    seen: list[int] = []

    def messages() -> Iterator[bytes]:
        yield frame({"jsonrpc": "2.0", "id": 0, "method": "initialize", "params": INITIALIZE})
        document = {"uri": "untitled:1", "languageId": "ascxml", "version": 1, "text": ""}
        yield frame({"jsonrpc": "2.0", "method": "textDocument/didOpen", "params": {"textDocument": document}})
        for number in range(200):
            change = {"textDocument": {"uri": "untitled:1", "version": number}, "contentChanges": [{"text": "<a/>"}]}
            yield frame({"jsonrpc": "2.0", "method": "textDocument/didChange", "params": change})
            yield frame({"jsonrpc": "2.0", "method": "$/setTrace", "params": {"value": "off"}})
            yield frame({"jsonrpc": "2.0", "method": "workspace/didChangeConfiguration", "params": {"settings": {}}})

    protocol = server.endpoint.protocol
    assert isinstance(protocol, Protocol)
    server.serve(BytesIO(b"".join(messages())), _Kept())
    seen = [len(protocol._request_futures), len(protocol._result_types), len(protocol.workspace.text_documents)]
    assert seen == [0, 0, 0]
    assert server.session.text("untitled:1") == "<a/>"


class Typing(RawIOBase):
    """The messages of a user who types, each sent after the previous ones are handled. The number of allocated blocks
    of memory is recorded from time to time.

    Args:
        messages: the messages.
        is_busy: whether there are messages that are not handled yet.
    """

    def __init__(self, messages: Iterator[bytes], is_busy: Callable[[], bool]) -> None:
        self._messages, self._is_busy = messages, is_busy
        self._rest = b""
        self.sent = 0
        self.allocated: dict[int, int] = {}

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        if not self._rest:
            while self._is_busy():
                time.sleep(0.001)
            self._rest = next(self._messages, b"")
            self.sent += 1
            if self.sent % 10 == 0:
                gc.collect()
                self.allocated[self.sent] = sys.getallocatedblocks()
        size = min(len(buffer), len(self._rest))
        buffer[:size], self._rest = self._rest[:size], self._rest[size:]
        return size


def test_memory_reaches_a_plateau(tmp_path: Path) -> None:
    """The memory stops growing while a user types, including the memory of background computations."""
    clock.write(tmp_path)
    path = tmp_path / "clock.ascxml"
    text = path.read_text()
    line, column = next((n, row.index("count")) for n, row in enumerate(text.split("\n")) if "count" in row)

    def messages() -> Iterator[bytes]:
        folders = [{"uri": tmp_path.as_uri(), "name": "robot"}]
        pulls = {"textDocument": {"diagnostic": {}}}
        params = {**INITIALIZE, "workspaceFolders": folders, "capabilities": pulls}
        yield frame({"jsonrpc": "2.0", "id": 0, "method": "initialize", "params": params})
        document = {"uri": path.as_uri(), "languageId": "ascxml", "version": 1, "text": text}
        yield frame({"jsonrpc": "2.0", "method": "textDocument/didOpen", "params": {"textDocument": document}})
        for number in range(300):
            start, end = ({"line": line, "character": column + at} for at in (0, number % 2))
            change = {"range": {"start": start, "end": end}, "text": "" if number % 2 else "x"}
            params = {"textDocument": {"uri": path.as_uri(), "version": number + 2}, "contentChanges": [change]}
            yield frame({"jsonrpc": "2.0", "method": "textDocument/didChange", "params": params})
            asked = {"textDocument": {"uri": path.as_uri()}}
            yield frame({"jsonrpc": "2.0", "id": number + 1, "method": "textDocument/diagnostic", "params": asked})

    def growth() -> int:
        server = create()
        typing = Typing(messages(), lambda: server.inbox.waiting)
        target = _Nowhere()
        server.serve(BufferedReader(typing), target)
        assert target.written > 1000
        # The first messages fill caches. Temporary data of computations come and go, so the minimum is used.
        first = min(typing.allocated[at] for at in range(200, 400, 10))
        return min(typing.allocated[at] for at in range(410, 601, 10)) - first

    # The blocks of all threads are counted, also those that an earlier test has left, so an excess is measured again.
    # There are 2 blocks for a message, where a future for each would take 5.
    grown = [growth()]
    while grown[-1] >= 400 and len(grown) < 3:
        grown.append(growth())
    assert grown[-1] < 400, grown


class _Nowhere(BytesIO):
    """A stream that counts the bytes that are written."""

    written = 0

    def write(self, data: Any) -> int:
        self.written += len(data)
        return len(data)


def test_a_client_that_never_answers() -> None:
    """Pending requests to the client are discarded after a while, the oldest first."""
    protocol = create().endpoint.protocol
    protocol.set_writer(_Kept(), include_headers=True)  # type: ignore[arg-type]
    futures = [protocol.send_request("workspace/codeLens/refresh") for _ in range(1500)]
    assert len(protocol._request_futures) == len(protocol._result_types) == 1000
    assert futures[-1] in protocol._request_futures.values()
    assert futures[0] not in protocol._request_futures.values()


def test_a_header_without_an_end() -> None:
    """Data between the header and the next message are skipped, and the next message is handled."""
    data = b"Content-Length: 100\r\n{no header}\r\n\r\nContent-Length: 2\r\nContent-Type: x\r\n\r\n{}"
    assert list(bodies(BytesIO(data))) == [b"{}"]

# SPDX-License-Identifier: Apache-2.0
"""Serving on a port and on a socket file: accepted and rejected clients."""

from __future__ import annotations

import asyncio
import json
import os
import re
import socket
import stat
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import pytest
from client import frame, start_raw
from lsprotocol import types
from pygls.lsp.client import LanguageClient

import clock
import prefork
from timeouts import TIMEOUT_S

TOKEN = "a-secret-of-the-user"
INITIALIZE = {"processId": None, "rootUri": None, "capabilities": {}}


@dataclass(frozen=True)
class Listening:
    """A server that listens.

    Attributes:
        port: 0 if it listens on a socket file.
    """

    process: asyncio.subprocess.Process
    port: int
    token: str


@asynccontextmanager
async def listening(*arguments: str, **environment: str) -> AsyncIterator[Listening]:
    """A server, after it has printed that it listens."""
    pipe = asyncio.subprocess.PIPE
    process = await asyncio.create_subprocess_exec(
        *prefork.command(), *arguments, stdin=pipe, stdout=pipe, stderr=pipe, env={**os.environ, **environment}
    )
    assert process.stderr is not None
    said = ""
    last = "initializationOptions" if "--tcp" in arguments else "listening on"
    while last not in said:
        line = (await asyncio.wait_for(process.stderr.readline(), TIMEOUT_S)).decode()
        assert line, said
        said += line
    port = re.search(r"listening on \S+:(\d+)\n", said)
    token = re.search(r"initializationOptions: (\S+)\n", said)
    try:
        yield Listening(process, int(port[1]) if port else 0, token[1] if token else "")
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()


def initialize(token: object = None) -> bytes:
    options = {} if token is None else {"initializationOptions": {"token": token}}
    return frame({"jsonrpc": "2.0", "id": 1, "method": "initialize", "params": {**INITIALIZE, **options}})


async def exchange(port: int, data: bytes) -> bytes:
    """The answer to some bytes, until the server closes the connection."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    with suppress(ConnectionError):
        writer.write(data)
        await writer.drain()
    answer = b""
    with suppress(ConnectionError):
        answer = await asyncio.wait_for(reader.read(), TIMEOUT_S)
    writer.close()
    return answer


async def end_of(server: Listening, port: int, token: str) -> int:
    """Connect as a client, and shut the server down; return its exit status."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    shutdown = frame({"jsonrpc": "2.0", "id": 2, "method": "shutdown"})
    writer.write(initialize(token) + shutdown + frame({"jsonrpc": "2.0", "method": "exit"}))
    answer = await asyncio.wait_for(reader.read(), TIMEOUT_S)
    assert b'"capabilities"' in answer
    writer.close()
    return await asyncio.wait_for(server.process.wait(), TIMEOUT_S)


@pytest.mark.parametrize("given", ["", TOKEN], ids=["printed", "chosen"])
async def test_tcp(tmp_path: Path, given: str) -> None:
    """The library of a client, which sends the token as an option."""
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    client = LanguageClient("test", "1")
    published = asyncio.Event()
    received: list[types.PublishDiagnosticsParams] = []

    @client.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
    def publish(params: types.PublishDiagnosticsParams) -> None:
        received.append(params)
        published.set()

    async with listening("--tcp", "127.0.0.1:0", AS2FM_TOKEN=given) as server:
        assert given in ("", server.token)
        assert len(server.token) >= 16
        await client.start_tcp("127.0.0.1", server.port)
        await client.initialize_async(
            types.InitializeParams(
                capabilities=types.ClientCapabilities(),
                workspace_folders=[types.WorkspaceFolder(tmp_path.as_uri(), "robot")],
                initialization_options={"token": server.token},
            )
        )
        client.initialized(types.InitializedParams())
        await asyncio.wait_for(published.wait(), TIMEOUT_S)
        assert [(Path(p.uri).name, [d.code for d in p.diagnostics]) for p in received] == [
            ("clock.ascxml", ["undeclared-variable"])
        ]
        await client.shutdown_async(None)
        client.exit(None)
        assert await asyncio.wait_for(server.process.wait(), TIMEOUT_S) == 0


def posted(target: Path) -> bytes:
    """Requests that a web page can send without permission: messages in the body."""
    command = {"command": "as2fm.translateToJani", "arguments": [(target / "main.xml").as_uri()]}
    execute = frame({"jsonrpc": "2.0", "id": 2, "method": "workspace/executeCommand", "params": command})
    body = initialize(TOKEN) + execute
    head = f"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: text/plain\r\nContent-Length: {len(body)}\r\n\r\n"
    return head.encode() + body


REFUSED = [
    initialize(),
    initialize("wrong"),
    initialize(["a", "list"]),
    initialize(TOKEN[:-1]),
    frame({"jsonrpc": "2.0", "id": 1, "method": "shutdown"}),
    frame({"jsonrpc": "2.0", "method": "exit"}),
]
DISCONNECTED = [
    b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
    b"\x16\x03\x01\x02\x00\x01" + bytes(500),
    b"\r\nContent-Length: 5\r\n\r\nhello",
    b"Host: localhost\r\nContent-Length: 5\r\n\r\nhello",
    b"Content-Length: 999999999\r\n\r\n{}",
    b"Content-Length: 200000\r\n\r\n" + b"[" * 200_000,
    b"Content-Length: 5\r\n\r\n{bad}",
    b"Content-Type: " + b"x" * 5000,
]


async def test_refused_clients(tmp_path: Path) -> None:
    """Each receives an error or is disconnected, and the next client is served."""
    main = clock.write(tmp_path)
    async with listening("--tcp", "127.0.0.1:0", AS2FM_TOKEN=TOKEN) as server:
        for data in REFUSED:
            answer = await exchange(server.port, data)
            assert json.loads(answer.partition(b"\r\n\r\n")[2])["error"]["code"] in (-32600, -32002), data
        for data in (*DISCONNECTED, posted(tmp_path)):
            assert await exchange(server.port, data) == b"", data[:40]
        _, silent = await asyncio.open_connection("127.0.0.1", server.port)
        silent.write(b"Content-Length: 100\r\n")
        assert await end_of(server, server.port, TOKEN) == 0
        silent.close()
    assert not main.with_suffix(".jani").exists()


async def test_it_ends_with_its_client() -> None:
    async with listening("--tcp", "localhost:0", AS2FM_TOKEN=TOKEN) as server:
        _, writer = await asyncio.open_connection("localhost", server.port)
        writer.write(initialize(TOKEN))
        writer.close()
        assert await asyncio.wait_for(server.process.wait(), TIMEOUT_S) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--tcp", "0.0.0.0:0"), "--tcp 0.0.0.0:0: other machines could connect there; use 127.0.0.1, or add --allow-"),
        (("--tcp", "[::]:0"), "--tcp [::]:0: other machines could connect there"),
        (("--tcp", "127.0.0.1:99999"), "--tcp needs HOST:PORT, not `127.0.0.1:99999`"),
        (("--tcp", "nonsense"), "--tcp needs HOST:PORT, not `nonsense`"),
        (("--tcp", ":1", "--socket", "x"), "--tcp and --socket exclude each other"),
        (("--allow-remote",), "--allow-remote needs --tcp"),
        (("--socket", "/nowhere/x.sock"), "--socket /nowhere/x.sock: No such file or directory"),
        (("--socket", "/dev/null"), "--socket /dev/null: a file with this name already exists"),
    ],
    ids=str,
)
async def test_wrong_use(arguments: tuple[str, ...], message: str) -> None:
    status, _, log = await (await start_raw(*arguments)).end()
    assert (status, log[: len("as2fm-lsp: ") + len(message)]) == (2, f"as2fm-lsp: {message}")


async def test_a_token_that_can_be_guessed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AS2FM_TOKEN", "1234")
    status, _, log = await (await start_raw("--tcp", "127.0.0.1:0")).end()
    assert (status, "AS2FM_TOKEN is too short" in log) == (2, True)


async def test_other_machines_are_served_if_requested() -> None:
    async with listening("--tcp", "0.0.0.0:0", "--allow-remote", AS2FM_TOKEN=TOKEN) as server:
        assert await end_of(server, server.port, TOKEN) == 0


async def test_a_port_that_is_taken() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        server = await start_raw("--tcp", f"127.0.0.1:{taken.getsockname()[1]}")
        status, _, log = await server.end()
    assert status == 2
    assert log.startswith("as2fm-lsp: --tcp 127.0.0.1:")
    assert "address already in use" in log.lower()


async def test_a_socket_file(tmp_path: Path) -> None:
    """Nobody else can connect. The file is removed with the connection, and a leftover file is replaced."""
    path = tmp_path / "as2fm.sock"
    with socket.socket(socket.AF_UNIX) as left:
        left.bind(str(path))
    async with listening("--socket", str(path)) as server:
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        status, _, log = await (await start_raw("--socket", str(path))).end()
        assert (status, "another server is listening there" in log) == (2, True)
        reader, writer = await asyncio.open_unix_connection(str(path))
        writer.write(b"GET / HTTP/1.1\r\n\r\n")
        assert await asyncio.wait_for(reader.read(), TIMEOUT_S) == b""
        writer.close()
        reader, writer = await asyncio.open_unix_connection(str(path))
        shutdown = frame({"jsonrpc": "2.0", "id": 2, "method": "shutdown"})
        writer.write(initialize() + shutdown + frame({"jsonrpc": "2.0", "method": "exit"}))
        assert b'"capabilities"' in await asyncio.wait_for(reader.read(), TIMEOUT_S)
        assert await asyncio.wait_for(server.process.wait(), TIMEOUT_S) == 0
        writer.close()
    assert not path.exists()

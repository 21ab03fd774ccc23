# SPDX-License-Identifier: Apache-2.0
"""A real client over standard input and output, with functions for tests."""

from __future__ import annotations

import asyncio
import json
import sys
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from lsprotocol import types
from pygls.protocol import default_converter
from pygls.uris import to_fs_path
from pytest_lsp import LanguageClient
from pytest_lsp.client import DEFAULT_CLIENT_FEATURES, register_lsp_features

import prefork
from timeouts import TIMEOUT_S

STARTED = (sys.executable, "-m", "as2fm_lsp")
"""The server as an editor starts it. Tests that are not about the start use `prefork.command()`, which is faster."""
QUICK = "from as2fm_lsp import __main__, diagnostics; diagnostics.PROGRESS_DELAY_S = {}; __main__.main()"

REFRESHES = (types.WORKSPACE_CODE_LENS_REFRESH, types.WORKSPACE_INLAY_HINT_REFRESH)
"""The requests of the server to refresh; `Client.refreshed` lists those that have arrived."""

PULLS = types.ClientCapabilities(
    text_document=types.TextDocumentClientCapabilities(diagnostic=types.DiagnosticClientCapabilities())
)


class Client(LanguageClient):
    """The client of pytest-lsp, which validates every message, with functions for tests."""

    def __init__(self, *, is_slow: bool = False) -> None:
        """Create the client.

        Args:
            is_slow: whether the answer to the request for settings is delayed until `answers` is set.
        """
        super().__init__(converter_factory=default_converter)
        self.published: dict[str, types.PublishDiagnosticsParams] = {}
        self.history: list[types.PublishDiagnosticsParams] = []
        self.refreshed: list[str] = []
        self.news = asyncio.Event()
        self.answers = asyncio.Event()
        self.parts: dict[str | int, list[object]] = {}
        features = DEFAULT_CLIENT_FEATURES | {types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS: _published}
        features |= {method: _with_news(features[method]) for method in (types.PROGRESS, types.WINDOW_SHOW_MESSAGE)}
        features[types.PROGRESS] = _parts(features[types.PROGRESS])
        features |= {method: _refresh(method) for method in REFRESHES}
        register_lsp_features(self, features | ({types.WORKSPACE_CONFIGURATION: _late} if is_slow else {}))

    # ------------------------------------------------------------- documents

    def open(self, path: Path, text: str | None = None, language: str = "ascxml") -> None:
        text = path.read_text(encoding="utf-8") if text is None else text
        item = types.TextDocumentItem(path.as_uri(), language, 1, text)
        self.text_document_did_open(types.DidOpenTextDocumentParams(item))

    def open_untitled(self, name: str, text: str, language: str = "ascxml") -> str:
        """Open a document without a file; return its URI."""
        uri = f"untitled:{name}"
        self.text_document_did_open(types.DidOpenTextDocumentParams(types.TextDocumentItem(uri, language, 1, text)))
        return uri

    def replace(self, path: Path, text: str, version: int = 2) -> None:
        """Replace the whole text of a document."""
        self.edit(path, types.TextDocumentContentChangeWholeDocument(text), version=version)

    def edit(self, path: Path, *changes: types.TextDocumentContentChangeEvent, version: int = 2) -> None:
        document = types.VersionedTextDocumentIdentifier(version, path.as_uri())
        self.text_document_did_change(types.DidChangeTextDocumentParams(document, list(changes)))

    def close(self, path: Path) -> None:
        document = types.TextDocumentIdentifier(path.as_uri())
        self.text_document_did_close(types.DidCloseTextDocumentParams(document))

    def folders(self, added: Sequence[Path] = (), removed: Sequence[Path] = ()) -> None:
        event = types.WorkspaceFoldersChangeEvent(
            [types.WorkspaceFolder(f.as_uri(), f.name) for f in added],
            [types.WorkspaceFolder(f.as_uri(), f.name) for f in removed],
        )
        self.workspace_did_change_workspace_folders(types.DidChangeWorkspaceFoldersParams(event))

    def changed(self, *paths: Path, kind: types.FileChangeType = types.FileChangeType.Changed) -> None:
        """Notify the server of changed files on the disk."""
        events = [types.FileEvent(path.as_uri(), kind) for path in paths]
        self.workspace_did_change_watched_files(types.DidChangeWatchedFilesParams(events))

    async def fixes(
        self, path: Path, range_: types.Range, shown: Sequence[types.Diagnostic] = ()
    ) -> list[types.CodeAction]:
        """The quick fixes at a place where the client shows some diagnostics."""
        params = types.CodeActionParams(
            types.TextDocumentIdentifier(path.as_uri()),
            range_,
            types.CodeActionContext(list(shown), only=[types.CodeActionKind.QuickFix]),
        )
        actions = await self.text_document_code_action_async(params)
        return [action for action in actions or () if isinstance(action, types.CodeAction)]

    # ---------------------------------------------------------------- events

    async def until(self, reached: Callable[[], object]) -> None:
        """Wait for messages that the server sends by itself (diagnostics, progress, messages, requests to refresh)
        until a condition holds.

        Raises:
            asyncio.TimeoutError: the condition does not become true.
        """
        while not reached():
            self.news.clear()
            await asyncio.wait_for(self.news.wait(), TIMEOUT_S)

    # ----------------------------------------------------------- diagnostics

    async def until_codes(self, path: Path | str, *codes: str) -> Sequence[types.Diagnostic]:
        """Wait until the diagnostics of a file have these codes."""
        try:
            await self.until(lambda: self.codes(path) == list(codes))
        except asyncio.TimeoutError:
            raise AssertionError(f"{path} has {self.codes(path)}, not {list(codes)}") from None
        params = self.published.get(_uri(path))
        return params.diagnostics if params else ()

    def codes(self, path: Path | str) -> list[str]:
        """The codes of the last published diagnostics of a file, given by its path or URI."""
        params = self.published.get(_uri(path))
        return [str(d.code) for d in params.diagnostics] if params else []

    async def pull(self, path: Path) -> Sequence[types.Diagnostic]:
        params = types.DocumentDiagnosticParams(types.TextDocumentIdentifier(path.as_uri()))
        report = await self.text_document_diagnostic_async(params)
        assert isinstance(report, types.RelatedFullDocumentDiagnosticReport)
        return report.items

    async def pull_all(self) -> dict[Path, Sequence[types.Diagnostic]]:
        """The diagnostics of the whole workspace, by file."""
        report = await self.workspace_diagnostic_async(types.WorkspaceDiagnosticParams([]))
        return {
            Path(str(to_fs_path(item.uri))): item.items
            for item in report.items
            if isinstance(item, types.WorkspaceFullDocumentDiagnosticReport)
        }


def _uri(path: Path | str) -> str:
    return path.as_uri() if isinstance(path, Path) else path


def _published(client: Client, params: types.PublishDiagnosticsParams) -> None:
    client.published[params.uri] = params
    client.history.append(params)
    client.news.set()


def _with_news(feature: Callable[[Client, Any], None]) -> Callable[[Client, Any], None]:
    """A feature of pytest-lsp that also wakes the code that waits for messages."""

    def take(client: Client, params: Any) -> None:
        feature(client, params)
        client.news.set()

    return take


def _parts(feature: Callable[[Client, Any], None]) -> Callable[[Client, Any], None]:
    """Store the partial results of a request. Progress of work is handled by the feature."""

    def take(client: Client, params: types.ProgressParams) -> None:
        if params.token in client.progress_reports:
            feature(client, params)
        else:
            client.parts.setdefault(params.token, []).append(params.value)

    return take


def _refresh(method: str) -> Callable[[Client, object], None]:
    def note(client: Client, _: object) -> None:
        client.refreshed.append(method)
        client.news.set()

    return note


async def _late(client: Client, params: types.ConfigurationParams) -> object:
    await client.answers.wait()
    return DEFAULT_CLIENT_FEATURES[types.WORKSPACE_CONFIGURATION](client, params)


@asynccontextmanager
async def connect(
    *folders: Path,
    capabilities: types.ClientCapabilities | None = None,
    options: dict[str, object] | None = None,
    settings: dict[str, object] | None = None,
    is_slow: bool = False,
    quick: float | None = None,
) -> AsyncIterator[Client]:
    """A server with these folders open. If `quick` is given, it shows the progress of checks that take longer than
    `quick` seconds."""
    client = Client(is_slow=is_slow)
    capabilities = capabilities or types.ClientCapabilities()
    if settings is not None:
        client.set_configuration({"as2fm": settings})
        capabilities.workspace = types.WorkspaceClientCapabilities(configuration=True)
    await client.start_io(*(prefork.command() if quick is None else (sys.executable, "-c", QUICK.format(quick))))
    try:
        await client.initialize_session(
            types.InitializeParams(
                capabilities=capabilities,
                workspace_folders=[types.WorkspaceFolder(folder.as_uri(), folder.name) for folder in folders],
                initialization_options=options,
            )
        )
        yield client
        await client.shutdown_session()
    except BaseException:
        if client._server is not None and client._server.returncode is None:
            client._server.kill()  # `stop` would wait for a server that nobody has told to end
        raise
    finally:
        await client.stop()


class RawServer:
    """A server that is sent bytes, for input that the library of a client would not send."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process

    def send_bytes(self, data: bytes) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(data)

    def send(self, method: str, params: object = None, id_: int | None = None) -> None:
        message: dict[str, object] = {"jsonrpc": "2.0", "method": method}
        if params is not None:
            message["params"] = params
        if id_ is not None:
            message["id"] = id_
        self.send_bytes(frame(message))

    async def read_log(self, text: str) -> str:
        """Wait until the log contains a text; return the log since the last call."""
        assert self._process.stdout is not None
        data = b""
        while text.encode() not in data:
            piece = await asyncio.wait_for(self._process.stdout.read(1 << 16), TIMEOUT_S)
            assert piece, f"it ends and has not said {text}"
            data += piece
        return data.decode()

    async def ended(self) -> int:
        """Wait for the end of the process while its input is open; return its exit status."""
        return await asyncio.wait_for(self._process.wait(), TIMEOUT_S)

    async def end(self) -> tuple[int, list[dict[str, object]], str]:
        """Close the input and wait. Return the exit status, the output, and the log."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        try:
            out, err = await asyncio.wait_for(self._process.communicate(), TIMEOUT_S)
        finally:
            if self._process.returncode is None:
                self._process.kill()
        return self._process.returncode, list(_messages(out)), err.decode()


async def start_raw(*arguments: str, command: Sequence[str] = ()) -> RawServer:
    """Start a server.

    Args:
        command: the command to start, if the server is not a fork.
    """
    pipe = asyncio.subprocess.PIPE
    command = command or prefork.command()
    process = await asyncio.create_subprocess_exec(*command, *arguments, stdin=pipe, stdout=pipe, stderr=pipe)
    return RawServer(process)


def frame(message: object) -> bytes:
    """The bytes of a message."""
    body = json.dumps(message).encode()
    return b"Content-Length: %d\r\n\r\n%b" % (len(body), body)


def _messages(data: bytes) -> Iterator[dict[str, object]]:
    while data:
        head, _, rest = data.partition(b"\r\n\r\n")
        lengths = [line for line in head.split(b"\r\n") if line.lower().startswith(b"content-length:")]
        length = int(lengths[0].partition(b":")[2])
        yield json.loads(rest[:length])
        data = rest[length:]

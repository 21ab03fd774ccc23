# SPDX-License-Identifier: Apache-2.0
"""Requests whose answers are no longer needed, progress of work, and the negotiation with the client."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from client import Client, connect, frame, start_raw
from lsprotocol import types
from pygls.exceptions import JsonRpcContentModified, JsonRpcRequestCancelled

import clock
from as2fm_lsp.inbox import Inbox
from as2fm_lsp.requests import Requests
from bench.generate import machine, write_system

LONG = machine(0, 2, 2500)
"""A machine whose check takes long: messages that are sent directly after it arrive during the check."""

CANCELLED, MODIFIED = -32800, -32801


async def answers(*messages: tuple[str, object, int | None], **capabilities: object) -> dict[object, dict[str, object]]:
    """The answers to messages that are sent at once, after a request that takes long (with the id 9)."""
    server = await start_raw()
    server.send(
        "initialize", {"processId": None, "capabilities": {"textDocument": {"diagnostic": {}}, **capabilities}}, 1
    )
    server.send("initialized", {})
    document = {"uri": "untitled:long", "languageId": "ascxml", "version": 1, "text": LONG}
    server.send("textDocument/didOpen", {"textDocument": document})
    server.send("textDocument/diagnostic", {"textDocument": {"uri": "untitled:long"}}, 9)
    for method, params, id_ in messages:
        server.send(method, params, id_)
    server.send("shutdown", None, 2)
    server.send("exit")
    status, messages, log = await server.end()
    assert (status, log) == (0, "")
    return {message["id"]: message for message in messages if "id" in message and "method" not in message}


def code(answer: dict[str, object]) -> object:
    error = answer.get("error")
    return error["code"] if isinstance(error, dict) else None


OF_LONG = {"textDocument": {"uri": "untitled:long"}}
TOKENS = "textDocument/semanticTokens/full"
CHANGE = {"textDocument": {"uri": "untitled:long", "version": 2}, "contentChanges": [{"text": "<ascxml/>"}]}


async def test_cancelled_before_it_has_begun() -> None:
    by_id = await answers(
        ("textDocument/foldingRange", OF_LONG, 10),
        (TOKENS, OF_LONG, "eleven"),
        ("$/cancelRequest", {"id": 10}, None),
        ("$/cancelRequest", {"id": "eleven"}, None),
        ("textDocument/foldingRange", OF_LONG, 12),
    )
    assert [code(by_id[id_]) for id_ in (9, 10, "eleven", 12)] == [None, CANCELLED, CANCELLED, None]
    assert by_id[12]["result"]


async def test_cancelled_while_it_runs() -> None:
    by_id = await answers(("$/cancelRequest", {"id": 9}, None), ("textDocument/foldingRange", OF_LONG, 10))
    assert [code(by_id[id_]) for id_ in (9, 10)] == [CANCELLED, None]


async def test_cancelled_when_it_is_answered() -> None:
    by_id = await answers(
        ("textDocument/foldingRange", OF_LONG, 10),
        ("textDocument/foldingRange", {"textDocument": {"uri": "untitled:none"}}, 11),
        ("$/cancelRequest", {"id": 9999}, None),
    )
    assert [code(by_id[id_]) for id_ in (9, 10, 11)] == [None, None, None]


@pytest.mark.parametrize(("again", "expected"), [([TOKENS], MODIFIED), (["textDocument/hover"], None), (None, None)])
async def test_a_text_that_is_about_to_change(again: list[str] | None, expected: int | None) -> None:
    """Only clients that support it are asked to repeat a request."""
    support = {"cancel": True, "retryOnContentModified": again}
    general = {} if again is None else {"general": {"staleRequestSupport": support}}
    by_id = await answers(
        (TOKENS, OF_LONG, 10), ("textDocument/didChange", CHANGE, None), (TOKENS, OF_LONG, 11), **general
    )
    assert code(by_id[10]) == expected
    assert by_id[11]["result"] != by_id[10].get("result")


async def test_a_cancelled_translation_writes_nothing(tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    command = {"command": "as2fm.translateToJani", "arguments": [main.as_uri()]}
    by_id = await answers(("workspace/executeCommand", command, 10), ("$/cancelRequest", {"id": 10}, None))
    assert code(by_id[10]) == CANCELLED
    assert not main.with_suffix(".jani").exists()


async def test_invalid_requests_are_answered() -> None:
    server = await start_raw()
    server.send("initialize", {"processId": None, "capabilities": {}}, 1)
    server.send("textDocument/hover", {"textDocument": 5}, 10)
    server.send("textDocument/hover", None, 11)
    server.send("shutdown", None, 2)
    server.send("exit")
    _, messages, _ = await server.end()
    by_id = {message["id"]: message for message in messages}
    assert [code(by_id[id_]) is not None for id_ in (10, 11, 2)] == [True, True, False]


async def test_a_refusal_is_not_an_internal_error(tmp_path: Path) -> None:
    """A rejected request is not an internal error, so the log stays empty."""
    main = clock.write(tmp_path)
    server = await start_raw()
    server.send("initialize", {"processId": None, "capabilities": {}}, 1)
    params = {"textDocument": {"uri": main.as_uri()}, "position": {"line": 0, "character": 0}, "newName": "x"}
    server.send("textDocument/rename", params, 10)
    server.send("no/such", {}, 11)
    server.send("shutdown", None, 2)
    server.send("exit")
    _, messages, log = await server.end()
    assert [code(message) for message in messages] == [None, -32803, -32601, None]
    assert log == ""


# ------------------------------------------------------------------ checkpoints


def guarded(inbox: Inbox, handler: Callable[[Requests], object], again: frozenset[str] = frozenset()) -> object:
    """The answer of a handler of a request with the id 7, during which the client sends messages."""
    requests = Requests(inbox, lambda: 7)
    requests.asked_again = again

    def handle(_: types.HoverParams) -> object:
        return handler(requests)

    params = types.HoverParams(types.TextDocumentIdentifier("untitled:1"), types.Position(0, 0))
    return requests.guarded("textDocument/hover", handle)(params)


def sends(inbox: Inbox, method: str, params: object) -> None:
    inbox.put(json.dumps({"jsonrpc": "2.0", "method": method, "params": params}).encode())


def test_checkpoints() -> None:
    inbox = Inbox()

    def handler(requests: Requests) -> str:
        requests.checkpoint()
        sends(inbox, "$/cancelRequest", {"id": 8})
        sends(inbox, "textDocument/didChange", {"textDocument": {"uri": "untitled:1"}})
        requests.checkpoint()
        sends(inbox, "$/cancelRequest", {"id": 7})
        requests.checkpoint()
        return "done"

    with pytest.raises(JsonRpcRequestCancelled):
        guarded(inbox, handler)
    assert not inbox.is_cancelled(7), "the id is forgotten"
    with pytest.raises(JsonRpcContentModified):
        guarded(inbox, Requests.checkpoint, frozenset(["textDocument/hover"]))


def test_checkpoints_without_a_request() -> None:
    inbox = Inbox()
    sends(inbox, "$/cancelRequest", {"id": 7})
    Requests(inbox, lambda: None).checkpoint()


# --------------------------------------------------------------------- progress

SHOWS = types.ClientCapabilities(window=types.WindowClientCapabilities(work_done_progress=True))


def titles(client: Client) -> list[str]:
    begun = (report for reports in client.progress_reports.values() for report in reports)
    return [report.title for report in begun if isinstance(report, types.WorkDoneProgressBegin)]


def token_of(client: Client, title: str) -> str | int | None:
    """The token of the progress with a title."""
    for token, reports in client.progress_reports.items():
        if any(
            isinstance(report, types.WorkDoneProgressBegin) and report.title.startswith(title) for report in reports
        ):
            return token
    return None


def is_over(reports: Sequence[object]) -> bool:
    return bool(reports) and isinstance(reports[-1], types.WorkDoneProgressEnd)


async def test_the_user_cancels_a_translation(tmp_path: Path) -> None:
    main = write_system(tmp_path, 80)
    async with connect(capabilities=SHOWS) as client:
        params = types.ExecuteCommandParams("as2fm.translateToJani", [main.as_uri()])
        answer = asyncio.ensure_future(client.workspace_execute_command_async(params))
        await client.until(lambda: token_of(client, "Translating"))
        token = token_of(client, "Translating")
        assert token is not None
        client.window_work_done_progress_cancel(types.WorkDoneProgressCancelParams(token))
        assert await answer is None
        assert isinstance(client.progress_reports[token][-1], types.WorkDoneProgressEnd)
        assert client.messages == []
    assert not main.with_suffix(".jani").exists()
    assert len(list(tmp_path.iterdir())) == 80


async def test_a_long_check_is_shown(tmp_path: Path) -> None:
    write_system(tmp_path, 40)
    async with connect(tmp_path, capabilities=SHOWS, quick=0.0) as client:
        await client.until(lambda: any(map(is_over, client.progress_reports.values())))
        assert titles(client) == ["Checking models"]
        (reports,) = client.progress_reports.values()
    shares = [report.percentage for report in reports[1:-1]]
    assert shares == sorted(set(shares))
    assert 0 < shares[0] < shares[-1] <= 100


async def test_a_short_check_is_not_shown(tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    async with connect(tmp_path, capabilities=SHOWS, quick=3600.0) as client:
        await client.until_codes(tmp_path / "clock.ascxml", "undeclared-variable")
        client.open(tmp_path / "clock.ascxml")
        client.replace(tmp_path / "clock.ascxml", clock.CLOCK)
        await client.until_codes(tmp_path / "clock.ascxml")
        assert titles(client) == []


# -------------------------------------------------------------------- agreements

UNITS = {"utf-8": 6, "utf-16": 3, "utf-32": 2}
"""The numbers of units of a robot emoji and an accented letter."""


@pytest.mark.parametrize("encoding", UNITS)
async def test_position_encodings(tmp_path: Path, encoding: str) -> None:
    line = '<assign location="coutn"'
    clock.write(tmp_path)
    path = tmp_path / "clock.ascxml"
    text = clock.CLOCK.replace('<assign location="count"', f"<!-- 🤖é -->{line}")
    ours = types.PositionEncodingKind(encoding)
    general = types.GeneralClientCapabilities(position_encodings=[ours])
    async with connect(tmp_path, capabilities=types.ClientCapabilities(general=general)) as client:
        client.open(path, text)
        (diagnostic,) = await client.until_codes(path, "undeclared-variable")
        before = len("            <!--  -->") + UNITS[encoding] + len('<assign location="')
        assert diagnostic.range == types.Range(types.Position(8, before), types.Position(8, before + 5))
        client.edit(path, types.TextDocumentContentChangePartial(diagnostic.range, "count"))
        await client.until_codes(path)


@pytest.mark.parametrize("offers", [["utf-7", "utf-8", "utf-16"], ["utf-7"]], ids=["some", "none"])
async def test_encodings_that_we_do_not_know(offers: list[str]) -> None:
    server = await start_raw()
    server.send_bytes(
        frame(
            {
                "jsonrpc": "2.0",
                "id": 1,
                "method": "initialize",
                "params": {"processId": None, "capabilities": {"general": {"positionEncodings": offers}}},
            }
        )
    )
    server.send("shutdown", None, 2)
    server.send("exit")
    _, (answer, _), _ = await server.end()
    expected = "utf-8" if "utf-8" in offers else "utf-16"
    assert answer["result"]["capabilities"]["positionEncoding"] == expected  # type: ignore[index]


async def test_settings_change_while_it_runs(tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    path = tmp_path / "clock.ascxml"
    async with connect(tmp_path, settings={}) as client:
        await client.until_codes(path, "undeclared-variable")
        client.set_configuration({"as2fm": {"severity": {"undeclared-variable": "hint"}}})
        client.workspace_did_change_configuration(types.DidChangeConfigurationParams(None))
        await client.until(lambda: _severities(client, path) == [types.DiagnosticSeverity.Hint])
        client.set_configuration({"as2fm": {"ignore": ["undeclared-variable"]}})
        client.workspace_did_change_configuration(types.DidChangeConfigurationParams(None))
        await client.until_codes(path)


def _severities(client: Client, path: Path) -> list[types.DiagnosticSeverity | None]:
    return [diagnostic.severity for diagnostic in client.published[path.as_uri()].diagnostics]


async def test_settings_that_come_with_the_first_message(tmp_path: Path) -> None:
    """A client that sends settings with `initialize` gets diagnostics without answering a request for settings."""
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    path = tmp_path / "clock.ascxml"
    sent: dict[str, object] = {"settings": {"severity": {"undeclared-variable": "hint"}}}
    async with connect(tmp_path, options=sent, settings={}, is_slow=True) as client:
        await client.until_codes(path, "undeclared-variable")
        assert _severities(client, path) == [types.DiagnosticSeverity.Hint]
        client.answers.set()
        await client.until(lambda: _severities(client, path) == [types.DiagnosticSeverity.Error])


async def test_settings_that_the_client_has_changed_its_mind_about(tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    path = tmp_path / "clock.ascxml"
    sent: dict[str, object] = {"settings": {"ignore": ["undeclared-variable"]}}
    async with connect(tmp_path, options=sent, settings={"exclude": ["none"]}) as client:
        await client.until_codes(path, "undeclared-variable")


async def test_settings_that_are_sent(tmp_path: Path) -> None:
    """Settings of a client that does not support requests for settings."""
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    path = tmp_path / "clock.ascxml"
    async with connect(tmp_path) as client:
        await client.until_codes(path, "undeclared-variable")
        settings = {"as2fm": {"ignore": ["undeclared-variable"]}}
        client.workspace_did_change_configuration(types.DidChangeConfigurationParams(settings))
        await client.until_codes(path)
        client.workspace_did_change_configuration(types.DidChangeConfigurationParams({"as2fm": {}}))
        await client.until_codes(path, "undeclared-variable")


async def test_a_configuration_file_that_changes(tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    path, configuration = tmp_path / "clock.ascxml", tmp_path / "as2fm.toml"
    async with connect(tmp_path) as client:
        await client.until_codes(path, "undeclared-variable")
        configuration.write_text('ignore = ["undeclared-variable"]\n')
        client.changed(configuration, kind=types.FileChangeType.Created)
        await client.until_codes(path)
        configuration.unlink()
        client.changed(configuration, kind=types.FileChangeType.Deleted)
        await client.until_codes(path, "undeclared-variable")

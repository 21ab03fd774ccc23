# SPDX-License-Identifier: Apache-2.0
"""Navigation over standard input and output, in a buffer that was not saved."""

from __future__ import annotations

from pathlib import Path

from client import Client, connect
from ide_models import ROBOT, load
from lsprotocol import types

import clock
from fixture import split_files


def place(path: Path, text: str, piece: str) -> tuple[types.TextDocumentIdentifier, types.Position]:
    """The document and the position of the caret in a piece of its text."""
    before, _, after = piece.partition("|")
    at = text.index(before + after) + len(before)
    line = text.count("\n", 0, at)
    return types.TextDocumentIdentifier(path.as_uri()), types.Position(line, at - text.rfind("\n", 0, at) - 1)


def lines(locations: object) -> list[tuple[str, int]]:
    assert isinstance(locations, (list, tuple))
    return [(location.uri.rpartition("/")[2], location.range.start.line + 1) for location in locations]


async def ask(client: Client, machine: Path, text: str) -> None:
    at = place(machine, text, 'event="g|o" target')
    assert lines(await client.text_document_definition_async(types.DefinitionParams(*at))) == [("a.ascxml", 6)]
    assert lines(await client.text_document_declaration_async(types.DeclarationParams(*at))) == [("a.ascxml", 6)]
    assert lines(await client.text_document_implementation_async(types.ImplementationParams(*at))) == [("a.ascxml", 7)]
    context = types.ReferenceContext(include_declaration=False)
    locations = await client.text_document_references_async(types.ReferenceParams(context, *at))
    assert lines(locations) == [("a.ascxml", 7), ("properties.jani", 1), ("properties.jani", 2)]
    shown = await client.text_document_document_highlight_async(types.DocumentHighlightParams(*at))
    assert [highlight.kind for highlight in shown or ()] == [
        types.DocumentHighlightKind.Write,
        types.DocumentHighlightKind.Read,
    ]
    typed = place(machine, text, "_msg.da|ta")
    (field,) = lines(await client.text_document_definition_async(types.DefinitionParams(*typed)))
    assert field[0] == "Int32.msg"
    typed = place(machine, text, 'name="in|put"')
    locations = await client.text_document_type_definition_async(types.TypeDefinitionParams(*typed))
    assert lines(locations) == [("Int32.msg", 1)]


async def test_navigation(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    machine = tmp_path / "a.ascxml"
    text = "<!-- 🤖 -->\n" + machine.read_text(encoding="utf-8")
    async with connect(tmp_path) as client:
        client.open(machine, text)
        await ask(client, machine, text)
        symbols = await client.workspace_symbol_async(types.WorkspaceSymbolParams("walk"))
        assert [(symbol.name, symbol.kind) for symbol in symbols or ()] == [("Walk", types.SymbolKind.Class)]


async def test_calls(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    machine = tmp_path / "a.ascxml"
    text = machine.read_text(encoding="utf-8")
    async with connect(tmp_path) as client:
        at = place(machine, text, 'name="in|put"')
        items = await client.text_document_prepare_call_hierarchy_async(types.CallHierarchyPrepareParams(*at))
        (topic,) = items or ()
        assert (topic.name, topic.detail) == ("a__b", "topic")
        senders = await client.call_hierarchy_incoming_calls_async(types.CallHierarchyIncomingCallsParams(topic))
        assert [(call.from_.name, len(call.from_ranges)) for call in senders or ()] == [("Walk", 1)]
        receivers = await client.call_hierarchy_outgoing_calls_async(types.CallHierarchyOutgoingCallsParams(topic))
        assert [call.to.name for call in receivers or ()] == ["A"]


async def test_hover(tmp_path: Path) -> None:
    clock.write(tmp_path)
    document = types.TextDocumentIdentifier((tmp_path / "clock.ascxml").as_uri())
    async with connect(tmp_path) as client:
        hover = await client.text_document_hover_async(types.HoverParams(document, types.Position(2, 19)))
        assert hover is not None
        assert isinstance(hover.contents, types.MarkupContent)
        assert "count : uint8" in hover.contents.value
        assert hover.range == types.Range(types.Position(2, 18), types.Position(2, 23))
        assert await client.text_document_hover_async(types.HoverParams(document, types.Position(1, 0))) is None

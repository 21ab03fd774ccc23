# SPDX-License-Identifier: Apache-2.0
"""The structure of a file and its tags over the wire, in UTF-16."""

from __future__ import annotations

from pathlib import Path

from client import connect
from lsprotocol import types

import clock

TEXT = '<ascxml name="🤖">\n<!-- 🤖 --><state id="a"><onentry>\n</onentry></state>\n</ascxml>'


def place(line: int, start: int, end: int) -> types.Range:
    return types.Range(types.Position(line, start), types.Position(line, end))


async def test_structure(tmp_path: Path) -> None:
    path = tmp_path / "a.ascxml"
    document = types.TextDocumentIdentifier(path.as_uri())
    async with connect(tmp_path) as client:
        client.open(path, TEXT)
        folds = await client.text_document_folding_range_async(types.FoldingRangeParams(document))
        assert [(fold.start_line, fold.end_line) for fold in folds or ()] == [(0, 2), (1, 2)]
        selections = await client.text_document_selection_range_async(
            types.SelectionRangeParams(document, [types.Position(1, 14), types.Position(9, 9)])
        )
        assert selections
        first, last = selections
        assert first.range == place(1, 12, 17)
        assert first.parent
        assert first.parent.range == place(1, 11, 25)
        assert last.range == types.Range(types.Position(0, 0), types.Position(3, 9))
        names = await client.text_document_linked_editing_range_async(
            types.LinkedEditingRangeParams(document, types.Position(1, 12))
        )
        assert names
        assert list(names.ranges) == [place(1, 12, 17), place(2, 12, 17)]
        symbols = await client.text_document_document_symbol_async(types.DocumentSymbolParams(document))
        shown = [(symbol.name, symbol.container_name) for symbol in symbols or () if hasattr(symbol, "location")]
        assert shown == [("🤖", None), ("a", "🤖")]


async def test_outline_is_nested_for_clients_that_take_it(tmp_path: Path) -> None:
    path = tmp_path / "a.ascxml"
    symbol = types.DocumentSymbolClientCapabilities(hierarchical_document_symbol_support=True)
    text_document = types.TextDocumentClientCapabilities(document_symbol=symbol)
    async with connect(tmp_path, capabilities=types.ClientCapabilities(text_document=text_document)) as client:
        client.open(path, TEXT)
        params = types.DocumentSymbolParams(types.TextDocumentIdentifier(path.as_uri()))
        (machine,) = await client.text_document_document_symbol_async(params) or ()
        assert isinstance(machine, types.DocumentSymbol)
        assert (machine.name, machine.selection_range) == ("🤖", place(0, 14, 16))
        assert [(child.name, child.selection_range) for child in machine.children or ()] == [("a", place(1, 22, 23))]


async def test_closing(tmp_path: Path) -> None:
    path = tmp_path / "a.ascxml"
    document, options = types.TextDocumentIdentifier(path.as_uri()), types.FormattingOptions(4, True)
    async with connect(tmp_path) as client:
        client.open(path, '<ascxml name="🤖">')
        params = types.DocumentOnTypeFormattingParams(document, types.Position(0, 18), ">", options)
        edits = await client.text_document_on_type_formatting_async(params)
        assert list(edits or ()) == [types.TextEdit(place(0, 18, 18), "</ascxml>")]
        client.replace(path, '<ascxml name="🤖"></ascxml>')
        assert not await client.text_document_on_type_formatting_async(params)


async def test_links(tmp_path: Path) -> None:
    clock.write(tmp_path)
    (tmp_path / "properties.jani").unlink()
    main = types.TextDocumentIdentifier((tmp_path / "main.xml").as_uri())
    async with connect(tmp_path) as client:
        links = await client.text_document_document_link_async(types.DocumentLinkParams(main))
        target = (tmp_path / "clock.ascxml").as_uri()
        assert [(link.range, link.target) for link in links or ()] == [(place(5, 39, 51), target)]

# SPDX-License-Identifier: Apache-2.0
"""Formatting over the wire."""

from __future__ import annotations

from pathlib import Path

from client import connect
from lsprotocol import types

from roaml.text import Position, SourceFile, Span, TextEdit, apply_edits

UGLY = '<ascxml name="A">\r\n<!-- 🤖🤖 --> <state id="🤖"  initial="é"/>   \r\n  <state/>\r\n</ascxml>'


def applied(text: str, edits: list[types.TextEdit] | None) -> str:
    """A text with the edits of a server that counts in UTF-16, made as an editor does."""
    source = SourceFile("", text)

    def offset(position: types.Position) -> int:
        start = source.lines.offset(Position(position.line, 0))
        line = text[start : source.lines.line_end(position.line)].encode("utf-16-le")
        assert position.character * 2 <= len(line)
        return start + len(line[: position.character * 2].decode("utf-16-le"))

    spans = [TextEdit(Span(offset(e.range.start), offset(e.range.end)), e.new_text) for e in edits or ()]
    return apply_edits(text, tuple(spans))


async def test_formatting(tmp_path: Path) -> None:
    path = tmp_path / "a.ascxml"
    document, four = types.TextDocumentIdentifier(path.as_uri()), types.FormattingOptions(4, True)
    async with connect(tmp_path) as client:
        client.open(path, UGLY)
        edits = await client.text_document_formatting_async(types.DocumentFormattingParams(document, four))
        assert applied(UGLY, list(edits or ())) == (
            '<ascxml name="A">\r\n    <!-- 🤖🤖 -->\r\n    <state id="🤖" initial="é" />\r\n'
            "    <state />\r\n</ascxml>\r\n"
        )
        line = types.Range(types.Position(2, 0), types.Position(2, 4))
        params = types.DocumentRangeFormattingParams(document, line, types.FormattingOptions(2, False))
        edits = await client.text_document_range_formatting_async(params)
        assert applied(UGLY, list(edits or ())) == UGLY.replace("  <state/>", "\t<state />")
        client.replace(path, UGLY[:-1])
        assert not await client.text_document_formatting_async(types.DocumentFormattingParams(document, four))

# SPDX-License-Identifier: Apache-2.0
"""Edits of an open document: the text of the server is equal to that of the client, in all position encodings."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import NamedTuple

import pytest
from client import connect
from hypothesis import given
from hypothesis import strategies as st
from lsprotocol import types

import clock
from as2fm_lsp.convert import Converter
from as2fm_lsp.session import Session
from roaml.text import SourceFile, Span

NO_LINE_ENDS = "\u2028\u2029\x85\x0b\x0c\x1c\x1d\x1e"
"""Characters at which `str.splitlines` ends a line and the protocol does not."""

ALPHABET = "ab<é€🤖\t \r\n\ufeff" + NO_LINE_ENDS
ENCODINGS = tuple(types.PositionEncodingKind)
UNIT_BYTES = dict(zip(ENCODINGS, (1, 2, 4), strict=True))
CODECS = {
    types.PositionEncodingKind.Utf8: "utf-8",
    types.PositionEncodingKind.Utf16: "utf-16-le",
    types.PositionEncodingKind.Utf32: "utf-32-le",
}


class ClientText:
    """A document as an editor stores it: a sequence of the units of its encoding, with lines that end as the protocol
    defines. It is independent of the server's code: it neither decodes nor uses regular expressions."""

    def __init__(self, encoding: types.PositionEncodingKind, text: str) -> None:
        self.encoding = encoding
        self.units = self.encoded(text)

    def encoded(self, text: str) -> list[bytes]:
        data, size = text.encode(CODECS[self.encoding], "surrogatepass"), UNIT_BYTES[self.encoding]
        return [data[at : at + size] for at in range(0, len(data), size)]

    @property
    def text(self) -> str:
        return b"".join(self.units).decode(CODECS[self.encoding], "surrogatepass")

    def line_starts(self) -> list[int]:
        """Where each line begins, in units."""
        lf, cr = self.encoded("\n")[0], self.encoded("\r")[0]
        starts = [0]
        for at, unit in enumerate(self.units):
            is_pair = unit == cr and self.units[at + 1 : at + 2] == [lf]
            if unit == lf or (unit == cr and not is_pair):
                starts.append(at + 1)
        return starts

    def offset(self, position: types.Position) -> int:
        starts = self.line_starts()
        if position.line >= len(starts):
            return len(self.units)
        ends = (*starts[1:], len(self.units))
        start, end = starts[position.line], ends[position.line]
        while end > start and self.units[end - 1] in (*self.encoded("\n"), *self.encoded("\r")):
            end -= 1
        return min(start + position.character, end)

    def position(self, offset: int) -> types.Position:
        line, start = [(n, s) for n, s in enumerate(self.line_starts()) if s <= offset][-1]
        return types.Position(line, offset - start)

    def edit(self, range_: types.Range, text: str) -> None:
        start, end = sorted((self.offset(range_.start), self.offset(range_.end)))
        self.units[start:end] = self.encoded(text)

    def boundaries(self) -> list[int]:
        """The offsets that a client can use. A client with UTF-8 texts never splits a character; others may."""
        if self.encoding is types.PositionEncodingKind.Utf8:
            return [at for at in range(len(self.units) + 1) if not 0x80 <= (*b"".join(self.units), 0)[at] < 0xC0]
        return list(range(len(self.units) + 1))


class Edit(NamedTuple):
    """An edit. `start` and `end` select among the places of the text at the time of the edit; `beyond` is added to a
    column, which is then too great."""

    start: int
    end: int
    beyond: int
    text: str


texts = st.text(ALPHABET, max_size=30)
edits = st.lists(
    st.builds(Edit, st.integers(0, 99), st.integers(0, 99), st.sampled_from([0, 0, 0, 1000]), texts), max_size=6
)


def opened(encoding: types.PositionEncodingKind, text: str) -> Session:
    session = Session()
    session.convert = Converter(encoding)
    session.open("untitled:1", text, 1)
    return session


@pytest.mark.parametrize("encoding", ENCODINGS)
@given(text=texts, made=edits, together=st.booleans())
def test_edits(encoding: types.PositionEncodingKind, text: str, made: list[Edit], together: bool) -> None:
    """Many edits in one change, or each in a change of its own."""
    client, session = ClientText(encoding, text), opened(encoding, text)
    changes: list[types.TextDocumentContentChangeEvent] = []
    for edit in made:
        places = client.boundaries()
        start, end = (client.position(places[at % len(places)]) for at in (edit.start, edit.end))
        end = types.Position(end.line, end.character + edit.beyond)
        range_ = types.Range(start, end)
        client.edit(range_, edit.text)
        changes.append(types.TextDocumentContentChangePartial(range_, edit.text))
    for change in [changes] if together else [[single] for single in changes]:
        session.change("untitled:1", change, 2)
    assert session.text("untitled:1") == client.text


@pytest.mark.parametrize("encoding", ENCODINGS)
@given(text=texts)
def test_places(encoding: types.PositionEncodingKind, text: str) -> None:
    """Positions are converted to the client's units and back without a change. A byte order mark before the text is
    only included in the client's columns."""
    client, session = ClientText(encoding, text), opened(encoding, text)
    source = SourceFile("untitled:1", text.removeprefix("\ufeff"))
    mark = len(text) - len(source.text)
    for offset in range(len(source.text) + 1):
        position = session.convert.position(source, offset)
        assert position == client.position(len(client.encoded(text[: mark + offset])))
        # There is no position between CR and LF; it is the end of the line.
        expected = offset - 1 if source.text[offset - 1 : offset + 1] == "\r\n" and offset else offset
        assert session.convert.offset(source, position) == expected
    ends = [at for at, character in enumerate(source.text) if character in "\r\n"]
    words = [Span(a, b) for a, b in itertools.pairwise((-1, *ends, len(source.text)))]
    spans = [Span(span.start + 1, span.end) for span in words]
    for span, (line, first, last) in zip(spans, session.convert.columns(source, spans), strict=True):
        expected_range = session.convert.range(source, span)
        assert (line, first, last) == (
            expected_range.start.line,
            expected_range.start.character,
            expected_range.end.character,
        )


def test_a_column_beyond_the_last_line() -> None:
    """A client that uses a column beyond the end means the end of the line, and not the position before the last
    character."""
    session = opened(types.PositionEncodingKind.Utf16, "<a/>")
    end = types.Position(0, 10_000)
    session.change("untitled:1", [types.TextDocumentContentChangePartial(types.Range(end, end), "<!-- -->")], 2)
    assert session.text("untitled:1") == "<a/><!-- -->"


def test_a_document_that_is_not_open_does_not_change() -> None:
    session = opened(types.PositionEncodingKind.Utf16, "<a/>")
    session.close("untitled:1")
    session.change("untitled:1", [types.TextDocumentContentChangeWholeDocument("<b/>")], 2)
    assert session.text("untitled:1") is None


@pytest.mark.parametrize("encoding", ENCODINGS)
async def test_what_is_checked_is_what_the_client_has(tmp_path: Path, encoding: types.PositionEncodingKind) -> None:
    """Over stdio: errors are reported and fixed behind all of these characters, also on the first line."""
    clock.write(tmp_path)
    path = tmp_path / "clock.ascxml"
    text = clock.CLOCK.replace('<assign location="count"', f'<!-- 🤖{NO_LINE_ENDS[:3]} --><assign location="count"')
    general = types.GeneralClientCapabilities(position_encodings=[encoding])
    async with connect(tmp_path, capabilities=types.ClientCapabilities(general=general)) as client:
        client.open(path, text)
        mirror = ClientText(encoding, text)

        def put(old: str, new: str, version: int) -> None:
            at = len(mirror.encoded(mirror.text[: mirror.text.index(old)]))
            places = types.Range(mirror.position(at), mirror.position(at + len(mirror.encoded(old))))
            mirror.edit(places, new)
            client.edit(path, types.TextDocumentContentChangePartial(places, new), version=version)

        put('<assign location="count"', '<assign location="coutn"', 2)
        (diagnostic,) = await client.until_codes(path, "undeclared-variable")
        at = len(mirror.encoded(mirror.text[: mirror.text.index("coutn")]))
        assert diagnostic.range == types.Range(mirror.position(at), mirror.position(at + 5))
        zero = types.Range(types.Position(0, 0), types.Position(0, 0))
        mirror.edit(zero, "\ufeff")
        client.edit(path, types.TextDocumentContentChangePartial(zero, "\ufeff"), version=3)
        put("<ascxml", "<ascxm", 4)  # the edit behind the mark is on its line
        put("<ascxm", "<ascxml", 5)
        put('"coutn"', '"count"', 6)
        await client.until_codes(path)
        client.replace(path, mirror.text, version=7)
        await client.until(lambda: client.published[path.as_uri()].version == 7 or not client.codes(path))
        assert client.codes(path) == []

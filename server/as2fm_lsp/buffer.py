# SPDX-License-Identifier: Apache-2.0
"""The text of an open document, exactly as the client has it, and the client's edits.

- Lines end at LF, CRLF and CR only, as in the protocol; `str.splitlines` splits at other characters as well.
- A position beyond the end of a line or of the text is replaced by that end.
- A byte order mark at the beginning is part of the text here. Analyses get the text without it, and `Converter` adds it
  to the columns of the first line again.
- In UTF-16 a client may split a character beyond U+FFFF, because it consists of two units.
"""

from __future__ import annotations

from lsprotocol import types

from roaml.regex import regex
from roaml.text import LineIndex

MARK = "\ufeff"

_SURROGATE = regex("[\ud800-\udfff]")


class Units:
    """Columns in a position encoding.

    Args:
        encoding: `utf-8`, `utf-16` or `utf-32`.
    """

    def __init__(self, encoding: str) -> None:
        self._encoding = types.PositionEncodingKind(encoding)
        self.may_cut = self._encoding is types.PositionEncodingKind.Utf16

    def count(self, text: str) -> int:
        """The number of units of `text`."""
        if self._encoding is types.PositionEncodingKind.Utf32 or text.isascii():
            return len(text)
        if self._encoding is types.PositionEncodingKind.Utf8:
            return len(text.encode("utf-8", "surrogatepass"))
        return len(text) + sum(character > "\uffff" for character in text)

    def column(self, line: str, units: int) -> tuple[int, bool]:
        """Convert a column from units to code points. Return the converted column, and whether the position splits a
        character; the column is then that of this character.

        A column beyond the end of the line is replaced by the end.
        """
        if self._encoding is types.PositionEncodingKind.Utf32 or line.isascii():
            return min(units, len(line)), False
        done = 0
        for column, character in enumerate(line):
            if done == units:
                return column, False
            done += self.count(character)
            if done > units:
                return column, True
        return len(line), False

    def place(self, text: str, lines: LineIndex, position: types.Position) -> tuple[int, bool]:
        """The offset of a position in a text, and whether the position splits a character. `lines` is the index of the
        text's lines."""
        if position.line >= lines.line_count:
            return len(text), False
        start = lines.line_start(position.line)
        line = text[start : lines.line_end(position.line)].rstrip("\r\n")
        column, is_inside = self.column(line, position.character)
        return start + column, is_inside


def edited(text: str, range_: types.Range, new_text: str, units: Units) -> str:
    """`text` with a range replaced by `new_text`."""
    lines = LineIndex(text)
    start, end = sorted((units.place(text, lines, range_.start), units.place(text, lines, range_.end)))
    before, after = text[: start[0]], text[end[0] :]
    if units.may_cut:
        if start[1]:
            before += _halves(text[start[0]])[0]
        if end[1]:
            after = _halves(text[end[0]])[1] + text[end[0] + 1 :]
        if any(map(_SURROGATE.search, (before[-1:], new_text, after[:1]))):
            return _joined(before + new_text + after)
    return before + new_text + after


def _halves(character: str) -> str:
    """The two UTF-16 surrogates of a character beyond U+FFFF."""
    code = ord(character) - 0x10000
    return chr(0xD800 + (code >> 10)) + chr(0xDC00 + (code & 0x3FF))


def _joined(text: str) -> str:
    """Join two adjacent surrogates to one character."""
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass")

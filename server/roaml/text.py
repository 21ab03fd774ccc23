# SPDX-License-Identifier: Apache-2.0
"""Source text and places in it.

There are three coordinate systems:

- an *offset* counts code points of the decoded text, from 0; a `Span` is a half-open range of offsets;
- a *position* is a zero-based line and a zero-based column in code points (`LineIndex` converts);
- UTF-8 and UTF-16 columns exist only where a protocol needs them (`as2fm_lsp.convert`).

Every span is created by the scanner that read the text and never rebuilt afterwards. A byte order mark is not part of
the text. Line ends are kept as they are; `\\n`, `\\r\\n` and a lone `\\r` each end a line.
"""

from __future__ import annotations

import bisect
import codecs
import re
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from itertools import accumulate
from typing import NamedTuple

from roaml.record import PartlyCompared, Record
from roaml.regex import regex


class Span(NamedTuple):
    """A half-open range of offsets."""

    start: int
    end: int

    def contains(self, offset: int) -> bool:
        """Whether a caret at `offset` touches the span; both ends are included."""
        return self.start <= offset <= self.end

    def encloses(self, other: Span) -> bool:
        """Whether `other` is inside the span."""
        return self.start <= other.start and other.end <= self.end

    def cover(self, other: Span) -> Span:
        """The smallest span that contains both spans."""
        return Span(min(self.start, other.start), max(self.end, other.end))


NO_SPAN = Span(0, 0)
"""The span of expressions that no text contains, such as those that a translation creates."""


def span_of(ends: tuple[int, int]) -> Span:
    """A span with these ends. It takes half the time of `Span(...)`, for callers that create a span for each word."""
    return tuple.__new__(Span, ends)


class Location(NamedTuple):
    """A span in a file. `path` is an absolute path of the operating system."""

    path: str
    span: Span


def location_of(fields: tuple[str, Span]) -> Location:
    """A location with these fields. It takes half the time of `Location(...)`, like `span_of`."""
    return tuple.__new__(Location, fields)


class Position(NamedTuple):
    """A zero-based line and a zero-based column in code points."""

    line: int
    column: int


class TextEdit(NamedTuple):
    """An edit that replaces the text in `span` by `new_text`. If the span is empty, it is an insertion."""

    span: Span
    new_text: str


Edit = TextEdit | Callable[[], TextEdit]
"""An edit, or a function that computes it when it is applied."""


def computed(edits: Iterable[Edit]) -> tuple[TextEdit, ...]:
    return tuple(edit if isinstance(edit, TextEdit) else edit() for edit in edits)


def apply_edits(text: str, edits: tuple[TextEdit, ...]) -> str:
    """`text` with `edits` applied. Edits refer to the original text; if two overlap, only the one that begins first is
    applied."""
    parts: list[str] = []
    done = 0
    for edit in sorted(edits, key=lambda e: e.span):
        if edit.span.start < done:
            continue
        parts += (text[done : edit.span.start], edit.new_text)
        done = edit.span.end
    parts.append(text[done:])
    return "".join(parts)


class Decoded(Record, frozen=True):
    """A piece of source text with its escapes resolved, and the mapping back to the source.

    `text` is the resolved text. Character `i` of it begins at source offset `sources[i]`; without escapes `sources` is
    `None` and the character begins at `base + i`.
    """

    text: str
    base: int
    sources: tuple[int, ...] | None = None

    def offset(self, index: int) -> int:
        """The source offset at which the character `index` begins; for `len(text)`, the offset of the end."""
        return self.base + index if self.sources is None else self.sources[index]

    def span(self, start: int, end: int) -> Span:
        """The source span of `text[start:end]`."""
        if self.sources is None:
            return span_of((self.base + start, self.base + end))
        return span_of((self.sources[start], self.sources[end]))

    def stripped(self) -> Decoded:
        """The text without surrounding white space."""
        text = self.text.strip()
        start = self.text.index(text)
        return self.part(start, start + len(text))

    def part(self, start: int, end: int) -> Decoded:
        """The characters from `start` to `end`."""
        sources = None if self.sources is None else self.sources[start : end + 1]
        return Decoded(self.text[start:end], self.offset(start), sources)


def joined(pieces: Sequence[Decoded]) -> Decoded:
    """The concatenation of one or more pieces."""
    if len(pieces) == 1:
        return pieces[0]
    sources = [piece.offset(index) for piece in pieces for index in range(len(piece.text))]
    end = pieces[-1].offset(len(pieces[-1].text))
    return Decoded("".join(piece.text for piece in pieces), pieces[0].base, (*sources, end))


_LINE_END = regex(r"\r\n|\n|\r")


class LineIndex:
    """The offsets of the lines of a text; converts between offsets and positions."""

    def __init__(self, text: str) -> None:
        self._starts = [0, *_ends(text)]
        self._text = text

    @property
    def line_count(self) -> int:
        return len(self._starts)

    def position(self, offset: int) -> Position:
        """The position of `offset`; an offset outside the text is replaced by the nearest end."""
        offset = max(0, min(offset, len(self._text)))
        line = bisect.bisect_right(self._starts, offset) - 1
        return Position(line, offset - self._starts[line])

    def offset(self, position: Position) -> int:
        """The offset of `position`; a line or column beyond the end is replaced by the end, before the line
        terminator."""
        if position.line < 0:
            return 0
        if position.line >= len(self._starts):
            return len(self._text)
        start = self._starts[position.line]
        line = self._text[start : self.line_end(position.line)]
        return start + min(max(0, position.column), len(line.rstrip("\r\n")))

    def line_start(self, line: int) -> int:
        return self._starts[line]

    def line_end(self, line: int) -> int:
        """The offset of the end of `line`, including its line terminator."""
        return self._starts[line + 1] if line + 1 < len(self._starts) else len(self._text)


def _ends(text: str) -> Iterable[int]:
    """The offset after the end of each line."""
    if "\r" in text:
        return (match.end() for match in _LINE_END.finditer(text))
    # This runs at each keystroke. Finding the line ends one by one would take four times as long.
    *lines, _ = text.split("\n")
    return accumulate(len(line) + 1 for line in lines)


class SourceFile(PartlyCompared, frozen=True, dict=True):
    """The text of one file at one moment. Two files with the same `digest` have the same text; caches compare the texts
    themselves.

    `undecodable` is the place of the first byte sequence that is not valid in the file's encoding, if any; invalid
    bytes appear in `text` as U+FFFD. `encoding` and the byte order `mark` are those with which the file was read.
    `ignored_encoding` is the place of the encoding in the XML declaration if the file was read with another one.
    """

    UNCOMPARED = frozenset({"encoding", "mark"})

    path: str
    text: str
    undecodable: Span | None = None
    encoding: str = "utf-8"
    mark: bytes = b""
    ignored_encoding: Span | None = None

    @cached_property
    def digest(self) -> bytes:
        import hashlib  # noqa: PLC0415 - loads OpenSSL, and only the names of results need it

        return hashlib.blake2b(self.text.encode("utf-8", "surrogatepass"), digest_size=16).digest()

    @cached_property
    def lines(self) -> LineIndex:
        return LineIndex(self.text)

    def encode(self, text: str) -> bytes:
        """The bytes of the file if its text is replaced by `text`: in its encoding, with its byte order mark."""
        return self.mark + text.encode(self.encoding)


_BOMS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16, whose mark it begins with
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_DECLARED = regex(r"""^\s*<\?xml[^>]{0,200}?encoding\s*=\s*["']([A-Za-z][\w.-]*)["']""", re.ASCII)
_MAX_DECLARATION_BYTES = 400


def decode(path: str, data: bytes) -> SourceFile:
    """Decode bytes: a byte order mark takes precedence, then an XML declaration, then UTF-8. Never fails.

    Only text encodings that Python supports are used; invalid bytes become U+FFFD.
    """
    encoding, mark = "utf-8", b""
    for mark_bytes, name in _BOMS:
        if data.startswith(mark_bytes):
            data, encoding, mark = data[len(mark_bytes) :], name, mark_bytes
            break
    else:
        if declared := _DECLARED.match(data[:_MAX_DECLARATION_BYTES].decode("latin-1")):
            encoding = _known_encoding(declared[1])
    undecodable = None
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        text = data.decode(encoding, "replace")
        start = min(len(data[: error.start].decode(encoding, "replace")), len(text))
        undecodable = Span(start, min(start + 1, len(text)))
    return SourceFile(path, text, undecodable, encoding, mark, ignored_encoding(text, encoding))


def ignored_encoding(text: str, encoding: str) -> Span | None:
    """The place where a text declares an encoding other than the one with which it was read; `None` if it does not.

    Names that Python does not know are reported by the XML parser.
    """
    declared = _DECLARED.match(text[:_MAX_DECLARATION_BYTES])
    if declared is None:
        return None
    try:
        name = codecs.lookup(declared[1]).name
    except LookupError:
        return None
    if name in (encoding, *_FAMILIES.get(encoding, ())) or (name == "ascii" and text.isascii()):
        return None
    return Span(*declared.span(1))


_FAMILIES = {
    "utf-8": ("utf-8-sig",),
    "utf-16-le": ("utf-16",),
    "utf-16-be": ("utf-16",),
    "utf-32-le": ("utf-32",),
    "utf-32-be": ("utf-32",),
}
"""The encoding of each byte order mark, with the other names that a declaration may use for it."""


_PLAIN = b"<?xml +AD0- ~ \\u0041 !"
"""Text that UTF-7, HZ and the escape codecs read differently, although they keep most of ASCII."""


def _known_encoding(name: str) -> str:
    """`name` if it is a text encoding that is compatible with ASCII and can skip invalid bytes, otherwise UTF-8."""
    try:
        info = codecs.lookup(name)
        if info._is_text_encoding and _PLAIN.decode(info.name) == _PLAIN.decode():
            b"\xff".decode(info.name, "replace")
            return info.name
    except (LookupError, UnicodeError):
        pass
    return "utf-8"

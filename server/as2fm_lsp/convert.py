# SPDX-License-Identifier: Apache-2.0
"""Between the library's plain data and the protocol's types. The only place that knows columns in UTF-8 and UTF-16.

- A document without a file (`untitled:…`) has its URI as its path.
- Documents are named back to the client by the very URI that it used.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from lsprotocol import types
from pygls import uris

import roaml.rules
from roaml.diagnostics import Diagnostic, Severity, Tag
from roaml.text import Location, Position, SourceFile, Span, TextEdit

SOURCE = "as2fm"

_UTF8, _UTF16, _UTF32 = (
    types.PositionEncodingKind.Utf8,
    types.PositionEncodingKind.Utf16,
    types.PositionEncodingKind.Utf32,
)

_SEVERITIES: Mapping[Severity, types.DiagnosticSeverity] = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.INFORMATION: types.DiagnosticSeverity.Information,
    Severity.HINT: types.DiagnosticSeverity.Hint,
}
_TAGS: Mapping[Tag, types.DiagnosticTag] = {
    Tag.UNNECESSARY: types.DiagnosticTag.Unnecessary,
    Tag.DEPRECATED: types.DiagnosticTag.Deprecated,
}


class Converter:
    """Converts in the position encoding that was agreed on with the client."""

    def __init__(self, encoding: str = _UTF16) -> None:
        self._encoding = encoding
        self._uris: dict[str, str] = {}

    # ----------------------------------------------------------------- paths

    def path(self, uri: str) -> str:
        """The path of a document. The URI is remembered as the name of that path."""
        path = uris.to_fs_path(uri) if uri.startswith("file:") else uri
        path = os.path.normpath(path) if path and uri.startswith("file:") else uri
        self._uris[path] = uri
        return path

    def uri(self, path: str) -> str:
        known = self._uris.get(path)
        return known if known is not None else (uris.from_fs_path(path) or path)

    # ------------------------------------------------------------- positions

    def position(self, source: SourceFile, offset: int) -> types.Position:
        found = source.lines.position(offset)
        start = source.lines.line_start(found.line)
        return types.Position(found.line, self._units(source.text[start : start + found.column]))

    def range(self, source: SourceFile, span: Span) -> types.Range:
        return types.Range(self.position(source, span.start), self.position(source, span.end))

    def columns(self, source: SourceFile, spans: Iterable[Span]) -> Iterator[tuple[int, int, int]]:
        """The line and the first and last column of each span; none goes over the end of a line. Quicker than `range`,
        for whole files."""
        text, lines = source.text, source.lines
        units = len if text.isascii() else self._units
        line = begin = following = 0
        for start, end in spans:
            if not begin <= start < following:
                line, column = lines.position(start)
                begin, following = start - column, lines.line_end(line)
            first = units(text[begin:start])
            yield line, first, first + units(text[start:end])

    def offset(self, source: SourceFile, position: types.Position) -> int:
        """The offset of a position; positions behind the end of a line or of the text are moved back to it."""
        lines = source.lines
        if position.line >= lines.line_count:
            return len(source.text)
        start, end = lines.line_start(position.line), lines.line_end(position.line)
        line = source.text[start:end].rstrip("\r\n")
        return lines.offset(Position(position.line, self._column(line, position.character)))

    def span(self, source: SourceFile, range_: types.Range) -> Span:
        start, end = self.offset(source, range_.start), self.offset(source, range_.end)
        return Span(min(start, end), max(start, end))

    def _units(self, text: str) -> int:
        """How many units of the encoding `text` has."""
        if self._encoding == _UTF32 or text.isascii():
            return len(text)
        if self._encoding == _UTF8:
            return len(text.encode("utf-8", "surrogatepass"))
        return len(text) + sum(character > "\uffff" for character in text)

    def _column(self, line: str, units: int) -> int:
        """The column in code points at `units` units of the encoding; inside a character, its beginning."""
        if self._encoding == _UTF32 or line.isascii():
            return min(units, len(line))
        done = 0
        for column, character in enumerate(line):
            done += self._units(character)
            if done > units:
                return column
        return len(line)

    # ----------------------------------------------------------- diagnostics

    def diagnostic(
        self, diagnostic: Diagnostic, source: SourceFile, sources: Mapping[str, SourceFile]
    ) -> types.Diagnostic:
        """`sources` are the texts of the files in which related places lie."""
        related = [
            types.DiagnosticRelatedInformation(
                types.Location(self.uri(r.location.path), self.range(sources[r.location.path], r.location.span)),
                r.message,
            )
            for r in diagnostic.related
            if r.location.path in sources
        ]
        return types.Diagnostic(
            range=self.range(source, diagnostic.span),
            message=diagnostic.message,
            severity=_SEVERITIES[diagnostic.severity],
            code=diagnostic.code,
            code_description=types.CodeDescription(rule_uri(diagnostic.code)),
            source=SOURCE,
            tags=[_TAGS[tag] for tag in diagnostic.tags] or None,
            related_information=related or None,
        )

    def location(self, source: SourceFile, location: Location) -> types.Location:
        return types.Location(self.uri(location.path), self.range(source, location.span))

    def edit(self, source: SourceFile, edit: TextEdit) -> types.TextEdit:
        return types.TextEdit(self.range(source, edit.span), edit.new_text)


def rule_uri(code: str) -> str:
    """The document of a rule, as it is installed beside the server: it needs no network and fits the version."""
    folder = Path(roaml.rules.__file__).parent
    return (folder / f"{code.replace('-', '_')}.md").as_uri()

# SPDX-License-Identifier: Apache-2.0
"""Conversion between the library's plain data and the protocol's types.

Columns in UTF-8 and UTF-16 exist only here and in `buffer`.

- The path of a document without a file (`untitled:…`) is its URI.
- Documents are identified to the client by exactly the URI that it used.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Iterable, Iterator, Mapping

from lsprotocol import types
from pygls import uris

from as2fm_lsp.buffer import MARK, Units
from roaml.diagnostics import Diagnostic, Severity, Tag
from roaml.disk import is_valid_path
from roaml.facts import facts_to_json
from roaml.rules import document_file
from roaml.text import Location, SourceFile, Span, TextEdit

SOURCE = "as2fm"

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
    """Converts in the position encoding that was negotiated with the client: `utf-8`, `utf-16` or `utf-32`."""

    def __init__(self, encoding: str = types.PositionEncodingKind.Utf16) -> None:
        self.units = Units(encoding)
        self._uris: dict[str, str] = {}
        self._marked: set[str] = set()

    # ----------------------------------------------------------------- paths

    def path(self, uri: str) -> str:
        """The path of a document; its URI if that is not the URI of a file. `uri` then returns this URI for the
        path."""
        path = _file(uri) or uri
        self._uris[path] = uri
        return path

    def uri(self, path: str) -> str:
        known = self._uris.get(path)
        return known if known is not None else (uris.from_fs_path(path) or path)

    # ------------------------------------------------------------- positions

    def mark(self, path: str, is_marked: bool) -> None:
        """Store whether the client has a byte order mark before the text of a document. The mark is included in the
        columns of the first line, but it is not part of the text."""
        (self._marked.add if is_marked else self._marked.discard)(path)

    def position(self, source: SourceFile, offset: int) -> types.Position:
        place = source.lines.position(offset)
        start = source.lines.line_start(place.line)
        column = self.units.count(source.text[start : start + place.column])
        return types.Position(place.line, column + self._hidden(source, place.line))

    def range(self, source: SourceFile, span: Span) -> types.Range:
        return types.Range(self.position(source, span.start), self.position(source, span.end))

    def columns(self, source: SourceFile, spans: Iterable[Span]) -> Iterator[tuple[int, int, int]]:
        """The line, the first column and the column after the end of each span. No span may extend over the end of a
        line. Faster than `range`, for whole files."""
        text, lines = source.text, source.lines
        units = len if text.isascii() else self.units.count
        line = begin = following = hidden = 0
        for start, end in spans:
            if not begin <= start < following:
                line, column = lines.position(start)
                begin, following = start - column, lines.line_end(line)
                hidden = self._hidden(source, line)
            first = hidden + units(text[begin:start])
            yield line, first, first + units(text[start:end])

    def offset(self, source: SourceFile, position: types.Position) -> int:
        """The offset of a position; positions beyond the end of a line or of the text are replaced by that end."""
        column = max(0, position.character - self._hidden(source, position.line))
        return self.units.place(source.text, source.lines, types.Position(position.line, column))[0]

    def span(self, source: SourceFile, range_: types.Range) -> Span:
        start, end = self.offset(source, range_.start), self.offset(source, range_.end)
        return Span(min(start, end), max(start, end))

    def _hidden(self, source: SourceFile, line: int) -> int:
        """The number of units by which the client's columns of a line are greater: those of the byte order mark."""
        return self.units.count(MARK) if line == 0 and source.path in self._marked else 0

    # ----------------------------------------------------------- diagnostics

    def diagnostic(self, diagnostic: Diagnostic, source: SourceFile) -> types.Diagnostic:
        """A diagnostic of a file with the text `source`, in the protocol's types."""
        related = [
            types.DiagnosticRelatedInformation(self.location(r.source, r.location), r.message)
            for r in diagnostic.related
            if r.source is not None
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
            data=facts_to_json(diagnostic.facts) if diagnostic.facts else None,
        )

    def location(self, source: SourceFile, location: Location) -> types.Location:
        return types.Location(self.uri(location.path), self.range(source, location.span))

    def edit(self, source: SourceFile, edit: TextEdit) -> types.TextEdit:
        return types.TextEdit(self.range(source, edit.span), edit.new_text)


def _file(uri: str) -> str:
    """The absolute path of the file of a URI; "" if it is not the URI of a file."""
    if not uri.startswith("file:"):
        return ""
    try:
        path = os.path.normpath(uris.to_fs_path(uri) or "")
    except ValueError:  # not a valid URI
        return ""
    return path if os.path.isabs(path) and is_valid_path(path) else ""


@functools.cache  # a file may have a thousand findings, and each look-up asks the disk several times
def rule_uri(code: str) -> str:
    """The URI of a rule's document. The document is installed with the server, so it needs no network and has the right
    version."""
    return document_file(code).as_uri()

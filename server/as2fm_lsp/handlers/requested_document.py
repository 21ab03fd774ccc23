# SPDX-License-Identifier: Apache-2.0
"""The document of a request, as the library represents it."""

from __future__ import annotations

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.convert import Converter
from roaml.project.analysis import Analysis
from roaml.project.workspace import Snapshot
from roaml.record import Record
from roaml.text import SourceFile, Span


class RequestedDocument(Record, frozen=True):
    """A file, with the state of the workspace at the time of the request."""

    path: str
    snapshot: Snapshot
    source: SourceFile
    convert: Converter

    @property
    def analysis(self) -> Analysis:
        return self.snapshot.analysis

    def offset(self, position: types.Position) -> int:
        return self.convert.offset(self.source, position)

    def span(self, range_: types.Range) -> Span:
        return self.convert.span(self.source, range_)

    def range(self, span: Span) -> types.Range:
        return self.convert.range(self.source, span)


def requested_document(context: Context, document: types.TextDocumentIdentifier) -> RequestedDocument | None:
    """The document; `None` if there is no such file."""
    session = context.session
    path = session.convert.path(document.uri)
    snapshot = session.moment().snapshot(path)
    source = snapshot.analysis.source(path)
    return None if source is None else RequestedDocument(path, snapshot, source, session.convert)

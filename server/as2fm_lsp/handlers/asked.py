# SPDX-License-Identifier: Apache-2.0
"""The document that a request is about, as the library sees it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lsprotocol import types

from as2fm_lsp.convert import Converter
from roaml.project.analysis import Analysis
from roaml.project.workspace import Snapshot
from roaml.text import SourceFile, Span

if TYPE_CHECKING:
    from as2fm_lsp.server import Server


@dataclass(frozen=True)
class Asked:
    """A file, with all that is known at the moment of the request."""

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


def asked(server: Server, document: types.TextDocumentIdentifier) -> Asked | None:
    """None if there is no such file."""
    session = server.session
    path = session.convert.path(document.uri)
    snapshot = session.moment().snapshot(path)
    source = snapshot.analysis.source(path)
    return None if source is None else Asked(path, snapshot, source, session.convert)

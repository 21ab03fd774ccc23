# SPDX-License-Identifier: Apache-2.0
"""`textDocument/hover`"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

from as2fm_lsp.markup import content
from roaml.ide.hover import hover as hover_at

if TYPE_CHECKING:
    from as2fm_lsp.server import Server


def register(server: Server) -> None:
    session = server.session

    @server.feature(types.TEXT_DOCUMENT_HOVER)
    def hover(params: types.HoverParams) -> types.Hover | None:
        path = session.convert.path(params.text_document.uri)
        analysis = session.moment().snapshot(path).analysis
        source = analysis.source(path)
        found = hover_at(analysis, path, session.convert.offset(source, params.position)) if source else None
        if source is None or found is None:
            return None
        text_document = server.client_capabilities.text_document
        formats = text_document.hover.content_format if text_document and text_document.hover else None
        return types.Hover(content(found.text, formats), session.convert.range(source, found.span))

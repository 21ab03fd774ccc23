# SPDX-License-Identifier: Apache-2.0
"""`textDocument/hover`"""

from __future__ import annotations

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import requested_document
from as2fm_lsp.markup import content
from roaml.ide.hover import hover as hover_at


def register(context: Context) -> None:
    @context.feature(types.TEXT_DOCUMENT_HOVER)
    def hover(params: types.HoverParams) -> types.Hover | None:
        on = requested_document(context, params.text_document)
        description = hover_at(on.analysis, on.path, on.offset(params.position)) if on else None
        if on is None or description is None:
            return None
        text_document = context.client.capabilities.text_document
        formats = text_document.hover.content_format if text_document and text_document.hover else None
        return types.Hover(content(description.text, formats), on.range(description.span))

# SPDX-License-Identifier: Apache-2.0
"""`textDocument/formatting` and `rangeFormatting`."""

from __future__ import annotations

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import requested_document
from roaml.ide.formatting import format_edits
from roaml.ide.formatting.layout import FileLayout

_MAX_INDENT_WIDTH = 16


def register(context: Context) -> None:
    @context.feature(types.TEXT_DOCUMENT_FORMATTING)
    def formatting(params: types.DocumentFormattingParams) -> list[types.TextEdit]:
        return _edits(context, params.text_document, params.options, None)

    @context.feature(types.TEXT_DOCUMENT_RANGE_FORMATTING)
    def range_formatting(params: types.DocumentRangeFormattingParams) -> list[types.TextEdit]:
        return _edits(context, params.text_document, params.options, params.range)


def layout_of(options: types.FormattingOptions) -> FileLayout:
    """The layout that a client requests; invalid values are replaced by the nearest valid ones."""
    return FileLayout(width=min(max(options.tab_size, 1), _MAX_INDENT_WIDTH), tabs=not options.insert_spaces)


def _edits(
    context: Context,
    document: types.TextDocumentIdentifier,
    options: types.FormattingOptions,
    range_: types.Range | None,
) -> list[types.TextEdit]:
    file = requested_document(context, document)
    if file is None:
        return []
    within = None if range_ is None else file.span(range_)
    edits = format_edits(file.analysis, file.path, layout_of(options), within)
    return [file.convert.edit(file.source, edit) for edit in edits]

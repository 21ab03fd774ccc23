# SPDX-License-Identifier: Apache-2.0
"""`textDocument/linkedEditingRange`: an edit of a tag also changes the other tag of the element;
`textDocument/onTypeFormatting`: writes the end tag while the user types."""

from __future__ import annotations

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import requested_document
from roaml.ide.linked_editing import NAME_PATTERN, linked_names
from roaml.ide.on_type import TRIGGERS, close_tag


def register(context: Context) -> None:
    @context.feature(types.TEXT_DOCUMENT_LINKED_EDITING_RANGE)
    def linked_editing_range(params: types.LinkedEditingRangeParams) -> types.LinkedEditingRanges | None:
        file = requested_document(context, params.text_document)
        if file is None:
            return None
        names = linked_names(file.analysis, file.path, file.offset(params.position))
        return types.LinkedEditingRanges([file.range(name) for name in names], NAME_PATTERN) if names else None

    first, *more = TRIGGERS

    @context.feature(
        types.TEXT_DOCUMENT_ON_TYPE_FORMATTING,
        types.DocumentOnTypeFormattingOptions(first, more_trigger_character=more),
    )
    def on_type_formatting(params: types.DocumentOnTypeFormattingParams) -> list[types.TextEdit]:
        file = requested_document(context, params.text_document)
        edit = close_tag(file.analysis, file.path, file.offset(params.position)) if file else None
        return [file.convert.edit(file.source, edit)] if file and edit else []

# SPDX-License-Identifier: Apache-2.0
"""`textDocument/prepareRename` and `textDocument/rename`."""

from __future__ import annotations

from lsprotocol import types
from pygls.exceptions import JsonRpcException

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import requested_document
from roaml.ide.rename import RenameRefusal, prepare, rename

_REQUEST_FAILED = types.LSPErrorCodes.RequestFailed.value


def register(context: Context) -> None:
    @context.feature(types.TEXT_DOCUMENT_PREPARE_RENAME)
    def prepare_rename(params: types.PrepareRenameParams) -> types.PrepareRenamePlaceholder | None:
        on = requested_document(context, params.text_document)
        if on is None:
            return None
        prepared = prepare(on.analysis, on.path, on.offset(params.position))
        if isinstance(prepared, RenameRefusal):
            raise _refused(prepared)
        return types.PrepareRenamePlaceholder(on.range(prepared.span), prepared.name)

    @context.feature(types.TEXT_DOCUMENT_RENAME, types.RenameOptions(prepare_provider=True))
    def rename_(params: types.RenameParams) -> types.WorkspaceEdit | None:
        on = requested_document(context, params.text_document)
        if on is None:
            return None
        renaming = rename(on.analysis, on.path, on.offset(params.position), params.new_name)
        if isinstance(renaming, RenameRefusal):
            raise _refused(renaming)
        changes = {}
        for path, edits in renaming.edits.items():
            target = on.analysis.source(path)
            if target is not None:
                changes[on.convert.uri(path)] = [on.convert.edit(target, edit) for edit in edits]
        return types.WorkspaceEdit(changes=changes)


def _refused(refusal: RenameRefusal) -> JsonRpcException:
    """The error for a renaming that is not possible. Its message is the reason as a sentence, because clients show
    it."""
    reason = refusal.reason
    return JsonRpcException(f"{reason[0].upper()}{reason[1:]}.", _REQUEST_FAILED)

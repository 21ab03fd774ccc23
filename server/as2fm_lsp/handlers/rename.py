# SPDX-License-Identifier: Apache-2.0
"""`textDocument/prepareRename` and `textDocument/rename`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types
from pygls.exceptions import JsonRpcException

from roaml.ide.rename import Refusal, prepare, rename

if TYPE_CHECKING:
    from as2fm_lsp.server import Server

_REQUEST_FAILED = types.LSPErrorCodes.RequestFailed.value


def register(server: Server) -> None:
    session = server.session

    @server.feature(types.TEXT_DOCUMENT_PREPARE_RENAME)
    def prepare_rename(params: types.PrepareRenameParams) -> types.PrepareRenamePlaceholder | None:
        path = session.convert.path(params.text_document.uri)
        analysis = session.moment().snapshot(path).analysis
        source = analysis.source(path)
        if source is None:
            return None
        found = prepare(analysis, path, session.convert.offset(source, params.position))
        if isinstance(found, Refusal):
            raise _refused(found)
        return types.PrepareRenamePlaceholder(session.convert.range(source, found.span), found.name)

    @server.feature(types.TEXT_DOCUMENT_RENAME, types.RenameOptions(prepare_provider=True))
    def rename_(params: types.RenameParams) -> types.WorkspaceEdit | None:
        path = session.convert.path(params.text_document.uri)
        moment = session.moment()
        analysis = moment.snapshot(path).analysis
        source = analysis.source(path)
        if source is None:
            return None
        found = rename(analysis, path, session.convert.offset(source, params.position), params.new_name)
        if isinstance(found, Refusal):
            raise _refused(found)
        changes = {}
        for each, edits in found.edits.items():
            target = analysis.source(each)
            if target is not None:
                changes[session.convert.uri(each)] = [session.convert.edit(target, edit) for edit in edits]
        return types.WorkspaceEdit(changes=changes)


def _refused(refusal: Refusal) -> JsonRpcException:
    """The reason as a sentence, which the client shows."""
    reason = refusal.reason
    return JsonRpcException(f"{reason[0].upper()}{reason[1:]}.", _REQUEST_FAILED)

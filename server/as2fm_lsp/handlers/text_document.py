# SPDX-License-Identifier: Apache-2.0
"""`textDocument/didOpen`, `didChange`, `didSave` and `didClose`"""

from __future__ import annotations

import os

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.workspace import show_problems
from roaml.model.config_files import CONFIG_FILES


def register(context: Context) -> None:
    session, diagnostics = context.session, context.diagnostics

    @context.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def did_open(params: types.DidOpenTextDocumentParams) -> None:
        document = params.text_document
        path = session.convert.path(document.uri)
        session.open(path, document.text, document.version)
        show_problems(context)
        diagnostics.schedule(path)

    @context.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def did_change(params: types.DidChangeTextDocumentParams) -> None:
        path = session.convert.path(params.text_document.uri)
        session.change(path, params.content_changes, params.text_document.version)
        diagnostics.schedule(path)

    @context.feature(types.TEXT_DOCUMENT_DID_SAVE)
    def did_save(params: types.DidSaveTextDocumentParams) -> None:
        path = session.convert.path(params.text_document.uri)
        session.invalidate()
        if os.path.basename(path) in CONFIG_FILES:
            session.configure()
            show_problems(context)
        diagnostics.schedule(path)

    @context.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def did_close(params: types.DidCloseTextDocumentParams) -> None:
        path = session.convert.path(params.text_document.uri)
        session.close(path)
        diagnostics.schedule(path)

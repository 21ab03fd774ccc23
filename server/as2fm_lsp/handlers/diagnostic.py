# SPDX-License-Identifier: Apache-2.0
"""`textDocument/diagnostic` and `workspace/diagnostic`: for clients that request diagnostics themselves."""

from __future__ import annotations

from lsprotocol import types

from as2fm_lsp.client import SECTION
from as2fm_lsp.context import Context


def register(context: Context) -> None:
    session, diagnostics = context.session, context.diagnostics
    options = types.DiagnosticOptions(inter_file_dependencies=True, workspace_diagnostics=True, identifier=SECTION)

    @context.feature(types.TEXT_DOCUMENT_DIAGNOSTIC, options)
    def document_diagnostic(params: types.DocumentDiagnosticParams) -> types.DocumentDiagnosticReport:
        path = session.convert.path(params.text_document.uri)
        return diagnostics.document_report(path, params.previous_result_id)

    @context.feature(types.WORKSPACE_DIAGNOSTIC)
    async def workspace_diagnostic(params: types.WorkspaceDiagnosticParams) -> types.WorkspaceDiagnosticReport:
        return await diagnostics.workspace_report(params.previous_result_ids)

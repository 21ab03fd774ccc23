# SPDX-License-Identifier: Apache-2.0
"""`textDocument/codeAction`: the fixes that rules offer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lsprotocol import types

if TYPE_CHECKING:
    from as2fm_lsp.server import Server


def register(server: Server) -> None:
    options = types.CodeActionOptions([types.CodeActionKind.QuickFix])

    @server.feature(types.TEXT_DOCUMENT_CODE_ACTION, options)
    def code_action(params: types.CodeActionParams) -> list[types.CodeAction]:
        session = server.session
        path = session.convert.path(params.text_document.uri)
        moment = session.moment()
        snapshot = moment.snapshot(path)
        source = snapshot.analysis.source(path)
        only = params.context.only
        if source is None or (only and not any(_contains(kind, types.CodeActionKind.QuickFix) for kind in only)):
            return []
        wanted = session.convert.span(source, params.range)
        actions = []
        found = snapshot.checker.diagnostics(path)
        for diagnostic, shown in zip(found, server.diagnostics.of(moment, path), strict=True):
            if diagnostic.span.start <= wanted.end and wanted.start <= diagnostic.span.end:
                for fix in diagnostic.fixes:
                    edits = [session.convert.edit(source, edit) for edit in fix.edits]
                    actions.append(
                        types.CodeAction(
                            fix.title,
                            kind=types.CodeActionKind.QuickFix,
                            diagnostics=[shown],
                            is_preferred=fix.preferred or None,
                            edit=types.WorkspaceEdit(changes={session.convert.uri(path): edits}),
                        )
                    )
        return actions


def _contains(wanted: str, kind: str) -> bool:
    """Whether actions of `kind` are among those of the kind that is wanted, as `quickfix` is in `` and in itself."""
    return wanted in ("", kind) or kind.startswith(f"{wanted}.")

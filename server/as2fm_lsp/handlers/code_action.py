# SPDX-License-Identifier: Apache-2.0
"""`textDocument/codeAction`: the fixes that rules offer, and what can be done with a whole system."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from lsprotocol import types

from as2fm_lsp.handlers import translate
from roaml.text import Span

if TYPE_CHECKING:
    from as2fm_lsp.server import Server
    from as2fm_lsp.session import Moment


def register(server: Server) -> None:
    options = types.CodeActionOptions([types.CodeActionKind.QuickFix, types.CodeActionKind.Source])

    @server.feature(types.TEXT_DOCUMENT_CODE_ACTION, options)
    def code_action(params: types.CodeActionParams) -> list[types.CodeAction]:
        session = server.session
        path = session.convert.path(params.text_document.uri)
        moment = session.moment()
        snapshot = moment.snapshot(path)
        source = snapshot.analysis.source(path)
        if source is None:
            return []
        found: list[types.CodeAction] = []
        only = params.context.only
        if _is_wanted(types.CodeActionKind.QuickFix, only):
            found += _fixes(server, moment, path, session.convert.span(source, params.range))
        if _is_wanted(types.CodeActionKind.Source, only):
            found += translate.actions(snapshot, path, session.convert)
        return found


def _fixes(server: Server, moment: Moment, path: str, place: Span) -> Iterator[types.CodeAction]:
    """The fixes of what is found at a place."""
    snapshot, convert = moment.snapshot(path), server.session.convert
    source = snapshot.analysis.source(path)
    assert source is not None
    found = snapshot.checker.diagnostics(path)
    for diagnostic, shown in zip(found, server.diagnostics.of(moment, path), strict=True):
        if diagnostic.span.start <= place.end and place.start <= diagnostic.span.end:
            for fix in diagnostic.fixes:
                edits = [convert.edit(source, edit) for edit in fix.edits]
                yield types.CodeAction(
                    fix.title,
                    kind=types.CodeActionKind.QuickFix,
                    diagnostics=[shown],
                    is_preferred=fix.preferred or None,
                    edit=types.WorkspaceEdit(changes={convert.uri(path): edits}),
                )


def _is_wanted(kind: str, only: Sequence[str] | None) -> bool:
    """Whether actions of `kind` are asked for: `quickfix` is part of `` and of itself."""
    return not only or any(wanted in ("", kind) or kind.startswith(f"{wanted}.") for wanted in only)

# SPDX-License-Identifier: Apache-2.0
"""Changes of files in the protocol's types."""

from __future__ import annotations

from lsprotocol import types

from as2fm_lsp.context import Context
from roaml.ide.code_actions.action import WorkspaceEdit
from roaml.project.workspace import Snapshot


def workspace_edit(context: Context, snapshot: Snapshot, change: WorkspaceEdit) -> types.WorkspaceEdit:
    """A `WorkspaceEdit` of the protocol. Creations of files precede edits, and renames follow them."""
    convert, analysis = context.session.convert, snapshot.analysis
    edits = {
        path: [convert.edit(source, edit) for edit in sorted(change.edits[path])]
        for path in change.edits
        if (source := analysis.source(path)) is not None
    }
    if not change.created and not change.renamed:
        return types.WorkspaceEdit(changes={convert.uri(path): text_edits for path, text_edits in edits.items()})
    start = types.Range(types.Position(0, 0), types.Position(0, 0))
    steps: list[types.TextDocumentEdit | types.CreateFile | types.RenameFile | types.DeleteFile] = []
    for path, text in change.created.items():
        steps.append(types.CreateFile(convert.uri(path), options=types.CreateFileOptions(ignore_if_exists=True)))
        steps.append(_document_edit(convert.uri(path), None, [types.TextEdit(start, text)]))
    versions = context.session.moment().versions
    steps += [_document_edit(convert.uri(path), versions.get(path), text_edits) for path, text_edits in edits.items()]
    steps += [types.RenameFile(convert.uri(path), convert.uri(new)) for path, new in change.renamed.items()]
    return types.WorkspaceEdit(document_changes=steps)


def _document_edit(uri: str, version: int | None, edits: list[types.TextEdit]) -> types.TextDocumentEdit:
    return types.TextDocumentEdit(types.OptionalVersionedTextDocumentIdentifier(uri, version), list(edits))

# SPDX-License-Identifier: Apache-2.0
"""`as2fm/migrate`: moves a system to the current dialect, as an edit that the user confirms.

What stands on the disk is migrated: the client saves first.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, TypedDict

from lsprotocol import types

from roaml import api
from roaml.project.migrate import Migration
from roaml.text import SourceFile, Span

if TYPE_CHECKING:
    from as2fm_lsp.server import Server

METHOD = "as2fm/migrate"
_ANNOTATION = "migrate"


class Migrated(TypedDict):
    """`files` counts those that change. `problem` tells why nothing can be done; else it is empty."""

    edit: types.WorkspaceEdit | None
    files: int
    problem: str


def register(server: Server) -> None:
    session = server.session

    @server.feature(METHOD)
    def migrate(params: Any) -> Migrated:
        path = session.convert.path(params.textDocument.uri)
        try:
            migrations = api.migrate([path], settings=session.settings_of(path))
        except api.PathError as error:
            return {"edit": None, "files": 0, "problem": str(error)}
        taken = [each.new_path for each in migrations if each.new_path != each.path and os.path.exists(each.new_path)]
        if taken:
            return {"edit": None, "files": 0, "problem": f"{taken[0]}: there is such a file already"}
        changes = [change for migration in migrations for change in edits(migration)]
        note = types.ChangeAnnotation("Migrate to the current dialect", needs_confirmation=True)
        edit = types.WorkspaceEdit(document_changes=changes, change_annotations={_ANNOTATION: note})
        return {"edit": edit if migrations else None, "files": len(migrations), "problem": ""}

    def edits(migration: Migration) -> list[types.TextDocumentEdit | types.RenameFile]:
        uri = session.convert.uri(migration.path)
        source = SourceFile(migration.path, migration.before)
        whole = session.convert.range(source, Span(0, len(source.text)))
        found: list[types.TextDocumentEdit | types.RenameFile] = []
        if migration.after != migration.before:
            edit = types.AnnotatedTextEdit(_ANNOTATION, whole, migration.after)
            found.append(types.TextDocumentEdit(types.OptionalVersionedTextDocumentIdentifier(uri), [edit]))
        if migration.new_path != migration.path:
            new = session.convert.uri(migration.new_path)
            found.append(types.RenameFile(uri, new, annotation_id=_ANNOTATION))
        return found

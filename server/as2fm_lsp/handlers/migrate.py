# SPDX-License-Identifier: Apache-2.0
"""`as2fm/migrate`: migrates a system to the current dialect, as an edit and a list of its changes.

The files on the disk are migrated: the client saves first.
"""

from __future__ import annotations

import os
from typing import Any, TypedDict

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri
from roaml import api
from roaml.project.migrate import Migration
from roaml.project.paths import seen_from
from roaml.text import SourceFile, Span

METHOD = "as2fm/migrate"


class Migrated(TypedDict):
    """`files` are the paths of the changed and renamed files, relative to the system; a renamed file is written
    `old → new`. `problem` is the reason why the migration is not possible; empty if it is possible."""

    edit: types.WorkspaceEdit | None
    files: list[str]
    problem: str


def shown(migration: Migration, system: str) -> str:
    """The path of a file relative to its system, with its new name."""
    names = (seen_from(path, system) for path in (migration.path, migration.new_path))
    return " → ".join(dict.fromkeys(names))


def register(context: Context) -> None:
    session = context.session

    @context.feature(METHOD)
    def migrate(params: Any) -> Migrated:
        context.trust.require(METHOD)
        path = session.convert.path(document_uri(params))
        try:
            migrations = api.migrate([path], settings=session.settings_of(path), with_related=True)
        except api.PathError as error:
            return {"edit": None, "files": [], "problem": str(error)}
        taken = [m.new_path for m in migrations if m.new_path != m.path and os.path.exists(m.new_path)]
        if taken:
            return {"edit": None, "files": [], "problem": f"{taken[0]} already exists"}
        changes = [change for migration in migrations for change in edits(migration)]
        edit = types.WorkspaceEdit(document_changes=changes)
        return {
            "edit": edit if migrations else None,
            "files": [shown(migration, path) for migration in migrations],
            "problem": "",
        }

    def edits(migration: Migration) -> list[types.TextDocumentEdit | types.RenameFile]:
        uri = session.convert.uri(migration.path)
        source = SourceFile(migration.path, migration.before)
        full_range = session.convert.range(source, Span(0, len(source.text)))
        steps: list[types.TextDocumentEdit | types.RenameFile] = []
        if migration.after != migration.before:
            edit = types.TextEdit(full_range, migration.after)
            steps.append(types.TextDocumentEdit(types.OptionalVersionedTextDocumentIdentifier(uri), [edit]))
        if migration.new_path != migration.path:
            new = session.convert.uri(migration.new_path)
            steps.append(types.RenameFile(uri, new))
        return steps

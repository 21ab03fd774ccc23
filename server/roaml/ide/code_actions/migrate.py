# SPDX-License-Identifier: Apache-2.0
"""A code action that migrates the systems of a file to the current dialect."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.ide.code_actions.action import REWRITE, CodeAction, WorkspaceEdit, text_edits
from roaml.project.migrate import CODES, migrate
from roaml.project.workspace import Snapshot
from roaml.text import Span

TITLE = "Convert the system to the current dialect"


def actions(snapshot: Snapshot, path: str, place: Span) -> Iterator[CodeAction]:
    """The action, which is offered at spellings of the older dialect in files of systems in that dialect."""
    analysis = snapshot.analysis
    systems = analysis.memberships.get(path, ())
    if not any((system := analysis.system(owner)) is not None and system.older for owner in systems):
        return
    older_spellings = (d for d in snapshot.checker.diagnostics(path) if d.code in CODES)
    if any(d.span.start <= place.end and place.start <= d.span.end for d in older_spellings):
        yield CodeAction(TITLE, REWRITE, lambda: _convert(snapshot, path), resources=("rename",))


def _convert(snapshot: Snapshot, path: str) -> WorkspaceEdit:
    """The edits that migrate the systems of `path` and all systems that share files with them, because a file cannot
    be in two dialects."""
    analysis = snapshot.analysis
    systems = list(analysis.memberships.get(path, ()))
    for system in systems:
        for file in analysis.files_of(system):
            systems += [owner for owner in analysis.memberships.get(file, ()) if owner not in systems]
    migrated = migrate(systems, (), snapshot.with_texts)
    return WorkspaceEdit(
        {file.path: edits for file in migrated if (edits := text_edits(file.before, file.after))},
        renamed={file.path: file.new_path for file in migrated if file.new_path != file.path},
    )

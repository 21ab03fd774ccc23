# SPDX-License-Identifier: Apache-2.0
"""`workspace/didChangeWorkspaceFolders` and `workspace/didChangeWatchedFiles`"""

from __future__ import annotations

import os
from collections.abc import Iterable

from lsprotocol import types

from as2fm_lsp.context import Context
from roaml.model.config_files import CONFIG_FILES
from roaml.model.kinds import EXTENSIONS, MOCKS_EXTENSION, PROJECT_EXTENSION

WATCHED = (
    *(f"**/*{extension}" for extension in (*EXTENSIONS, PROJECT_EXTENSION, MOCKS_EXTENSION, ".csv")),
    *(f"**/{name}" for name in CONFIG_FILES),
)
"""Patterns of the files whose changes on the disk are relevant."""


def register(context: Context) -> None:
    session, diagnostics = context.session, context.diagnostics

    @context.feature(types.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS)
    def did_change_folders(_: types.DidChangeWorkspaceFoldersParams) -> None:
        use_folders(context)
        show_problems(context)
        diagnostics.schedule()

    @context.feature(types.WORKSPACE_DID_CHANGE_WATCHED_FILES)
    def did_change_watched_files(params: types.DidChangeWatchedFilesParams) -> None:
        paths = [session.convert.path(change.uri) for change in params.changes]
        session.invalidate()
        if any(os.path.basename(path) in CONFIG_FILES for path in paths):
            session.configure()
            show_problems(context)
        if any(change.type is not types.FileChangeType.Changed for change in params.changes):
            session.refresh()
        diagnostics.schedule()


def use_folders(context: Context, otherwise: Iterable[str] = ()) -> None:
    """Use the open folders of the client as workspaces, or the folders at the URIs `otherwise` if there are none."""
    session = context.session
    session.set_folders(session.convert.path(uri) for uri in context.client.folders or otherwise)


def show_problems(context: Context) -> None:
    """Show the problems of the configuration that were not shown yet."""
    for problem in dict.fromkeys(context.session.problems):
        context.client.show_message(types.MessageType.Warning, problem)
    context.session.problems.clear()

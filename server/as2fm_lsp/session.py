# SPDX-License-Identifier: Apache-2.0
"""The state of the server: open documents, folders, settings.

- Each folder of the client is a workspace with its own configuration, so that it is checked as in CI.
- A file that is outside of all folders, and that no system in them uses, is checked in a separate workspace, its
  repository or folder, while it is open.
- All workspaces see all open documents. Each file is analysed and reported in one of them (`Moment`).
"""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from lsprotocol import types

from as2fm_lsp.buffer import MARK, edited
from as2fm_lsp.convert import Converter
from roaml.interruption import go_on
from roaml.project.configuration import find_settings
from roaml.project.paths import is_below, is_on_disk
from roaml.project.settings import Settings, ament_prefixes, enclosing_root, settings_from
from roaml.project.workspace import Snapshot, Workspace
from roaml.record import replace

log = logging.getLogger(__name__)

MAX_SNAPSHOT_AGE_S = 0.5
"""The time, in s, after which files are read again even if no change is reported."""


class Moment:
    """All workspaces at one moment, each frozen at its first use.

    Args:
        folders: the workspaces of the client's folders.
        around: returns the workspace for a file that is in none of these folders.
        versions: the open documents with their versions.
    """

    def __init__(
        self,
        folders: Mapping[str, Workspace],
        around: Callable[[str], Workspace],
        versions: Mapping[str, int | None],
    ) -> None:
        self.versions = dict(versions)
        self._folders = dict(folders)
        self._around = around
        self._snapshots: dict[int, Snapshot] = {}

    def snapshot(self, path: str) -> Snapshot:
        """The snapshot in which a file is analysed.

        The workspace is the first one that exists of these: the innermost folder around the file in which a system uses
        it, any folder in which a system uses it, the innermost folder around it, a workspace outside all folders.
        """
        near = sorted((folder for folder in self._folders if is_below(path, folder)), key=len, reverse=True)
        if near and len(self._folders) == 1:
            return self._frozen(self._folders[near[0]])
        for folder in dict.fromkeys((*near, *self._folders)):
            snapshot = self._frozen(self._folders[folder])
            if path in snapshot.memberships:
                return snapshot
        return self._frozen(self._folders[near[0]] if near else self._around(path))

    def files(self) -> tuple[str, ...]:
        """All files that are reported: open files, the files of their systems, and the files of the folders."""
        there = dict.fromkeys(path for workspace in self._folders.values() for path in self._frozen(workspace).files())
        paths: dict[str, None] = {}
        for path in self.versions:
            snapshot = self.snapshot(path)
            of_systems = (f for s in snapshot.memberships.get(path, ()) for f in snapshot.analysis.files_of(s))
            opened = dict.fromkeys((path, *of_systems))
            paths.update((file, None) for file in opened if file in there or snapshot.analysis.source(file) is not None)
        return tuple({**paths, **there})

    def _frozen(self, workspace: Workspace) -> Snapshot:
        if id(workspace) not in self._snapshots:
            self._snapshots[id(workspace)] = workspace.snapshot()
        return self._snapshots[id(workspace)]


class Session:
    """The open documents, the folders and the settings of one client.

    Attributes:
        problems: errors in the configuration that have not been shown yet.
        checkpoint: called repeatedly during all work of the workspaces.
    """

    def __init__(self, checkpoint: Callable[[], None] = go_on) -> None:
        self.checkpoint = checkpoint
        self.convert = Converter()
        self.problems: list[str] = []
        self._versions: dict[str, int | None] = {}
        self._texts: dict[str, str] = {}
        self._folders: dict[str, Workspace] = {}
        self._around: dict[str, Workspace] = {}
        self._client_settings: object = {}
        self._moment: Moment | None = None
        self._taken = 0.0

    def moment(self) -> Moment:
        """The current moment. Answers share it until a change is reported, for at most `MAX_SNAPSHOT_AGE_S`."""
        now = time.monotonic()
        if self._moment is None or now - self._taken > MAX_SNAPSHOT_AGE_S:
            self._moment = Moment(self._folders, self._workspace_around, self._versions)
            self._taken = now
        return self._moment

    def invalidate(self) -> None:
        """Discard the current moment, because a file has changed in the editor or on the disk."""
        self._moment = None

    # ------------------------------------------------------------- documents

    def open(self, path: str, text: str, version: int | None) -> None:
        self._put(path, text, version)
        if not any(is_below(path, folder) for folder in self._folders):
            self._workspace_around(path)  # now, so that problems with its configuration can be shown

    def change(self, path: str, changes: Iterable[types.TextDocumentContentChangeEvent], version: int | None) -> None:
        """Apply the edits of a change in order, each to the result of the previous one. Documents that are not open
        have no text to change."""
        text = self._texts.get(path)
        if text is None:
            log.warning("%s is changed, but it is not open", path)
            return
        for change in changes:
            if isinstance(change, types.TextDocumentContentChangePartial):
                text = edited(text, change.range, change.text, self.convert.units)
            else:
                text = change.text
        self._put(path, text, version)

    def text(self, path: str) -> str | None:
        """The text of an open document, as the client has it; `None` if the document is not open."""
        return self._texts.get(path)

    def version(self, path: str) -> int | None:
        """The version of an open document, as the client has sent it."""
        return self._versions.get(path)

    def close(self, path: str) -> None:
        self._texts.pop(path, None)
        self._versions.pop(path, None)
        self.convert.mark(path, False)
        self.invalidate()
        needed = {_surroundings(path) for path in self._texts}
        self._around = {root: workspace for root, workspace in self._around.items() if root in needed}
        for workspace in self._workspaces():
            workspace.close(path)

    def _put(self, path: str, text: str, version: int | None) -> None:
        self._texts[path] = text
        self._versions[path] = version
        self.convert.mark(path, text.startswith(MARK))
        self.invalidate()
        for workspace in self._workspaces():
            workspace.open(path, text.removeprefix(MARK))

    # ------------------------------------------------------------ workspaces

    def set_folders(self, folders: Iterable[str]) -> None:
        """Set the open folders of the client. Workspaces of folders that remain open keep their caches."""
        folders = tuple(dict.fromkeys(os.path.normpath(folder) for folder in folders))
        known, self._around = self._folders, {}
        self.invalidate()
        self._folders = {f: known[f] if f in known else self._new_workspace(f) for f in folders}
        for folder, workspace in self._folders.items():
            workspace.set_package_folders(self._packages(folder, workspace.roots))

    def refresh(self) -> None:
        """List the folders again, because files were created or deleted."""
        self.invalidate()
        for workspace in self._workspaces():
            workspace.refresh()

    def configure(self, client_settings: object = None) -> None:
        """Apply new settings of the client, or a changed configuration file."""
        if client_settings is not None:
            self._client_settings = client_settings
        self.problems.clear()
        self.invalidate()
        for folder, workspace in (*self._folders.items(), *self._around.items()):
            settings = self._settings(folder)
            workspace.configure(settings, _roots(folder, settings))

    @property
    def client_settings(self) -> object:
        """The settings as the client has sent them; they are not validated."""
        return self._client_settings

    def _workspaces(self) -> tuple[Workspace, ...]:
        return (*self._folders.values(), *self._around.values())

    def _workspace_around(self, path: str) -> Workspace:
        root = _surroundings(path)
        if root not in self._around:
            self._around[root] = self._new_workspace(root)
        return self._around[root]

    def _new_workspace(self, folder: str) -> Workspace:
        settings = self._settings(folder)
        roots = _roots(folder, settings)
        workspace = Workspace(roots, settings, packages=self._packages(folder, roots), checkpoint=self.checkpoint)
        for path, text in self._texts.items():
            workspace.open(path, text.removeprefix(MARK))
        return workspace

    def _packages(self, folder: str, roots: Iterable[str]) -> tuple[str, ...]:
        """The folders that are searched for ROS packages: `folder` first, then the roots outside of it, then the
        client's folders."""
        outside = [root for root in roots if not is_below(root, folder)]
        return tuple(filter(is_on_disk, dict.fromkeys((folder, *outside, *self._folders))))

    def settings_of(self, path: str) -> Settings:
        """The settings with which a file is checked."""
        return self._settings(self.configured_folder(path))

    def configured_folder(self, path: str) -> str:
        """The folder whose configuration applies to a file."""
        near = [folder for folder in self._folders if is_below(path, folder)]
        return max(near, key=len) if near else _surroundings(path)

    def _settings(self, folder: str) -> Settings:
        """The configuration in a folder, with the client's settings added."""
        settings, problems = find_settings(folder) if is_on_disk(folder) else (Settings(), ())
        settings, mistakes = settings_from(_kebab(self._client_settings), folder, settings)
        if not settings.origin:  # errors in a configuration file are its diagnostics
            self.problems += problems
        self.problems += [f"In the editor's settings: {mistake.message}." for mistake in mistakes]
        return replace(settings, ament_prefixes=ament_prefixes())


def _surroundings(path: str) -> str:
    """The folder in which a file outside all folders is checked: its repository, or the folder that contains it.

    For a document without a file, this is the document itself, which is checked alone. A file in the root of the file
    system is also checked alone, because listing all files would take too long.
    """
    if not is_on_disk(path):
        return path
    folder = enclosing_root(path) or os.path.dirname(path)
    return path if folder == os.path.dirname(folder) else folder


def _roots(folder: str, settings: Settings) -> tuple[str, ...]:
    return settings.roots or ((folder,) if is_on_disk(folder) else ())


_CLIENT_KEYS = {
    "rosPath": "ros-path",
    "roots": "roots",
    "exclude": "exclude",
    "select": "select",
    "ignore": "ignore",
    "severity": "severity",
}


def _kebab(settings: object) -> dict[str, Any]:
    """The client's settings under the names of the configuration file, without settings that only the client uses."""
    if not isinstance(settings, Mapping):  # a client may send anything
        return {}
    return {_CLIENT_KEYS[key]: value for key, value in settings.items() if key in _CLIENT_KEYS and value}

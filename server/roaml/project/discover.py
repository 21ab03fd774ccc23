# SPDX-License-Identifier: Apache-2.0
"""Finds the files in a folder that may be supported, and the system files among them.

Folders that contain no sources, such as build folders, are skipped. A folder that several links lead to is searched
once. An unreadable folder is treated as empty.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator

from roaml.disk import Roots, UnreadableReason, read, status_of
from roaml.model.config_files import CONFIG_FILES
from roaml.model.kinds import EXTENSIONS, FileKind, kind_of
from roaml.project.exclude import NOTHING, Exclude
from roaml.project.files import Files
from roaml.project.paths import is_below, relative
from roaml.text import decode

SKIPPED_FOLDERS = frozenset(("build", "install", "log", "node_modules", "venv", "env", "__pycache__", "site-packages"))
MAX_FILES = 50_000
"""The maximum number of paths that `candidates` returns."""

_HEAD = 65_536
"""The number of bytes to read at the beginning of a file. The 20,000 characters that `root_name` reads fit if a
character has at most 3 bytes."""


def candidates(roots: Iterable[str], exclude: Exclude = NOTHING, within: Roots | None = None) -> Iterator[str]:
    """The paths of all files below `roots` whose names are those of supported files, without duplicates; sorted within
    each folder.

    Args:
        within: links that lead out of these folders are not followed; if `None`, all links are followed.
    """
    seen: set[str] = set()
    count = 0
    for root in roots:
        for folder, names, files in os.walk(root, followlinks=True):
            real = os.path.realpath(folder)
            outside = within is not None and not within.hold(folder)
            if real in seen or outside or exclude.covers_folder(folder, root):
                names.clear()
                continue
            seen.add(real)
            names[:] = sorted(name for name in names if not _is_skipped(name))
            for name in sorted(files):
                path = os.path.join(folder, name)
                if _may_be_ours(name) and not exclude.covers(path, root):
                    yield path
                    count += 1
                    if count >= MAX_FILES:
                        return


def is_candidate(path: str, roots: Iterable[str], exclude: Exclude = NOTHING, *, any_name: bool = False) -> bool:
    """Whether `candidates` returns `path` if the file exists; with `any_name`, also if its name is not that of a
    supported file."""
    for root in roots:
        if is_below(path, root):
            *folders, name = relative(path, root).split("/")
            if not any(map(_is_skipped, folders)) and (any_name or _may_be_ours(name)):
                return not exclude.covers(path, root)
    return False


def _may_be_ours(name: str) -> bool:
    return name.lower().endswith(EXTENSIONS) or name in CONFIG_FILES


def _is_skipped(folder_name: str) -> bool:
    return folder_name in SKIPPED_FOLDERS or folder_name.startswith(".")


class SystemIndex:
    """A cache that stores which files are system files. A file is read again if its size or modification time
    changes."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[tuple[int, int], bool]] = {}

    def systems(self, paths: Iterable[str], files: Files) -> tuple[str, ...]:
        return tuple(path for path in paths if self._is_system(path, files))

    def _is_system(self, path: str, files: Files) -> bool:
        if path in files.open_files:
            return kind_of(path, files.open_files[path].text) is FileKind.SYSTEM
        if not path.lower().endswith(".xml"):
            return False
        status = status_of(path)
        if isinstance(status, UnreadableReason):
            return False
        stamp = (status.st_mtime_ns, status.st_size)
        known = self._known.get(path)
        if known is not None and known[0] == stamp:
            return known[1]
        head = read(path, head=_HEAD)
        if isinstance(head, UnreadableReason) or not files.roots.hold(path):
            return False
        is_system = kind_of(path, decode(path, head).text) is FileKind.SYSTEM
        self._known[path] = (stamp, is_system)
        return is_system

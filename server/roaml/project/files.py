# SPDX-License-Identifier: Apache-2.0
"""Reads the user's files. Open buffers of an editor take precedence over the disk.

- The content of the disk never causes an exception: the result for an unusable file is an `UnreadableReason`.
- Only regular files are opened (`roaml.disk`). A link to a file outside of the roots is not followed.
- A file is read again only if its size or modification time has changed.
"""

from __future__ import annotations

import os
from collections.abc import Mapping

from roaml.disk import MAX_BYTES, Roots, UnreadableReason, read, status_of
from roaml.text import SourceFile, decode

MAX_CHARACTERS = 2_000_000
"""The maximum number of characters of a file that is analysed. Hand-written files are much smaller."""


class DiskFiles:
    """The files on the disk, cached by size and modification time. A link that leads out of `roots` is not followed."""

    def __init__(self, roots: Roots | None = None) -> None:
        self.roots = roots or Roots()
        self._known: dict[str, tuple[tuple[int, int, int], SourceFile | UnreadableReason]] = {}

    def read(self, path: str) -> SourceFile | UnreadableReason:
        status = status_of(path)
        if isinstance(status, UnreadableReason):
            self._known.pop(path, None)
            return status
        stamp = (status.st_mtime_ns, status.st_size, status.st_ino)
        known = self._known.get(path)
        if known is None or known[0] != stamp:
            known = self._known[path] = (stamp, self._read(path))
        return known[1]

    def _read(self, path: str) -> SourceFile | UnreadableReason:
        if not self.roots.hold(path):
            return UnreadableReason.OUTSIDE
        content = read(path, MAX_BYTES)
        return content if isinstance(content, UnreadableReason) else decode(path, content)

    def listing(self, folder: str) -> tuple[str, ...]:
        """The names of the files in a folder, sorted; empty if it cannot be read."""
        try:
            with os.scandir(folder) as entries:
                return tuple(sorted(entry.name for entry in entries if entry.is_file()))
        except (OSError, ValueError):
            return ()


class Files:
    """The files at one moment. `open_files` take precedence over the disk. Each path is read at most once."""

    def __init__(self, disk: DiskFiles, open_files: Mapping[str, SourceFile]) -> None:
        self._disk = disk
        self.open_files = open_files
        self._seen: dict[str, SourceFile | UnreadableReason] = {}
        self._folders: dict[str, tuple[str, ...]] = {}

    @property
    def roots(self) -> Roots:
        return self._disk.roots

    def read(self, path: str) -> SourceFile | UnreadableReason:
        if path in self.open_files:
            return self.open_files[path]
        if path not in self._seen:
            self._seen[path] = self._disk.read(path)
        return self._seen[path]

    def beside(self, path: str, extension: str) -> tuple[str, ...]:
        """The sorted paths of the other files with the extension `extension` in the folder of the file `path`."""
        folder = os.path.dirname(path)
        if folder not in self._folders:
            self._folders[folder] = self._disk.listing(folder)
        paths = {os.path.join(folder, name) for name in self._folders[folder] if name.endswith(extension)}
        paths |= {p for p in self.open_files if os.path.dirname(p) == folder and p.endswith(extension)}
        return tuple(sorted(paths - {path}))

    def with_texts(self, texts: Mapping[str, SourceFile]) -> Files:
        """These files, in which some have other texts."""
        return Files(self._disk, {**self.open_files, **texts})

    def text(self, path: str) -> SourceFile | None:
        source = self.read(path)
        return source if isinstance(source, SourceFile) else None

# SPDX-License-Identifier: Apache-2.0
"""Files that have changed on disk since they were read. The lines of the run are those of the files as read."""

from __future__ import annotations

import os
from collections.abc import Iterable


class ChangedFiles:
    """Remembers the times and sizes of files."""

    def __init__(self, paths: Iterable[str]) -> None:
        self._known = {path: _stamp(path) for path in paths}

    def take(self) -> list[str]:
        """The files that have changed, or were deleted, since they were read or since the last call."""
        changed = [path for path, stamp in self._known.items() if _stamp(path) != stamp]
        self._known |= {path: _stamp(path) for path in changed}
        return changed


def _stamp(path: str) -> tuple[int, int] | None:
    try:
        status = os.stat(path)
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size

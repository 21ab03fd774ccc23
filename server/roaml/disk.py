# SPDX-License-Identifier: Apache-2.0
"""The one reader of the user's files: models, definitions, configuration, baselines, states.

- Only regular files are opened. A device, socket or pipe may wait for ever or never end.
- Nothing larger than what the caller expects is read.
"""

from __future__ import annotations

import enum
import os
import stat

MEGABYTE = 1024 * 1024

MAX_BYTES = 32 * MEGABYTE
"""Of a model or interface definition."""

MAX_DATA = 512 * MEGABYTE
"""Of what tools write for tools: a translated model, a baseline, the state of a verification."""


class UnreadableReason(enum.Enum):
    """Why a path gives no text."""

    MISSING = "there is no such file"
    FOLDER = "it is a folder"
    SPECIAL = "it is no regular file"
    UNREADABLE = "it cannot be read"
    TOO_LARGE = "it is larger than 32 MB"
    TOO_LONG = "it is too large to be checked"
    OUTSIDE = (
        "it is a link to a file outside of the workspace; open that file's folder as well, or name it in `roots` or "
        "`ros-path`"
    )


class NotReadableError(OSError):
    """A file that must be read is not there, is of the wrong kind, or too large. `problem` says which."""

    def __init__(self, path: str, problem: UnreadableReason, most: int) -> None:
        words = f"it is larger than {most // MEGABYTE} MB" if problem is UnreadableReason.TOO_LARGE else problem.value
        super().__init__(None, words, path)
        self.problem = problem

    def __str__(self) -> str:
        return f"{self.filename}: {self.strerror}"


def status_of(path: str, most: int = MAX_BYTES) -> os.stat_result | UnreadableReason:
    """The status of a regular file of at most `most` bytes; links are followed."""
    try:
        status = os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return UnreadableReason.MISSING
    except (OSError, ValueError):
        return UnreadableReason.UNREADABLE
    return _judged(status, most) or status


def read(path: str, most: int = MAX_BYTES, head: int | None = None) -> bytes | UnreadableReason:
    """The content of a regular file.

    Args:
        most: a larger file is not read.
        head: only so many bytes, however large the file is.
    """
    status = status_of(path, most) if head is None else status_of(path, _ANY)
    if isinstance(status, UnreadableReason):
        return status
    try:
        # What has become a pipe in the meantime must not wait for who writes it.
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        with open(handle, "rb") as file:
            problem = _judged(os.fstat(handle), _ANY if head is not None else most)
            return problem or file.read(most if head is None else head)
    except FileNotFoundError:
        return UnreadableReason.MISSING
    except (OSError, ValueError):
        return UnreadableReason.UNREADABLE


def required(path: str, most: int = MAX_BYTES) -> bytes:
    """The content of a file without which a command cannot go on.

    Raises:
        NotReadableError: why there is none.
    """
    found = read(path, most)
    if isinstance(found, UnreadableReason):
        raise NotReadableError(path, found, most)
    return found


_ANY = 1 << 62


def _judged(status: os.stat_result, most: int) -> UnreadableReason | None:
    if stat.S_ISDIR(status.st_mode):
        return UnreadableReason.FOLDER
    if not stat.S_ISREG(status.st_mode):
        return UnreadableReason.SPECIAL
    return UnreadableReason.TOO_LARGE if status.st_size > most else None


class Roots:
    """The folders whose files belong to the user's work. Links in them lead to files of theirs only.

    Args:
        folders: the workspace. What a link in them leads to must lie in one of the roots.
        trusted: folders of the environment or the configuration with ROS interface packages, as `colcon build
            --symlink-install` makes them: links in them are followed wherever they lead.
    """

    def __init__(self, folders: tuple[str, ...] = (), trusted: tuple[str, ...] = ()) -> None:
        self._folders = tuple(os.path.join(os.path.abspath(folder), "") for folder in folders)
        self._trusted = tuple(os.path.join(os.path.abspath(folder), "") for folder in trusted)
        self._real = tuple(os.path.join(os.path.realpath(folder), "") for folder in (*folders, *trusted))

    def hold(self, path: str) -> bool:
        """Whether a path may be read, a file's or a folder's: no link on it leads out of the roots."""
        path = os.path.abspath(path)
        if path.startswith(self._trusted) or not path.startswith(self._folders):
            return True
        return os.path.join(os.path.realpath(path), "").startswith(self._real)

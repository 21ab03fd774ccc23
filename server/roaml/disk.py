# SPDX-License-Identifier: Apache-2.0
"""The only module that reads files of the user: models, definitions, configurations, baselines, saved verifications.

- Only regular files are opened. A device, socket or pipe may block for ever or never end.
- Nothing larger than the given limit is read.
"""

from __future__ import annotations

import enum
import os
import stat
import sys

MEGABYTE = 1024 * 1024

MAX_BYTES = 32 * MEGABYTE
"""The maximum size of a model or interface definition, in bytes."""

MAX_DATA = 512 * MEGABYTE
"""The maximum size of generated files, in bytes: a translated model, a baseline, the state of a verification."""


class UnreadableReason(enum.Enum):
    """The reason why the file at a path cannot be read."""

    MISSING = "there is no such file"
    FOLDER = "it is a folder"
    SPECIAL = "it is not a regular file"
    UNREADABLE = "it cannot be read"
    TOO_LARGE = "it is larger than 32 MB"
    TOO_LONG = "it is too large to be checked"
    OUTSIDE = (
        "it is a link to a file outside of the workspace; open the folder of that file as well, or add it to "
        "`roots` or "
        "`ros-path`"
    )


class NotReadableError(OSError):
    """Raised for a required file that does not exist, is not a regular file, cannot be read, or is too large. `problem`
    is the reason."""

    def __init__(self, path: str, problem: UnreadableReason, most: int) -> None:
        words = f"it is larger than {most // MEGABYTE} MB" if problem is UnreadableReason.TOO_LARGE else problem.value
        super().__init__(None, words, path)
        self.problem = problem

    def __str__(self) -> str:
        return f"{self.filename}: {self.strerror}"


def path_of_resource(package: str, *names: str) -> str:
    """The path of a file of an imported package of this project, below the folder of the package.
    (`importlib.resources` would import `tempfile` and `zipfile`, which takes 4 ms at each start.)"""
    return os.path.join(os.path.dirname(str(sys.modules[package].__file__)), *names)


def resource(package: str, *names: str) -> str:
    """The text of a file of an imported package of this project."""
    with open(path_of_resource(package, *names), encoding="utf-8") as file:
        return file.read()


def is_valid_path(path: str) -> bool:
    """Whether a file can have this path: it contains no null character, and the file system can encode it."""
    try:
        os.fsencode(path)
    except UnicodeEncodeError:
        return False
    return "\0" not in path


def status_of(path: str, most: int = MAX_BYTES) -> os.stat_result | UnreadableReason:
    """The status of a regular file of at most `most` bytes, or why the file cannot be read. Links are followed."""
    try:
        status = os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return UnreadableReason.MISSING
    except (OSError, ValueError):
        return UnreadableReason.UNREADABLE
    return _unreadable_reason(status, most) or status


def read(path: str, most: int = MAX_BYTES, head: int | None = None) -> bytes | UnreadableReason:
    """The content of a regular file, or why it cannot be read.

    Args:
        most: the maximum size in bytes; a larger file is not read.
        head: the maximum number of bytes to read, however large the file is.
    """
    status = status_of(path, most) if head is None else status_of(path, _NO_LIMIT)
    if isinstance(status, UnreadableReason):
        return status
    try:
        # If the path has become a pipe in the meantime, opening it must not block.
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        with open(handle, "rb") as file:
            opened = os.fstat(handle)
            problem = _unreadable_reason(opened, _NO_LIMIT if head is not None else most)
            if problem is not None:
                return problem
            # `read` reserves memory for as many bytes as it may return. Files below /proc have the size 0.
            limit = min(most if head is None else head, opened.st_size + MEGABYTE)
            # Without data, some files below /proc return None, as a pipe without a writer.
            content: bytes | None = file.read(limit)
            return UnreadableReason.UNREADABLE if content is None else content
    except FileNotFoundError:
        return UnreadableReason.MISSING
    except (OSError, ValueError):
        return UnreadableReason.UNREADABLE


def required(path: str, most: int = MAX_BYTES) -> bytes:
    """The content of a file that a command requires.

    Raises:
        NotReadableError: the file cannot be read.
    """
    content = read(path, most)
    if isinstance(content, UnreadableReason):
        raise NotReadableError(path, content, most)
    return content


_NO_LIMIT = 1 << 62


def _unreadable_reason(status: os.stat_result, most: int) -> UnreadableReason | None:
    """Why a file with this status may not be read; `None` if it may be read."""
    if stat.S_ISDIR(status.st_mode):
        return UnreadableReason.FOLDER
    if not stat.S_ISREG(status.st_mode):
        return UnreadableReason.SPECIAL
    return UnreadableReason.TOO_LARGE if status.st_size > most else None


class Roots:
    """The folders that contain the user's files. Links in folders of the workspace are followed only if their target is
    in one of the folders.

    Args:
        folders: the folders of the workspace. The target of a link in them must be in one of `folders` or `trusted`.
        trusted: folders of the environment or the configuration with ROS interface packages, as `colcon build
            --symlink-install` creates them: links in them are always followed.
    """

    def __init__(self, folders: tuple[str, ...] = (), trusted: tuple[str, ...] = ()) -> None:
        self._folders = tuple(os.path.join(os.path.abspath(folder), "") for folder in folders)
        self._trusted = tuple(os.path.join(os.path.abspath(folder), "") for folder in trusted)
        self._real = tuple(os.path.join(os.path.realpath(folder), "") for folder in (*folders, *trusted))

    def hold(self, path: str) -> bool:
        """Whether a file or folder may be read: no link on its path leads out of the roots."""
        path = os.path.abspath(path)
        if path.startswith(self._trusted) or not path.startswith(self._folders):
            return True
        return os.path.join(os.path.realpath(path), "").startswith(self._real)

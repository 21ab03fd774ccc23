# SPDX-License-Identifier: Apache-2.0
"""Atomic writes of files.

A file is written under another name, `.as2fm-writing-…`, in the same folder, and then renamed. The writer holds a lock
on it. A file with this prefix that nobody has locked was left behind by a killed process; the next writer in the folder
removes it.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable

try:
    import fcntl
except ImportError:  # Windows, where leftover files remain
    fcntl = None  # type: ignore[assignment]

PREFIX = ".as2fm-writing-"


def write_file(path: str, content: str | bytes | Iterable[str]) -> None:
    """Write a file so that it is complete or, after a failure, unchanged. Symbolic links are followed.

    Args:
        content: the whole content, or its text in pieces, which are not joined in memory.

    Raises:
        OSError: the file cannot be written; `filename` is `path`.
    """
    pieces = [content] if isinstance(content, (str, bytes)) else content
    data = (piece.encode("utf-8", "backslashreplace") if isinstance(piece, str) else piece for piece in pieces)
    try:
        if os.path.exists(path) and not os.path.isfile(path):  # a device or pipe is written to, not replaced
            with open(path, "wb") as file:
                file.writelines(data)
        else:
            _replace(os.path.realpath(path), data)
    except OSError as error:
        # The error names the requested file: the original error names the temporary file, or no file if the disk is
        # full.
        error.filename, error.filename2 = path, None
        raise


def _replace(path: str, data: Iterable[bytes]) -> None:
    mode = os.stat(path).st_mode & 0o777 if os.path.exists(path) else 0o666 & ~_umask()
    folder = os.path.dirname(path)
    sweep(folder)
    handle, temporary = _temporary(folder)
    # The lock is kept until after `close`, which may fail. Windows has no locks, and cannot rename an open file.
    locked = None if fcntl is None else os.dup(handle)
    try:
        with open(handle, "wb") as file:
            file.writelines(data)
        os.chmod(temporary, mode)
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise
    finally:
        if locked is not None:
            os.close(locked)


def _temporary(folder: str) -> tuple[int, str]:
    """Create a temporary file in `folder`, open and locked. Return its descriptor and its path."""
    import tempfile  # noqa: PLC0415 - many commands write no file

    while True:
        handle, path = tempfile.mkstemp(dir=folder, prefix=PREFIX)
        if fcntl is not None:
            with contextlib.suppress(OSError):  # a file system without locks
                fcntl.flock(handle, fcntl.LOCK_EX)
        if fcntl is None or os.fstat(handle).st_nlink:
            return handle, path
        os.close(handle)  # another process removed the file before it was locked


def sweep(folder: str) -> None:
    """Remove the leftover files of killed processes from a folder."""
    if fcntl is None:
        return
    try:
        names = os.listdir(folder)
    except OSError:
        return
    for name in names:
        if name.startswith(PREFIX):
            with contextlib.suppress(OSError):
                _remove_unlocked(os.path.join(folder, name))


def _remove_unlocked(path: str) -> None:
    """Remove a leftover file.

    Raises:
        OSError: another process is writing the file, or it cannot be removed.
    """
    handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        os.unlink(path)
    finally:
        os.close(handle)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask

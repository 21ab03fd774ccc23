# SPDX-License-Identifier: Apache-2.0
"""Writing: files whole or not at all, and to a terminal or pipe whatever it can take."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import tempfile


def write_file(path: str, content: str | bytes) -> None:
    """Write a file so that it is complete or, if anything fails, as it was before. Links are followed.

    Raises:
        OSError: it cannot be written.
    """
    data = content.encode("utf-8", "backslashreplace") if isinstance(content, str) else content
    if os.path.exists(path) and not os.path.isfile(path):  # a device or pipe is written to, not replaced
        with open(path, "wb") as file:
            file.write(data)
        return
    path = os.path.realpath(path)
    mode = os.stat(path).st_mode & 0o777 if os.path.exists(path) else 0o666 & ~_umask()
    handle, temporary = tempfile.mkstemp(dir=os.path.dirname(path), prefix=".as2fm-")
    try:
        with open(handle, "wb") as file:
            file.write(data)
        os.chmod(temporary, mode)
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise


def print_text(text: str, encoding: str | None = None) -> None:
    """Write to standard output, in its own encoding if none is asked for. What that cannot express is escaped: names of
    files may hold anything."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding=encoding or sys.stdout.encoding, errors="backslashreplace")
    sys.stdout.write(text)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask

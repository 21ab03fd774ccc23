# SPDX-License-Identifier: Apache-2.0
"""Writing files whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterable


def write_file(path: str, content: str | bytes | Iterable[str]) -> None:
    """Write a file so that it is complete or, if anything fails, as it was before. Links are followed.

    Args:
        content: all of it, or its text in pieces, which are not held together.

    Raises:
        OSError: it cannot be written.
    """
    pieces = [content] if isinstance(content, (str, bytes)) else content
    data = (piece.encode("utf-8", "backslashreplace") if isinstance(piece, str) else piece for piece in pieces)
    if os.path.exists(path) and not os.path.isfile(path):  # a device or pipe is written to, not replaced
        with open(path, "wb") as file:
            file.writelines(data)
        return
    path = os.path.realpath(path)
    mode = os.stat(path).st_mode & 0o777 if os.path.exists(path) else 0o666 & ~_umask()
    try:
        handle, temporary = tempfile.mkstemp(dir=os.path.dirname(path), prefix=".as2fm-")
    except OSError as error:
        error.filename = path  # not the name of a file that nobody has asked for
        raise
    try:
        with open(handle, "wb") as file:
            file.writelines(data)
        os.chmod(temporary, mode)
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask

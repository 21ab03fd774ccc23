# SPDX-License-Identifier: Apache-2.0
"""Writing to a terminal or pipe whatever it can take."""

from __future__ import annotations

import io
import sys
from typing import TextIO


def print_text(text: str, encoding: str | None = None, stream: TextIO | None = None) -> None:
    """Write to standard output or `stream`, in its own encoding if none is asked for. What that cannot express is
    escaped: names of files may hold anything."""
    stream = stream or sys.stdout
    if isinstance(stream, io.TextIOWrapper):
        stream.reconfigure(encoding=encoding or stream.encoding, errors="backslashreplace")
    stream.write(text)

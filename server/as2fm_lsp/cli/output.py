# SPDX-License-Identifier: Apache-2.0
"""Writing to a terminal or pipe whatever it can take."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TextIO

STANDARD_OUTPUT = "standard output"
"""The `filename` of an `OSError` that standard output has raised."""


def print_text(text: str, encoding: str | None = None, stream: TextIO | None = None) -> None:
    """Write to standard output or `stream`, in its own encoding if none is asked for. What that cannot express is
    escaped: names of files may hold anything.

    Raises:
        OSError: standard output cannot be written to. Standard error raises none: this is where it would be told.
    """
    stream = stream or sys.stdout
    with _open(stream):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(encoding=encoding or stream.encoding, errors="backslashreplace")
        stream.write(text)


def complain(message: str) -> None:
    """Tell on standard error what is wrong. If that cannot be written to, the exit status alone must do."""
    print_text(f"as2fm-lsp: {message}\n", stream=sys.stderr)


def flush() -> None:
    """Hand on what has been written to standard output.

    Raises:
        OSError: standard output cannot be written to.
    """
    if not sys.stdout.closed:  # as the server does to say that it has ended
        with _open(sys.stdout):
            sys.stdout.flush()


@contextmanager
def _open(stream: TextIO) -> Iterator[None]:
    """What is written within goes nowhere, from the first failure on; Python would complain again at exit."""
    try:
        yield
    except OSError as error:
        with suppress(OSError, ValueError):  # it is no file
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        if stream is not sys.stderr:
            error.filename = STANDARD_OUTPUT
            raise

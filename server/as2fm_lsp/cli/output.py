# SPDX-License-Identifier: Apache-2.0
"""Output to a terminal or pipe with any encoding."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import TextIO

from as2fm_lsp.outputs import STANDARD_OUTPUT_PATH, OutputFiles

STANDARD_OUTPUT = "standard output"
"""The `filename` of an `OSError` raised for standard output."""


def print_text(text: str, encoding: str | None = None, stream: TextIO | None = None) -> None:
    """Write to standard output or `stream`, in the encoding of the stream unless another is given. Characters that the
    encoding does not support are escaped, because names of files may contain any characters.

    Raises:
        OSError: standard output cannot be written to. Errors of standard error are ignored, because they could not be
            reported.
    """
    stream = stream or sys.stdout
    with _open(stream):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(encoding=encoding or stream.encoding, errors="backslashreplace")
        stream.write(text)


def complain(message: str) -> None:
    """Report an error on standard error. If that cannot be written to, only the exit status reports it."""
    print_text(f"as2fm-lsp: {message}\n", stream=sys.stderr)


def flush() -> None:
    """Flush standard output.

    Raises:
        OSError: standard output cannot be written to.
    """
    if not sys.stdout.closed:  # the server closes it to signal its end
        with _open(sys.stdout):
            sys.stdout.flush()


@contextmanager
def _open(stream: TextIO) -> Iterator[None]:
    """Discard further output after the first failure. Otherwise Python would report the failure again at exit."""
    try:
        yield
    except OSError as error:
        with suppress(OSError, ValueError):  # the stream is not a file
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        if stream is not sys.stderr:
            error.filename = STANDARD_OUTPUT
            raise


def takes_color(stream: TextIO) -> bool:
    """Whether the output goes to a terminal that supports and wants colors (https://no-color.org)."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def write_output(outputs: OutputFiles, path: str, content: str | Iterable[str], *, translates: bool = False) -> None:
    """Write a text file, or write to standard output if the path is `-`. Both are UTF-8.

    Args:
        translates: whether the content is a translation, which may replace an older translation.

    Raises:
        OSError: the file may not be replaced, or the file or standard output cannot be written.
    """
    if path != STANDARD_OUTPUT_PATH:
        outputs.write(path, content, translates=translates)
        return
    for text in [content] if isinstance(content, str) else content:
        print_text(text, encoding="utf-8")

# SPDX-License-Identifier: Apache-2.0
"""Output to a terminal or pipe with any encoding, and how much of it the user wants."""

from __future__ import annotations

import enum
import io
import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import TextIO

from as2fm_lsp.outputs import STANDARD_OUTPUT_PATH, OutputFiles

STANDARD_OUTPUT = "standard output"
"""The `filename` of an `OSError` raised for standard output."""


class Verbosity(enum.IntEnum):
    """How much a command writes besides its results and errors."""

    QUIET = 0
    NORMAL = 1
    VERBOSE = 2


_verbosity = Verbosity.NORMAL


def set_verbosity(verbosity: Verbosity) -> None:
    """Set how much the commands of this process write from now on."""
    global _verbosity  # noqa: PLW0603 - as for the levels of `logging`, there is one for the process
    _verbosity = verbosity


def is_quiet() -> bool:
    """Whether only results and errors are written: no notes, summaries and progress."""
    return _verbosity is Verbosity.QUIET


def is_verbose() -> bool:
    """Whether everything is written, also long lists."""
    return _verbosity is Verbosity.VERBOSE


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


def note(message: str) -> None:
    """Write a note on standard error, except with `--quiet`."""
    if not is_quiet():
        complain(message)


def detail(message: str) -> None:
    """Write on standard error what only `--verbose` shows."""
    if is_verbose():
        complain(message)


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

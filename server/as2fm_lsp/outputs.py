# SPDX-License-Identifier: Apache-2.0
"""Decides which files a command may write. All commands and the server ask `check_can_write`.

An output replaces an older output, but neither a file from which the command has read nor a model. Models are
recognized by name and content. The translations that this tool writes contain a mark, and a translation may replace
them. Commands that change their inputs on purpose (`format`, `migrate`, `check --fix`, `verify --resume`) write with
`write_file`.
"""

from __future__ import annotations

import argparse
import os
import stat
from collections.abc import Iterable, Iterator

STANDARD_OUTPUT_PATH = "-"
"""The path that means standard output."""


class OverwriteError(OSError):
    """An output would replace a file that must be kept. `filename` is its path, `strerror` the reason."""

    def __init__(self, path: str, reason: str) -> None:
        super().__init__(None, f"{reason}; write the output to another file", path)

    def __str__(self) -> str:
        return f"{self.filename}: {self.strerror}"


class InputPath(str):
    """The argument of an option that names a file to read."""

    __slots__ = ()


class OutputPath(str):
    """The argument of an option that names a file to write, or standard output."""

    __slots__ = ()


class TranslationPath(OutputPath):
    """The argument of an option that names a translation to write. It may replace an older translation."""

    __slots__ = ()


class OutputFolder(str):
    """The argument of an option that names a folder into which files are written."""

    __slots__ = ()


class OutputFiles:
    """The files that a command writes.

    Args:
        inputs: the files that the command has read.
    """

    def __init__(self, inputs: Iterable[str]) -> None:
        self._inputs = tuple(inputs)

    def check(self, paths: Iterable[str], *, translates: bool = False) -> None:
        """Check that files may be written, before the work whose results they receive.

        Raises:
            OverwriteError: a file may not be written.
        """
        for path in paths:
            if path != STANDARD_OUTPUT_PATH:
                check_can_write(path, self._inputs, translates=translates)

    def write(self, path: str, content: str | bytes | Iterable[str], *, translates: bool = False) -> None:
        """Write a file, as `write_file`.

        Raises:
            OverwriteError: the file may not be written.
            OSError: the file cannot be written.
        """
        from as2fm_lsp.atomic_write import write_file  # noqa: PLC0415 - most commands write no file

        self.check([path], translates=translates)
        write_file(path, content)


def outputs_of(options: argparse.Namespace, files: Iterable[str]) -> OutputFiles:
    """The outputs of a command that has read `files` and the files that its options name, after a check of those that
    its options name.

    Raises:
        OverwriteError: an output may not be written, or two options name the same output.
    """
    outputs = OutputFiles((*_arguments(options, InputPath), *files))
    paths = list(_arguments(options, OutputPath))
    for path in paths:
        outputs.check([path], translates=isinstance(path, TranslationPath))
    real = [os.path.realpath(path) for path in paths]
    for path, where in zip(paths, real, strict=True):
        if real.count(where) > 1 and not _is_special(path):
            raise OverwriteError(path, "two options write this output")
    return outputs


def check_can_write(path: str, inputs: Iterable[str], *, translates: bool = False) -> None:
    """Check that an output replaces neither an input nor a model. A file without content may always be replaced, and
    devices and pipes are not replaced.

    Args:
        inputs: the files that have been read.
        translates: whether the output is a translation, which may replace an older translation.

    Raises:
        OverwriteError: the output may not be written.
    """
    if _is_special(path):
        return
    if any(_is_same(path, file) for file in inputs):
        raise OverwriteError(path, "this file is an input of the command")
    from as2fm_lsp.kept_files import reason_to_keep  # noqa: PLC0415 - most commands write no file

    reason = reason_to_keep(path, translates=translates)
    if reason is not None:
        raise OverwriteError(path, reason)


def _arguments(options: argparse.Namespace, type_: type[str]) -> Iterator[str]:
    """The arguments of all options of a type."""
    for value in vars(options).values():
        for argument in dict.fromkeys(value) if isinstance(value, list) else (value,):
            if isinstance(argument, type_):
                yield argument


def _is_special(path: str) -> bool:
    """Whether a path names a device, a pipe or a folder."""
    try:
        return not stat.S_ISREG(os.stat(path).st_mode)
    except (OSError, ValueError):
        return False


def _is_same(path: str, other: str) -> bool:
    """Whether two paths name the same file, also through links or with other letter case."""
    if os.path.realpath(path) == os.path.realpath(other):
        return True
    try:
        return os.path.samefile(path, other)
    except (OSError, ValueError):
        return False

# SPDX-License-Identifier: Apache-2.0
"""The mocks that the arguments of a command declare."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path

from as2fm_lsp.cli.formats.report import shown_path
from as2fm_lsp.cli.output import complain
from roaml.mocks.mock import Mock, MockError, read_mock, read_mocks
from roaml.project.mock_files import mocks_path

MAX_NAMES = 8
"""The maximum number of types of leaves in a message."""


def mocks_in(options: argparse.Namespace) -> tuple[Mock, ...]:
    """The mocks given with `--mock`, followed by those in the file given with `--mocks`.

    Raises:
        MockError: a mock is not valid, or the file is not valid UTF-8.
        OSError: the file cannot be read.
    """
    mocks = tuple(read_mock(text) for text in options.mock)
    return mocks if options.mocks is None else mocks + _mocks_of(options.mocks)


def mocks_for_tree(options: argparse.Namespace, tree: str) -> tuple[Mock, ...]:
    """The mocks for a tree that belongs to no system: those that the arguments declare, otherwise those in the file
    beside the tree, if there is one.

    Raises:
        MockError: as for `mocks_in`.
    """
    path = mocks_path(tree)
    if options.mock or options.mocks is not None or not Path(path).is_file():
        return mocks_in(options)
    complain(f"with the mocks of {shown_path(path)}")
    return _mocks_of(path)


def _mocks_of(path: str) -> tuple[Mock, ...]:
    try:
        return read_mocks(Path(path).read_text(encoding="utf-8"))
    except UnicodeDecodeError:
        raise MockError(f"{path}: not valid UTF-8; fix the encoding") from None


def missing_mocks(path: str, types: Iterable[str]) -> MockError:
    """The error for leaves without mocks."""
    names = list(dict.fromkeys(types))
    listed = ", ".join(names[:MAX_NAMES]) + (", …" if len(names) > MAX_NAMES else "")
    return MockError(f'{shown_path(path)}: these leaves need mocks: {listed}; for example --mock "*: 0.9 in 1 s"')

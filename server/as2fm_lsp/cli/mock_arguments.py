# SPDX-License-Identifier: Apache-2.0
"""The mocks that the arguments of a command declare."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path

from as2fm_lsp.cli.formats.report import shown_path
from roaml.mocks.mock import Mock, MockError, read_mock, read_mocks

MAX_NAMES = 8
"""The maximum number of types of leaves in a message."""


def mocks_in(options: argparse.Namespace) -> tuple[Mock, ...]:
    """The mocks given with `--mock`, followed by those in the file given with `--mocks`.

    Raises:
        MockError: a mock is not valid, or the file is not valid UTF-8.
        OSError: the file cannot be read.
    """
    mocks = tuple(read_mock(text) for text in options.mock)
    if options.mocks is None:
        return mocks
    try:
        return mocks + read_mocks(Path(options.mocks).read_text(encoding="utf-8"))
    except UnicodeDecodeError:
        raise MockError(f"{options.mocks}: not valid UTF-8; fix the encoding") from None


def missing_mocks(path: str, types: Iterable[str]) -> MockError:
    """The error for leaves without mocks."""
    names = list(dict.fromkeys(types))
    listed = ", ".join(names[:MAX_NAMES]) + (", …" if len(names) > MAX_NAMES else "")
    return MockError(f'{shown_path(path)}: these leaves need mocks: {listed}; for example --mock "*: 0.9 in 1 s"')

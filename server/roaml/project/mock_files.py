# SPDX-License-Identifier: Apache-2.0
"""The file with the mocks of a tree that belongs to no system (docs/spec/mocks.md#leaves)."""

from __future__ import annotations

import os

from roaml.mocks.mock import Mock, MockError, read_mocks
from roaml.model.kinds import MOCKS_EXTENSION
from roaml.project.analysis import Analysis


def mocks_path(tree: str) -> str:
    """The path of the file with the mocks of a tree, which need not exist: `fetch.mocks` beside `fetch.xml`."""
    return f"{os.path.splitext(tree)[0]}{MOCKS_EXTENSION}"


def mocks_beside(analysis: Analysis, tree: str) -> tuple[Mock, ...]:
    """The mocks in the file beside a tree; empty if there is no file, or if it is not valid."""
    source = analysis.source(mocks_path(tree))
    try:
        return read_mocks(source.text) if source is not None else ()
    except MockError:
        return ()

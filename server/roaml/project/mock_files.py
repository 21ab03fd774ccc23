# SPDX-License-Identifier: Apache-2.0
"""Trees that belong to no system, and the files with their mocks (docs/spec/mocks.md#leaves)."""

from __future__ import annotations

from collections.abc import Sequence

from roaml.lower.programs.refusal import TreeRefusal
from roaml.mocks.mock import Mock, MockError, read_mocks
from roaml.mocks.unfolding import main_tree
from roaml.model.kinds import FileKind, mocks_path
from roaml.model.tree import Tree
from roaml.project.analysis import Analysis
from roaml.project.paths import resolve


def with_data(analysis: Analysis, path: str, mocks: Sequence[Mock]) -> tuple[Mock, ...]:
    """Mocks with the data that their durations are drawn from. Paths are relative to the file `path`, which contains
    the tree or lists the system.

    Raises:
        MockError: a file cannot be read, or is not valid.
    """

    def read(name: str) -> str | None:
        source = analysis.source(resolve(path, name))
        return None if source is None else source.text

    return tuple(mock.with_data(read) for mock in mocks)


def executed_tree(analysis: Analysis, path: str) -> Tree | None:
    """The tree that is executed if a file of trees is run alone; `None` if the file belongs to a system, or if it is
    not clear which tree is executed."""
    if analysis.kind(path) is not FileKind.TREE or analysis.memberships.get(path):
        return None
    forest = analysis.forest(path)
    try:
        return main_tree(forest) if forest is not None else None
    except TreeRefusal:
        return None


def mocks_beside(analysis: Analysis, tree: str) -> tuple[Mock, ...]:
    """The mocks in the file beside a tree; empty if there is no file, or if it is not valid."""
    source = analysis.source(mocks_path(tree))
    try:
        return read_mocks(source.text) if source is not None else ()
    except MockError:
        return ()

# SPDX-License-Identifier: Apache-2.0
"""The mocks of a tree that belongs to no system, as an editor shows and changes them (docs/spec/mocks.md#leaves)."""

from __future__ import annotations

import re

from roaml.ide.code_actions.action import WorkspaceEdit
from roaml.mocks.mock import Mock, read_mocks, without_comment
from roaml.mocks.proposal import MockableLeaf, mockable_leaves, proposed_text
from roaml.model.kinds import mocks_path
from roaml.project.analysis import Analysis
from roaml.project.paths import name_of
from roaml.record import Record
from roaml.text import Span, TextEdit


class LoneTreeMocks(Record, frozen=True, eq=False):
    """The mocks of a tree.

    Attributes:
        path: the file with the mocks, which need not exist.
        exists: whether it exists.
        leaves: the leaves, each with its mock and a proposal.
    """

    path: str
    exists: bool
    leaves: tuple[MockableLeaf, ...]

    def leaf(self, pattern: str) -> MockableLeaf | None:
        """The leaves whose mock has a pattern; `None` if there are none. Nodes with children are not among them."""
        leaves = (leaf for leaf in self.leaves if not leaf.kind.has_children)
        return next((leaf for leaf in leaves if leaf.proposed.pattern == pattern), None)


def lone_tree_mocks(analysis: Analysis, path: str) -> LoneTreeMocks:
    """The mocks of the tree in a file.

    Raises:
        MockError: the file with the mocks is not valid.
        TreeRefusal: the tree cannot be executed.
        ValueError: the file is not a file of trees.
    """
    forest = analysis.forest(path)
    if forest is None:
        raise ValueError(f"{path} is not a file of behavior trees")
    beside = mocks_path(path)
    source = analysis.source(beside)
    mocks = read_mocks(source.text) if source is not None else ()
    return LoneTreeMocks(beside, source is not None, mockable_leaves(forest, mocks))


def set_mock(analysis: Analysis, path: str, known: LoneTreeMocks, mock: Mock) -> WorkspaceEdit:
    """The change of the file with mocks that sets a mock. The proposals become its other lines if there is no such
    file. A line keeps its comment.

    Args:
        known: the mocks of the tree in the file `path`.
        mock: the mock, with the pattern of one of the leaves.
    """
    source = analysis.source(known.path)
    leaf = known.leaf(mock.pattern)
    is_instant = leaf is not None and not leaf.kind.has_duration
    written = f"{mock.pattern}: {mock.behaviour(is_instant=is_instant)}"
    text = source.text if source is not None else proposed_text(name_of(path), known.leaves)
    span, replacement = _place(text, mock.pattern, written)
    if source is None:
        return WorkspaceEdit({}, {known.path: text[: span.start] + replacement + text[span.end :]})
    return WorkspaceEdit({known.path: (TextEdit(span, replacement),)})


def _place(text: str, pattern: str, written: str) -> tuple[Span, str]:
    """The text to replace, and its replacement: the first line with this pattern for leaves, which is the one that
    applies; otherwise a new line at the end."""
    for line in re.finditer(r"[^\r\n]+", text):
        code = without_comment(line[0])
        if [mock.pattern for mock in read_mocks(code) if mock.like is None] == [pattern]:
            start = line.start() + len(code) - len(code.lstrip())
            return Span(start, line.start() + len(code.rstrip())), written
    separator = "" if not text or text.endswith("\n") else "\n"
    return Span(len(text), len(text)), f"{separator}{written}\n"

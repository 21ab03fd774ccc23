# SPDX-License-Identifier: Apache-2.0
"""Checks files of mocks: lines that are not mocks, and mocks that match no node (docs/spec/mocks.md#leaves)."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from fractions import Fraction

from roaml.diagnostics import Finding
from roaml.durations import NANOSECONDS
from roaml.expansion.uses import VARIABLE
from roaml.forest.forest import Forest
from roaml.mocks.likeness import needs_likeness
from roaml.mocks.mock import TREE_MARK, MockableWords, MockError, mock_for, mock_spans, read_mock, read_mocks
from roaml.model.tree import TreeFile, TreeNode, nodes
from roaml.record import replace
from roaml.rules.parser_rules import MOCK_SYNTAX, UNMATCHED_MOCK
from roaml.rules.rule import replacements
from roaml.text import SourceFile, Span

_FOLDER = "the trees in this folder"


def mock_findings(
    source: SourceFile, beside: Callable[[str, str], Iterable[str]], forest: Callable[[str], Forest | None]
) -> Iterator[Finding]:
    """The findings in a file of mocks. Mocks that contain parameters are not checked, because a system sets them. The
    names of the trees of a system are not checked.

    Args:
        beside: returns the files beside a file with an extension.
        forest: returns the trees in a file that is not in a system; `None` if it cannot be read.
    """
    words = _words(source.path, beside, forest)
    for span in mock_spans(source.text):
        line = source.text[span.start : span.end]
        if VARIABLE.search(line):
            continue
        try:
            mock = read_mock(line)
        except MockError as error:
            yield MOCK_SYNTAX.at(span, str(error))
            continue
        start = span.start
        if words.trees == _FOLDER and TREE_MARK in mock.pattern:
            tree, _, node = mock.pattern.partition(TREE_MARK)
            start, mock = start + len(tree) + len(TREE_MARK), replace(mock, pattern=node)
        reason = words.why_unused(mock) if words.nodes or words.parents else ""
        if reason:
            at = Span(start, start + len(mock.pattern))
            fixes = replacements(at, words.close(mock))
            yield UNMATCHED_MOCK.at(at, f"the mock `{mock.pattern}` {reason}", *fixes)


def mocked_durations(file: TreeFile, text: str) -> Mapping[TreeNode, Fraction]:
    """The leaves of a tree that a mock can let succeed, each with the time, in ns, that it then takes; empty if the
    text is not a file of mocks. A duration that is drawn from a distribution may be 0."""
    try:
        mocks = read_mocks(text)
    except MockError:
        return {}
    durations: dict[TreeNode, Fraction] = {}
    for tree in file.trees:
        for node in nodes(tree):
            if node.children or node.plugin is None:
                continue
            mock = mock_for(mocks, node.name.value if node.name else "", node.plugin.value)
            if mock is not None and mock.probability > 0 and isinstance(mock.duration, Fraction):
                durations[node] = mock.duration * NANOSECONDS["ms"]
    return durations


def _words(
    path: str, beside: Callable[[str, str], Iterable[str]], forest: Callable[[str], Forest | None]
) -> MockableWords:
    """The names and types of the nodes that the mocks of a file may describe: those of the tree `fetch.xml` beside
    `fetch.mocks`; if there is none, of all trees of the folder."""
    tree = f"{os.path.splitext(path)[0]}.xml"
    is_beside = forest(tree) is not None
    words: dict[str, None] = {}
    parents: dict[str, None] = {}
    for other in (tree,) if is_beside else beside(path, ".xml"):
        trees = forest(other)
        for _, _, node in trees.all_nodes if trees is not None else ():
            own = [name.value for name in (node.name, node.plugin) if name is not None]
            (parents if trees is not None and needs_likeness(trees, node) else words).update(dict.fromkeys(own))
    phrase = f"`{os.path.basename(tree)}`" if is_beside else _FOLDER
    return MockableWords(phrase, tuple(words), tuple(parents))

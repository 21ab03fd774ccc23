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
from roaml.mocks.mock import ALL, MockError, matches, mock_for, mock_spans, read_mock, read_mocks
from roaml.model.tree import TreeFile, TreeNode, nodes
from roaml.rules.parser_rules import MOCK_SYNTAX, UNMATCHED_MOCK
from roaml.rules.rule import did_you_mean, replacements
from roaml.suggest import close_names
from roaml.text import SourceFile, Span


def mock_findings(
    source: SourceFile, beside: Callable[[str, str], Iterable[str]], forest: Callable[[str], Forest | None]
) -> Iterator[Finding]:
    """The findings in a file of mocks. Mocks that contain parameters are not checked, because a system sets them.

    Args:
        beside: returns the files beside a file with an extension.
        forest: returns the trees in a file that is not in a system; `None` if it cannot be read.
    """
    names, where = _nodes(source.path, beside, forest)
    for span in mock_spans(source.text):
        line = source.text[span.start : span.end]
        if VARIABLE.search(line):
            continue
        try:
            pattern = read_mock(line).pattern
        except MockError as error:
            yield MOCK_SYNTAX.at(span, str(error))
            continue
        if names and pattern != ALL and not matches(pattern, names):
            at = Span(span.start, span.start + len(pattern))
            close = close_names(pattern, names)
            message = f"the mock `{pattern}` matches no node of {where}{did_you_mean(close) or '; remove it'}"
            yield UNMATCHED_MOCK.at(at, message, *replacements(at, close))


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


def _nodes(
    path: str, beside: Callable[[str, str], Iterable[str]], forest: Callable[[str], Forest | None]
) -> tuple[tuple[str, ...], str]:
    """The names and types of the nodes that the mocks of a file may describe, and a phrase for their trees: the tree
    `fetch.xml` beside `fetch.mocks`; if there is none, all trees of the folder."""
    tree = f"{os.path.splitext(path)[0]}.xml"
    is_beside = forest(tree) is not None
    words: dict[str, None] = {}
    for other in (tree,) if is_beside else beside(path, ".xml"):
        trees = forest(other)
        for _, _, node in trees.all_nodes if trees is not None else ():
            words.update((name.value, None) for name in (node.name, node.plugin) if name is not None)
    return tuple(words), f"`{os.path.basename(tree)}`" if is_beside else "the trees in this folder"

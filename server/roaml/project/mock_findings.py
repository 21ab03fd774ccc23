# SPDX-License-Identifier: Apache-2.0
"""Checks files of mocks: lines that are not mocks, and mocks that match no node (docs/spec/mocks.md#leaves)."""

from __future__ import annotations

import os
from collections.abc import Iterator

from roaml.diagnostics import Finding
from roaml.expansion.uses import VARIABLE
from roaml.mocks.mock import ALL, MockError, matches, mock_spans, read_mock
from roaml.project.analysis import Analysis
from roaml.rules.parser_rules import MOCK_SYNTAX, UNMATCHED_MOCK
from roaml.rules.rule import did_you_mean, replacements
from roaml.suggest import close_names
from roaml.text import SourceFile, Span


def mock_findings(analysis: Analysis, source: SourceFile) -> Iterator[Finding]:
    """The findings in a file of mocks. Mocks that contain parameters are not checked, because a system sets them."""
    nodes, where = _nodes(analysis, source.path)
    for span in mock_spans(source.text):
        line = source.text[span.start : span.end]
        if VARIABLE.search(line):
            continue
        try:
            pattern = read_mock(line).pattern
        except MockError as error:
            yield MOCK_SYNTAX.at(span, str(error))
            continue
        if nodes and pattern != ALL and not matches(pattern, nodes):
            at = Span(span.start, span.start + len(pattern))
            close = close_names(pattern, nodes)
            message = f"the mock `{pattern}` matches no node of {where}{did_you_mean(close) or '; remove it'}"
            yield UNMATCHED_MOCK.at(at, message, *replacements(at, close))


def _nodes(analysis: Analysis, path: str) -> tuple[tuple[str, ...], str]:
    """The names and types of the nodes that the mocks of a file may describe, and a phrase for their trees: the tree
    `fetch.xml` beside `fetch.mocks`; if there is none, all trees of the folder."""
    tree = f"{os.path.splitext(path)[0]}.xml"
    is_beside = analysis.tree(tree) is not None and bool(analysis.forest(tree))
    trees = (tree,) if is_beside else analysis.files.beside(path, ".xml")
    words: dict[str, None] = {}
    for other in trees:
        forest = analysis.forest(other) if analysis.tree(other) is not None else None
        for _, _, node in forest.all_nodes if forest is not None else ():
            words.update((name.value, None) for name in (node.name, node.plugin) if name is not None)
    return tuple(words), f"`{os.path.basename(tree)}`" if is_beside else "the trees in this folder"

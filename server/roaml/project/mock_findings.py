# SPDX-License-Identifier: Apache-2.0
"""Checks files of mocks: lines that are not mocks, and mocks that match no node (docs/spec/mocks.md#leaves)."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator

from roaml.diagnostics import Finding
from roaml.expansion.uses import VARIABLE
from roaml.forest.forest import Forest
from roaml.mocks.mock import ALL, MockError, matches, mock_spans, read_mock
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
    nodes, where = _nodes(source.path, beside, forest)
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

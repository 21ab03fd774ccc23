# SPDX-License-Identifier: Apache-2.0
"""Checks files of mocks: lines that are not mocks, mocks that match no node, repeated
and missing mocks (docs/spec/mocks.md#leaves)."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from roaml.diagnostics import Finding, Fix, Related
from roaml.durations import NANOSECONDS
from roaml.edit.elements import removal
from roaml.expansion.uses import VARIABLE
from roaml.forest.forest import Forest
from roaml.mocks.likeness import needs_likeness
from roaml.mocks.mock import TREE_MARK, Mock, MockableWords, MockError, mock_for, mock_spans, read_mock, read_mocks
from roaml.model.tree import TreeFile, TreeNode, nodes
from roaml.project.paths import resolve
from roaml.record import replace
from roaml.rules.parser_rules import MISSING_MOCK, MOCK_SYNTAX, REPEATED_MOCK, UNMATCHED_MOCK
from roaml.rules.rule import listing, replacements
from roaml.text import SourceFile, Span, TextEdit

_FOLDER = "the trees in this folder"


def mock_findings(
    source: SourceFile,
    beside: Callable[[str, str], Iterable[str]],
    forest: Callable[[str], Forest | None],
    read: Callable[[str], SourceFile | None],
    has_plugin: Callable[[str, str], bool],
) -> Iterator[Finding]:
    """The findings in a file of mocks. Mocks that contain parameters are not checked, because a system sets them. The
    names of the trees of a system are not checked. Files with data are checked if there is a tree beside the mocks,
    because their paths are relative to the tree.

    Args:
        beside: returns the files beside a file with an extension.
        forest: returns the trees in a file that is not in a system; `None` if it cannot be read.
        read: returns the file with a path; `None` if it cannot be read.
        has_plugin: whether a system that lists the tree with a path has a plugin for a type of nodes.
    """
    trees = forest(_tree_of(source.path))
    words = _words(source.path, beside, forest)
    first: dict[tuple[str, bool], Span] = {}
    mocks: list[Mock] = []
    is_right = True
    for span in mock_spans(source.text):
        line = source.text[span.start : span.end]
        if VARIABLE.search(line):
            is_right = False
            continue
        try:
            mock = read_mock(line)
            if trees is not None:
                mock.with_data(lambda name: _text(read(resolve(source.path, name))))
        except MockError as error:
            is_right = False
            yield MOCK_SYNTAX.at(span, str(error))
            continue
        start = span.start
        mocks.append(mock)
        earlier = first.setdefault((mock.pattern, mock.like is None), span)
        if earlier is not span:
            yield _repeated(source, mock, span, earlier)
            continue
        if words.trees == _FOLDER and TREE_MARK in mock.pattern:
            tree, _, node = mock.pattern.partition(TREE_MARK)
            start, mock = start + len(tree) + len(TREE_MARK), replace(mock, pattern=node)
        reason = words.why_unused(mock) if words.nodes or words.parents else ""
        if reason:
            at = Span(start, start + len(mock.pattern))
            fixes = replacements(at, words.close(mock))
            is_right = False
            yield UNMATCHED_MOCK.at(at, f"the mock `{mock.pattern}` {reason}", *fixes)

    if is_right and trees is not None:
        yield from _missing(source, trees, mocks, lambda type_: has_plugin(trees.path, type_))


def _text(source: SourceFile | None) -> str | None:
    return None if source is None else source.text


def _repeated(source: SourceFile, mock: Mock, span: Span, earlier: Span) -> Finding:
    message = f"there is a mock for `{mock.pattern}` above, which is used; remove one of them"
    fix = Fix("Remove this mock", (removal(source.text, span),), preferred=False)
    related = [Related(earlier, "this mock is used")]
    return REPEATED_MOCK.at(Span(span.start, span.start + len(mock.pattern)), message, fix, related=related)


def _missing(
    source: SourceFile, trees: Forest, mocks: Sequence[Mock], has_plugin: Callable[[str], bool]
) -> Iterator[Finding]:
    """The finding that leaves of the tree have no mock, at the last mock. A leaf with a plugin in a system needs none,
    because the mocks of a system are for the other leaves."""
    from roaml.lower.programs.refusal import TreeRefusal  # noqa: PLC0415 - most files with mocks have no such tree
    from roaml.mocks.proposal import completed_text, mockable_leaves  # noqa: PLC0415

    try:
        leaves = [leaf for leaf in mockable_leaves(trees, mocks) if leaf.is_missing]
        leaves = [leaf for leaf in leaves if not all(has_plugin(n.own_type or n.type) for n in leaf.nodes)]
    except TreeRefusal:
        return
    if not leaves:
        return
    names = listing([leaf.proposed.pattern for leaf in leaves])
    span = next(reversed([*mock_spans(source.text)]), Span(0, 0))
    message = f"no mock matches {names} of `{os.path.basename(_tree_of(source.path))}`, so `verify` does not start"
    end = len(source.text)
    added = TextEdit(Span(end, end), completed_text(source.text, leaves)[end:])
    yield MISSING_MOCK.at(span, message, Fix("Add the missing mocks as they are proposed", (added,)))


def mock_patterns(text: str) -> Iterator[str]:
    """What the valid mocks in the text of a file name."""
    for span in mock_spans(text):
        try:
            yield read_mock(text[span.start : span.end]).pattern
        except MockError:
            continue


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
    tree = _tree_of(path)
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


def _tree_of(path: str) -> str:
    """The path of the tree beside a file of mocks."""
    return f"{os.path.splitext(path)[0]}.xml"

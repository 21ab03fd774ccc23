# SPDX-License-Identifier: Apache-2.0
"""Folding ranges: elements, attributes on several lines, comments, CDATA sections; objects and lists in JSON."""

from __future__ import annotations

import enum
from collections.abc import Iterator
from typing import NamedTuple

from roaml.ide.json_tree import values
from roaml.ide.syntax import xml_file
from roaml.json_syntax import JsonArray, JsonObject
from roaml.project.analysis import Analysis
from roaml.text import SourceFile, Span
from roaml.xml_syntax import CData, Comment, Document, Element


class FoldKind(enum.Enum):
    BLOCK = "block"
    COMMENT = "comment"


class Fold(NamedTuple):
    """The lines `first` to `last`, counted from 0, are folded to the line `first`."""

    first: int
    last: int
    kind: FoldKind = FoldKind.BLOCK


def folds(analysis: Analysis, path: str) -> tuple[Fold, ...]:
    """The folds of a file, in the order of the text; if several begin on one line, only the longest is returned."""
    source = analysis.source(path)
    if source is None:
        return ()
    if (file := xml_file(analysis, path)) is not None:
        unordered = _xml(source, file.document)
    elif (json := analysis.json(path)) is not None and path.endswith((".jani", ".json")):
        spans = [value.span for value in values(json[0]) if isinstance(value, (JsonObject, JsonArray))]
        unordered = (fold for span in spans for fold in _block(source, span.start, span.end - 1))
    else:
        return ()
    first: dict[int, Fold] = {}
    for fold in sorted(unordered, key=lambda fold: (fold.first, -fold.last)):
        first.setdefault(fold.first, fold)
    return tuple(first.values())


def _xml(source: SourceFile, document: Document) -> Iterator[Fold]:
    stack = list(document.nodes)
    while stack:
        node = stack.pop()
        if isinstance(node, Element):
            stack += node.nodes
            yield from _lines(source, node.open_span)
            yield from _block(source, node.open_span.end - 1, node.content_span.end)
        elif isinstance(node, Comment):
            yield from _lines(source, node.span, FoldKind.COMMENT)
        elif isinstance(node, CData):
            yield from _lines(source, node.span)


def _lines(source: SourceFile, span: Span, kind: FoldKind = FoldKind.BLOCK) -> Iterator[Fold]:
    """All lines of a span, if there are several."""
    first, last = (source.lines.position(offset).line for offset in (span.start, span.end - 1))
    if last > first:
        yield Fold(first, last, kind)


def _block(source: SourceFile, start: int, end: int) -> Iterator[Fold]:
    """The lines from that of `start` to the one before that of `end`, so that the closing bracket or tag stays
    visible."""
    first, last = source.lines.position(start).line, source.lines.position(end)
    before = source.text[source.lines.line_start(last.line) : end]
    shown = last.line if before.strip(" \t]}") else last.line - 1
    if shown > first:
        yield Fold(first, shown)

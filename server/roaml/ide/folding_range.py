# SPDX-License-Identifier: Apache-2.0
"""Folding ranges: in XML, elements, regions, attributes on several lines, comments and CDATA sections; in JSON, objects
and lists."""

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
from roaml.xml_syntax.regions import regions


class FoldKind(enum.Enum):
    BLOCK = "block"
    COMMENT = "comment"


class Fold(NamedTuple):
    """A range of lines, from `first` to `last` inclusive, counted from 0. If it is folded, only the line `first` is
    visible."""

    first: int
    last: int
    kind: FoldKind = FoldKind.BLOCK


def folds(analysis: Analysis, path: str) -> tuple[Fold, ...]:
    """The folding ranges of a file, in the order of the text. If several begin on one line, only the longest is
    returned."""
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
            for region in regions(node.nodes):
                yield from _lines(source, region.span)
            yield from _lines(source, node.open_span)
            yield from _block(source, node.open_span.end - 1, node.content_span.end)
        elif isinstance(node, Comment):
            yield from _lines(source, node.span, FoldKind.COMMENT)
        elif isinstance(node, CData):
            yield from _lines(source, node.span)


def _lines(source: SourceFile, span: Span, kind: FoldKind = FoldKind.BLOCK) -> Iterator[Fold]:
    """The folding range of all lines of a span, if the span has several lines."""
    first, last = (source.lines.position(offset).line for offset in (span.start, span.end - 1))
    if last > first:
        yield Fold(first, last, kind)


def _block(source: SourceFile, start: int, end: int) -> Iterator[Fold]:
    """The folding range from the line of `start` to the line before `end`, so that the closing bracket or tag stays
    visible."""
    first, last = source.lines.position(start).line, source.lines.position(end)
    before = source.text[source.lines.line_start(last.line) : end]
    shown = last.line if before.strip(" \t]}") else last.line - 1
    if shown > first:
        yield Fold(first, shown)

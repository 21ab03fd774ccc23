# SPDX-License-Identifier: Apache-2.0
"""Selection ranges, which grow in steps: expression, value, attribute, tag, content, element, parents."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr.tree import Expr, children
from roaml.ide.json_tree import spans_at
from roaml.ide.syntax import Typed, expressions, path_at, xml_file
from roaml.model.syntax import Expression
from roaml.project.analysis import Analysis
from roaml.text import Span
from roaml.xml_syntax import CData, Comment, Document, Element, Instruction, Text


def selections(analysis: Analysis, path: str, offset: int) -> tuple[Span, ...]:
    """The spans around an offset, innermost first. Each is contained in the next, and the last one is the whole text.
    The result is empty if the file cannot be read."""
    source = analysis.source(path)
    if source is None:
        return ()
    spans = [Span(0, len(source.text))]
    if (file := xml_file(analysis, path)) is not None:
        around = path_at(file, offset)
        for typed in around:
            spans += [typed.element.span, typed.element.content_span]
        spans += _node(file.document, around[-1].element if around else None, offset)
        spans += _in_element(file.document, around[-1], offset) if around else ()
    elif path.endswith((".jani", ".json")) and (json := analysis.json(path)) is not None:
        spans += spans_at(json[0], offset)
    return tuple(_nested(spans, offset)) or (Span(0, 0),)


def _nested(spans: list[Span], offset: int) -> list[Span]:
    """The spans around the offset, innermost first; each is contained in the next."""
    result: list[Span] = []
    for span in sorted(set(spans), key=lambda span: (span.start - span.end, span)):
        if (
            span.contains(offset)
            and span.start < span.end
            and (not result or (result[-1].start <= span.start and span.end <= result[-1].end))
        ):
            result.append(span)
    return result[::-1]


def _in_element(document: Document, typed: Typed, offset: int) -> Iterator[Span]:
    """The spans around an offset in the tags and the expressions of an element."""
    element = typed.element
    yield element.open_span
    yield element.name_span
    if element.close_span is not None and element.close_name_span is not None:
        yield element.close_span
        yield element.close_name_span
    for attribute in element.attributes:
        yield attribute.span
        yield attribute.name_span
        if attribute.has_value:
            quoted = Span(attribute.value_span.start - 1, attribute.span.end)
            yield quoted if document.text[quoted.start] in "\"'" else attribute.value_span
            yield attribute.value_span
    for expression in expressions(document, typed):
        if expression.span.contains(offset):
            yield expression.span
            yield from _in_expression(expression, offset)


def _in_expression(expression: Expression, offset: int) -> Iterator[Span]:
    level: tuple[Expr, ...] = (expression.tree,)
    while inside := [node for node in level if node.span.contains(offset)]:
        # If the caret is between two expressions, as in `a|+b`, the one that begins at the caret is selected.
        yield inside[-1].span
        level = children(inside[-1])


def _node(document: Document, parent: Element | None, offset: int) -> Iterator[Span]:
    """The spans of the comment or text around an offset, with and without its delimiters or white space."""
    for node in parent.nodes if parent else document.nodes:
        if not isinstance(node, Element) and node.span.contains(offset):
            raw = document.text[node.span.start : node.span.end]
            if isinstance(node, Text):
                lead = len(raw) - len(raw.lstrip())
                yield Span(node.span.start + lead, node.span.start + max(lead, len(raw.rstrip())))
            else:
                yield node.span
                opener = {Comment: 4, CData: 9, Instruction: 2}[type(node)]
                yield Span(node.span.start + opener, node.span.start + opener + len(node.value))

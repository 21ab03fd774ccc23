# SPDX-License-Identifier: Apache-2.0
"""Finds suppression comments: `<!-- as2fm: ignore[code, other-code] -->`, or `ignore` without brackets for all codes.

A comment applies to its line. A comment on a line without other content applies to the whole element that follows it.
"""

from __future__ import annotations

import bisect
from collections.abc import Callable, Iterable

from roaml.diagnostics import Finding, current_code
from roaml.record import Record
from roaml.regex import regex
from roaml.text import Span
from roaml.xml_syntax import Comment, Document, Element, Node, Text

_COMMENT = regex(r"\s*as2fm:\s*ignore(?:\s*\[([^\]]*)\])?\s*\Z")


class Suppression(Record, frozen=True):
    """A suppression comment.

    Attributes:
        span: the text to which the comment applies.
        codes: the codes that are suppressed; `None` for all codes.
        comment: the position of the comment.
    """

    span: Span
    codes: frozenset[str] | None
    comment: Span

    def hides(self, finding: Finding) -> bool:
        if self.codes is not None and finding.code not in self.codes:
            return False
        return self.span.start <= finding.span.start < self.span.end


def suppressions(document: Document | None) -> tuple[Suppression, ...]:
    """All suppression comments of a document."""
    if document is None or "as2fm:" not in document.text:
        return ()
    suppressions: list[Suppression] = []
    _collect(document, document.nodes, suppressions)
    for root in document.nodes:
        if isinstance(root, Element):
            for element in root.walk():
                _collect(document, element.nodes, suppressions)
    return tuple(suppressions)


def covering(comments: Iterable[Suppression]) -> Callable[[int], tuple[Suppression, ...]]:
    """A function from an offset to the comments that apply to findings that begin there.

    If several comments have the same range and codes, only the first is returned. The function searches a sorted index,
    because there may be many comments.
    """
    opening: dict[int, list[Suppression]] = {}
    closing: dict[int, list[Suppression]] = {}
    for comment in {
        (suppression.span, suppression.codes): suppression for suppression in reversed(tuple(comments))
    }.values():
        opening.setdefault(comment.span.start, []).append(comment)
        closing.setdefault(comment.span.end, []).append(comment)
    starts = sorted({*opening, *closing})
    active: dict[Suppression, None] = {}
    table: list[tuple[Suppression, ...]] = [()]
    for start in starts:
        for comment in closing.get(start, ()):
            active.pop(comment, None)
        active.update(dict.fromkeys(opening.get(start, ())))
        table.append(tuple(active))
    return lambda offset: table[bisect.bisect_right(starts, offset)]


def _collect(document: Document, nodes: Iterable[Node], suppressions: list[Suppression]) -> None:
    waiting: list[tuple[Span, frozenset[str] | None]] = []
    for node in nodes:
        match node:
            case Comment() if match := _COMMENT.match(node.value):
                listed = (code.strip() for code in (match[1] or "").split(","))
                codes = None if match[1] is None else frozenset(current_code(code) for code in listed if code)
                line = _line(document.text, node.span)
                if document.text[line.start : line.end].strip() == document.text[node.span.start : node.span.end]:
                    waiting.append((node.span, codes))
                else:
                    suppressions.append(Suppression(line, codes, node.span))
            case Element():
                suppressions += [Suppression(node.span, codes, comment) for comment, codes in waiting]
                waiting.clear()
            case Text() if node.value.strip():
                waiting.clear()


def _line(text: str, span: Span) -> Span:
    """The span of the whole line or lines that contain `span`, without the last line break."""
    start = max(text.rfind("\n", 0, span.start), text.rfind("\r", 0, span.start)) + 1
    ends = [i for i in (text.find("\n", span.end), text.find("\r", span.end)) if i >= 0]
    return Span(start, min(ends, default=len(text)))

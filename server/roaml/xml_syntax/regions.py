# SPDX-License-Identifier: Apache-2.0
"""Regions: siblings between the comments `<!-- #region NAME -->` and `<!-- #endregion -->`, as in VS Code."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from roaml.regex import regex
from roaml.text import Span
from roaml.xml_syntax.tree import Comment, Node

_MARK = regex(r"\s*#(end)?region\b(.*)", re.ASCII | re.DOTALL)


class CommentRegion(NamedTuple):
    """A region.

    Attributes:
        name: the text after `#region`; "" if there is none.
        start: the comment with which it begins.
        span: from the beginning of the first comment to the end of the last.
        path: the names of the regions around it, the outermost first, and its own.
    """

    name: str
    start: Span
    span: Span
    path: tuple[str, ...]


def regions(nodes: Sequence[Node]) -> tuple[CommentRegion, ...]:
    """The regions among the children of an element, in the order of their beginnings. They can contain others. A
    comment whose counterpart is missing is ignored."""
    opened: list[tuple[str, Span]] = []
    pairs: list[tuple[str, Span, Span]] = []
    for node in nodes:
        mark = _MARK.match(node.value) if isinstance(node, Comment) else None
        if mark is None:
            continue
        if mark[1] is None:
            opened.append((" ".join(mark[2].split()), node.span))
        elif opened:
            name, start = opened.pop()
            pairs.append((name, start, Span(start.start, node.span.end)))
    found: list[CommentRegion] = []
    for name, start, span in sorted(pairs, key=lambda pair: pair[1]):
        around = next((other for other in reversed(found) if span.end <= other.span.end), None)
        found.append(CommentRegion(name, start, span, (*(around.path if around else ()), name)))
    return tuple(found)

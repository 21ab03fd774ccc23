# SPDX-License-Identifier: Apache-2.0
"""Reads the comment about an element: before the element, or after it on the same line."""

from __future__ import annotations

import re
from collections.abc import Sequence

from roaml.regex import regex
from roaml.xml_syntax import Comment, Document, Element, Node, Text

_TYPE = regex(r"[,;]?\s*\bTYPE\s+\w+\s*:\s*[\w\[\]]+")
_LICENCE = regex(r"SPDX-|Copyright|Licen[cs]ed under", re.IGNORECASE)


def remark(document: Document, element: Element) -> str:
    """The text of the comment about `element`; "" if it has none.

    This is the comment after the element on the same line. If there is none, it is the comment directly before the
    element, without an empty line in between, if nothing else precedes that comment on its line. Types in comments
    (`TYPE level:int16`) and licences are left out.
    """
    around = document.path_at(element.span.start + 1)
    siblings: Sequence[Node] = around[-2].nodes if len(around) > 1 else document.nodes
    at = next((i for i, node in enumerate(siblings) if node is element), None)
    if at is None:
        return ""
    return _behind(siblings, at) or _before(siblings, at)


def _behind(siblings: Sequence[Node], at: int) -> str:
    rest = siblings[at + 1 : at + 3]
    if rest and isinstance(rest[0], Text):
        if "\n" in rest[0].value or rest[0].value.strip():
            return ""
        rest = rest[1:]
    return _text(rest[0]) if rest and isinstance(rest[0], Comment) else ""


def _before(siblings: Sequence[Node], at: int) -> str:
    before = at - 1
    if before >= 0 and isinstance(gap := siblings[before], Text):
        if gap.value.strip() or gap.value.count("\n") > 1:
            return ""
        before -= 1
    if before < 0 or not isinstance(comment := siblings[before], Comment):
        return ""
    begins_line = before == 0 or (isinstance(lead := siblings[before - 1], Text) and "\n" in lead.value)
    return _text(comment) if begins_line else ""


def _text(comment: Comment) -> str:
    text = _TYPE.sub("", comment.value).strip()
    return "" if _LICENCE.search(text) else text

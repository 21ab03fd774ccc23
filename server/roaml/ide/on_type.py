# SPDX-License-Identifier: Apache-2.0
"""Automatic insertions while a tag is typed: `</state>` after `<state>`, `state>` after `</`, `>` after `<a /`.

An insertion is made only if the text has fewer syntax errors with it, so balanced text is not changed.
"""

from __future__ import annotations

from roaml.ide.syntax import xml_file
from roaml.project.analysis import Analysis
from roaml.text import Span, TextEdit
from roaml.xml_syntax import CData, Comment, Document, Element, Instruction, parse

TRIGGERS = (">", "/")

_CLOSERS = {Comment: "-->", CData: "]]>", Instruction: "?>"}


def close_tag(analysis: Analysis, path: str, offset: int) -> TextEdit | None:
    """The insertion after the character before `offset` has been typed; `None` if nothing is inserted."""
    file = xml_file(analysis, path)
    if file is None:
        return None
    document = file.document
    text = document.text
    if text[offset - 1 : offset] == ">":
        new = _end_tag(document, offset)
    elif text[offset - 2 : offset] == "</":
        new = _rest_of_end_tag(text, offset)
    elif text[offset - 1 : offset] == "/":
        new = _end_of_start_tag(document, offset)
    else:
        return None
    if not new or len(parse(text[:offset] + new + text[offset:]).findings) >= len(document.findings):
        return None
    return TextEdit(Span(offset, offset), new)


def _end_tag(document: Document, offset: int) -> str:
    """The end tag for the start tag that ends at the offset; "" if no start tag ends there."""
    for element in _elements(document):
        if element.open_span.end == offset and not element.self_closing:
            return f"</{document.text[element.name_span.start : element.name_span.end]}>"
    return ""


def _rest_of_end_tag(text: str, offset: int) -> str:
    """The text that completes the `</` before the offset: the name of the innermost open element, and `>`."""
    name = open_element(text, offset - 2)
    return name if not name or text[offset : offset + 1] == ">" else f"{name}>"


def open_element(text: str, offset: int) -> str:
    """The name of the innermost open element at an offset; "" if there is none, or no tag is allowed there."""
    before = parse(text[:offset])
    name, nodes = "", list(before.nodes)
    while nodes:
        last = nodes[-1]
        if not isinstance(last, Element):
            closer = _CLOSERS.get(type(last))
            if closer and not before.text.endswith(closer) and last.span.end == len(before.text):
                return ""  # for example in a comment
            elements = [node for node in nodes if isinstance(node, Element)]
            if not elements:
                break
            last = elements[-1]
        elif before.text[last.open_span.end - 1] != ">":
            return ""  # the offset is in a tag
        if last.close_span is not None or last.self_closing or before.text[last.open_span.end - 1] != ">":
            break
        name, nodes = before.text[last.name_span.start : last.name_span.end], last.nodes
    return name


def _end_of_start_tag(document: Document, offset: int) -> str:
    """The text that completes the `/` before the offset: `>` if the `/` is in a start tag and at the end of its line,
    otherwise ""."""
    line = document.text[offset : _line_end(document.text, offset)]
    if line.strip() and not line.lstrip().startswith("<"):
        return ""
    for element in _elements(document):
        if element.name_span.end < offset <= element.open_span.end:
            in_value = any(a.span.start < offset <= a.span.end for a in element.attributes)
            return "" if in_value else ">"
    return ""


def _line_end(text: str, offset: int) -> int:
    return min((at for at in (text.find(end, offset) for end in "\r\n") if at >= 0), default=len(text))


def _elements(document: Document) -> list[Element]:
    roots = [node for node in document.nodes if isinstance(node, Element)]
    return [element for root in roots for element in root.walk()]

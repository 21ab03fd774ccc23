# SPDX-License-Identifier: Apache-2.0
"""The place of a caret in an XML document: a tag, an attribute, a value or content.

The place is determined from the tree. Only `<` and `</` without a name, which the tree does not contain, are searched
for in the text.
"""

from __future__ import annotations

import re
from typing import TypeAlias

from roaml.ide.on_type import open_element
from roaml.ide.syntax import Typed, XmlFile, path_at
from roaml.record import Record
from roaml.regex import regex
from roaml.text import Span
from roaml.xml_syntax import Attribute, CData, Comment, Document, Element, Instruction, Text

_WORD_BEFORE = regex(r"[\w:.-]*\Z")
_WORD_AFTER = regex(r"[\w:.-]*")
_TAG = regex(r"<(/?)([\w:.-]*)\Z")


class StartTag(Record, frozen=True, eq=False):
    """The name of a start tag; `span` may be empty. `bare` is true if no other part of the tag follows the name."""

    parents: tuple[Typed, ...]
    span: Span
    bare: bool


class EndTag(Record, frozen=True, eq=False):
    """The name of an end tag. `name` is the name of the innermost open element, "" if there is none. `bare` is true if
    no `>` follows the caret."""

    name: str
    span: Span
    bare: bool


class AttributeName(Record, frozen=True, eq=False):
    """The name of an attribute of the element `typed`. `attribute` is the attribute at the caret; `None` if a new one
    would be inserted."""

    parents: tuple[Typed, ...]
    typed: Typed
    span: Span
    attribute: Attribute | None


class AttributeValue(Record, frozen=True, eq=False):
    """The value of an attribute. `quote` is its quotation mark, "" if it does not have one yet."""

    parents: tuple[Typed, ...]
    typed: Typed
    attribute: Attribute
    span: Span
    quote: str


class Content(Record, frozen=True, eq=False):
    """A place between tags. `span` is the word at the caret, `text` all character data around it."""

    parents: tuple[Typed, ...]
    span: Span
    text: Span


Place: TypeAlias = StartTag | EndTag | AttributeName | AttributeValue | Content


def place_at(file: XmlFile, offset: int) -> Place | None:
    """The place of a caret; `None` in comments, CDATA sections and instructions."""
    document = file.document
    path = tuple(path_at(file, offset))
    if _is_skipped(document, path, offset):
        return None
    if path and (in_start_tag := _in_start_tag(document.text, path, offset)) is not None:
        return in_start_tag[0]
    if tag := _TAG.search(document.text, max(0, offset - 200), offset):
        return _tag(document, path, tag, offset)
    if path and _in_end_tag(path[-1].element, offset):
        return None
    return _content(document, path, offset)


def _is_skipped(document: Document, path: tuple[Typed, ...], offset: int) -> bool:
    nodes = path[-1].element.nodes if path else document.nodes
    for node in nodes:
        if isinstance(node, (Comment, CData, Instruction)) and node.span.start < offset:
            closed = document.text[: node.span.end].endswith(("-->", "]]>", "?>"))
            if offset < node.span.end or (offset == node.span.end and not closed):
                return True
    return False


def _in_start_tag(text: str, path: tuple[Typed, ...], offset: int) -> tuple[Place | None] | None:
    """A tuple of the place in the start tag of the innermost element, or of `None` if nothing can be completed there;
    `None` instead of a tuple if the caret is not in this tag."""
    typed, parents = path[-1], path[:-1]
    element = typed.element
    end = element.open_span.end
    is_ended = text[:end].endswith(">")
    if not element.open_span.start < offset or (offset >= end if is_ended else offset > end):
        return None
    if offset <= element.name_span.end:
        behind = text[element.name_span.end : end].strip()
        bare = not element.attributes and not behind
        return (StartTag(parents, element.name_span, bare),)
    for attribute in element.attributes:
        if attribute.name_span.start < offset <= attribute.name_span.end:
            return (AttributeName(parents, typed, attribute.name_span, attribute),)
        if attribute.has_value and attribute.value_span.start <= offset <= attribute.value_span.end:
            before = text[attribute.value_span.start - 1]
            quote = before if before in "\"'" else ""
            return (AttributeValue(parents, typed, attribute, attribute.value_span, quote),)
        if offset == attribute.span.end and text[offset - 1] == "=":
            return (AttributeValue(parents, typed, attribute, Span(offset, offset), ""),)
    if not text[offset - 1].isspace():
        return (None,)
    return (AttributeName(parents, typed, Span(offset, offset), None),)


def _tag(document: Document, path: tuple[Typed, ...], tag: re.Match[str], offset: int) -> Place:
    span = Span(tag.start(2), offset)
    behind = document.text[offset : offset + 1]
    if tag[1]:
        return EndTag(open_element(document.text, tag.start()), span, behind != ">")
    return StartTag(path, span, not behind or behind.isspace() or behind == "<")


def _in_end_tag(element: Element, offset: int) -> bool:
    close = element.close_span
    return close is not None and close.start < offset < close.end


def _content(document: Document, path: tuple[Typed, ...], offset: int) -> Content:
    before = _WORD_BEFORE.search(document.text, max(0, offset - 200), offset)
    after = _WORD_AFTER.match(document.text, offset)
    assert before is not None
    assert after is not None
    nodes = path[-1].element.nodes if path else document.nodes
    texts = (node.span for node in nodes if isinstance(node, Text) and node.span.contains(offset))
    return Content(path, Span(before.start(), after.end()), next(texts, Span(offset, offset)))

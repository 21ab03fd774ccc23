# SPDX-License-Identifier: Apache-2.0
"""The elements of an XML text and their texts, for strategies that change texts."""

from __future__ import annotations

from roaml.text import Span
from roaml.xml_syntax import Attribute, Element, parse


def elements_of(text: str) -> list[Element]:
    """All elements, in the order of the text; empty for a text without a root."""
    root = parse(text).root
    return [] if root is None else list(root.walk())


def attributes_of(text: str) -> list[Attribute]:
    return [attribute for element in elements_of(text) for attribute in element.attributes]


def piece(text: str, span: Span) -> str:
    """The text at a span."""
    return text[span.start : span.end]


def put(text: str, span: Span, new: str) -> str:
    """The text with the text at a span replaced."""
    return text[: span.start] + new + text[span.end :]

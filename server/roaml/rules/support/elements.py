# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about elements and attributes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.language import Grammar
from roaml.language.grammar import ElementType
from roaml.xml_syntax import Document, Element


def own_elements(document: Document) -> Iterator[Element]:
    """The elements of a document, parents first, without elements of other namespaces and their content."""
    stack = [document.root] if document.root else []
    while stack:
        element = stack.pop()
        yield element
        stack.extend(child for child in reversed(element.elements) if not child.is_foreign)


def known_elements(document: Document, grammar: Grammar) -> Iterator[tuple[Element, ElementType, Element | None]]:
    """The elements that are where the grammar allows them, each with its declaration and its parent; the parent of the
    root is `None`."""
    root = document.root
    if root is None or root.name not in grammar.roots:
        return
    stack: list[tuple[Element, ElementType, Element | None]] = [(root, grammar.elements[root.name], None)]
    while stack:
        element, type_, parent = stack.pop()
        yield element, type_, parent
        for child in reversed(element.elements):
            child_type = grammar.child(type_, child.name)
            if child_type is not None and not child.is_foreign:
                stack.append((child, child_type, element))


def stands_alone(document: Document, element: Element) -> bool:
    """Whether an element is the only content of a part of an `<if>`."""
    parent = document.path_at(element.name_span.end)[-2:-1]
    if not parent or parent[0].name != "if":
        return False
    siblings = parent[0].elements
    at = siblings.index(element)
    before, behind = siblings[at - 1].name if at else "else", [e.name for e in siblings[at + 1 :]][:1] or ["else"]
    return before in ("else", "elseif") and behind[0] in ("else", "elseif")

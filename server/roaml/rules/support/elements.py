# SPDX-License-Identifier: Apache-2.0
"""What rules about elements and attributes share."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.language import Grammar
from roaml.language.grammar import ElementType
from roaml.language.validate import is_foreign
from roaml.xml_syntax import Document, Element


def own_elements(document: Document) -> Iterator[Element]:
    """The elements of a document, parents first; those of other languages and all in them are left out."""
    namespaces = dict(document.namespaces)
    stack = [document.root] if document.root else []
    while stack:
        element = stack.pop()
        yield element
        stack.extend(child for child in reversed(element.elements) if not is_foreign(namespaces, child))


def known_elements(document: Document, grammar: Grammar) -> Iterator[tuple[Element, ElementType, Element | None]]:
    """The elements that stand where the grammar has them: what they are there, and their parents."""
    root, namespaces = document.root, dict(document.namespaces)
    if root is None or root.name not in grammar.roots:
        return
    stack: list[tuple[Element, ElementType, Element | None]] = [(root, grammar.elements[root.name], None)]
    while stack:
        element, type_, parent = stack.pop()
        yield element, type_, parent
        for child in reversed(element.elements):
            child_type = grammar.child(type_, child.name)
            if child_type is not None and not is_foreign(namespaces, child):
                stack.append((child, child_type, element))


def stands_alone(document: Document, element: Element) -> bool:
    """Whether an element is all that a part of an `<if>` holds."""
    parent = document.path_at(element.name_span.end)[-2:-1]
    if not parent or parent[0].name != "if":
        return False
    siblings = parent[0].elements
    at = siblings.index(element)
    before, behind = siblings[at - 1].name if at else "else", [e.name for e in siblings[at + 1 :]][:1] or ["else"]
    return before in ("else", "elseif") and behind[0] in ("else", "elseif")

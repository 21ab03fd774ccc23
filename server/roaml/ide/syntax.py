# SPDX-License-Identifier: Apache-2.0
"""A file as XML with its grammar, and the expressions in it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from roaml.language import ElementType, Grammar
from roaml.model.kinds import GRAMMARS
from roaml.model.syntax import Expression, expression_from
from roaml.project.analysis import Analysis
from roaml.roles import ValueRole
from roaml.text import Decoded
from roaml.xml_syntax import Document, Element

_EXPRESSIONS = (ValueRole.EXPRESSION, ValueRole.LOCATION, ValueRole.CONSTANT)


class XmlFile(NamedTuple):
    document: Document
    grammar: Grammar


class Typed(NamedTuple):
    """An element with its type in the grammar, which is `None` for unknown elements."""

    element: Element
    type: ElementType | None


def xml_file(analysis: Analysis, path: str) -> XmlFile | None:
    """A file in one of the supported XML languages; `None` for other files."""
    grammar = GRAMMARS.get(analysis.kind(path))
    document = analysis.document(path) if grammar else None
    return None if grammar is None or document is None else XmlFile(document, grammar)


def walk(file: XmlFile) -> Iterator[Typed]:
    """All elements of a file with their types, in document order."""
    stack = [_typed(file.grammar, None, typed) for typed in _roots(file.document)][::-1]
    while stack:
        typed = stack.pop()
        yield typed
        stack += [_typed(file.grammar, typed.type, child) for child in reversed(typed.element.elements)]


def path_at(file: XmlFile, offset: int) -> list[Typed]:
    """The elements around an offset, outermost first."""
    path: list[Typed] = []
    for element in file.document.path_at(offset):
        path.append(_typed(file.grammar, path[-1].type if path else None, element))
    return path


def expression_sources(document: Document, typed: Typed) -> Iterator[Decoded]:
    """The expressions in the attributes and in the text of an element, in the order of the text."""
    element, type_ = typed
    if type_ is None:
        return
    for attribute in element.attributes:
        known = type_.attributes.get(attribute.name)
        if known is not None and known.value in _EXPRESSIONS and attribute.has_value:
            yield document.decoded(attribute.value_span)
    if type_.value in _EXPRESSIONS and (source := document.content(element)):
        yield source


def expressions(document: Document, typed: Typed) -> Iterator[Expression]:
    """The expressions of an element, in the order of the text."""
    return (expression_from(source) for source in expression_sources(document, typed))


def expression_at(file: XmlFile, offset: int) -> Expression | None:
    """The expression around an offset; `None` if there is none. An offset at the end of an expression is inside it."""
    around = path_at(file, offset)
    return expression_in(file.document, around[-1], offset) if around else None


def expression_in(document: Document, typed: Typed, offset: int) -> Expression | None:
    """The expression of the element `typed` around an offset; `None` if there is none. The offset must not be in a
    child of the element."""
    sources = expression_sources(document, typed)
    source = next((s for s in sources if s.span(0, len(s.text)).contains(offset)), None)
    return None if source is None else expression_from(source)


def _roots(document: Document) -> list[Element]:
    return [node for node in document.nodes if isinstance(node, Element)]


def _typed(grammar: Grammar, parent: ElementType | None, element: Element) -> Typed:
    """An element with the type that it has as a child of `parent`; if it is not allowed there, with the type of any
    element with its name."""
    known = grammar.child(parent, element.name) if parent else None
    return Typed(element, known or grammar.find(element.name))

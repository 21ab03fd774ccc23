# SPDX-License-Identifier: Apache-2.0
"""Hover texts, as Markdown.

A name is described by its symbol; other elements, attributes, values, functions and operators by their description in
the language.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from roaml.expr.types import Struct, parse_type, resolve_type
from roaml.ide.describe import describe
from roaml.ide.describe import language as describe_language
from roaml.ide.describe.machine import protocol, rate
from roaml.ide.describe.markdown import paragraphs
from roaml.ide.hover.expression import in_expression
from roaml.ide.hover.property_file import global_variable, in_json
from roaml.ide.hover.system_file import listed_file, parameter
from roaml.ide.hover.tree import node_at
from roaml.ide.names.lookup import occurrences_at, systems_of
from roaml.ide.syntax import XmlFile, path_at, xml_file
from roaml.language import AttributeType
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.text import Span
from roaml.xml_syntax import Attribute, Element

SEPARATOR = "\n\n---\n\n"


@dataclass(frozen=True, slots=True)
class Hover:
    """`span` is what `text` is about."""

    span: Span
    text: str


def hover(analysis: Analysis, path: str, offset: int) -> Hover | None:
    """The hover at a place; `None` if there is none."""
    source = analysis.source(path)
    found = occurrences_at(analysis, path, offset) if source else ()
    known = dict.fromkeys(
        describe(analysis, each.symbol, source.text[each.span.start : each.span.end] if source else "")
        for each in found
    )
    known.pop("", None)
    text, is_property = SEPARATOR.join(known), analysis.kind(path) is FileKind.PROPERTIES
    span = found[0].span if known else None
    for more_span, more in _around(analysis, path, offset, bool(known)):
        if more and more not in text:
            span = more_span if span is None else span
            text = SEPARATOR.join(filter(None, (more, text))) if is_property else paragraphs(text, more)
    return Hover(span, text) if span is not None and text else None


def _around(analysis: Analysis, path: str, offset: int, has_name: bool) -> Iterator[tuple[Span, str]]:
    """Further information. With a name, only what adds to the description of the name."""
    kind = analysis.kind(path)
    if kind in (FileKind.PROPERTIES, FileKind.JANI_MODEL):
        found = global_variable(analysis, path, offset) or (None if has_name else in_json(analysis, path, offset))
        if found is not None:
            yield found
    file = xml_file(analysis, path)
    if file is not None and not has_name:
        yield from _written(analysis, path, file, offset)
    if kind is FileKind.TREE and (node := node_at(analysis, path, offset)):
        yield node


def _written(analysis: Analysis, path: str, file: XmlFile, offset: int) -> Iterator[tuple[Span, str]]:
    """The description of a part of the language."""
    found = in_expression(analysis, path, file, offset) or listed_file(analysis, path, offset)
    if found is not None and found[1]:
        yield found
        return
    around = path_at(file, offset)
    element, type_ = around[-1] if around else (None, None)
    if element is None or type_ is None:
        return
    for tag in (element.name_span, element.close_name_span):
        if tag is not None and tag.contains(offset):
            yield tag, paragraphs(describe_language.element(type_), protocol(analysis, path, type_))
            return
    for attribute in element.attributes:
        known = type_.attributes.get(attribute.name)
        if known is not None and attribute.name_span.contains(offset):
            yield attribute.name_span, describe_language.attribute(known)
        elif known is not None and attribute.has_value and attribute.value_span.contains(offset):
            yield attribute.value_span, _value(analysis, path, element, attribute, known)


def _value(analysis: Analysis, path: str, element: Element, attribute: Attribute, known: AttributeType) -> str:
    """The description of a value; if there is none, that of its attribute."""
    system = analysis.system_file(path)
    chosen = next((each for each in known.simple.choices if each.value == attribute.value.strip()), None)
    said = ""
    if system is not None:
        said = parameter(element, attribute)
    elif known.value == "type":
        said = _type(analysis, path, attribute.value.strip())
    elif attribute.name == "rate_hz":
        said = rate(attribute.value)
    if chosen is not None:
        return paragraphs(describe_language.choice(chosen), said)
    return paragraphs(said or describe_language.attribute(known))


def _type(analysis: Analysis, path: str, written: str) -> str:
    name = parse_type(written)
    structs = analysis.structs(systems_of(analysis, path)[0])
    type_ = resolve_type(name, structs.types.get) if name else None
    return "" if type_ is None or isinstance(type_, Struct) else describe_language.type_(type_)

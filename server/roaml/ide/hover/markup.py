# SPDX-License-Identifier: Apache-2.0
"""Hover texts for elements, attributes and values, from the documentation of the schemas."""

from __future__ import annotations

from roaml.expr.types import Struct, parse_type, resolve_type
from roaml.ide.describe import language as describe_language
from roaml.ide.describe.machine import protocol, rate
from roaml.ide.describe.markdown import paragraphs
from roaml.ide.describe.system_parameter import parameter
from roaml.ide.hover.place import Place
from roaml.language import AttributeType
from roaml.model.kinds import FileKind
from roaml.roles import ValueRole
from roaml.text import Span
from roaml.xml_syntax import Attribute, Element


def in_markup(place: Place) -> tuple[Span, str] | None:
    """The description of the tag, attribute or value at a place; `None` elsewhere."""
    element, type_ = place.elements[-1] if place.elements else (None, None)
    if element is None or type_ is None:
        return None
    for tag in (element.name_span, element.close_name_span):
        if tag is not None and tag.contains(place.offset):
            return tag, paragraphs(describe_language.element(type_), protocol(place.analysis, place.path, type_))
    for attribute in element.attributes:
        known = type_.attributes.get(attribute.name)
        if known is not None and attribute.name_span.contains(place.offset):
            return attribute.name_span, describe_language.attribute(known)
        if known is not None and attribute.has_value and attribute.value_span.contains(place.offset):
            return attribute.value_span, _value(place, element, attribute, known)
    return None


def _value(place: Place, element: Element, attribute: Attribute, known: AttributeType) -> str:
    """The description of a value; if there is none, the description of its attribute."""
    chosen = next((choice for choice in known.simple.choices if choice.value == attribute.value.strip()), None)
    description = ""
    if place.kind is FileKind.SYSTEM:
        description = parameter(element, attribute)
    elif known.value is ValueRole.TYPE:
        description = _type(place, attribute.value.strip())
    elif attribute.name == "rate_hz":
        description = rate(attribute.value)
    if chosen is not None:
        return paragraphs(describe_language.choice(chosen), description)
    return paragraphs(description or describe_language.attribute(known))


def _type(place: Place, written: str) -> str:
    name = parse_type(written)
    structs = place.analysis.structs(place.systems[0])
    type_ = resolve_type(name, structs.types.get) if name else None
    return "" if type_ is None or isinstance(type_, Struct) else describe_language.type_(type_)

# SPDX-License-Identifier: Apache-2.0
"""Hover texts in a property file or JANI model: operators, keys, formulas, numbers, global variables."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.ide.describe import property_file as describe_properties
from roaml.ide.describe import system as describe_system
from roaml.ide.describe.markdown import code, lines, paragraphs
from roaml.ide.describe.markdown import name as markdown_name
from roaml.ide.hover.place import Place
from roaml.ide.json_tree import members
from roaml.json_syntax import JsonArray, JsonNumber, JsonObject, JsonString, JsonValue, Member
from roaml.language.json_schema import PROPERTIES, Schema
from roaml.model.tree_paths import label_of
from roaml.text import Span


def global_variable(place: Place) -> tuple[Span, str] | None:
    """The descriptions of the global variable whose name is at a place, in each system of the file; `None` if there is
    none."""
    analysis, offset = place.analysis, place.offset
    value = analysis.json(place.path)
    hovered = value_at(value[0], offset) if value else None
    if not isinstance(hovered, JsonString) or not hovered.content_span.contains(offset):
        return None
    texts: dict[str, None] = {}
    for owner in place.systems:
        system = analysis.system(owner) if owner else None
        variable = analysis.globals(owner).get(hovered.value) if owner else None
        if system is not None and variable is not None:
            node = describe_system.node_of(system, hovered.value)
            about = describe_system.node(system, node) if node else ""
            label = label_of(system, node.instance) if node and node.instance else ""
            who = f"Node {markdown_name(label)} of the tree" if label else ""
            texts[paragraphs(describe_properties.global_variable(variable), lines(who, about))] = None
    return (hovered.content_span, paragraphs(*texts)) if texts else None


def in_json(place: Place) -> tuple[Span, str] | None:
    """The description of the key, number or operator at a place, or the formula of the property whose name is there;
    `None` if there is none."""
    value, offset = place.analysis.json(place.path), place.offset
    if value is None:
        return None
    for schema, owner, member in _members_at(value[0], offset):
        if isinstance(member.value, JsonNumber) and member.value.span.contains(offset):
            text = describe_properties.number(member.value, members(owner))
            return (member.value.span, text) if text else None
        known = PROPERTIES.keys(schema, owner).get(member.key)
        if member.key_span.contains(offset):
            return (member.key_span, describe_properties.member(known)) if known else None
        text_value = member.value
        if not isinstance(text_value, JsonString) or not text_value.content_span.contains(offset):
            continue
        text = ""
        if member.key == "op":
            head = code(describe_properties.formula(owner))
            description = describe_properties.operator(text_value.value)
            text = paragraphs(head, description) if description else ""
        elif member.key == "name" and PROPERTIES.is_a(schema, "property"):
            expression = members(owner).get("expression")
            text = code(describe_properties.formula(expression)) if expression else ""
        elif known is not None and known.name in ("fun", "constant", "distribution"):
            text = describe_properties.member(known)
        return (text_value.content_span, text) if text else None
    return None


def value_at(value: JsonValue, offset: int) -> JsonValue | None:
    """The innermost value around an offset; `None` at a key, and between a key and its value."""
    innermost: JsonValue | None = value
    while innermost is not None:
        if isinstance(innermost, JsonObject):
            member = next((candidate for candidate in innermost.members if candidate.span.contains(offset)), None)
            if member is None:
                return innermost
            if member.key_span.contains(offset) or member.value is None or not member.value.span.contains(offset):
                return None
            innermost = member.value
        elif isinstance(innermost, JsonArray):
            inner = next((item for item in innermost.items if item.span.contains(offset)), None)
            if inner is None:
                return innermost
            innermost = inner
        else:
            return innermost if innermost.span.contains(offset) else None
    return None


def _members_at(value: JsonValue, offset: int) -> Iterator[tuple[Schema, JsonObject, Member]]:
    """The members around an offset, innermost first, with their objects and their declarations in the schema."""
    around: list[tuple[Schema, JsonObject, Member]] = []
    schema, inner = PROPERTIES.root, value
    while True:
        if isinstance(inner, JsonArray):
            schema = PROPERTIES.item(schema, inner)
            item = next((candidate for candidate in inner.items if candidate.span.contains(offset)), None)
            if item is None:
                break
            inner = item
        elif isinstance(inner, JsonObject):
            member = next((candidate for candidate in inner.members if candidate.span.contains(offset)), None)
            if member is None:
                break
            if any(inner.get(key) for key in _OF_FORMULAS):
                schema = PROPERTIES.definition("formula")
            around.append((schema, inner, member))
            if member.value is None:
                break
            schema, inner = PROPERTIES.member(schema, inner, member.key), member.value
        else:
            break
    yield from reversed(around)


_OF_FORMULAS = ("op", "constant", "distribution")
"""Keys that occur only in formulas and expressions, including those outside of the properties of a JANI model."""

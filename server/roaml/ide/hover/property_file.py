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
    """The global variable whose name is at a place, in each system of the file."""
    analysis, offset = place.analysis, place.offset
    value = analysis.json(place.path)
    found = value_at(value[0], offset) if value else None
    if not isinstance(found, JsonString) or not found.content_span.contains(offset):
        return None
    texts: dict[str, None] = {}
    for each in place.systems:
        system = analysis.system(each) if each else None
        variable = analysis.globals(each).get(found.value) if each else None
        if system is not None and variable is not None:
            node = describe_system.node_of(system, found.value)
            about = describe_system.node(system, node) if node else ""
            label = label_of(system, node.instance) if node and node.instance else ""
            who = f"Node {markdown_name(label)} of the tree" if label else ""
            texts[paragraphs(describe_properties.global_variable(variable), lines(who, about))] = None
    return (found.content_span, paragraphs(*texts)) if texts else None


def in_json(place: Place) -> tuple[Span, str] | None:
    """The description of a key or an operator in the syntax of properties; the formula of a property."""
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
        held = member.value
        if not isinstance(held, JsonString) or not held.content_span.contains(offset):
            continue
        text = ""
        if member.key == "op":
            head = code(describe_properties.formula(owner))
            said = describe_properties.operator(held.value)
            text = paragraphs(head, said) if said else ""
        elif member.key == "name" and PROPERTIES.is_a(schema, "property"):
            expression = members(owner).get("expression")
            text = code(describe_properties.formula(expression)) if expression else ""
        elif known is not None and known.name in ("fun", "constant", "distribution"):
            text = describe_properties.member(known)
        return (held.content_span, text) if text else None
    return None


def value_at(value: JsonValue, offset: int) -> JsonValue | None:
    """The innermost value around an offset; None on keys and between values."""
    found: JsonValue | None = value
    while found is not None:
        if isinstance(found, JsonObject):
            member = next((each for each in found.members if each.span.contains(offset)), None)
            if member is None:
                return found
            if member.key_span.contains(offset) or member.value is None or not member.value.span.contains(offset):
                return None
            found = member.value
        elif isinstance(found, JsonArray):
            inner = next((each for each in found.items if each.span.contains(offset)), None)
            if inner is None:
                return found
            found = inner
        else:
            return found if found.span.contains(offset) else None
    return None


def _members_at(value: JsonValue, offset: int) -> Iterator[tuple[Schema, JsonObject, Member]]:
    """The members around an offset, innermost first, with their objects and their declarations in the schema."""
    found: list[tuple[Schema, JsonObject, Member]] = []
    schema, inner = PROPERTIES.root, value
    while True:
        if isinstance(inner, JsonArray):
            schema = PROPERTIES.item(schema, inner)
            item = next((each for each in inner.items if each.span.contains(offset)), None)
            if item is None:
                break
            inner = item
        elif isinstance(inner, JsonObject):
            member = next((each for each in inner.members if each.span.contains(offset)), None)
            if member is None:
                break
            if any(inner.get(key) for key in _OF_FORMULAS):
                schema = PROPERTIES.definition("formula")
            found.append((schema, inner, member))
            if member.value is None:
                break
            schema, inner = PROPERTIES.member(schema, inner, member.key), member.value
        else:
            break
    yield from reversed(found)


_OF_FORMULAS = ("op", "constant", "distribution")
"""Keys that only formulas have, also in the parts of a model that are not properties."""

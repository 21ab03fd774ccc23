# SPDX-License-Identifier: Apache-2.0
"""The tables of the languages are equal to the content of the schemas that an independent reader, xmlschema, finds."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest
import xmlschema
from lxml import etree

from roaml.language import BEHAVIOR_TREE, HL_SCXML, PLAIN_SCXML, STRUCTS, SYSTEM, XML_PROPERTIES
from roaml.language.grammar import AttributeType, ElementType, Grammar, Multiplicity
from roaml.language.resources import schema_path
from roaml.roles import UNBOUNDED, SymbolKind, ValueRole

GRAMMARS = [HL_SCXML, PLAIN_SCXML, SYSTEM, STRUCTS, XML_PROPERTIES, BEHAVIOR_TREE]
XS = "{http://www.w3.org/2001/XMLSchema}"

each_grammar = pytest.mark.parametrize("grammar", GRAMMARS, ids=lambda grammar: grammar.schema)


@cache
def independent(schema: str) -> Any:
    return xmlschema.XMLSchema(str(schema_path(schema)))


def pairs(grammar: Grammar) -> Iterator[tuple[str, ElementType, Any]]:
    """Every element of the grammar, local ones included, in both readings, with the path to it."""
    schema = independent(grammar.schema)
    waiting = [(name, grammar.elements[name], schema.elements[name]) for name in grammar.elements]
    while waiting:
        path, ours, theirs = waiting.pop()
        yield path, ours, theirs
        for child in particles(theirs):
            if child.name in ours.local:
                waiting.append((f"{path}/{child.name}", ours.local[child.name], child))


def particles(element: Any) -> list[Any]:
    """The named children that an element may contain."""
    content = element.type.content
    return [c for c in content.iter_elements() if c.name is not None] if hasattr(content, "iter_elements") else []


@each_grammar
def test_elements(grammar: Grammar) -> None:
    assert grammar.elements.keys() == set(independent(grammar.schema).elements)
    assert set(grammar.roots) <= grammar.elements.keys()


@each_grammar
def test_every_kind_of_element_is_compared(grammar: Grammar) -> None:
    declared = etree.parse(str(schema_path(grammar.schema))).iter(f"{XS}element")
    assert {ours.name for _, ours, _ in pairs(grammar)} == {node.get("name") for node in declared if node.get("name")}


@each_grammar
def test_attributes(grammar: Grammar) -> None:
    for path, ours, theirs in pairs(grammar):
        known = {name: a for name, a in theirs.attributes.items() if name is not None}
        assert set(ours.attributes) == set(known), path
        wildcard = theirs.attributes.get(None)
        assert ours.any_attribute is (wildcard is not None and "##any" in wildcard.namespace), path
        for name, attribute in known.items():
            compare_attribute(f"{path}@{name}", ours.attributes[name], attribute)


def compare_attribute(place: str, ours: AttributeType, theirs: Any) -> None:
    assert ours.name == theirs.name
    assert ours.required is (theirs.use == "required"), place
    assert ours.documentation == documentation(theirs.elem), place
    values = tuple(theirs.type.enumeration or ())
    assert tuple(choice.value for choice in ours.simple.choices) == values, place
    base, facets = facets_of(theirs.type)
    assert ours.simple.base == base, place
    assert ours.simple.pattern == facets.get("pattern", ""), place
    assert ours.simple.non_empty is ("minLength" in facets), place
    numbers = (ours.simple.above, ours.simple.least, ours.simple.most)
    expected = (facets.get("minExclusive"), facets.get("minInclusive"), facets.get("maxInclusive"))
    assert numbers == tuple(None if limit is None else float(limit) for limit in expected), place
    assert facets.keys() <= {"enumeration", "pattern", "minLength", "minExclusive", "minInclusive", "maxInclusive"}


def facets_of(type_: Any) -> tuple[str, dict[str, Any]]:
    """The type of XML Schema that a type restricts, and by what."""
    if type_.name and type_.name.startswith(XS):
        return type_.local_name, {}
    facets = {}
    for name, facet in type_.facets.items():
        local = etree.QName(name).localname if name else ""
        if local != "whiteSpace" and facet is not None:
            facets[local] = facet.regexps[0] if local == "pattern" else getattr(facet, "value", None)
    base, more = facets_of(type_.base_type)
    assert not more
    return base, facets


def documentation(node: Any) -> str:
    return (node.findtext(f"{XS}annotation/{XS}documentation") or "").strip()


@each_grammar
def test_content(grammar: Grammar) -> None:
    for path, ours, theirs in pairs(grammar):
        names = {child.name for child in particles(theirs)}
        assert set(ours.children) == names, path
        for name in names:
            assert ours.children[name] == occurrence(theirs.type.content, name), f"{path}/{name}"
        assert ours.text is bool(theirs.type.mixed or theirs.type.has_simple_content()), path
        assert ours.any_child == wildcard_of(theirs), path


def occurrence(particle: Any, name: str | None) -> Multiplicity:
    """How often `name` may occur in a particle; `None` means elements with any name."""
    least, most = particle.min_occurs, UNBOUNDED if particle.max_occurs is None else particle.max_occurs
    if is_wildcard(particle):
        return Multiplicity(least, most) if name is None else Multiplicity(0, 0)
    if not hasattr(particle, "model"):
        return Multiplicity(least, most) if particle.name == name else Multiplicity(0, 0)
    inner = [occurrence(child, name) for child in particle] or [Multiplicity(0, 0)]
    together = max if particle.model == "choice" else sum
    fewest = min(o.least for o in inner) if particle.model == "choice" else sum(o.least for o in inner)
    return Multiplicity(fewest * least, min(UNBOUNDED, together(o.most for o in inner) * most))


def is_wildcard(particle: Any) -> bool:
    return bool(particle.elem.tag == f"{XS}any")


def wildcard_of(element: Any) -> Multiplicity | None:
    content = element.type.content
    if not hasattr(content, "iter_elements"):
        return None
    if not any(is_wildcard(c) and "##other" not in c.namespace for c in content.iter_elements()):
        return None
    return occurrence(content, None)


# ------------------------------------------------------------ documentation and roles


@each_grammar
def test_everything_is_documented(grammar: Grammar) -> None:
    for path, ours, theirs in pairs(grammar):
        assert ours.documentation == documentation(theirs.elem), path
        assert ours.documentation, path
        for attribute in ours.attributes.values():
            assert attribute.documentation, f"{path}@{attribute.name}"
            for choice in attribute.simple.choices:
                assert choice.documentation, f"{path}@{attribute.name}={choice.value}"


VALUE_TYPES = {"", "bool", "int", "any", "msg", "srv", "action"}
ELSEWHERE = {SymbolKind.TOPIC, SymbolKind.SERVICE, SymbolKind.ACTION, SymbolKind.FIELD, SymbolKind.PLUGIN}
"""Kinds of symbols that no attribute of a language defines: names in the ROS graph, fields of its types, machines as
plugins."""


def test_roles_are_those_that_tools_know() -> None:
    every = [ours for grammar in GRAMMARS for _, ours, _ in pairs(grammar)]
    attributes = [attribute for element in every for attribute in element.attributes.values()]
    defined = {attribute.defines for attribute in attributes} - {None}
    assert {kind for a in attributes for kind in a.refers} | {k for e in every for k in e.refers} <= defined | ELSEWHERE
    assert {a.value for a in attributes} | {e.value for e in every} == {*ValueRole, None}
    assert {a.value_type for a in attributes} | {e.value_type for e in every} <= VALUE_TYPES
    assert all(
        attribute.value_type
        for attribute in attributes
        if attribute.value in (ValueRole.EXPRESSION, ValueRole.ROS_TYPE)
    )


PORT_MODEL = ("type", "default", "description")
PLAIN = {
    "ascxml.xsd": {"log@expr", "log@label"},
    "roaml.xsd": {
        *("max_time@reaction_time", "input@namespace", "remap@from", "remap@to", "channel@delay", "channel@step"),
    },
    "structs.xsd": set(),
    "properties.xsd": {"property@expect", "property@expr", "clock@topic_name", "clock@type"},
    "behaviortree.xsd": {
        *("root@BTCPP_format", "include@ros_pkg"),
        *(f"{port}@{name}" for port in ("input_port", "output_port", "inout_port") for name in PORT_MODEL),
    },
}
"""Attributes with values that denote no symbol. A new attribute belongs to this list, or needs a role."""


@pytest.mark.parametrize("grammar", [g for g in GRAMMARS if g is not PLAIN_SCXML], ids=lambda grammar: grammar.schema)
def test_every_attribute_has_a_role_or_is_plain(grammar: Grammar) -> None:
    without = {
        f"{ours.name}@{attribute.name}"
        for _, ours, _ in pairs(grammar)
        for attribute in ours.attributes.values()
        if not has_role(attribute)
    }
    assert without == PLAIN[grammar.schema]


def has_role(attribute: AttributeType) -> bool:
    says = attribute.defines or attribute.refers or attribute.value or attribute.port or attribute.use
    return bool(says) or attribute.ignored is not None or bool(attribute.simple.choices)


@each_grammar
def test_successors_exist(grammar: Grammar) -> None:
    for path, ours, _ in pairs(grammar):
        assert not ours.use or ours.use in grammar.elements, path
        for attribute in ours.attributes.values():
            known = ours.attributes.keys() | {"_autoremap"}
            assert not attribute.use or attribute.use in known, f"{path}@{attribute.name}"
            values = {choice.value for choice in attribute.simple.choices}
            assert {choice.use for choice in attribute.simple.choices} - {""} <= values


# ------------------------------------------------------------------- looking things up

PATHS = [
    (HL_SCXML, "scxml state transition", "transition"),
    (HL_SCXML, "ascxml datamodel data", "data"),
    (HL_SCXML, "ascxml data", None),
    (HL_SCXML, "state", None),
    (HL_SCXML, "", None),
    (HL_SCXML, "ascxml nothing state", None),
    (SYSTEM, "roaml parameters max_time", "max_time"),
    (SYSTEM, "roaml max_time", None),
    (BEHAVIOR_TREE, "root BehaviorTree Sequence", "Sequence"),
    (BEHAVIOR_TREE, "root BehaviorTree Sequence MyOwnNode", None),
]


@pytest.mark.parametrize(("grammar", "path", "name"), PATHS)
def test_element_at(grammar: Grammar, path: str, name: str | None) -> None:
    element_type = grammar.element_at(path.split())
    assert (element_type.name if element_type else None) == name


def test_find_and_parents() -> None:
    assert HL_SCXML.find("assign") is HL_SCXML.elements["assign"]
    assert HL_SCXML.find("nothing") is None
    assert "transition" in HL_SCXML.parents("assign")
    assert HL_SCXML.parents("nothing") == ()
    for grammar in GRAMMARS:
        for path, ours, _ in pairs(grammar):
            assert grammar.find(ours.name) is not None, path


@pytest.mark.parametrize(
    "name",
    [
        "ascxml.xsd",
        "ascxml-namespace.xsd",
        "roaml.xsd",
        "behaviortree.xsd",
        "structs.xsd",
        "properties.xsd",
        "scxml.xsd",
    ],
)
def test_plain_lxml_reads_the_schema(name: str) -> None:
    etree.XMLSchema(etree.parse(str(schema_path(name))))

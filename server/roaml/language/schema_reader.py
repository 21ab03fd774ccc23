# SPDX-License-Identifier: Apache-2.0
"""Reads a schema into the tables of a grammar, for `docs/build.py`.

Only the part of XML Schema that the schemas in `schemas/` use is supported; the tests compare the tables with
`xmlschema`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from lxml import etree

from roaml.language.grammar import (
    AttributeType,
    Binding,
    ElementType,
    Multiplicity,
    PortType,
    SchemaTables,
    SimpleType,
    ValueChoice,
)
from roaml.language.resources import schema_path
from roaml.record import Record, field
from roaml.roles import UNBOUNDED, Direction, NodeKind, ProtocolPart, SymbolKind, ValuePart, ValueRole

_XS = "{http://www.w3.org/2001/XMLSchema}"
_R = "{urn:roaml:roles}"
_PARTICLES = ("sequence", "choice", "all", "group", "element", "any")
_KNOWN_BASES = ("string", "token", "integer", "nonNegativeInteger", "positiveInteger", "decimal", "double")
"""The types of XML Schema for which `roaml.language.validate.unmet` finds all invalid values."""


def read_schema(schema: str) -> SchemaTables:
    """The tables of a file of `schemas/`."""
    reader = _Reader(schema)
    return SchemaTables(reader.elements, reader.group_names())


class _Shape(Record):
    """The parts of a complex type that have been read so far."""

    attributes: dict[str, AttributeType] = field(default_factory=dict)
    children: dict[str, Multiplicity] = field(default_factory=dict)
    local: dict[str, ElementType] = field(default_factory=dict)
    any_child: Multiplicity | None = None
    any_is_opaque: bool = False
    any_attribute: bool = False
    text: bool = False


class _Reader:
    """Reads one schema file into tables."""

    def __init__(self, schema: str) -> None:
        top = etree.parse(str(schema_path(schema))).getroot()
        self.named: dict[tuple[str, str], Any] = {
            (_local(node), name): node for node in top if isinstance(node.tag, str) and (name := node.get("name"))
        }
        self.elements = {name: self.element(node) for (kind, name), node in self.named.items() if kind == "element"}

    def group_names(self) -> dict[str, tuple[str, ...]]:
        return {
            name: tuple(child.get("ref") for child in node.iter(f"{_XS}element"))
            for (kind, name), node in self.named.items()
            if kind == "group"
        }

    def element(self, node: Any) -> ElementType:
        shape = _Shape()
        complex_type = node.find(f"{_XS}complexType")
        if complex_type is None and ("complexType", node.get("type")) in self.named:
            complex_type = self.named["complexType", node.get("type")]
        assert complex_type is not None, "an element with a value of its own is not supported"
        assert complex_type.find(f"{_XS}simpleContent") is None
        self.collect(complex_type, shape, Multiplicity(1, 1))
        roles = dict(_roles(node))
        ignored, deprecated = roles.get("ignored"), roles.get("deprecated")
        tree_node = roles.get("node", {})
        value = roles.get("value", {})
        return ElementType(
            node.get("name"),
            _documentation(node),
            shape.attributes,
            shape.children,
            shape.local,
            shape.any_child,
            shape.any_is_opaque,
            shape.any_attribute,
            shape.text,
            refers=_symbols(roles.get("refers")),
            value=_value_role(value),
            value_type=value.get("type", ""),
            sends=_part(roles.get("sends")),
            receives=_part(roles.get("receives")),
            code=int({**roles.get("sends", {}), **roles.get("receives", {})}.get("code", "0")),
            binds=tuple(_binding(r) for kind, r in _roles(node) if kind == "binds"),
            ignored=ignored is not None,
            use=deprecated["use"] if deprecated else "",
            node=NodeKind(kind) if (kind := tree_node.get("kind")) else None,
            translated=tree_node.get("translated") != "false",
            program_only=tree_node.get("program-only") == "true",
            order=self.order(complex_type),
        )

    def order(self, complex_type: Any) -> str:
        """`ElementType.order`."""
        parts = list(self.particles(complex_type))
        return "" if len(parts) < 2 and all(map(self.is_counted, parts)) else "".join(map(self.expression, parts))

    def particles(self, node: Any) -> Iterator[Any]:
        """The particles of a complex type, or of a part of one. Elements of foreign namespaces are ignored."""
        for part in node:
            kind = _local(part) if isinstance(part.tag, str) else ""
            if kind in ("complexContent", "extension"):
                if part.get("base"):
                    yield from self.particles(self.named["complexType", part.get("base")])
                yield from self.particles(part)
            elif kind in _PARTICLES and (kind != "any" or part.get("namespace") is None):
                yield part

    def is_counted(self, part: Any) -> bool:
        """Whether the number of children with each name determines whether they are valid, if `part` is all that an
        element may contain."""
        kind = _local(part)
        if kind in ("element", "any", "all"):
            return True
        parts = [self.group(part)] if kind == "group" else list(self.particles(part))
        once = ("1", "1")
        if len(parts) == 1 and once in (_occurs(part), _occurs(parts[0])) and _occurs(part) in (once, ("0", "1")):
            return self.is_counted(parts[0])
        return kind != "sequence" and _occurs(part) == ("0", "unbounded") and all(map(self.is_one, parts))

    def is_one(self, part: Any) -> bool:
        """Whether `part` accepts each of its children alone."""
        kind = _local(part)
        if kind in ("element", "any"):
            return _occurs(part) == ("1", "1")
        inner = [self.group(part)] if kind == "group" else list(self.particles(part))
        return _occurs(part) == ("1", "1") and kind in ("choice", "group") and all(map(self.is_one, inner))

    def group(self, reference: Any) -> Any:
        (content,) = self.particles(self.named["group", reference.get("ref")])
        return content

    def expression(self, part: Any) -> str:
        """A regular expression for the names that `part` accepts, each with a space behind it."""
        kind = _local(part)
        if kind == "element":
            accepted = re.escape(part.get("ref") or part.get("name")) + " "
        elif kind == "any":
            accepted = r"\S+ "
        elif kind == "group":
            accepted = self.expression(self.group(part))
        else:
            assert kind != "all", "`all` is the only particle of a type"
            accepted = ("|" if kind == "choice" else "").join(map(self.expression, self.particles(part)))
        least, most = _occurs(part)
        times = "" if (least, most) == ("1", "1") else f"{{{least},{most.removeprefix('unbounded')}}}"
        return f"(?:{accepted}){times}" if times or kind == "choice" else accepted

    def collect(self, node: Any, shape: _Shape, occurs: Multiplicity) -> None:
        """Add the attributes and children that `node` declares to `shape`. `node` is a part of a complex type and may
        occur `occurs` times."""
        if node.get("mixed") == "true":
            shape.text = True
        for part in node:
            if not isinstance(part.tag, str):
                continue
            kind = _local(part)
            if kind in ("sequence", "choice", "all"):
                inner = _times(part, occurs)
                if kind == "choice" and len([p for p in part if isinstance(p.tag, str)]) > 1:
                    inner = Multiplicity(0, inner.most)
                self.collect(part, shape, inner)
            elif kind == "group":
                self.collect(self.named["group", part.get("ref")], shape, _times(part, occurs))
            elif kind == "element":
                self.child(part, shape, _times(part, occurs))
            elif kind == "any" and part.get("namespace") is None:
                shape.any_child = _times(part, occurs)
                shape.any_is_opaque = part.get("processContents") == "skip"
            elif kind in ("complexContent", "extension"):
                base = part.get("base")
                if base:
                    self.collect(self.named["complexType", base], shape, occurs)
                self.collect(part, shape, occurs)
            elif kind == "attributeGroup":
                self.collect(self.named["attributeGroup", part.get("ref")], shape, occurs)
            elif kind == "attribute":
                shape.attributes[part.get("name")] = self.attribute(part)
            elif kind == "anyAttribute" and part.get("namespace") is None:
                shape.any_attribute = True

    def child(self, node: Any, shape: _Shape, occurs: Multiplicity) -> None:
        name = node.get("ref") or node.get("name")
        if node.get("name"):
            shape.local[name] = self.element(node)
        if name in shape.children:
            before = shape.children[name]
            occurs = Multiplicity(min(before.least, occurs.least), min(UNBOUNDED, before.most + occurs.most))
        shape.children[name] = occurs

    def attribute(self, node: Any) -> AttributeType:
        roles = dict(_roles(node))
        value, ignored, port = roles.get("value", {}), roles.get("ignored"), roles.get("port")
        return AttributeType(
            node.get("name"),
            _documentation(node),
            node.get("use") == "required",
            self.simple(node),
            defines=next(iter(_symbols(roles.get("defines"))), None),
            refers=_symbols(roles.get("refers")),
            value=_value_role(value),
            value_type=value.get("type", value.get("kind", "")),
            ignored=None if ignored is None else ignored.get("quietly") == "true",
            use=roles.get("deprecated", {}).get("use", ""),
            port=_port(port) if port else None,
        )

    def simple(self, node: Any) -> SimpleType:
        """The simple type of an attribute. It is built in, a named type of the schema, or declared in the attribute."""
        definition = node.find(f"{_XS}simpleType")
        if definition is None:
            name = node.get("type", "xs:string")
            if name.startswith("xs:"):
                assert name.removeprefix("xs:") in _KNOWN_BASES
                return SimpleType(name.removeprefix("xs:"))
            definition = self.named["simpleType", name]
        restriction = definition.find(f"{_XS}restriction")
        assert restriction.get("base").removeprefix("xs:") in _KNOWN_BASES
        facets = {_local(f): f.get("value") for f in restriction if isinstance(f.tag, str)}
        return SimpleType(
            restriction.get("base").removeprefix("xs:"),
            tuple(
                ValueChoice(
                    choice.get("value"),
                    _documentation(choice),
                    dict(_roles(choice)).get("deprecated", {}).get("use", ""),
                )
                for choice in restriction.findall(f"{_XS}enumeration")
            ),
            facets.get("pattern", ""),
            "minLength" in facets,
            _number(facets.get("minExclusive")),
            _number(facets.get("minInclusive")),
            _number(facets.get("maxInclusive")),
        )


def _occurs(part: Any) -> tuple[str, str]:
    return part.get("minOccurs", "1"), part.get("maxOccurs", "1")


def _local(node: Any) -> str:
    return str(node.tag).rpartition("}")[2]


def _documentation(node: Any) -> str:
    text = node.findtext(f"{_XS}annotation/{_XS}documentation")
    return text.strip() if text else ""


def _binding(role: Mapping[str, str]) -> Binding:
    return Binding(role["name"], ValuePart(role["only"]) if "only" in role else None)


def _roles(node: Any) -> Iterator[tuple[str, dict[str, str]]]:
    for role in node.findall(f"{_XS}annotation/{_XS}appinfo/*"):
        if role.tag.startswith(_R):
            yield _local(role), dict(role.attrib)


def _part(role: Mapping[str, str] | None) -> ProtocolPart | None:
    return ProtocolPart(role["part"]) if role else None


def _symbols(role: Mapping[str, str] | None) -> tuple[SymbolKind, ...]:
    return tuple(map(SymbolKind, role["symbol"].split())) if role else ()


def _times(node: Any, outer: Multiplicity) -> Multiplicity:
    most = node.get("maxOccurs", "1")
    return Multiplicity(
        int(node.get("minOccurs", "1")) * outer.least,
        min(UNBOUNDED, outer.most * (UNBOUNDED if most == "unbounded" else int(most))),
    )


def _number(text: str | None) -> float | None:
    return None if text is None else float(text)


def _value_role(role: Mapping[str, str]) -> ValueRole | None:
    return ValueRole(role["is"]) if role else None


def _port(role: Mapping[str, str]) -> PortType:
    required, constant = (role.get(key) == "true" for key in ("required", "constant"))
    default, alias_of = role.get("default", ""), role.get("alias-of", "")
    return PortType(Direction(role["direction"]), role["type"], required, default, constant, alias_of)

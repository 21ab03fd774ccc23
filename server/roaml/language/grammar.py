# SPDX-License-Identifier: Apache-2.0
"""The elements and attributes of a language as tables, read from its XSD.

- Only the part of XML Schema that the schemas in `schemas/` use is supported; the tests compare the tables with
  `xmlschema`.
- Documentation is the text of `xs:documentation` (Markdown); roles are those of `xs:appinfo` (urn:roaml:roles).
- A grammar is read on first use and cached.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from roaml.language.resources import schema_path
from roaml.record import Record, field
from roaml.roles import UNBOUNDED, Direction, NodeKind, ProtocolPart, SymbolKind, ValuePart, ValueRole

if TYPE_CHECKING:
    from lxml import etree

_XS = "{http://www.w3.org/2001/XMLSchema}"
_R = "{urn:roaml:roles}"


class ValueChoice(Record, frozen=True):
    """One value of an enumeration. If the value is deprecated, `use` is the value that replaces it, otherwise ""."""

    value: str
    documentation: str
    use: str = ""


class SimpleType(Record, frozen=True):
    """The set of values of an attribute: a base type of XML Schema (without prefix) restricted by facets.

    Attributes:
        choices: the values of an enumeration; empty if the type is not an enumeration.
        pattern: a regular expression for the whole value, or "".
        non_empty: whether the value must not be empty.
        above: the exclusive minimum, if any.
        least, most: the inclusive minimum and maximum, if any.
    """

    base: str = "string"
    choices: tuple[ValueChoice, ...] = ()
    pattern: str = ""
    non_empty: bool = False
    above: float | None = None
    least: float | None = None
    most: float | None = None


class PortType(Record, frozen=True):
    """A port of a tree node.

    Attributes:
        type: a base type, such as "int32", or "any".
        required: whether the port must be set.
        default: the value of the port if it is not set.
        constant: whether the value of the port must be a constant.
        alias_of: the port of which this is another name, or "".
    """

    direction: Direction
    type: str
    required: bool
    default: str = ""
    constant: bool = False
    alias_of: str = ""


class AttributeType(Record, frozen=True):
    """An attribute of an element.

    Attributes:
        defines: the kind of symbol that the value defines, if any.
        refers: the kinds of symbols to which the value may refer.
        value: the role of a value that neither defines a symbol nor refers to one.
        simple: the allowed values, by their form.
        value_type: the required type of an expression (bool, int, any), or the kind of a ROS type (msg, srv, action).
        ignored: `None` if the attribute has an effect; otherwise, `False` if a rule reports that it has none, and
            `True` if no rule reports this.
        use: the attribute that replaces this one if this one is deprecated, otherwise "".
        port: the port of a tree node that the attribute sets, if any.
    """

    name: str
    documentation: str
    required: bool = False
    simple: SimpleType = SimpleType()
    defines: SymbolKind | None = None
    refers: tuple[SymbolKind, ...] = ()
    value: ValueRole | None = None
    value_type: str = ""
    ignored: bool | None = None
    use: str = ""
    port: PortType | None = None


class Multiplicity(Record, frozen=True):
    """The minimum and maximum number of occurrences of a child in its parent."""

    least: int
    most: int


class Binding(Record, frozen=True):
    """An event variable. It is available in conditions if `only` is `COND`, in bodies if `only` is `BODY`, and in both
    if `only` is `None`."""

    name: str
    only: ValuePart | None = None


class ElementType(Record, frozen=True):
    """An element.

    Attributes:
        children: name -> multiplicity; `Grammar.child` returns the type of a child.
        local: the types of the children that are declared inside this element, by name.
        any_child: the allowed number of children with any name, or `None`; children in foreign namespaces are ignored.
        any_is_opaque: whether the grammar ignores the names and the content of these children.
        any_attribute: whether attributes that are not listed are allowed; attributes in foreign namespaces always are.
        text: whether character data is allowed.
        refers, value, value_type: the role of the character data, as for the value of an attribute.
        sends, receives: the part of an interface or of the tree protocol that the element sends or receives, if any.
        code: the result code of an action that corresponds to the element, or 0.
        binds: the event variables that are available in the element.
        ignored: whether the element has no effect on the model.
        use: the element that replaces this one if this one is deprecated, otherwise "".
        node: the kind of node if the element is a node of a tree.
        translated: false for tree nodes that are known but cannot be translated.
        program_only: whether a tree node can be translated only as a program (docs/spec/nodes.md#library).
    """

    name: str
    documentation: str
    attributes: dict[str, AttributeType]
    children: dict[str, Multiplicity]
    local: dict[str, ElementType]
    any_child: Multiplicity | None = None
    any_is_opaque: bool = False
    any_attribute: bool = False
    text: bool = False
    refers: tuple[SymbolKind, ...] = ()
    value: ValueRole | None = None
    value_type: str = ""
    sends: ProtocolPart | None = None
    receives: ProtocolPart | None = None
    code: int = 0
    binds: tuple[Binding, ...] = ()
    ignored: bool = False
    use: str = ""
    node: NodeKind | None = None
    translated: bool = True
    program_only: bool = False

    @property
    def ports(self) -> tuple[AttributeType, ...]:
        """The ports of a tree node, by their primary names."""
        return tuple(a for a in self.attributes.values() if a.port and not a.port.alias_of)

    def port_key(self, name: str) -> str:
        """The primary name of the port that the attribute `name` sets; `name` may be another name of the port."""
        attribute = self.attributes.get(name)
        return (attribute.port.alias_of if attribute and attribute.port else "") or name


class Grammar(Record, frozen=True, dict=True):
    """One language: the name of its schema file, the names of its root elements, and its title."""

    schema: str
    roots: tuple[str, ...]
    title: str

    @cached_property
    def elements(self) -> dict[str, ElementType]:
        """All global elements by name."""
        return self._reader.elements

    @cached_property
    def groups(self) -> dict[str, frozenset[str]]:
        """The names of the elements in each named group."""
        return self._reader.group_names()

    @cached_property
    def _reader(self) -> _Reader:
        return _Reader(self.schema)

    @cached_property
    def validator(self) -> etree.XMLSchema:
        """The compiled schema (libxml2)."""
        from lxml import etree  # noqa: PLC0415 - models in JANI do not need it

        return etree.XMLSchema(etree.parse(str(schema_path(self.schema))))

    def child(self, parent: ElementType, name: str) -> ElementType | None:
        """The type of a child element `name` of `parent`; `None` if the child is not allowed."""
        if name in parent.local:
            return parent.local[name]
        if name in parent.children or (parent.any_child is not None and not parent.any_is_opaque):
            return self.elements.get(name)
        return None

    def element_at(self, names: list[str]) -> ElementType | None:
        """The type of the element at the end of a path of names that begins at a root; `None` if the grammar does not
        allow an element on the path."""
        if not names or names[0] not in self.roots:
            return None
        element: ElementType | None = self.elements[names[0]]
        for name in names[1:]:
            if element is None:
                return None
            element = self.child(element, name)
        return element

    def find(self, name: str) -> ElementType | None:
        """The type of an element with this name; `None` if the grammar has none. A global element takes precedence over
        one that is declared inside another element."""
        return self.elements.get(name) or self._by_name.get(name)

    @cached_property
    def _by_name(self) -> Mapping[str, ElementType]:
        return {element.name: element for element in reversed(tuple(self._everywhere))}

    def parents(self, name: str) -> tuple[str, ...]:
        """The names of the elements that declare a child `name`."""
        return tuple(dict.fromkeys(element.name for element in self._everywhere if name in element.children))

    @cached_property
    def _everywhere(self) -> tuple[ElementType, ...]:
        """All elements: first the global ones, then those that are only declared inside other elements."""
        elements = list(self.elements.values())
        for element in elements:
            elements += element.local.values()
        return tuple(elements)


HL_SCXML = Grammar("ascxml.xsd", ("ascxml", "scxml"), "HL-SCXML")
PLAIN_SCXML = Grammar("scxml.xsd", ("scxml",), "plain SCXML")
SYSTEM = Grammar("roaml.xsd", ("roaml", "convince_mc_tc"), "system file")
XML_PROPERTIES = Grammar("properties.xsd", ("properties",), "properties in XML")
STRUCTS = Grammar("structs.xsd", ("types",), "struct declarations")
BEHAVIOR_TREE = Grammar("behaviortree.xsd", ("root",), "BehaviorTree.CPP XML")
XML_GRAMMARS = (HL_SCXML, PLAIN_SCXML, SYSTEM, XML_PROPERTIES, STRUCTS, BEHAVIOR_TREE)


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
        from lxml import etree  # noqa: PLC0415 - models in JANI do not need it

        top = etree.parse(str(schema_path(schema))).getroot()
        self.named: dict[tuple[str, str], Any] = {
            (_local(node), name): node for node in top if isinstance(node.tag, str) and (name := node.get("name"))
        }
        self.elements = {name: self.element(node) for (kind, name), node in self.named.items() if kind == "element"}

    def group_names(self) -> dict[str, frozenset[str]]:
        return {
            name: frozenset(child.get("ref") for child in node.iter(f"{_XS}element"))
            for (kind, name), node in self.named.items()
            if kind == "group"
        }

    def element(self, node: Any) -> ElementType:
        shape = _Shape()
        complex_type = node.find(f"{_XS}complexType")
        if complex_type is None and ("complexType", node.get("type")) in self.named:
            complex_type = self.named["complexType", node.get("type")]
        if complex_type is not None:
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
        )

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
                return SimpleType(name.removeprefix("xs:"))
            definition = self.named["simpleType", name]
        restriction = definition.find(f"{_XS}restriction")
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

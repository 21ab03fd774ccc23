# SPDX-License-Identifier: Apache-2.0
"""The elements and attributes of a language as tables.

- `docs/build.py` writes the tables from the schemas (`roaml.language.schema_reader`), because reading these when the
  program starts would take a tenth of a check.
- Documentation is the text of `xs:documentation` (Markdown); roles are those of `xs:appinfo` (urn:roaml:roles).
- A grammar is read on first use and cached.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING

from roaml.disk import path_of_resource, resource
from roaml.language.resources import schema_path
from roaml.record import Record, decoded
from roaml.roles import Direction, NodeKind, ProtocolPart, SymbolKind, ValuePart, ValueRole

if TYPE_CHECKING:
    from lxml import etree


class ValueChoice(Record, frozen=True, omit_defaults=True):
    """One value of an enumeration. If the value is deprecated, `use` is the value that replaces it, otherwise ""."""

    value: str
    documentation: str
    use: str = ""


class SimpleType(Record, frozen=True, omit_defaults=True):
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


class PortType(Record, frozen=True, omit_defaults=True):
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


class AttributeType(Record, frozen=True, omit_defaults=True):
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


class Multiplicity(Record, frozen=True, omit_defaults=True):
    """The minimum and maximum number of occurrences of a child in its parent."""

    least: int
    most: int


class Binding(Record, frozen=True, omit_defaults=True):
    """An event variable. It is available in conditions if `only` is `COND`, in bodies if `only` is `BODY`, and in both
    if `only` is `None`."""

    name: str
    only: ValuePart | None = None


class ElementType(Record, frozen=True, omit_defaults=True):
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
        order: a regular expression for the names of all children, each with a space behind it; "" if `children` and
            `any_child` state which children are valid.
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
    order: str = ""

    @property
    def ports(self) -> tuple[AttributeType, ...]:
        """The ports of a tree node, by their primary names."""
        return tuple(a for a in self.attributes.values() if a.port and not a.port.alias_of)

    def port_key(self, name: str) -> str:
        """The primary name of the port that the attribute `name` sets; `name` may be another name of the port."""
        attribute = self.attributes.get(name)
        return (attribute.port.alias_of if attribute and attribute.port else "") or name


class SchemaTables(Record, frozen=True, omit_defaults=True):
    """The content of a schema: all global elements by name, and the names of the elements in each named group."""

    elements: dict[str, ElementType]
    groups: dict[str, tuple[str, ...]]


class Grammar(Record, frozen=True, dict=True):
    """One language: the name of its schema file, the names of its root elements, and its title."""

    schema: str
    roots: tuple[str, ...]
    title: str

    @cached_property
    def elements(self) -> dict[str, ElementType]:
        """All global elements by name."""
        return self._tables.elements

    @cached_property
    def groups(self) -> dict[str, frozenset[str]]:
        """The names of the elements in each named group."""
        return {name: frozenset(elements) for name, elements in self._tables.groups.items()}

    @cached_property
    def _tables(self) -> SchemaTables:
        return decoded(resource(*self._file), SchemaTables)

    @property
    def tables_file(self) -> str:
        """The path of the file with the tables."""
        return path_of_resource(*self._file)

    @property
    def _file(self) -> tuple[str, ...]:
        return (__package__, "tables", self.schema.replace(".xsd", ".json"))

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

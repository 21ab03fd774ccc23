# SPDX-License-Identifier: Apache-2.0
"""A property file in XML as typed data (docs/spec/xml-properties.md#file). Reading a file raises no exception."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.exhaustive import Vocabulary
from roaml.language import XML_PROPERTIES
from roaml.model.syntax import Expression, Name, TypeRef, expression_from, expression_of, name_of, type_of
from roaml.observers.notation import Notation, read
from roaml.record import Record
from roaml.text import Decoded
from roaml.xml_syntax import Document, Element


class PortVariableKind(Vocabulary):
    """The kind of a variable of a port. The values are the names of the elements."""

    STATE = "state_var"
    EVENT = "event_var"
    GOAL_ID = "goal_id"
    RESULT_CODE = "result_code"
    ACCEPTED = "accepted"


class PortKind(Vocabulary):
    """The kind of interface, node or event that a port listens to. The values are the names of the elements."""

    TOPIC = "ros_topic"
    SERVICE = "ros_service"
    ACTION = "ros_action"
    NODE = "bt_node"
    PLAIN = "scxml_event_send"


class ObservedPart(Vocabulary):
    """The part of an interface, or of the protocol of the tree, that a port listens to. The values are those of the
    attribute `event`."""

    PUBLISH = "publish"
    REQUEST = "request"
    RESPONSE = "response"
    GOAL_REQUEST = "goal_request"
    GOAL_RESPONSE = "goal_response"
    CANCEL_REQUEST = "cancel_request"
    FEEDBACK = "feedback"
    RESULT = "result"
    TICK = "tick"
    HALT = "halt"


_VARIABLES = {kind.value: kind for kind in PortVariableKind}
_PORTS = {kind.value: kind for kind in PortKind}
_PARTS = {part.value: part for part in ObservedPart}

NAME_ATTRIBUTES = {
    PortKind.TOPIC: "topic_name",
    PortKind.SERVICE: "service_name",
    PortKind.ACTION: "action_name",
    PortKind.NODE: "node",
    PortKind.PLAIN: "event",
}
"""Kind of port -> the attribute with the name of the interface, node or event that the port listens to."""


class PropertySection(Vocabulary):
    """A section of a property file that contains properties. The values are the names of the elements."""

    GUARANTEES = "guarantees"
    ASSUMES = "assumes"


_SECTIONS = {section.value: section for section in PropertySection}
PORTS = "ports"
"""The section with the ports."""


class PortVariable(Record, frozen=True, eq=False):
    """A variable of a port. `field` is the dotted path of a field in a message, or the name of a parameter of an
    event."""

    element: Element
    kind: PortVariableKind
    id: Name | None
    type: TypeRef | None
    field: Name | None
    initial: Expression | None


class Port(Record, frozen=True, eq=False):
    """A port. `name` is the interface, node or event that it listens to; `event` is the part of the interface."""

    element: Element
    kind: PortKind
    name: Name | None
    type: Name | None
    event: Name | None
    origin: Name | None
    target: Name | None
    variables: tuple[PortVariable, ...]

    @property
    def part(self) -> ObservedPart | None:
        """The value of the attribute `event`; `None` if the attribute is missing or has an invalid value."""
        return _PARTS.get(self.event.value) if self.event is not None else None


class WrittenScope(Record, frozen=True, eq=False):
    element: Element
    type: Name | None
    event: Expression | None
    until: Expression | None


class TimeInterval(Record, frozen=True, eq=False):
    element: Element
    time: Name | None
    after: Name | None
    within: Name | None
    unit: Name | None


class WrittenFormula(Record, frozen=True, eq=False):
    """A formula with the conditions that are its atoms, in the order of `notation.atoms`."""

    source: Decoded
    notation: Notation
    atoms: tuple[Expression, ...]


class WrittenProperty(Record, frozen=True, eq=False):
    """A property as written. `conditions` are the conditions in `<event>` or `<events>`."""

    element: Element
    section: PropertySection
    id: Name | None
    pattern: Name | None
    logic: Name | None
    formula: WrittenFormula | None
    conditions: tuple[Expression, ...]
    scopes: tuple[WrittenScope, ...]
    intervals: tuple[TimeInterval, ...]
    expect: Name | None = None

    @property
    def expressions(self) -> Iterator[Expression]:
        """All conditions of the property: those of the pattern, then those of the first scope, then those of the
        formula."""
        yield from self.conditions
        for scope in self.scopes[:1]:
            yield from (condition for condition in (scope.event, scope.until) if condition is not None)
        if self.formula is not None:
            yield from self.formula.atoms


class PropertyFile(Record, frozen=True, eq=False):
    document: Document
    element: Element
    ports: tuple[Port, ...]
    properties: tuple[WrittenProperty, ...]

    @property
    def variables(self) -> Iterator[tuple[Port, PortVariable]]:
        for port in self.ports:
            for variable in port.variables:
                yield port, variable


def build_property_file(document: Document) -> PropertyFile | None:
    """The properties in `document`; `None` if it has another root element."""
    root = document.root
    if root is None or root.name not in XML_PROPERTIES.roots:
        return None
    ports = [
        _port(document, element)
        for section in root.elements
        if section.name == PORTS
        for element in section.elements
        if element.name in _PORTS
    ]
    properties = [
        _property(document, element, _SECTIONS[section.name])
        for section in root.elements
        if section.name in _SECTIONS
        for element in section.elements
        if element.name == "property"
    ]
    return PropertyFile(document, root, tuple(ports), tuple(properties))


def _port(document: Document, element: Element) -> Port:
    variables = tuple(_variable(document, child) for child in element.elements if child.name in _VARIABLES)
    kind = _PORTS[element.name]
    name, type_ = name_of(element.get(NAME_ATTRIBUTES[kind])), name_of(element.get("type"))
    event = None if kind is PortKind.PLAIN else name_of(element.get("event"))
    origin, target = name_of(element.get("origin")), name_of(element.get("target"))
    return Port(element, kind, name, type_, event, origin, target, variables)


def _variable(document: Document, element: Element) -> PortVariable:
    field = name_of(element.get("field")) or name_of(element.get("param"))
    initial = expression_of(document, element.get("expr"))
    return PortVariable(
        element, _VARIABLES[element.name], name_of(element.get("id")), type_of(element.get("type")), field, initial
    )


def _property(document: Document, element: Element, section: PropertySection) -> WrittenProperty:
    holders = [child for child in element.elements if child.name in ("event", "events")]
    events = [child for h in holders for child in ([h] if h.name == "event" else h.elements) if child.name == "event"]
    contents = (document.content(event) for event in events)
    scopes = tuple(
        WrittenScope(
            child,
            name_of(child.get("type")),
            expression_of(document, child.get("event")),
            expression_of(document, child.get("until")),
        )
        for child in element.elements
        if child.name == "scope"
    )
    intervals = tuple(
        TimeInterval(child, *(name_of(child.get(name)) for name in ("time", "after", "within", "time_unit")))
        for child in element.elements
        if child.name == "time_interval"
    )
    return WrittenProperty(
        element,
        section,
        name_of(element.get("id")),
        name_of(element.get("pattern")),
        name_of(element.get("logic")),
        _formula(document, element),
        tuple(expression_from(content) for content in contents if content is not None),
        scopes,
        intervals,
        name_of(element.get("expect")),
    )


def _formula(document: Document, element: Element) -> WrittenFormula | None:
    attribute = element.get("expr")
    if attribute is None or not attribute.has_value:
        return None
    source = document.decoded(attribute.value_span)
    notation = read(source.text)
    atoms = tuple(expression_from(source.part(*span).stripped()) for span in notation.atoms)
    return WrittenFormula(source, notation, atoms)

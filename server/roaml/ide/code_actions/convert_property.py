# SPDX-License-Identifier: Apache-2.0
"""Converts a property of a system from JANI to XML and back (docs/spec/properties.md#conversion).

The property moves to a property file of the other format, which is created and listed if the system has none.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from roaml.edit.elements import after, first_in, last_in, removal
from roaml.expr.tree import Name, walk
from roaml.ide.code_actions import new_file
from roaml.ide.code_actions.action import REWRITE, CodeAction, WorkspaceEdit
from roaml.ide.code_actions.inputs import add_input
from roaml.ide.new_property import lines_of_element
from roaml.ide.property_conversion.forms import pattern_of
from roaml.ide.property_conversion.to_jani import jani_property
from roaml.ide.property_conversion.to_xml import EventPorts, NeededVariable, XmlProperty, xml_property
from roaml.jani.expressions import Expression, Integer, Real
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import (
    BinaryFormula,
    Filter,
    FilterFunction,
    Formula,
    Predicate,
    Probability,
    ProbabilityOperator,
    Property,
    StatePredicate,
)
from roaml.json_syntax import JsonArray, JsonObject, JsonValue
from roaml.model.kinds import FileKind
from roaml.model.property_file import PORTS, PropertyFile, PropertySection
from roaml.model.property_links import LinkedProperty, clock_step
from roaml.model.system_file import SystemSection
from roaml.project.analysis import Analysis
from roaml.project.edits import in_layout, line_end_of
from roaml.project.paths import folder_of
from roaml.text import Edit, Span, TextEdit

TO_XML = "Convert this property to XML"
TO_JANI = "Convert this property to JANI"
XML_FILE, JANI_FILE = "properties.xml", "properties.jani"
_RELATIONS = {
    BinaryOperator.LESS: "<",
    BinaryOperator.LESS_EQUAL: "<=",
    BinaryOperator.GREATER: ">",
    BinaryOperator.GREATER_EQUAL: ">=",
    BinaryOperator.EQUAL: "==",
}


def actions(analysis: Analysis, path: str, place: Span) -> Iterator[CodeAction]:
    """The conversion of the property at the caret, if exactly one system lists its file, and if the property has an
    equivalent in the other format."""
    owners = analysis.memberships.get(path, ())
    if len(owners) != 1:
        return  # other systems may have other ports and clocks
    (system,) = owners
    if analysis.kind(path) is FileKind.XML_PROPERTIES:
        yield from _to_jani(analysis, path, system, place)
    elif analysis.kind(path) is FileKind.PROPERTIES:
        yield from _to_xml(analysis, path, system, place)


def _file_of(analysis: Analysis, system: str, kind: FileKind) -> str | None:
    """The first property file of the kind `kind` that no other system lists and to which a property can be added;
    `None` if there is none."""
    for listed in analysis.listed(system):
        if not listed.usable or listed.required_kind is not kind or analysis.kind(listed.path) is not kind:
            continue
        if analysis.memberships.get(listed.path) != (system,):
            continue
        if kind is FileKind.PROPERTIES and _array(analysis, listed.path) is not None:
            return listed.path
        file = analysis.property_file(listed.path) if kind is FileKind.XML_PROPERTIES else None
        if file is not None and file.element.find(PropertySection.ASSUMES.value) is None and file.element.complete:
            return listed.path  # assumptions would restrict the property
    return None


# --------------------------------------------------------------------- to XML


def _to_xml(analysis: Analysis, path: str, system: str, place: Span) -> Iterator[CodeAction]:
    array, model = _array(analysis, path), analysis.system(system)
    if array is None or model is None:
        return
    index = next((i for i, item in enumerate(array.items) if item.span.contains(place.start)), None)
    if index is None or not array.items[index].span.contains(place.end):
        return
    span = array.items[index].span
    property_ = next((p for p in analysis.properties(path)[0] if p.origin and p.origin.span == span), None)
    parts = _parts_of(property_) if property_ is not None else None
    if property_ is None or parts is None:
        return
    formula, expect = parts
    step = clock_step(model)
    form = pattern_of(formula, step)
    if form is None:
        return
    target = _file_of(analysis, system, FileKind.XML_PROPERTIES)
    file = analysis.property_file(target) if target is not None else None
    ports = EventPorts(model, analysis.interface, analysis.globals(system))
    converted = xml_property(property_.name, expect, form, ports, step, _known(file))
    if converted is None:
        return

    def make() -> WorkspaceEdit:
        removed = _without_item(array, index)
        if file is None or target is None:
            created = new_file.free_path(analysis, folder_of(system), XML_FILE)
            listing = add_input(analysis, system, SystemSection.PROPERTIES, "xml", created)
            return WorkspaceEdit({path: removed, system: listing}, created={created: _new_xml(converted)})
        source = analysis.source(target)
        assert source is not None
        return WorkspaceEdit({path: removed, target: tuple(in_layout(source, _added(file, converted)))})

    resources = () if file is not None else ("create",)
    yield CodeAction(TO_XML, REWRITE, make, resources=resources)


def _parts_of(property_: Property) -> tuple[Formula, str] | None:
    """The path formula of a property that is a minimum probability, and the expectation of the property, "" if there is
    none; `None` for other properties."""
    match property_.expression:
        case Filter(FilterFunction.VALUES, values, Predicate(StatePredicate.INITIAL)):
            pass
        case _:
            return None
    match values:
        case Probability(ProbabilityOperator.PMIN, path):
            return path, ""
        case BinaryFormula(operator, Probability(ProbabilityOperator.PMIN, path), Integer() | Real() as number) if (
            operator in _RELATIONS
        ):
            return path, f"{_RELATIONS[operator]} {_number(number)}"
    return None


def _number(number: Expression) -> str:
    assert isinstance(number, (Integer, Real))
    return repr(number.value)


def _known(file: PropertyFile | None) -> dict[NeededVariable, str]:
    """The variables of the ports of a file -> their ids. An id that is missing in this mapping, because a variable with
    the same port and attributes precedes it, is added with the port ""."""
    known: dict[NeededVariable, str] = {}
    for port, variable in file.variables if file is not None else ():
        if variable.id is None:
            continue
        attributes = [a for a in port.element.attributes if a.has_value]
        tag = " ".join((port.element.name, *(f'{a.name}="{a.value}"' for a in attributes)))
        own = [variable.element.get(name) for name in ("type", "field", "param", "expr")]
        element = " ".join((variable.kind.value, *(f'{a.name}="{a.value}"' for a in own if a is not None)))
        known.setdefault(NeededVariable(tag, element), variable.id.value)
    for _, variable in file.variables if file is not None else ():
        if variable.id is not None and variable.id.value not in known.values():
            known[NeededVariable("", variable.id.value)] = variable.id.value
    return known


def _port_lines(converted: XmlProperty, known: dict[NeededVariable, str]) -> list[str]:
    by_port: dict[str, list[str]] = {}
    for id_, needed in converted.variables.items():
        if needed not in known:
            kind, _, rest = needed.element.partition(" ")
            element = f'<{kind} id="{id_}"{" " if rest else ""}{rest} />'
            by_port.setdefault(needed.port, []).append(f"    {element}")
    lines: list[str] = []
    for tag, variables in by_port.items():
        lines += [f"<{tag}>", *variables, f"</{tag.partition(' ')[0]}>"]
    return lines


def _new_xml(converted: XmlProperty) -> str:
    ports = _port_lines(converted, {})
    sections = [
        *(lines_of_element(PORTS, ports) if ports else ()),
        *lines_of_element(PropertySection.GUARANTEES.value, converted.lines),
    ]
    return "\n".join(lines_of_element("properties", sections)) + "\n"


def _added(file: PropertyFile, converted: XmlProperty) -> Iterator[Edit]:
    root, document, lines = file.element, file.document, _port_lines(converted, _known(file))
    ports, guarantees = root.find(PORTS), root.find(PropertySection.GUARANTEES.value)
    new: list[str] = []
    if lines and ports is not None:
        yield last_in(document, ports, *lines)
    elif lines and guarantees is not None:
        yield first_in(document, root, *lines_of_element(PORTS, lines))
    elif lines:
        new += lines_of_element(PORTS, lines)
    if guarantees is not None:
        yield last_in(document, guarantees, *converted.lines)
        return
    new += lines_of_element(PropertySection.GUARANTEES.value, converted.lines)
    yield after(document, ports, *new) if ports is not None else first_in(document, root, *new)


# -------------------------------------------------------------------- to JANI


def _to_jani(analysis: Analysis, path: str, system: str, place: Span) -> Iterator[CodeAction]:
    file, linked, model = (
        analysis.property_file(path),
        analysis.linked_properties(path, system),
        analysis.system(system),
    )
    if file is None or linked is None or model is None or file.element.find(PropertySection.ASSUMES.value) is not None:
        return  # assumptions restrict the property
    for property_ in linked.properties:
        span = property_.written.element.span
        if not (span.start <= place.start and place.end <= span.end):
            continue
        value = jani_property(property_, analysis.globals(system), clock_step(model))
        if value is not None:
            target = _file_of(analysis, system, FileKind.PROPERTIES)

            def make(
                property_: LinkedProperty = property_, value: Any = value, target: str | None = target
            ) -> WorkspaceEdit:
                source = analysis.source(path)
                assert source is not None
                removed = tuple(in_layout(source, _without(file, property_)))
                if target is None:
                    created = new_file.free_path(analysis, folder_of(system), JANI_FILE)
                    listing = add_input(analysis, system, SystemSection.PROPERTIES, "jani", created)
                    text = json.dumps({"properties": [value]}, indent=4, ensure_ascii=False) + "\n"
                    return WorkspaceEdit({path: removed, system: listing}, created={created: text})
                return WorkspaceEdit({path: removed, target: _with_item(analysis, target, value)})

            yield CodeAction(TO_JANI, REWRITE, make, resources=() if target is not None else ("create",))


def _without(file: PropertyFile, property_: LinkedProperty) -> Iterator[Edit]:
    """Edits that remove a property, and the ports and variables that only this property uses."""
    text = file.document.text
    used = {
        node.name
        for written in file.properties
        if written is not property_.written
        for condition in written.expressions
        for node in walk(condition.tree)
        if isinstance(node, Name)
    }
    own = {n.name for c in property_.conditions.values() for n in walk(c.tree) if isinstance(n, Name)} - used
    for port in file.ports:
        unused = [v for v in port.variables if v.id is not None and v.id.value in own]
        if unused and len(unused) == len(port.variables):
            yield removal(text, port.element.span)
        else:
            yield from (removal(text, variable.element.span) for variable in unused)
    yield removal(text, property_.written.element.span)


# ------------------------------------------------------------------------ JSON


def _array(analysis: Analysis, path: str) -> JsonArray | None:
    """The list of properties of a property file; `None` if its JSON has errors or contains no list of properties."""
    document = analysis.json(path)
    if document is None or document[1] or not isinstance(document[0], JsonObject):
        return None
    value: JsonValue | None = document[0].get("properties")
    return value if isinstance(value, JsonArray) else None


def _without_item(array: JsonArray, index: int) -> tuple[TextEdit, ...]:
    """The edit that removes an item with its comma."""
    items = array.items
    if index > 0:
        span = Span(items[index - 1].span.end, items[index].span.end)
    elif len(items) > 1:
        span = Span(items[0].span.start, items[1].span.start)
    else:
        span = Span(array.span.start + 1, array.span.end - 1)
    return (TextEdit(span, ""),)


def _with_item(analysis: Analysis, path: str, value: Any) -> tuple[TextEdit, ...]:
    """The edit that adds an item at the end of the list of properties."""
    array, source = _array(analysis, path), analysis.source(path)
    assert array is not None
    assert source is not None
    items, end = array.items, line_end_of(source)
    at = items[-1].span.start if items else array.span.start
    line = source.text[source.lines.line_start(source.lines.position(at).line) : at]
    own = re.match(r"[ \t]*", line)
    assert own is not None
    indent = own[0] if items else f"{own[0]}    "
    text = json.dumps(value, indent=4, ensure_ascii=False).replace("\n", f"{end}{indent}")
    if items:
        span = Span(items[-1].span.end, items[-1].span.end)
        return (TextEdit(span, f",{end}{indent}{text}"),)
    return (TextEdit(Span(array.span.start + 1, array.span.end - 1), f"{end}{indent}{text}{end}{own[0]}"),)

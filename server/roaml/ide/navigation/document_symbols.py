# SPDX-License-Identifier: Apache-2.0
"""The outline of a file: its named parts, nested as in the file.

A part without a name has the name of its element, so that an incomplete file has an outline as well.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.ide.describe.markdown import plain
from roaml.ide.json_tree import members
from roaml.ide.navigation.document_symbol import DocumentSymbol, DocumentSymbolKind
from roaml.ide.navigation.jani_symbols import jani_symbols
from roaml.json_syntax import JsonArray, JsonObject, JsonString
from roaml.model.kinds import FileKind
from roaml.model.machine import Chart, Data, Declaration, Handler, Machine, Port, State, Thread
from roaml.model.property_file import Port as PropertyPort
from roaml.model.property_file import PropertyFile
from roaml.model.property_sentences import sentence
from roaml.model.structs import StructDeclaration
from roaml.model.syntax import Name, PortRead
from roaml.model.system_file import SystemFile
from roaml.model.tree import TreeFile, TreeNode
from roaml.project.analysis import Analysis
from roaml.text import Span
from roaml.xml_syntax import Element


def document_symbols(analysis: Analysis, path: str) -> tuple[DocumentSymbol, ...]:
    """The outline of a file, in the order of the text."""
    kind = analysis.kind(path)
    if kind is FileKind.MACHINE and (machine := analysis.machine(path)):
        return (_machine(machine),)
    if kind is FileKind.TREE and (tree := analysis.tree(path)):
        return tuple(_trees(tree))
    if kind is FileKind.SYSTEM and (system := analysis.system_file(path)):
        return (_system(system),)
    if kind is FileKind.STRUCTS:
        return tuple(_struct(declaration) for declaration in analysis.struct_declarations(path))
    if kind is FileKind.PROPERTIES:
        return tuple(_properties(analysis, path))
    if kind is FileKind.XML_PROPERTIES and (file := analysis.property_file(path)):
        return tuple(_property_file(file))
    if kind is FileKind.JANI_MODEL and (json := analysis.json(path)):
        return tuple(jani_symbols(json[0]))
    return ()


def _symbol(
    element: Element,
    name: Name | None,
    kind: DocumentSymbolKind,
    detail: str = "",
    children: Iterable[DocumentSymbol] = (),
) -> DocumentSymbol:
    inside = sorted(children, key=lambda child: child.span)
    span = name.span if name and _is_inside(name.span, element.span) else element.name_span
    return DocumentSymbol(name.value if name else f"<{element.name}>", detail, kind, element.span, span, tuple(inside))


def _is_inside(inner: Span, outer: Span) -> bool:
    return outer.start <= inner.start and inner.end <= outer.end


# -------------------------------------------------------------------- machines


def _machine(machine: Machine) -> DocumentSymbol:
    children = [
        *(_port(port) for port in machine.ports),
        *(_declaration(declaration) for declaration in machine.declarations),
        *(_thread(thread) for thread in machine.threads),
        *_chart(machine.chart),
    ]
    return _symbol(machine.element, machine.name, DocumentSymbolKind.MACHINE, children=children)


def _chart(chart: Chart) -> Iterator[DocumentSymbol]:
    datamodel = chart.element.find("datamodel")
    data = [_data(variable) for variable in chart.data]
    if datamodel is not None:
        inside = [symbol for symbol in data if _is_inside(symbol.span, datamodel.span)]
        name = Name("datamodel", datamodel.name_span)
        yield _symbol(datamodel, name, DocumentSymbolKind.DATAMODEL, children=inside)
        data = [symbol for symbol in data if symbol not in inside]
    yield from data
    for state in chart.states:
        yield _state(state)


def _data(data: Data) -> DocumentSymbol:
    return _symbol(data.element, data.id, DocumentSymbolKind.VARIABLE, data.type.text if data.type else "")


def _port(port: Port) -> DocumentSymbol:
    type_ = f" {port.type.text}" if port.type else ""
    return _symbol(port.element, port.key, DocumentSymbolKind.PORT, f"{port.direction}{type_}")


def _declaration(declaration: Declaration) -> DocumentSymbol:
    interface = declaration.interface
    shown = "from a port" if isinstance(interface, PortRead) else interface.value if interface else ""
    return _symbol(
        declaration.element, declaration.handle, DocumentSymbolKind.ROS, f"{declaration.kind.value} {shown}".rstrip()
    )


def _thread(thread: Thread) -> DocumentSymbol:
    return _symbol(thread.element, thread.server, DocumentSymbolKind.THREAD, "action thread", _chart(thread.chart))


def _state(state: State) -> DocumentSymbol:
    return _symbol(state.element, state.id, DocumentSymbolKind.STATE, "", map(_handler, state.handlers))


def _handler(handler: Handler) -> DocumentSymbol:
    """The symbol of a handler. Its name is the event of a plain transition, or the element and the handle to which the
    element refers."""
    element = handler.element
    words = [name.value for name in (handler.handle, handler.child) if name]
    if element.name != "transition":
        words.insert(0, element.name)
    name = handler.event.value if handler.event else " ".join(words)
    targets = ", ".join(dict.fromkeys(target.state.value for target in handler.targets if target.state))
    cond = f"[{' '.join(handler.cond.text.split())}]" if handler.cond else ""
    detail = " ".join(part for part in (cond, f"→ {targets}" if targets else "") if part)
    place = handler.event.span if handler.event else element.name_span
    return _symbol(element, Name(name or "transition", place), DocumentSymbolKind.TRANSITION, detail)


# --------------------------------------------------------------- other languages


def _trees(file: TreeFile) -> Iterator[DocumentSymbol]:
    for tree in file.trees:
        yield _symbol(tree.element, tree.id, DocumentSymbolKind.TREE, children=map(_node, tree.roots))


def _node(node: TreeNode) -> DocumentSymbol:
    """The symbol of a node: the name of the node, with its plugin as detail."""
    type_ = Name(node.type_name, node.element.name_span)
    name, detail = (node.name, type_.value) if node.name else (type_, "")
    kind = DocumentSymbolKind.CONTROL if node.children else DocumentSymbolKind.LEAF
    return _symbol(node.element, name, kind, detail, map(_node, node.children))


def _system(file: SystemFile) -> DocumentSymbol:
    sections = []
    for element in file.element.elements:
        inputs = [
            _symbol(entry.element, entry.src, DocumentSymbolKind.INPUT, entry.type.value if entry.type else "")
            for entry in file.inputs
            if _is_inside(entry.element.span, element.span)
        ]
        name = Name(element.name, element.name_span)
        sections.append(_symbol(element, name, DocumentSymbolKind.SECTION, children=inputs))
    name = Name(file.element.name, file.element.name_span)
    return _symbol(file.element, name, DocumentSymbolKind.SYSTEM, children=sections)


def _struct(struct: StructDeclaration) -> DocumentSymbol:
    children = tuple(
        DocumentSymbol(
            member.name.value,
            member.type.text if member.type else "",
            DocumentSymbolKind.MEMBER,
            member.span,
            member.name.span,
        )
        for member in struct.members
        if member.name
    )
    name = struct.name or Name("<struct>", struct.span)
    return DocumentSymbol(name.value, "", DocumentSymbolKind.STRUCT, struct.span, name.span, children)


def _properties(analysis: Analysis, path: str) -> Iterator[DocumentSymbol]:
    """The symbols of the properties in the text. They include properties with errors, which the model does not
    contain."""
    json = analysis.json(path)
    entries = json[0].get("properties") if json and isinstance(json[0], JsonObject) else None
    for entry in entries.items if isinstance(entries, JsonArray) else ():
        named = members(entry)
        name, comment = named.get("name"), named.get("comment")
        if isinstance(name, JsonString) and name.value:
            detail = comment.value if isinstance(comment, JsonString) else ""
            yield DocumentSymbol(name.value, detail, DocumentSymbolKind.PROPERTY, entry.span, name.content_span)


def _property_file(file: PropertyFile) -> Iterator[DocumentSymbol]:
    """The symbols of the sections of a property file in XML, with their ports and properties."""
    for section in file.element.elements:
        ports = [_property_port(port) for port in file.ports if _is_inside(port.element.span, section.span)]
        properties = [
            _symbol(written.element, written.id, DocumentSymbolKind.PROPERTY, plain(sentence(file, written)))
            for written in file.properties
            if _is_inside(written.element.span, section.span)
        ]
        name = Name(section.name, section.name_span)
        yield _symbol(section, name, DocumentSymbolKind.SECTION, children=(*ports, *properties))


def _property_port(port: PropertyPort) -> DocumentSymbol:
    variables = (
        _symbol(variable.element, variable.id, DocumentSymbolKind.VARIABLE, variable.type.text if variable.type else "")
        for variable in port.variables
    )
    detail = port.event.value if port.event is not None else ""
    return _symbol(port.element, port.name, DocumentSymbolKind.ROS, detail, variables)

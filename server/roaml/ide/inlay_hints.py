# SPDX-License-Identifier: Apache-2.0
"""Inlay hints: types, topics, parameters of events, numbers and names of tree nodes, names of compared numbers.

The hints are computed from the analysed models. The explanation of a hint is computed on request (`explain`).
"""

from __future__ import annotations

import enum
from collections.abc import Iterable, Iterator, Mapping

from roaml.diagnostics import Symbol
from roaml.expr.types import UNKNOWN, Struct, StructKind, Type, unwrap
from roaml.ide.describe import describe
from roaml.ide.describe import system as describe_system
from roaml.ide.describe.machine import inferred_type
from roaml.ide.describe.system import node_of
from roaml.ide.names.in_machine import interface_symbol, is_implicit
from roaml.ide.navigation import definition_of
from roaml.ide.property_values import named_json_numbers, named_numbers
from roaml.ide.system_names import grouped
from roaml.jani.properties import identifiers
from roaml.model.kinds import FileKind
from roaml.model.machine import (
    Chart,
    Declaration,
    Handler,
    Machine,
    Param,
    RosSend,
    Send,
    SetOutput,
    bodies,
    statements,
)
from roaml.model.property_file import PortKind
from roaml.model.syntax import Name, PortRead
from roaml.model.system import System, SystemAutomaton
from roaml.model.tree import TreeNode, nodes
from roaml.model.tree_paths import label_of, nodes_called
from roaml.model.value_types import TypedValue, ValueUse, find_handle, port_type
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.roles import ProtocolPart, SymbolKind
from roaml.text import Location, Span
from roaml.xml_syntax import Element

_MAX_NAMES = 3
"""The maximum number of interfaces, nodes or systems that a hint names."""


class HintKind(enum.Enum):
    """The kinds of hints that can be shown or hidden. The values are the names of the settings."""

    TYPES = "types"
    PORTS = "ports"
    TOPICS = "topics"
    EVENTS = "events"
    NODES = "nodes"


ALL_HINTS = frozenset(HintKind)


class InlayHintLabelPart(Record, frozen=True):
    """A part of the text of a hint. `symbol` is the symbol that it names, if any."""

    text: str
    symbol: Symbol | None = None


class InlayHint(Record, frozen=True):
    """An inlay hint. `offset` is its position in the text of the file."""

    offset: int
    kind: HintKind
    parts: tuple[InlayHintLabelPart, ...]

    @property
    def text(self) -> str:
        return "".join(part.text for part in self.parts)


class Explanation(Record, frozen=True):
    """The explanation of a symbol in a hint: its description in Markdown, and the place of its definition."""

    text: str
    location: Location | None


def inlay_hints(
    analysis: Analysis, path: str, within: Span, kinds: frozenset[HintKind] = ALL_HINTS
) -> tuple[InlayHint, ...]:
    """The hints in a part of a file, in the order of the text."""
    by_system = {
        system or "": {hint for hint in _hints(analysis, path, within, system) if hint.kind in kinds}
        for system in analysis.systems_of(path)
    }
    merged = _merged(by_system) if len(by_system) > 1 else next(iter(by_system.values()))
    chosen = (hint for hint in merged if within.start <= hint.offset <= within.end)
    return tuple(sorted(chosen, key=lambda hint: (hint.offset, hint.text)))


def _hints(analysis: Analysis, path: str, within: Span, system: str | None) -> Iterable[InlayHint]:
    """The hints in a file as a part of `system`, or as a file without a system."""
    kind, machine = analysis.kind(path), analysis.machine(path)
    if kind is FileKind.MACHINE and machine is not None:
        return _Machine(analysis, path, machine, within, system).all()
    linked = analysis.system(system) if system else None
    if kind is FileKind.TREE:
        return _tree(analysis, path, within, linked)
    if kind is FileKind.PROPERTIES and linked is not None:
        return _properties(analysis, path, within, linked)
    if kind is FileKind.XML_PROPERTIES:
        return _property_file(analysis, path, linked)
    return ()


def _merged(by_system: Mapping[str, set[InlayHint]]) -> set[InlayHint]:
    """The hints of all systems that share a file. A hint that is equal in all systems occurs once; hints that differ
    contain the names of their systems."""
    at: dict[tuple[int, HintKind], dict[str, InlayHint]] = {}
    for system, system_hints in by_system.items():
        for hint in system_hints:
            at.setdefault((hint.offset, hint.kind), {})[system] = hint
    merged: set[InlayHint] = set()
    for (offset, kind), hints in at.items():
        parts: list[InlayHintLabelPart] = []
        # A system without a hint at this place differs as well.
        groups = grouped({system: hints[system].text if system in hints else "" for system in by_system})
        shown = [(text, names) for text, names in groups if text]
        for text, names in shown[:_MAX_NAMES]:
            own = next(hint.parts for hint in hints.values() if hint.text == text)
            again = bool(parts) and own[0].text.strip() in _LEADS
            parts += [
                *([InlayHintLabelPart("; ")] if parts else []),
                *own[again:],
                *([InlayHintLabelPart(f" in {names}")] if names else []),
            ]
        if len(shown) > _MAX_NAMES:
            parts.append(InlayHintLabelPart(", …"))
        merged.add(InlayHint(offset, kind, tuple(parts)))
    return merged


_LEADS = ("", "→", "=", ":")
"""Texts at the beginning of hints. They are omitted in all but the first of several merged hints."""


def explain(analysis: Analysis, symbol: Symbol) -> Explanation:
    """The explanation of `symbol` in a hint."""
    if symbol.kind is not SymbolKind.TREE_INSTANCE:
        return Explanation(describe(analysis, symbol), definition_of(analysis, symbol))
    system = analysis.system(symbol.path)
    node = system.by_instance.get(int(symbol.name)) if system and symbol.name.isdecimal() else None
    if system is None or node is None:
        return Explanation("", None)
    machine = Symbol(node.path, SymbolKind.MACHINE, node.outline.name)
    plugin = machine if node.path else Symbol("", SymbolKind.PLUGIN, node.outline.name)
    text = describe(analysis, plugin)
    about = describe_system.node(system, node)
    return Explanation(f"{about}\n\n{text}", definition_of(analysis, plugin))


def _touches(within: Span, element: Element) -> bool:
    return element.span.start <= within.end and within.start <= element.span.end


def _behind(name: Name) -> int:
    """The offset after the quote at the end of an attribute's value."""
    return name.span.end + 1


# -------------------------------------------------------------------- machines


class _Machine:
    def __init__(self, analysis: Analysis, path: str, machine: Machine, within: Span, system: str | None) -> None:
        self.analysis = analysis
        self.path = path
        self.machine = machine
        self.within = within
        self.linked = analysis.system(system) if system else None
        self.owner = system or path
        self.typed = analysis.typed_in(path, system)
        self.values: dict[Element, TypedValue] = {
            value.element: value for value in self.typed.values if value.use in (ValueUse.PARAMETER, ValueUse.FIELD)
        }
        self.interfaces: dict[tuple[SymbolKind, str], dict[Symbol, str]] = {}
        if self.linked is not None:
            for automaton in self.linked.automata_of(path):
                self.take(self.linked, automaton)

    def take(self, system: System, automaton: SystemAutomaton) -> None:
        for use in automaton.outline.interfaces:
            name = automaton.interface_name(use)
            if name is not None:
                known = self.interfaces.setdefault((use.kind, use.handle), {})
                known[interface_symbol(system.path, use.kind, name)] = name

    def all(self) -> Iterator[InlayHint]:
        for declaration in self.machine.declarations:
            if _touches(self.within, declaration.element):
                yield from self.declaration(declaration)
        for chart in self.machine.charts:
            if _touches(self.within, chart.element):
                yield from self.chart(chart)

    def declaration(self, declaration: Declaration) -> Iterator[InlayHint]:
        for value in (declaration.interface, declaration.rate):
            if isinstance(value, PortRead):
                yield from self.port_read(value)
        port = declaration.interface
        if isinstance(port, PortRead) and port.key:
            handle = declaration.handle.value if declaration.handle else ""
            yield from self.names(port.key, self.interfaces.get((declaration.kind, handle), {}), " = ")

    def names(self, at: Name, interfaces: dict[Symbol, str], lead: str) -> Iterator[InlayHint]:
        """The hint with the topics, services or actions to which a name refers."""
        if not interfaces:
            return
        parts: list[InlayHintLabelPart] = []
        for symbol, written in list(interfaces.items())[:_MAX_NAMES]:
            parts += [InlayHintLabelPart(", " if parts else lead), InlayHintLabelPart(written, symbol)]
        if len(interfaces) > _MAX_NAMES:
            parts.append(InlayHintLabelPart(", …"))
        yield InlayHint(_behind(at), HintKind.TOPICS, tuple(parts))

    def chart(self, chart: Chart) -> Iterator[InlayHint]:
        for data in chart.data:
            if data.id is not None and _touches(self.within, data.element):
                if data.element.get("type") is None:
                    known = self.typed.variables.get(chart.scope, {}).get(data.id.value, UNKNOWN)
                    type_ = known if data.type else inferred_type(self.typed, chart.scope, data.id.value)
                    yield from self.type(data.id, type_)
                for value in (data.value, data.lower, data.upper):
                    if isinstance(value, PortRead):
                        yield from self.port_read(value)
        for state in chart.states:
            if _touches(self.within, state.element):
                for handler in state.handlers:
                    yield from self.handler(handler)
        for state, _, body in bodies(chart):
            if _touches(self.within, state.element):
                for statement in statements(body):
                    match statement:
                        case Send():
                            yield from self.params(statement.params)
                        case RosSend():
                            yield from self.handle(statement)
                            yield from self.params(statement.fields)
                        case SetOutput() if statement.key:
                            read = PortRead(statement.key, statement.element.span)
                            yield from self.type(statement.key, port_type(self.machine, read))
        reads = (v.value for v in self.typed.values if v.place.chart is chart and isinstance(v.value, PortRead))
        for read in reads:
            yield from self.port_read(read)

    def params(self, params: Iterable[Param]) -> Iterator[InlayHint]:
        for param in params:
            value = self.values.get(param.element)
            if param.name is not None and value is not None:
                yield from self.type(param.name, value.type if value.use is ValueUse.PARAMETER else value.required)

    def type(self, name: Name, type_: Type | None) -> Iterator[InlayHint]:
        if type_ is not None and type_ != UNKNOWN:
            yield InlayHint(_behind(name), HintKind.TYPES, (InlayHintLabelPart(" : "), self.type_part(type_)))

    def type_part(self, type_: Type) -> InlayHintLabelPart:
        inner, _ = unwrap(type_)
        is_declared = isinstance(inner, Struct) and inner.kind is StructKind.DECLARED
        struct = Symbol(self.owner, SymbolKind.STRUCT, str(inner)) if is_declared else None
        return InlayHintLabelPart(str(type_), struct)

    def port_read(self, read: PortRead) -> Iterator[InlayHint]:
        if read.key is not None:
            yield from self.type(read.key, port_type(self.machine, read))

    def handler(self, handler: Handler) -> Iterator[InlayHint]:
        yield from self.handle(handler)
        if handler.trigger is not ProtocolPart.EVENT or handler.event is None or self.linked is None:
            return
        event = self.linked.events.get(handler.event.value)
        members = event.data.members if event else ()
        parts: list[InlayHintLabelPart] = []
        for name, type_ in members:
            parts += [
                InlayHintLabelPart(", " if parts else "("),
                InlayHintLabelPart(name),
                InlayHintLabelPart(" : "),
                self.type_part(type_),
            ]
        if parts:
            yield InlayHint(_behind(handler.event), HintKind.EVENTS, (*parts, InlayHintLabelPart(")")))

    def handle(self, user: Handler | RosSend) -> Iterator[InlayHint]:
        """The hint with the interface of a handle, unless the handle is the name of the interface, or with the rate of
        a timer."""
        declaration = find_handle(self.machine, user)
        if user.handle is None or declaration is None or is_implicit(declaration):
            return
        if declaration.kind is SymbolKind.TIMER:
            if isinstance(declaration.rate, Name):
                symbol = Symbol(self.path, SymbolKind.TIMER, user.handle.value)
                text = f"{declaration.rate.value} Hz"
                yield InlayHint(
                    _behind(user.handle), HintKind.TOPICS, (InlayHintLabelPart(" "), InlayHintLabelPart(text, symbol))
                )
            return
        interfaces = self.interfaces.get((declaration.kind, user.handle.value), {})
        if not interfaces and isinstance(declaration.interface, Name):
            written = declaration.interface.value
            interfaces = {interface_symbol(self.owner, declaration.kind, written): written}
        if {name.removeprefix("/") for name in interfaces.values()} != {user.handle.value.removeprefix("/")}:
            yield from self.names(user.handle, interfaces, " → ")


# ----------------------------------------------------------- trees and properties


def _tree(analysis: Analysis, path: str, within: Span, system: System | None) -> Iterator[InlayHint]:
    file = analysis.tree(path)
    instances = _instances(system, path) if system is not None else {}
    for tree in file.trees if file else ():
        if not _touches(within, tree.element):
            continue
        for position, node in enumerate(nodes(tree)):
            automata = instances.get((tree.id.value if tree.id else "", position), [])
            if node.plugin is not None and within.start <= node.element.open_span.end:
                yield from _node(node, node.plugin, automata)


def _node(node: TreeNode, plugin: Name, automata: list[tuple[System, SystemAutomaton]]) -> Iterator[InlayHint]:
    at = plugin.span.end + (0 if node.compact else 1)
    parts: list[InlayHintLabelPart] = []
    numbers = {(s.path, a.instance.number): None for s, a in automata if a.instance}
    for (system, number), _ in list(numbers.items())[:_MAX_NAMES]:
        parts += [
            InlayHintLabelPart(", " if parts else " "),
            InlayHintLabelPart(f"bt_{number}", Symbol(system, SymbolKind.TREE_INSTANCE, str(number))),
        ]
    if len(numbers) > _MAX_NAMES:
        parts.append(InlayHintLabelPart(", …"))
    if parts:
        yield InlayHint(at, HintKind.NODES, tuple(parts))
    for port in node.ports:
        types = {a.outline.port(port.key.value): a for _, a in automata}
        shown = dict.fromkeys(port.type for port in types if port is not None and port.type)
        owners = [a for a in types.values() if a.path]
        if shown and port.attribute.has_value:
            symbol = Symbol(owners[0].path, SymbolKind.PORT, port.key.value) if owners else None
            yield InlayHint(
                _behind(port.value),
                HintKind.PORTS,
                (InlayHintLabelPart(" : "), InlayHintLabelPart(" or ".join(shown), symbol)),
            )


def _instances(system: System, path: str) -> dict[tuple[str, int], list[tuple[System, SystemAutomaton]]]:
    """The nodes of the executed tree of a system that are written in a file, by tree and position."""
    by_position: dict[tuple[str, int], list[tuple[System, SystemAutomaton]]] = {}
    for automaton in system.automata:
        source = automaton.instance.source if automaton.instance else None
        if source is not None and source.path == path:
            by_position.setdefault((source.tree, source.position), []).append((system, automaton))
    return by_position


def _properties(analysis: Analysis, path: str, within: Span, system: System) -> Iterator[InlayHint]:
    """Hints in a property file in JANI: the nodes whose numbers occur in names of events, and the names of numbers in
    comparisons."""
    for declared in analysis.properties(path)[0]:
        for identifier, span in identifiers(declared.expression):
            if span.start > within.end or span.end < within.start:
                continue
            node = node_of(system, identifier)
            if node is not None and node.instance is not None:
                symbol = Symbol(system.path, SymbolKind.TREE_INSTANCE, str(node.instance.number))
                label = label_of(system, node.instance)
                parts = (InlayHintLabelPart(" "), InlayHintLabelPart(label, symbol))
                yield InlayHint(span.end + 1, HintKind.NODES, parts)
    json = analysis.json(path)
    for number, name in named_json_numbers(json[0]) if json is not None else ():
        yield _value(number.span, name)


def _property_file(analysis: Analysis, path: str, system: System | None) -> Iterator[InlayHint]:
    """Hints in a property file in XML: the nodes that ports name, and the names of numbers in comparisons."""
    file = analysis.property_file(path)
    for port in file.ports if file is not None and system is not None else ():
        nodes_ = nodes_called(system, port.name.value) if system and port.kind is PortKind.NODE and port.name else ()
        if system is not None and port.name is not None and len(nodes_) == 1:
            symbol = Symbol(system.path, SymbolKind.TREE_INSTANCE, str(nodes_[0].number))
            parts = (InlayHintLabelPart(" "), InlayHintLabelPart(label_of(system, nodes_[0]), symbol))
            yield InlayHint(_behind(port.name), HintKind.NODES, parts)
    for written in file.properties if file is not None else ():
        for condition in written.expressions:
            for number, name in named_numbers(file, condition.tree) if file is not None else ():
                yield _value(number.span, name)


def _value(span: Span, name: str) -> InlayHint:
    return InlayHint(span.end, HintKind.NODES, (InlayHintLabelPart(f" {name}"),))

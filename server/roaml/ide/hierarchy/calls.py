# SPDX-License-Identifier: Apache-2.0
"""The call hierarchy: which machines communicate, as a graph.

A machine calls the events, topics, services and actions that it sends to. These call the machines that receive them: a
client calls a service, and the service calls its server. A tree calls the machines of its nodes and its subtrees.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Symbol
from roaml.ide.names.in_machine import interface_symbol
from roaml.ide.names.lookup import SymbolUse, occurrences_at, symbol_group
from roaml.ide.names.occurrence import HANDLES, Access
from roaml.ide.names.occurrences import trees_of, uses
from roaml.model.outline import InterfaceUse
from roaml.model.system import System, SystemAutomaton
from roaml.model.tree import nodes
from roaml.project.analysis import Analysis
from roaml.record import Record, replace
from roaml.roles import SymbolKind
from roaml.text import Location, Span

_SENDING = frozenset((SymbolKind.PUBLISHER, SymbolKind.SERVICE_CLIENT, SymbolKind.ACTION_CLIENT))
_INTERFACES = (SymbolKind.TOPIC, SymbolKind.SERVICE, SymbolKind.ACTION)
_CALLABLE = (SymbolKind.EVENT, *_INTERFACES, SymbolKind.MACHINE, SymbolKind.TREE)


class CallHierarchyItem(Record, frozen=True):
    """A node of the graph. `span` is the span of the element, `name_span` that of its name."""

    symbol: Symbol
    path: str
    span: Span
    name_span: Span


class HierarchyCall(Record, frozen=True):
    """An edge of the graph: the item at its other end, and the places of the calls in the caller's file."""

    item: CallHierarchyItem
    places: tuple[Span, ...]


def items_at(analysis: Analysis, path: str, offset: int) -> tuple[CallHierarchyItem, ...]:
    """The items at a caret. A handle is resolved to its topic, service or action."""
    symbols: dict[Symbol, None] = {}
    for occurrence in occurrences_at(analysis, path, offset):
        symbol = occurrence.symbol
        if symbol.kind in HANDLES:
            symbols.update(dict.fromkeys(interfaces_of(analysis, symbol)))
        elif symbol.kind in _CALLABLE:
            symbols[symbol] = None
    candidates = (_item(analysis, symbol) for symbol in symbols)
    return tuple(item for item in candidates if item is not None)


def incoming(analysis: Analysis, symbol: Symbol) -> tuple[HierarchyCall, ...]:
    """The callers of an item."""
    calls = _calls(analysis, _edges(analysis, symbol, into=True))
    return tuple(
        replace(call, places=(call.item.name_span,)) if _is_message(call.item.symbol) else call for call in calls
    )


def outgoing(analysis: Analysis, symbol: Symbol) -> tuple[HierarchyCall, ...]:
    """The items that an item calls."""
    calls = _calls(analysis, _edges(analysis, symbol, into=False))
    item = _item(analysis, symbol) if _is_message(symbol) else None
    return tuple(replace(call, places=(item.name_span,)) for call in calls) if item else calls


def _is_message(symbol: Symbol) -> bool:
    """Whether the symbol of an item is an event, topic, service or action. A call by one of these items has the place
    of the name of the item."""
    return symbol.kind is SymbolKind.EVENT or symbol.kind in _INTERFACES


_Edge = tuple[Symbol, Span]


def _calls(analysis: Analysis, edges: Iterable[_Edge]) -> tuple[HierarchyCall, ...]:
    places: dict[Symbol, dict[Span, None]] = {}
    for symbol, span in edges:
        places.setdefault(symbol, {})[span] = None
    callers = ((_item(analysis, symbol), tuple(sorted(spans))) for symbol, spans in places.items())
    return tuple(HierarchyCall(item, spans) for item, spans in callers if item is not None)


def _item(analysis: Analysis, symbol: Symbol) -> CallHierarchyItem | None:
    group = symbol_group(analysis, (symbol,))
    own = [use for use in group.uses if use.occurrence.symbol == symbol]
    use = next((use for use in own if use.occurrence.defines), own[0] if own else None)
    if use is None:
        return None
    span = use.occurrence.span
    return CallHierarchyItem(symbol, use.path, _whole(analysis, use), span)


def _whole(analysis: Analysis, use: SymbolUse) -> Span:
    """The element that contains a name."""
    document = analysis.document(use.path) if analysis.kind(use.path).name in ("MACHINE", "TREE") else None
    around = document.path_at(use.occurrence.span.start) if document else []
    return around[-1].span if around else use.occurrence.span


def _edges(analysis: Analysis, symbol: Symbol, *, into: bool) -> Iterator[_Edge]:
    match symbol.kind:
        case SymbolKind.EVENT:
            yield from _of_event(analysis, symbol, into=into)
        case SymbolKind.TOPIC | SymbolKind.SERVICE | SymbolKind.ACTION:
            yield from _of_interface(analysis, symbol, into=into)
        case SymbolKind.MACHINE:
            yield from _of_machine(analysis, symbol, into=into)
        case SymbolKind.TREE:
            yield from _of_tree(analysis, symbol, into=into)


def _machine(analysis: Analysis, path: str) -> Symbol | None:
    machine = analysis.machine(path)
    return Symbol(path, SymbolKind.MACHINE, machine.name.value) if machine and machine.name else None


# ------------------------------------------------------------- events, interfaces


def _of_event(analysis: Analysis, symbol: Symbol, *, into: bool) -> Iterator[_Edge]:
    access = Access.WRITE if into else Access.READ
    for use in symbol_group(analysis, (symbol,)).uses:
        machine = _machine(analysis, use.path)
        if machine is not None and use.occurrence.access is access:
            yield machine, use.occurrence.span


def _of_interface(analysis: Analysis, symbol: Symbol, *, into: bool) -> Iterator[_Edge]:
    for system in _systems(analysis, symbol.path):
        for automaton in system.automata:
            for use in automaton.outline.interfaces:
                if (use.kind in _SENDING) == into and _interface(system, automaton, use) == symbol:
                    machine = _machine(analysis, automaton.path)
                    if machine is not None:
                        yield from ((machine, span) for span in _places(analysis, system.path, automaton, use))


def _systems(analysis: Analysis, path: str) -> tuple[System, ...]:
    owners = (analysis.system(system) for system in analysis.systems_of(path) if system)
    return tuple(system for system in owners if system is not None)


def _interface(system: System, automaton: SystemAutomaton, use: InterfaceUse) -> Symbol | None:
    name = automaton.interface_name(use)
    return None if name is None else interface_symbol(system.path, use.kind, name)


def interfaces_of(analysis: Analysis, handle: Symbol) -> Iterator[Symbol]:
    """The topics, services or actions to which a handle refers in the systems of its file."""
    for system in _systems(analysis, handle.path):
        for automaton in system.automata_of(handle.path):
            for use in automaton.outline.interfaces:
                if (use.kind, use.handle) == (handle.kind, handle.name):
                    symbol = _interface(system, automaton, use)
                    if symbol is not None:
                        yield symbol


def _places(analysis: Analysis, system: str, automaton: SystemAutomaton, use: InterfaceUse) -> tuple[Span, ...]:
    """The places where a machine sends or receives by a declared interface; if there are none, the places where it only
    names the interface, such as its declaration."""
    known = uses(analysis, automaton.path, system).by_symbol
    occurrences = list(known.get(automaton.symbol(use), ()))
    if use.name and not occurrences:  # the name of the interface is used as the handle
        occurrences = list(known.get(interface_symbol(system, use.kind, use.name), ()))
    access = Access.WRITE if use.kind in _SENDING else Access.READ
    chosen = [occurrence for occurrence in occurrences if occurrence.access is access] or [
        occurrence for occurrence in occurrences if occurrence.access is Access.TEXT
    ]
    return tuple(occurrence.span for occurrence in chosen)


# ------------------------------------------------------------- machines, trees


def _of_machine(analysis: Analysis, symbol: Symbol, *, into: bool) -> Iterator[_Edge]:
    access = Access.READ if into else Access.WRITE
    for system in analysis.systems_of(symbol.path):
        for occurrence in uses(analysis, symbol.path, system).all:
            if occurrence.symbol.kind is SymbolKind.EVENT and occurrence.access is access:
                yield occurrence.symbol, occurrence.span
    for linked in _systems(analysis, symbol.path):
        for automaton in linked.automata_of(symbol.path):
            for use in automaton.outline.interfaces:
                interface = _interface(linked, automaton, use)
                if interface is not None and (use.kind in _SENDING) != into:
                    for span in _places(analysis, linked.path, automaton, use):
                        yield interface, span
    if into:
        yield from _trees_with(analysis, symbol)


def _trees_with(analysis: Analysis, symbol: Symbol) -> Iterator[_Edge]:
    """The trees that contain nodes of a plugin, or use a tree."""
    for use in symbol_group(analysis, (symbol,)).uses:
        tree = _tree_around(analysis, symbol, use)
        if tree is not None:
            yield tree, use.occurrence.span


def _tree_around(analysis: Analysis, symbol: Symbol, use: SymbolUse) -> Symbol | None:
    file = analysis.tree(use.path)
    trees = trees_of(analysis, use.path, analysis.systems_of(use.path)[0])
    for tree in file.trees if file else ():
        for node in nodes(tree):
            if tree.id and node.plugin and node.element.open_span.contains(use.occurrence.span.start):
                inside = node.plugin.value == use.occurrence.symbol.name and use.occurrence.symbol.kind == symbol.kind
                if inside and node.element.open_span.start < use.occurrence.span.start:
                    return trees.tree_symbol(use.path, tree.id.value)
    return None


def _of_tree(analysis: Analysis, symbol: Symbol, *, into: bool) -> Iterator[_Edge]:
    if into:
        yield from _trees_with(analysis, symbol)
        return
    for location in symbol_group(analysis, (symbol,)).definitions:
        yield from _in_tree(analysis, location)


def _in_tree(analysis: Analysis, place: Location) -> Iterator[_Edge]:
    """The machines and trees that are named by the nodes of a tree. `place` is the place of the tree's definition."""
    file = analysis.tree(place.path)
    for tree in file.trees if file else ():
        if tree.id is None or tree.id.span != place.span:
            continue
        for system in analysis.systems_of(place.path):
            for occurrence in uses(analysis, place.path, system).all:
                inside = tree.element.content_span.start <= occurrence.span.start < tree.element.content_span.end
                if inside and occurrence.symbol.kind in (SymbolKind.MACHINE, SymbolKind.TREE):
                    yield occurrence.symbol, occurrence.span

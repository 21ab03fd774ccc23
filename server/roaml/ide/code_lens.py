# SPDX-License-Identifier: Apache-2.0
"""Code lenses. A lens above a declaration shows the number of its uses; a lens above a property in XML shows what the
property requires.

The positions of all lenses are computed at once. The text of a lens is computed when it becomes visible (`counted`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Symbol
from roaml.ide.describe.markdown import plain
from roaml.ide.describe.system import is_clock, is_main
from roaml.ide.hierarchy.calls import interfaces_of
from roaml.ide.names.lookup import SymbolUse, symbol_group
from roaml.ide.names.occurrence import HANDLES, Access
from roaml.ide.names.occurrences import uses
from roaml.ide.system_names import MAX_NAMES, grouped
from roaml.model.kinds import FileKind
from roaml.model.machine import Machine
from roaml.model.property_sentences import sentences
from roaml.model.system import System
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.roles import SymbolKind
from roaml.text import Location, Span


class Lens(Record, frozen=True):
    """The position of a lens. `span` is the declaration of `symbol`, or the first use of an event, which has no
    declaration."""

    span: Span
    symbol: Symbol


class Counted(Record, frozen=True):
    """The text of a lens, and the places of the uses whose number the text contains."""

    title: str
    places: tuple[Location, ...]


def lenses(analysis: Analysis, path: str) -> tuple[Lens, ...]:
    """The lenses of a file, in the order of the text."""
    kind, machine = analysis.kind(path), analysis.machine(path)
    unordered: Iterable[Lens] = ()
    if kind is FileKind.MACHINE and machine is not None:
        unordered = _machine(analysis, path, machine)
    elif kind is FileKind.TREE:
        unordered = _defined(analysis, path, SymbolKind.TREE)
    elif kind is FileKind.XML_PROPERTIES:
        unordered = _defined(analysis, path, SymbolKind.PROPERTY)
    elif kind in (FileKind.STRUCTS, FileKind.JSON_STRUCTS):
        unordered = _defined(analysis, path, SymbolKind.STRUCT)
    return tuple(sorted(dict.fromkeys(unordered), key=lambda lens: lens.span))


def _machine(analysis: Analysis, path: str, machine: Machine) -> Iterator[Lens]:
    owner = _owner(analysis, path)
    if machine.name is not None and (machine.ports or _is_plugin(analysis, path)):
        yield Lens(machine.name.span, Symbol(path, SymbolKind.MACHINE, machine.name.value))
    for port in machine.ports:
        if port.key is not None:
            yield Lens(port.key.span, Symbol(path, SymbolKind.PORT, port.key.value))
    for declaration in machine.declarations:
        if declaration.handle is not None:
            symbol = Symbol(path, declaration.kind, declaration.handle.value)
            yield Lens(declaration.element.name_span, symbol)
    seen: set[Symbol] = set()
    for occurrence in uses(analysis, path, owner if owner != path else None).all:
        if occurrence.symbol.kind is SymbolKind.EVENT and occurrence.symbol not in seen:
            seen.add(occurrence.symbol)
            yield Lens(occurrence.span, occurrence.symbol)


def _defined(analysis: Analysis, path: str, kind: SymbolKind) -> Iterator[Lens]:
    """The lenses above the definitions of symbols of one kind."""
    owner = _owner(analysis, path)
    for occurrence in uses(analysis, path, owner if owner != path else None).all:
        if occurrence.defines and occurrence.symbol.kind is kind:
            yield Lens(occurrence.span, occurrence.symbol)


def _owner(analysis: Analysis, path: str) -> str:
    return next(iter(analysis.memberships.get(path, ())), path)


def _is_plugin(analysis: Analysis, path: str) -> bool:
    systems = (analysis.system(owner) for owner in analysis.memberships.get(path, ()))
    return any(path == plugin for system in systems if system for plugin, _ in system.plugins)


# ---------------------------------------------------------------------- counting


def counted(analysis: Analysis, symbol: Symbol, path: str) -> Counted:
    """The text of the lens of a symbol of a file. For a property in XML, this is its sentence. For other symbols, it is
    the number of uses, with their places: the uses are counted for each system that contains the file; if the numbers
    differ, the text names the systems."""
    if symbol.kind is SymbolKind.PROPERTY:
        file = analysis.property_file(path)
        return Counted(plain(sentences(file).get(symbol.name, "")) if file is not None else "", ())
    systems = analysis.systems_of(path)
    by_system = {system or "": _counted(analysis, symbol, system) for system in systems}
    texts = grouped({system: count.title for system, count in by_system.items()})
    title = " / ".join(f"{names}: {title}" if names else title for title, names in texts[:MAX_NAMES])
    places = tuple(sorted({place for count in by_system.values() for place in count.places}))
    return Counted(f"{title} / …" if len(texts) > MAX_NAMES else title, places)


def _counted(analysis: Analysis, symbol: Symbol, system: str | None) -> Counted:
    """The uses of a symbol in one system, or in the file if `system` is `None`."""
    if symbol.kind in HANDLES:
        return _handle(analysis, symbol, system)
    uses_in_system = _within(analysis, symbol_group(analysis, (symbol,)).uses, system)
    in_trees = [use for use in uses_in_system if analysis.tree(use.path) is not None]
    match symbol.kind:
        case SymbolKind.EVENT:
            return _event(analysis, uses_in_system)
        case SymbolKind.MACHINE:
            return Counted(f"{_count(in_trees, 'use')} in trees", _locations(in_trees))
        case SymbolKind.PORT:
            return Counted(f"set {_times(in_trees)} in trees", _locations(in_trees))
        case SymbolKind.TREE:
            places = [use for use in in_trees if not use.occurrence.defines]
            executed = "executed · " if is_main(analysis, symbol) else ""
            return Counted(f"{executed}{_count(places, 'use')}", _locations(places))
    places = [use for use in uses_in_system if not use.occurrence.defines]
    return Counted(_count(places, "use"), _locations(places))


def _within(analysis: Analysis, symbol_uses: Iterable[SymbolUse], system: str | None) -> list[SymbolUse]:
    """The uses in the files of a system; all uses if `system` is `None`."""
    files = frozenset(analysis.files_of(system)) if system else None
    return [use for use in symbol_uses if files is None or use.path in files]


def _event(analysis: Analysis, symbol_uses: Iterable[SymbolUse]) -> Counted:
    in_machines = [use for use in symbol_uses if analysis.machine(use.path) is not None]
    sent = [use for use in in_machines if use.occurrence.access is Access.WRITE]
    received = [use for use in in_machines if use.occurrence.access is Access.READ]
    return Counted(f"sent {_times(sent)} · received {_times(received)}", _locations(in_machines))


_SIDES = {
    SymbolKind.TOPIC: ("publisher", "subscriber"),
    SymbolKind.SERVICE: ("server", "client"),
    SymbolKind.ACTION: ("server", "client"),
}


def _handle(analysis: Analysis, symbol: Symbol, system: str | None) -> Counted:
    """The uses of a handle: the numbers of publishers and subscribers, or of servers and clients, of its interface, or
    the callbacks of a timer."""
    own = [use for use in symbol_group(analysis, (symbol,)).uses if not use.occurrence.defines]
    linked = analysis.system(system) if system else None
    interfaces = tuple(
        dict.fromkeys(interface for interface in interfaces_of(analysis, symbol) if interface.path == system)
    )
    if not interfaces or linked is None:
        return Counted(_count(own, "use"), _locations(own))
    shown = [_sides(linked, interface) for interface in interfaces]
    places = [
        use for interface in interfaces for use in _within(analysis, symbol_group(analysis, (interface,)).uses, system)
    ]
    title = " / ".join(dict.fromkeys(shown))
    if len(interfaces) > 1:
        title = f"{len(interfaces)} {interfaces[0].kind.value}s: {title}"
    in_models = (use for use in places if analysis.machine(use.path) or analysis.tree(use.path))
    return Counted(title, _locations((*in_models, *own)))


def _sides(system: System, interface: Symbol) -> str:
    channel = system.channels(interface.kind).get(interface.name)
    source, user = _SIDES[interface.kind]
    sources, users = (channel.sources, channel.users) if channel else ([], [])
    if is_clock(system, interface):
        return f"the clock · {_count(users, user)}"
    return f"{_count(sources, source)} · {_count(users, user)}"


def _count(counted_things: Iterable[object], noun: str) -> str:
    count = len(list(counted_things))
    return f"{count} {noun}" if count == 1 else f"{count or 'no'} {noun}s"


def _times(counted_things: Iterable[object]) -> str:
    count = len(list(counted_things))
    return {0: "nowhere", 1: "once", 2: "twice"}.get(count, f"{count} times")


def _locations(symbol_uses: Iterable[SymbolUse]) -> tuple[Location, ...]:
    return tuple(sorted(dict.fromkeys(use.location for use in symbol_uses)))

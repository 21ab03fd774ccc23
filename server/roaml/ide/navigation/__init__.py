# SPDX-License-Identifier: Apache-2.0
"""Navigation from a name to its definition, declaration, type, implementation and uses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Symbol
from roaml.expr.types import Struct, StructKind, Type, unwrap
from roaml.ide.names.lookup import SymbolGroup, SymbolUse, occurrences_at, symbol_group, symbol_group_at
from roaml.ide.names.occurrence import DEFINED_BY_ROS, HANDLES, Access
from roaml.ide.navigation.interface_files import locate_ros, locate_type, type_of_field
from roaml.libraries.programs.assembly import program_place
from roaml.model.expand import tree_called
from roaml.model.system import System
from roaml.model.tree import nodes
from roaml.model.value_types import INTERFACE_KINDS
from roaml.project.analysis import Analysis
from roaml.project.paths import resolve
from roaml.record import Record
from roaml.roles import SymbolKind
from roaml.text import Location, Span

INTERFACES = (SymbolKind.TOPIC, SymbolKind.SERVICE, SymbolKind.ACTION)


class DocumentHighlight(Record, frozen=True):
    """A use of the symbol at a caret, in the file of the caret. `access` is the kind of the use; a definition is a
    write access."""

    span: Span
    access: Access


def definition(analysis: Analysis, path: str, offset: int) -> tuple[Location, ...]:
    """The definitions of the symbol at a caret, or the file whose path is at the caret. Those of an event are its
    senders, those of a topic its publishers, and those of a service or action its servers. An attribute of a
    `<SubTree>` leads to the entry in the subtree: to its definitions there, otherwise to its first use."""
    file = _file_at(analysis, path, offset)
    if file is not None:
        return (Location(file, Span(0, 0)),)
    group = symbol_group_at(analysis, path, offset)
    if group is None:
        return ()
    entered = _in_subtree(analysis, path, offset, group)
    return entered or (*group.definitions, *_ros(analysis, group.symbols), *_builtin(group.symbols))


def definition_of(analysis: Analysis, symbol: Symbol) -> Location | None:
    """The first definition of a symbol; if there is none, its first use; `None` if there is neither."""
    group = symbol_group(analysis, (symbol,))
    uses = (use.location for use in group.uses)
    return next(iter((*_ros(analysis, (symbol,)), *_builtin((symbol,)), *group.definitions, *uses)), None)


def declaration(analysis: Analysis, path: str, offset: int) -> tuple[Location, ...]:
    """The declarations of the symbol at a caret. Those of a topic, service or action are the declarations in all
    machines that use it; for other symbols, the result is that of `definition`."""
    group = symbol_group_at(analysis, path, offset)
    if group is None or not group.kinds & set(INTERFACES):
        return definition(analysis, path, offset)
    return tuple(use.location for use in group.uses if use.occurrence.access is Access.TEXT)


def implementation(analysis: Analysis, path: str, offset: int) -> tuple[Location, ...]:
    """The implementations of the symbol at a caret. Those of an event are its handlers; for other symbols, the result
    is that of `definition`, such as the machine of a tree node."""
    group = symbol_group_at(analysis, path, offset)
    if group is not None and SymbolKind.EVENT in group.kinds:
        return tuple(
            use.location
            for use in group.uses
            if use.occurrence.access is Access.READ and analysis.machine(use.path) is not None
        )
    return definition(analysis, path, offset)


def references(analysis: Analysis, path: str, offset: int, *, with_declaration: bool = True) -> tuple[Location, ...]:
    """All uses of the symbol at a caret, in all files, sorted by file and place; `with_declaration` includes its
    definitions."""
    group = symbol_group_at(analysis, path, offset)
    if group is None:
        return ()
    uses = (use.location for use in group.uses if with_declaration or not use.occurrence.defines)
    return (*uses, *(_ros(analysis, group.symbols) if with_declaration else ()))


def highlights(analysis: Analysis, path: str, offset: int) -> tuple[DocumentHighlight, ...]:
    """All uses of the symbol at a caret, in the file of the caret."""
    group = symbol_group_at(analysis, path, offset)
    uses: Iterable[SymbolUse] = group.uses if group else ()
    return tuple(_highlight(use) for use in uses if use.path == path)


def _highlight(use: SymbolUse) -> DocumentHighlight:
    occurrence = use.occurrence
    return DocumentHighlight(occurrence.span, Access.WRITE if occurrence.defines else occurrence.access)


def _ros(analysis: Analysis, symbols: Iterable[Symbol]) -> tuple[Location, ...]:
    places = (locate_ros(analysis, symbol) for symbol in symbols if symbol.kind in DEFINED_BY_ROS)
    return tuple(dict.fromkeys(place for place in places if place is not None))


def _builtin(symbols: Iterable[Symbol]) -> Iterator[Location]:
    """The programs of the nodes of BehaviorTree.CPP, which define the behavior of the nodes in the translation."""
    for symbol in symbols:
        place = program_place(symbol.name) if symbol.kind is SymbolKind.PLUGIN and not symbol.path else None
        if place is not None:
            yield place


def _in_subtree(analysis: Analysis, path: str, offset: int, group: SymbolGroup) -> tuple[Location, ...]:
    """The definitions, in a subtree, of the entry that an attribute of a `<SubTree>` at a caret sets; if there are
    none, its first use there; empty if there is no such attribute, or if the subtree does not use the entry."""
    file = analysis.tree(path)
    subtrees = (node for tree in file.trees for node in nodes(tree) if node.is_subtree) if file else ()
    named = next((n.plugin for n in subtrees if any(port.key.span.contains(offset) for port in n.ports)), None)
    if named is None:
        return ()
    inside = [use for use in group.uses if _is_in_tree(analysis, use.location, named.value)]
    defining = tuple(use.location for use in inside if use.occurrence.defines)
    return defining or tuple(use.location for use in inside[:1])


def _is_in_tree(analysis: Analysis, place: Location, name: str) -> bool:
    file = analysis.tree(place.path)
    tree = tree_called(file, name) if file is not None else None
    return tree is not None and tree.element.span.start <= place.span.start < tree.element.span.end


def _file_at(analysis: Analysis, path: str, offset: int) -> str | None:
    """The file to which the path at a caret refers; `None` if there is no path, or if the file cannot be read."""
    system, tree = analysis.system_file(path), analysis.tree(path)
    names = [entry.src for entry in system.inputs] if system else []
    names += [include.path for include in tree.includes] if tree else []
    named = next((name for name in names if name and name.span.contains(offset)), None)
    target = resolve(path, named.value) if named else None
    return target if target and analysis.source(target) is not None else None


# ------------------------------------------------------------------------ types


def type_definition(analysis: Analysis, path: str, offset: int) -> tuple[Location, ...]:
    """The definition of the type of the symbol at a caret: a struct, or a ROS definition file."""
    locations: dict[Location, None] = {}
    for occurrence in occurrences_at(analysis, path, offset):
        for system in analysis.systems_of(path):
            locations.update(dict.fromkeys(_type_of(analysis, path, system, occurrence.symbol)))
    return tuple(locations)


def _type_of(analysis: Analysis, path: str, system: str | None, symbol: Symbol) -> Iterator[Location]:
    linked = analysis.system(system) if system else None
    match symbol.kind:
        case SymbolKind.VARIABLE:
            types = analysis.typed_in(symbol.path, system).variables.get(symbol.scope, {})
            yield from _of_type(analysis, system or path, types.get(symbol.name))
        case SymbolKind.MEMBER:
            struct = analysis.structs(system).types.get(symbol.scope)
            if isinstance(struct, Struct):
                yield from _of_type(analysis, system or path, struct.member(symbol.name))
        case SymbolKind.PARAMETER:
            data = linked.event_data.get(symbol.scope) if linked else None
            yield from _of_type(analysis, system or path, data.member(symbol.name) if data else None)
        case SymbolKind.STRUCT:
            yield from symbol_group(analysis, (symbol,)).definitions
        case SymbolKind.FIELD:
            place = type_of_field(analysis, symbol)
            if place is not None:
                yield place
        case SymbolKind.ROS_TYPE:
            yield from _ros(analysis, (symbol,))
        case kind if kind in HANDLES:
            yield from _of_handle(analysis, symbol)
        case kind if kind in INTERFACES and linked is not None:
            yield from _of_interface(analysis, linked, symbol)
        case kind if kind in INTERFACES:
            yield from _of_declarations(analysis, symbol_group(analysis, (symbol,)))


def _of_type(analysis: Analysis, owner: str, type_: Type | None) -> Iterator[Location]:
    inner = unwrap(type_)[0] if type_ is not None else None
    if isinstance(inner, Struct) and inner.kind is StructKind.DECLARED:
        yield from symbol_group(analysis, (Symbol(owner, SymbolKind.STRUCT, inner.name),)).definitions


def _of_handle(analysis: Analysis, symbol: Symbol) -> Iterator[Location]:
    machine = analysis.machine(symbol.path)
    for declared in machine.declarations if machine else ():
        if declared.kind == symbol.kind and declared.handle and declared.handle.value == symbol.name and declared.type:
            place = locate_type(analysis, INTERFACE_KINDS.get(declared.kind, "msg"), declared.type.value)
            if place is not None:
                yield place


def _of_interface(analysis: Analysis, system: System, symbol: Symbol) -> Iterator[Location]:
    channel = system.channels(symbol.kind).get(symbol.name)
    for endpoint in channel.endpoints if channel else ():
        place = locate_type(analysis, INTERFACE_KINDS[endpoint.use.kind], endpoint.use.type)
        if place is not None:
            yield place


def _of_declarations(analysis: Analysis, group: SymbolGroup) -> Iterator[Location]:
    for use in group.uses:
        machine = analysis.machine(use.path)
        for declared in machine.declarations if machine else ():
            name = declared.interface
            if name is not None and name.span.contains(use.occurrence.span.start) and declared.type:
                place = locate_type(analysis, INTERFACE_KINDS[declared.kind], declared.type.value)
                if place is not None:
                    yield place

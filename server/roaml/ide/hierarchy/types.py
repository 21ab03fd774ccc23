# SPDX-License-Identifier: Apache-2.0
"""The type hierarchy: messages and structs.

The subtypes of a type are the types of its fields or members; its supertypes are the types that contain it. Supertypes
are found only among the ROS types that the machines of the systems declare, and the types inside these.
"""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Symbol
from roaml.expr.types import Struct, StructKind, unwrap
from roaml.ide.names.lookup import occurrences_at
from roaml.ide.navigation import definition_of
from roaml.interfaces.registry import NotFound
from roaml.interfaces.types import KIND_NAMES, Definition, Kind
from roaml.model.value_types import INTERFACE_KINDS
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.roles import SymbolKind
from roaml.text import Location


class TypeItem(Record, frozen=True):
    """A message, service, action or struct. In results about another type, `detail` lists the fields that connect both
    types; otherwise, it is the kind of the type."""

    symbol: Symbol
    detail: str
    location: Location


def types_at(analysis: Analysis, path: str, offset: int) -> tuple[TypeItem, ...]:
    """The types at a caret: the type that is written there, or the types of the variable, field or member."""
    symbols: dict[Symbol, None] = {}
    for occurrence in occurrences_at(analysis, path, offset):
        symbols.update(dict.fromkeys(_types_of(analysis, path, occurrence.symbol)))
    items = (_item(analysis, symbol, ()) for symbol in symbols)
    return tuple(item for item in items if item is not None)


def members_of(analysis: Analysis, symbol: Symbol) -> tuple[TypeItem, ...]:
    """The types of the fields or members of a type."""
    return _items(analysis, ((inner, name) for name, inner in _inside(analysis, symbol)))


def holders_of(analysis: Analysis, symbol: Symbol) -> tuple[TypeItem, ...]:
    """The types with a field or member of the type `symbol`."""
    candidates = _structs(analysis, symbol.path) if symbol.kind is SymbolKind.STRUCT else _used(analysis)
    fields = ((holder, name) for holder in candidates for name, inner in _inside(analysis, holder) if inner == symbol)
    return _items(analysis, fields)


def _items(analysis: Analysis, holders: Iterator[tuple[Symbol, str]]) -> tuple[TypeItem, ...]:
    fields: dict[Symbol, list[str]] = {}
    for symbol, field in holders:
        fields.setdefault(symbol, []).append(field)
    items = (_item(analysis, symbol, tuple(names)) for symbol, names in fields.items())
    return tuple(item for item in items if item is not None)


def _item(analysis: Analysis, symbol: Symbol, fields: tuple[str, ...]) -> TypeItem | None:
    place = definition_of(analysis, symbol)
    if place is None or analysis.source(place.path) is None:
        return None
    kind_name = "struct" if symbol.kind is SymbolKind.STRUCT else KIND_NAMES[_kind(symbol)]
    return TypeItem(symbol, ", ".join(fields) or kind_name, place)


def _kind(symbol: Symbol) -> Kind:
    return symbol.scope  # type: ignore[return-value]


def _message(name: str) -> Symbol:
    return Symbol("", SymbolKind.ROS_TYPE, name, "msg")


def _types_of(analysis: Analysis, path: str, symbol: Symbol) -> Iterator[Symbol]:
    match symbol.kind:
        case SymbolKind.ROS_TYPE | SymbolKind.STRUCT:
            yield symbol
        case SymbolKind.VARIABLE | SymbolKind.MEMBER:
            for system in analysis.systems_of(path):
                if symbol.kind is SymbolKind.VARIABLE:
                    type_ = analysis.typed_in(symbol.path, system).variables.get(symbol.scope, {}).get(symbol.name)
                else:
                    owner = analysis.structs(system).types.get(symbol.scope)
                    type_ = owner.member(symbol.name) if isinstance(owner, Struct) else None
                inner = unwrap(type_)[0] if type_ is not None else None
                if isinstance(inner, Struct) and inner.kind is StructKind.DECLARED:
                    yield Symbol(system or path, SymbolKind.STRUCT, inner.name)
        case SymbolKind.FIELD:
            name, _, section = symbol.scope.partition(" ")
            kinds = {"request": "srv", "response": "srv", "": "msg", "goal": "action"}
            for inner_name, inner_symbol in _inside(
                analysis, Symbol("", SymbolKind.ROS_TYPE, name, kinds.get(section, "action"))
            ):
                if inner_name == symbol.name:
                    yield inner_symbol


def _inside(analysis: Analysis, symbol: Symbol) -> Iterator[tuple[str, Symbol]]:
    """The fields or members of a type that are messages or structs."""
    if symbol.kind is SymbolKind.STRUCT:
        struct = analysis.structs(symbol.path).types.get(symbol.name) if symbol.path in analysis.system_paths else None
        for name, type_ in struct.members if isinstance(struct, Struct) else ():
            inner, _ = unwrap(type_)
            if isinstance(inner, Struct):
                yield name, Symbol(symbol.path, SymbolKind.STRUCT, inner.name)
        return
    definition = analysis.registry.resolve(_kind(symbol), symbol.name)
    for section in () if isinstance(definition, NotFound) else definition.sections:
        for field in section.fields:
            if not field.type.is_primitive:
                yield field.name, _message(field.type.name)


def _structs(analysis: Analysis, system: str) -> list[Symbol]:
    types = analysis.structs(system).types if system in analysis.system_paths else {}
    return [Symbol(system, SymbolKind.STRUCT, name) for name in types]


def _used(analysis: Analysis) -> list[Symbol]:
    """The ROS types that machines declare, and the types inside them."""
    ros_types: dict[Symbol, None] = {}
    for path in dict.fromkeys(p for system in analysis.system_paths for p in analysis.files_of(system)):
        machine = analysis.machine(path)
        for declaration in machine.declarations if machine else ():
            kind = INTERFACE_KINDS.get(declaration.kind)
            definition = analysis.registry.resolve(kind, declaration.type.value) if kind and declaration.type else None
            if isinstance(definition, Definition):
                ros_types[Symbol("", SymbolKind.ROS_TYPE, definition.full_name, definition.kind)] = None
    todo = list(ros_types)
    while todo:
        for _, inner in _inside(analysis, todo.pop()):
            if inner not in ros_types:
                ros_types[inner] = None
                todo.append(inner)
    return list(ros_types)

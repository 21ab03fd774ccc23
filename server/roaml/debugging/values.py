# SPDX-License-Identifier: Apache-2.0
"""Values of variables as the sources declare them: structs with members, strings, and arrays with their length.

The translation stores a struct as one variable for each leaf, a string as an array of characters, and an array with its
bound and a length (docs/spec/jani.md#array-storage).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TypeAlias, cast

from roaml.expr.types import Array, Struct, Type
from roaml.smc.record import Plain
from roaml.views.arrays import declared, element_at, length_of, without_lengths
from roaml.views.values import shown_value

Value: TypeAlias = "bool | int | float | str | list[Value] | dict[str, Value]"

SEPARATOR = "__"
"""Separates the members of a struct in the name of a variable."""


def typed_value(name: str, type_: Type | None, stored: Mapping[str, Plain]) -> Value | None:
    """The value of a variable with a declared type; `None` if it is not stored.

    Args:
        stored: the variables of the network, lengths included.
    """
    return _built(name, type_, stored, ())


def untyped_values(stored: Mapping[str, Plain]) -> dict[str, Value]:
    """The values of variables without declared types. Arrays are cut to their length."""
    return cast("dict[str, Value]", without_lengths(stored))


def nested(values: Mapping[str, Value]) -> dict[str, Value]:
    """Values of leaves, as structs: `{"pose__x": 1}` becomes `{"pose": {"x": 1}}`. Members of ROS messages do not
    contain the separator themselves."""
    result: dict[str, Value] = {}
    for name, value in values.items():
        *path, last = name.split(SEPARATOR)
        members = result
        for member in path:
            inner = members.setdefault(member, {})
            if not isinstance(inner, dict):
                inner = members[member] = {}
            members = inner
        members[last] = value
    return result


def _built(name: str, type_: Type | None, stored: Mapping[str, Plain], index: tuple[int, ...]) -> Value | None:
    if isinstance(type_, Struct):
        members = ((m, _built(f"{name}{SEPARATOR}{m}", inner, stored, index)) for m, inner in type_.members)
        return {member: value for member, value in members if value is not None}
    if isinstance(type_, Array):
        length = length_of(_first_leaf(name, type_), stored, index)
        if length is not None:
            elements = (_built(name, type_.element, stored, (*index, i)) for i in range(length))
            return [element for element in elements if element is not None]
    if name not in stored:
        return None
    return cast(Value, declared(name, element_at(stored[name], index), stored, index))


def _first_leaf(name: str, type_: Type) -> str:
    while True:
        if isinstance(type_, Array):
            type_ = type_.element
        elif isinstance(type_, Struct) and type_.members:
            member, type_ = type_.members[0]
            name = f"{name}{SEPARATOR}{member}"
        else:
            return name


def bytes_of(text: str) -> bytes:
    """The bytes of a string (docs/spec/types.md#strings)."""
    return text.encode("utf-8", "surrogatepass")


MAX_SHOWN = 120
"""The maximum number of characters of a displayed struct or array."""


def shown(value: Value) -> str:
    """A value in the notation of expressions; a long struct or array is abbreviated."""
    match value:
        case bool() | int() | float() | str():
            return shown_value(value)
        case list():
            return _joined("[", (shown(element) for element in value[:MAX_SHOWN]), "]")
        case dict():
            return _joined("{", (f"{member}: {shown(inner)}" for member, inner in value.items()), "}")


def _joined(left: str, parts: Iterable[str], right: str) -> str:
    text = ", ".join(parts)
    return f"{left}{text if len(text) <= MAX_SHOWN else text[:MAX_SHOWN] + '…'}{right}"


def type_of(value: Value) -> str:
    """The name of the type of a value whose declaration is not known."""
    match value:
        case bool():
            return "bool"
        case int():
            return "int"
        case float():
            return "real"
        case str():
            return "string"
        case list():
            return f"array of {len(value)}"
        case dict():
            return "struct"

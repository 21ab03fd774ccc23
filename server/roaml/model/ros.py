# SPDX-License-Identifier: Apache-2.0
"""ROS interface types in HL-SCXML: their parts as structs of HL-SCXML types (docs/spec/ros.md#interface-types).

- Every kind of ROS field has an HL-SCXML type. The reference translator does not support some kinds of fields. Models
  that were written for it omit these fields, so they need not be set (`InterfaceType.optional`).
- A member has an unknown type if the definition of its type is not found, or contains itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeAlias

from roaml.expr.types import BASE_TYPES, UNKNOWN, Array, Struct, StructKind, Type, leaves, unwrap
from roaml.interfaces.registry import NotFound
from roaml.interfaces.types import SECTION_NAMES, ArrayKind, Definition, Field, FieldType, Kind, Section
from roaml.model.nesting import TypeExtent, extents
from roaml.record import Record

FindMessage: TypeAlias = Callable[[str], Definition | NotFound]
"""Finds the definition of a message by its full name, `package/Name`."""

_HL_NAMES = {"byte": "uint8", "char": "uint8", "wstring": "string"}
_REFERENCE_SEQUENCES = frozenset(("int32", "float32", "float64"))


class RepeatedType(Record, frozen=True):
    """A ROS type that two files define differently.

    Attributes:
        used_by: the type in a declaration, as written; it is the repeated type or contains it.
        path: the file whose definition is used.
        other: the file whose definition is ignored.
    """

    used_by: str
    package: str
    name: str
    path: str
    other: str


Enumeration: TypeAlias = tuple[tuple[str, int], ...]
"""The names and values of the constants for a field, in the order of their values."""


class InterfaceType(Record, frozen=True):
    """A ROS interface type in terms of HL-SCXML.

    Attributes:
        name: the full name, `package/Name`.
        parts: the names of the parts with their structs: message; request and response; or goal, result and feedback.
        optional: for each part, the dotted paths of the leaf fields that need not be set.
        enumerations: part, field, and the constants that are all values of this field.
    """

    name: str
    kind: Kind
    parts: tuple[tuple[str, Struct], ...]
    optional: tuple[tuple[str, frozenset[str]], ...]
    enumerations: tuple[tuple[str, str, Enumeration], ...] = ()

    def part(self, name: str) -> Struct:
        return dict(self.parts)[name]

    def required(self, part: str) -> tuple[str, ...]:
        """The dotted paths of the leaf fields of `part` that must be set, in the order of the definition."""
        skip = dict(self.optional)[part]
        return tuple(path for path in self.leaf_paths(part) if path not in skip)

    def leaf_paths(self, part: str) -> tuple[str, ...]:
        return tuple(".".join(path) for path, _ in leaves(self.part(part)))


def interface_type(definition: Definition, find: FindMessage) -> InterfaceType:
    """The interface type of `definition`, which must not be too large (see `extent_of`). `find` resolves nested
    messages."""
    parts, optional, enumerations = [], [], []
    reader = _Reader(find)
    for name, section in zip(SECTION_NAMES[definition.kind], definition.sections, strict=True):
        label = name if definition.kind == "msg" else f"{name} of {definition.full_name}"
        title = definition.full_name if definition.kind == "msg" else f"{definition.full_name} {name}"
        if definition.kind == "msg":
            reader.inside.append(definition.full_name)
        parts.append((name, Struct(title, reader.members(section), label, StructKind.ROS)))
        optional.append((name, frozenset(_optional(section, (), parts[-1][1], find))))
        for field in section.fields:
            values = _enumeration(section, field)
            if values:
                enumerations.append((name, field.name, values))
    return InterfaceType(definition.full_name, definition.kind, tuple(parts), tuple(optional), tuple(enumerations))


def _enumeration(section: Section, field: Field) -> Enumeration:
    """The constants that are all values of a field, because they are consecutive integers, and named after it or the
    only ones for the only field of their type; otherwise none."""
    named = section.named_values(field.name)
    values = sorted((c.value, c.name) for c in named if isinstance(c.value, int) and not isinstance(c.value, bool))
    numbers = [number for number, _ in values]
    is_series = len(numbers) > 1 and numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    is_named = all(c.name.startswith(field.name.upper()) for c in named)
    is_only = sum(other.type.name == field.type.name for other in section.fields) == 1
    is_limit = any(word in _LIMITS for c in named for word in c.name.split("_"))
    if field.type.is_array or not is_series or is_limit or not (is_named or is_only):
        return ()
    return tuple((name, number) for number, name in values)


_LIMITS = frozenset(("DEFAULT", "LIMIT", "MAX", "MIN", "SIZE"))
"""Words in the names of constants that limit the values of a field, which is then no enumeration."""


def extent_of(definitions: Iterable[Definition]) -> TypeExtent:
    """The size of the first definition. The other definitions are the messages that it contains."""
    fields = {message.full_name: [f.type.name for s in message.sections for f in s.fields] for message in definitions}
    return extents(fields)[next(iter(fields))]


class _Reader:
    """Creates the type of each message once. `inside` contains the messages whose types are not finished yet."""

    def __init__(self, find: FindMessage) -> None:
        self.find = find
        self.inside: list[str] = []
        self.known: dict[str, Type] = {}

    def members(self, section: Section) -> tuple[tuple[str, Type], ...]:
        return tuple((field.name, self.member(field)) for field in section.fields)

    def member(self, field: Field) -> Type:
        type_ = self.element(field.type.element)
        if field.type.is_array:
            bound = None if field.type.array is ArrayKind.UNBOUNDED else field.type.size
            return Array(type_, bound)
        return type_

    def element(self, type_: FieldType) -> Type:
        if type_.is_primitive:
            return BASE_TYPES[_HL_NAMES.get(type_.name, type_.name)]
        if type_.name not in self.known:
            definition = self.find(type_.name)
            if isinstance(definition, NotFound) or type_.name in self.inside:
                return UNKNOWN
            self.inside.append(type_.name)
            self.known[type_.name] = Struct(type_.name, self.members(definition.sections[0]), "message", StructKind.ROS)
            self.inside.pop()
        return self.known[type_.name]


def _optional(section: Section, path: tuple[str, ...], struct: Struct, find: FindMessage) -> Iterator[str]:
    """The dotted paths of the fields that need not be set."""
    for field, (_, type_) in zip(section.fields, struct.members, strict=True):
        if not known_to_reference(field.type):
            yield ".".join((*path, field.name))
        inner, _ = unwrap(type_)
        definition = find(field.type.name) if isinstance(inner, Struct) else None
        if isinstance(inner, Struct) and isinstance(definition, Definition):
            yield from _optional(definition.sections[0], (*path, field.name), inner, find)


def known_to_reference(type_: FieldType) -> bool:
    """Whether the reference translator requires a field of this type to be set (docs/spec/ros.md#required-fields)."""
    if not type_.is_primitive:
        return True
    if type_.is_array:
        return type_.array is ArrayKind.UNBOUNDED and type_.name in _REFERENCE_SEQUENCES
    return type_.name not in ("byte", "wstring")

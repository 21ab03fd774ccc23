# SPDX-License-Identifier: Apache-2.0
"""Struct declarations (spec/01 §3): read from XML, and resolved to types."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from roaml.expr.types import BASE_TYPES, UNKNOWN, Struct, Type, TypeName, wrap
from roaml.model.syntax import Name, TypeRef, name_of, type_of
from roaml.text import Span
from roaml.xml import Document


@dataclass(frozen=True, slots=True)
class MemberDeclaration:
    """`span` is the whole declaration."""

    name: Name | None
    type: TypeRef | None
    span: Span


@dataclass(frozen=True, slots=True)
class StructDeclaration:
    name: Name | None
    members: tuple[MemberDeclaration, ...]
    span: Span

    @property
    def outline(self) -> StructOutline | None:
        """The declaration without places; None if it has no name."""
        if self.name is None:
            return None
        members = tuple((m.name.value, m.type.name) for m in self.members if m.name and m.type and m.type.name)
        return StructOutline(self.name.value, members)


@dataclass(frozen=True, slots=True)
class StructOutline:
    """Name and members of a struct; members whose declaration is incomplete are left out."""

    name: str
    members: tuple[tuple[str, TypeName], ...]


def structs_in_xml(document: Document) -> tuple[StructDeclaration, ...]:
    """The declarations in a `<types>` file."""
    if document.root is None:
        return ()
    return tuple(
        StructDeclaration(
            name_of(struct.get("id")),
            tuple(
                MemberDeclaration(name_of(member.get("id")), type_of(member.get("type")), member.span)
                for member in struct.elements
                if member.name == "member"
            ),
            struct.span,
        )
        for struct in document.root.elements
        if struct.name == "struct"
    )


def resolve_structs(outlines: Iterable[StructOutline]) -> Mapping[str, Type]:
    """All structs by name, their members resolved. Of equal names the last counts.

    A member whose type is not known, or that would contain the struct itself, has an unknown type.
    """
    by_name = {outline.name: outline for outline in outlines}
    resolved: dict[str, Type] = {}

    def resolve(name: str, inside: tuple[str, ...]) -> Type:
        if name in BASE_TYPES:
            return BASE_TYPES[name]
        if name in resolved:
            return resolved[name]
        outline = by_name.get(name)
        if outline is None or name in inside:
            return UNKNOWN
        path = (*inside, name)
        struct = Struct(name, tuple((m, wrap(resolve(t.base, path), t.dimensions)) for m, t in outline.members))
        if not inside:
            resolved[name] = struct
        return struct

    for name in by_name:
        resolve(name, ())
    return resolved


def struct_cycle(name: str, outlines: Mapping[str, StructOutline]) -> tuple[str, ...]:
    """The names on a path of members from struct `name` back to itself, both ends included; empty if there is none."""
    stack: list[tuple[str, ...]] = [(name,)]
    seen: set[str] = set()
    while stack:
        path = stack.pop()
        outline = outlines.get(path[-1])
        for _, type_ in outline.members if outline else ():
            if type_.base == name:
                return (*path, name)
            if type_.base in outlines and type_.base not in seen:
                seen.add(type_.base)
                stack.append((*path, type_.base))
    return ()

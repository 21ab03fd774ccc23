# SPDX-License-Identifier: Apache-2.0
"""Reads struct declarations from XML and resolves them to types (docs/spec/types.md#structs)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from roaml.expr.types import BASE_TYPES, UNKNOWN, Struct, Type, TypeName, wrap
from roaml.model.nesting import TypeExtent, extents
from roaml.model.syntax import Name, TypeRef, name_of, type_of
from roaml.record import Record
from roaml.text import Span
from roaml.xml_syntax import Document, Element


class MemberDeclaration(Record, frozen=True):
    """The declaration of a member of a struct. `span` is the whole declaration."""

    name: Name | None
    type: TypeRef | None
    span: Span


class StructDeclaration(Record, frozen=True):
    """The declaration of a struct. `complete` means that all parts of it could be read."""

    name: Name | None
    members: tuple[MemberDeclaration, ...]
    span: Span
    complete: bool = True

    @property
    def outline(self) -> StructOutline | None:
        """The declaration without positions; `None` if it has no name."""
        if self.name is None:
            return None
        members = tuple((m.name.value, m.type.name if m.type else None) for m in self.members if m.name)
        return StructOutline(self.name.value, members, self.complete and all(m.name for m in self.members))


class StructOutline(Record, frozen=True):
    """The name and the members of a struct, without positions. The type of a member is `None` if it cannot be read.
    `complete` means that all declarations of members could be read."""

    name: str
    members: tuple[tuple[str, TypeName | None], ...]
    complete: bool = True


def structs_in_xml(document: Document) -> tuple[StructDeclaration, ...]:
    """The declarations in a `<types>` file. An unknown element is read as a misspelled `<struct>`."""
    if document.root is None:
        return ()
    return tuple(
        _struct(element) for element in document.root.elements if element.name == "struct" or not element.is_foreign
    )


def _struct(element: Element) -> StructDeclaration:
    members = tuple(
        MemberDeclaration(name_of(member.get("id")), type_of(member.get("type")), member.span)
        for member in element.elements
        if member.name == "member"
    )
    strange = any(child.name != "member" and not child.is_foreign for child in element.elements)
    complete = element.name == "struct" and not strange
    return StructDeclaration(name_of(element.get("id")), members, element.span, complete)


def resolve_structs(outlines: Iterable[StructOutline]) -> Mapping[str, Type]:
    """All structs by name, with their members resolved. If names are equal, the last declaration is used.

    The type of a member is unknown if it is not declared, or if it contains the struct itself. The type of a struct is
    unknown if its declaration is not complete, or if it is too large.
    """
    by_name = {outline.name: outline for outline in outlines}
    resolved: dict[str, Type] = {}
    for name, extent in extents(_graph(by_name)).items():
        members = tuple((m, _member_type(t, resolved)) for m, t in by_name[name].members)
        known = by_name[name].complete and not extent.is_too_large
        resolved[name] = Struct(name, members) if known else UNKNOWN
    return {name: resolved[name] for name in by_name}


def _member_type(name: TypeName | None, resolved: Mapping[str, Type]) -> Type:
    if name is None:
        return UNKNOWN
    return wrap(BASE_TYPES.get(name.base) or resolved.get(name.base, UNKNOWN), name.dimensions)


def struct_extents(outlines: Mapping[str, StructOutline]) -> Mapping[str, TypeExtent]:
    """The sizes of structs, including their members."""
    return extents(_graph(outlines))


def _graph(by_name: Mapping[str, StructOutline]) -> dict[str, list[str]]:
    """Struct -> the types of its members."""
    return {name: [t.base if t else "" for _, t in outline.members] for name, outline in by_name.items()}


def struct_cycles(outlines: Mapping[str, StructOutline]) -> Mapping[tuple[str, str], tuple[str, ...]]:
    """The members by which structs contain themselves: struct and member -> the names of the structs in the cycle,
    beginning and ending with the same name. Each cycle has one such member: the one that leads back to the struct of
    the cycle that is declared first."""
    cycles: dict[tuple[str, str], tuple[str, ...]] = {}
    done: set[str] = set()
    for start in outlines:
        path = [] if start in done else [start]
        places = dict.fromkeys(path, 0)
        stack: list[Iterator[tuple[str, TypeName | None]]] = [iter(outlines[name].members) for name in path]
        while stack:
            member, type_ = next(stack[-1], ("", None))
            if not member and type_ is None:
                stack.pop()
                done.add(path.pop())
            elif type_ is not None and type_.base in places and type_.base not in done:
                cycles[path[-1], member] = (*path[places[type_.base] :], type_.base)
            elif type_ is not None and type_.base in outlines and type_.base not in done:
                places[type_.base] = len(path)
                path.append(type_.base)
                stack.append(iter(outlines[type_.base].members))
    return cycles

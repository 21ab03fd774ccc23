# SPDX-License-Identifier: Apache-2.0
"""Completion of the fields of a ROS message that a sending element can set."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Symbol
from roaml.expr.types import Struct, Type, leaves
from roaml.expr.zero import zero_text
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank, Snippet
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.language import ElementType
from roaml.model.machine import Declaration, RosSend
from roaml.model.ros import InterfaceType
from roaml.model.value_types import INTERFACE_KINDS, find_handle, section_of
from roaml.roles import SymbolKind
from roaml.xml_syntax import Element


def field_names(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The names that a `<field>` may have, without those that other `<field>` elements of the message have. Fields that
    must be set come first."""
    holder = subject.parents[-1].element if subject.parents else None
    statement = request.ros_send_of(holder) if holder is not None else None
    if statement is None:
        return
    given = {field.name.value for field in statement.fields if field.name and field.element is not subject.element}
    declaration = find_handle(request.machine, statement) if request.machine else None
    required = set(_required(request, declaration, statement.type))
    for path, (type_, owner) in _sent_fields(request, statement).items():
        if path not in given:
            about = Symbol("", SymbolKind.FIELD, path.rpartition(".")[2], owner)
            rank = Rank.LIKELY if path in required else Rank.LATE
            yield CompletionItem(path, ItemKind.MEMBER, detail=str(type_), about=about, rank=rank)


def fields_to_add(request: Request, element: Element) -> Iterator[CompletionItem]:
    """The `<field>` elements for a sending element: one item for each missing field that must be set, and one item for
    all of them."""
    statement = request.ros_send_of(element)
    if statement is None:
        return
    known = _sent_fields(request, statement)
    given = {field.name.value for field in statement.fields if field.name}
    declaration = find_handle(request.machine, statement) if request.machine else None
    missing = [path for path in _required(request, declaration, statement.type) if path not in given]
    if len(missing) > 1:
        insert = str(_all(Snippet(), {path: known[path][0] for path in missing}, "\n"))
        detail = ", ".join(missing)
        yield CompletionItem(
            "all missing fields", ItemKind.SKELETON, insert, detail, None, Rank.BEST, "field all missing"
        )
    for path in missing:
        about = Symbol("", SymbolKind.FIELD, path.rpartition(".")[2], known[path][1])
        insert = str(_field(Snippet(), path, known[path][0]))
        yield CompletionItem(f"field {path}", ItemKind.SKELETON, insert, str(known[path][0]), about, Rank.LIKELY)


def sending(request: Request, type_: ElementType) -> Iterator[CompletionItem]:
    """Items for a sending element, one for each handle that it may use, with the handle and all fields that must be
    set."""
    name = type_.attributes.get("name")
    if name is None or "field" not in type_.children:
        return
    for declaration in request.machine.declarations if request.machine else ():
        if declaration.kind in name.refers and declaration.handle is not None:
            part, required = _part(request, declaration, type_), _required(request, declaration, type_)
            types = {".".join(path): leaf for path, leaf in leaves(part)} if part else {}
            made = Snippet().text(f'{type_.name} name="{declaration.handle.value}"')
            for attribute in type_.attributes.values():
                if attribute.required and attribute is not name:
                    made.text(f' {attribute.name}="').stop().text('"')
            if required:
                _all(made.text(">"), {path: types[path] for path in required}, "\n\t")
                made.text(f"\n</{type_.name}>").end()
            else:
                made.text("/>").end()
            about = Symbol(request.path, declaration.kind, declaration.handle.value)
            label = f"{type_.name} {declaration.handle.value}"
            detail = ", ".join(required)
            yield CompletionItem(label, ItemKind.SKELETON, str(made), detail, about, Rank.LIKELY)


def _all(made: Snippet, types: Mapping[str, Type], lead: str) -> Snippet:
    """Add several `<field>` elements to a snippet, each on a separate line."""
    for number, (path, type_) in enumerate(types.items()):
        made.text(lead if number or "\t" in lead else "")
        _field(made, path, type_)
    return made


def _field(made: Snippet, path: str, type_: Type) -> Snippet:
    return made.text(f'<field name="{path}" expr="').stop([zero_text(type_)]).text('"/>')


def _sent_fields(request: Request, statement: RosSend) -> Mapping[str, tuple[Type, str]]:
    """The dotted paths of all leaf fields, with their types and the message that contains them."""
    declaration = find_handle(request.machine, statement) if request.machine else None
    part = _part(request, declaration, statement.type)
    return {path: (type_, owner) for path, type_, owner in fields_of(part)}


def fields_of(part: Struct | None) -> Iterator[tuple[str, Type, str]]:
    """The dotted path of each leaf field of a part of an interface, its type, and the message that contains it."""
    for path, type_ in leaves(part) if part is not None else ():
        owner: Type | None = part
        for name in path[:-1]:
            owner = owner.member(name) if isinstance(owner, Struct) else None
        yield ".".join(path), type_, owner.name if isinstance(owner, Struct) else ""


def _interface(request: Request, declaration: Declaration | None) -> InterfaceType | None:
    if declaration is None or declaration.type is None or declaration.kind not in INTERFACE_KINDS:
        return None
    return request.environment.interface(INTERFACE_KINDS[declaration.kind], declaration.type.value)


def _part(request: Request, declaration: Declaration | None, type_: ElementType) -> Struct | None:
    """The part of a declared interface that an element of the type `type_` sends; `None` if it sends none, or if the
    interface is not known."""
    interface = _interface(request, declaration) if "field" in type_.children else None
    return dict(interface.parts).get(_section(type_)) if interface else None


def _required(request: Request, declaration: Declaration | None, type_: ElementType) -> tuple[str, ...]:
    interface = _interface(request, declaration)
    return interface.required(_section(type_)) if interface and _part(request, declaration, type_) else ()


def _section(type_: ElementType) -> str:
    return section_of(type_.sends) if type_.sends else ""

# SPDX-License-Identifier: Apache-2.0
"""Completion of attributes that an element does not have yet."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Symbol
from roaml.ide.completion import property_files
from roaml.ide.completion.elements import likely
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank, Snippet
from roaml.ide.completion.ports import ports_to_add
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.ide.names.frames import names_in
from roaml.ide.syntax import Typed
from roaml.language import BEHAVIOR_TREE, AttributeType, ElementType
from roaml.model.tree import EXPLICIT, SUBTREES
from roaml.roles import SymbolKind


def attributes(request: Request, parents: tuple[Typed, ...], typed: Typed, *, bare: bool) -> Iterator[CompletionItem]:
    """The attributes that may be inserted in a start tag.

    Args:
        bare: whether no part of the attribute follows the caret, so that the name is inserted with `=` and a value.
            Otherwise, only the name is inserted.
    """
    element, type_ = typed
    is_node = request.file.grammar is BEHAVIOR_TREE and any(p.element.name == "BehaviorTree" for p in parents)
    if type_ is None and is_node:
        type_ = _plugin_type()
    if type_ is None:
        return
    subject = CompletionSubject(element, type_, parents)
    given = {attribute.name for attribute in element.attributes}
    if is_node and bare:
        yield from ports_to_add(request, subject)
        if element.name in SUBTREES:
            yield from _remappings(request, subject, given)
    for attribute in type_.attributes.values():
        if attribute.name in given or (attribute.port and is_node):
            continue
        if is_node and attribute.name == "ID" and element.name not in (*EXPLICIT, *SUBTREES):
            continue
        if property_files.is_property_file(request) and not property_files.has_effect(parents, type_, attribute):
            continue
        yield _item(request, subject, attribute, bare=bare)


def _plugin_type() -> ElementType:
    """The element type that is used for a node in compact form. It has the attributes that all nodes have."""
    return BEHAVIOR_TREE.elements["Action"]


def _item(request: Request, subject: CompletionSubject, attribute: AttributeType, *, bare: bool) -> CompletionItem:
    about = Symbol(subject.key, SymbolKind.ATTRIBUTE, attribute.name, request.file.grammar.schema)
    insert = ""
    if bare:
        values = likely(request, subject, attribute)
        insert = str(Snippet().text(f'{attribute.name}="').stop(values).text('"'))
    rank = Rank.LIKELY if attribute.required else Rank.USUAL
    if attribute.use or attribute.ignored is not None or attribute.name.startswith("_"):
        rank = Rank.LATE
    detail = "required" if attribute.required else ""
    return CompletionItem(
        attribute.name, ItemKind.ATTRIBUTE, insert, detail, about, rank, deprecated=bool(attribute.use)
    )


def _remappings(request: Request, subject: CompletionSubject, given: set[str]) -> Iterator[CompletionItem]:
    """Attributes that remap variables of a subtree, for the start tag of a node that executes the subtree."""
    id_ = subject.element.get("ID") if subject.element else None
    path, tree = request.trees.trees.get(id_.value if id_ else "", ("", None))
    if tree is None or id_ is None:
        return
    for name in dict.fromkeys(names_in(tree)):
        if name not in given and not name.startswith("@"):
            insert = str(Snippet().text(f'{name}="').stop([f"{{{name}}}"]).text('"'))
            about = request.trees.variable(path, id_.value, name)
            yield CompletionItem(name, ItemKind.PORT, insert, "variable of the subtree", about, Rank.LIKELY)

# SPDX-License-Identifier: Apache-2.0
"""Completion of elements that are allowed at a caret, with placeholders for the values of their attributes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Symbol
from roaml.ide.completion import property_files
from roaml.ide.completion.fields import fields_to_add, sending
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank, Snippet
from roaml.ide.completion.names import library_nodes, plugins, port_list
from roaml.ide.completion.parameters import parameters_to_add
from roaml.ide.completion.ports import add_port, ports_of
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.ide.completion.values import candidates
from roaml.ide.describe import forest as describe_forest
from roaml.ide.names.occurrence import HANDLES
from roaml.ide.syntax import Typed
from roaml.language import BEHAVIOR_TREE, XML_PROPERTIES, AttributeType, ElementType
from roaml.model.system_file import SystemSection
from roaml.model.tree import EXPLICIT, SUBTREES
from roaml.model.vocabulary import INSIDE_THREADS, OUTSIDE_THREADS, UNUSUAL_IN_THREADS
from roaml.roles import NodeKind, SymbolKind, ValueRole
from roaml.xml_syntax import Element

_MAX_CHOICES = 20
"""The maximum number of values that a placeholder suggests."""


def elements(request: Request, parents: tuple[Typed, ...], *, bare: bool) -> Iterator[CompletionItem]:
    """The elements that are allowed inside the last of `parents`.

    Args:
        bare: whether no part of the tag follows the caret, so that the element is inserted with attributes and an end
            tag. Otherwise, only its name is inserted.
    """
    if not parents:
        for name in request.file.grammar.roots:
            type_ = request.file.grammar.elements[name]
            if not type_.use and not any(isinstance(node, Element) for node in request.file.document.nodes):
                yield _item(request, type_, parents, bare=bare)
        return
    parent = parents[-1]
    if parent.type is None:
        if request.forest is not None and any(typed.element.name == "BehaviorTree" for typed in parents):
            # The type of the parent is not declared by the schema.
            yield from _tree_nodes(request, parents, bare=bare)
        return
    if bare and "field" in parent.type.children:
        yield from fields_to_add(request, parent.element)
    if bare and "param" in parent.type.children:
        yield from parameters_to_add(request, CompletionSubject(parent.element, parent.type, parents[:-1]))
    if request.file.grammar is BEHAVIOR_TREE and parent.type.any_child is not None:
        yield from _tree_nodes(request, parents, bare=bare)
        return
    if bare:
        yield from property_files.skeletons(request, parents)
    for name, occurrence in parent.type.children.items():
        if not _has_effect(request, parents, name):
            continue
        if sum(child.name == name for child in parent.element.elements) < occurrence.most or not bare:
            type_child = request.file.grammar.child(parent.type, name)
            if type_child is not None:
                if bare:
                    yield from sending(request, type_child)
                yield _item(request, type_child, parents, bare=bare)


def _has_effect(request: Request, parents: tuple[Typed, ...], name: str) -> bool:
    """Whether the rules `tree-element-in-node` and `thread-element-outside-thread` allow an element that the schema
    allows."""
    if name.startswith("bt_"):
        sections = request.sections
        return SystemSection.NODE_MODELS not in sections or SystemSection.BEHAVIOR_TREE in sections
    if any(parent.element.name == "ros_action_thread" for parent in parents):
        return name not in (*OUTSIDE_THREADS, *UNUSUAL_IN_THREADS)
    return name not in INSIDE_THREADS


def snippet(request: Request, type_: ElementType, parents: tuple[Typed, ...]) -> str:
    """A complete element in snippet syntax: its name, its usual attributes, and its end tag or `/>`."""
    made = Snippet().text(type_.name)
    subject = CompletionSubject(None, type_, parents)
    for attribute in type_.attributes.values():
        if request.file.grammar is XML_PROPERTIES:
            is_usual = property_files.is_usual(parents, type_, attribute)
        else:
            is_usual = _is_usual(type_, attribute)
        if not is_usual:
            continue
        choices = attribute.simple.choices
        if len(choices) == 1:
            made.text(f' {attribute.name}="{choices[0].value}"')
        else:
            made.text(f' {attribute.name}="').stop(likely(request, subject, attribute)).text('"')
    _close(made, type_.name, type_)
    return str(made)


def likely(request: Request, subject: CompletionSubject, attribute: AttributeType) -> list[str]:
    """The likely values of an attribute; empty if there are more than `_MAX_CHOICES`, and for ROS types."""
    if attribute.value is ValueRole.ROS_TYPE:
        return []
    labels = [item.label for item in candidates(request, subject, attribute) if not item.deprecated]
    return labels if len(labels) <= _MAX_CHOICES else []


def _is_usual(type_: ElementType, attribute: AttributeType) -> bool:
    """Whether an element is usually written with an attribute, even if the schema does not require it."""
    if attribute.use or attribute.ignored is not None:
        return False
    if attribute.required:
        return True
    if attribute.name in ("name", "ID") and type_.node:
        return False
    names = (
        attribute.defines
        or attribute.refers
        or attribute.value in (ValueRole.TYPE, ValueRole.ROS_TYPE, ValueRole.NUMBER)
    )
    return bool(names) or attribute.name == "expr"


def _close(made: Snippet, name: str, type_: ElementType | None) -> None:
    """Add the end of a start tag, and an end tag if the element usually has content."""
    if type_ is not None and type_.text and not type_.attributes:
        made.text(">").end().text(f"</{name}>")
    elif type_ is not None and type_.node in (NodeKind.ACTION, NodeKind.CONDITION, NodeKind.SUBTREE):
        made.text("/>").end()
    elif type_ is not None and (type_.any_child or any(child not in type_.attributes for child in type_.children)):
        made.text(">\n\t").end().text(f"\n</{name}>")
    else:
        made.text("/>").end()


def _item(request: Request, type_: ElementType, parents: tuple[Typed, ...], *, bare: bool) -> CompletionItem:
    insert = snippet(request, type_, parents) if bare else ""
    rank = Rank.LATE if type_.ignored or type_.use or _has_no_handle(request, type_) else Rank.USUAL
    above = parents[-1].element.name if parents else ""
    about = Symbol(above, SymbolKind.ELEMENT, type_.name, request.file.grammar.schema)
    return CompletionItem(type_.name, ItemKind.ELEMENT, insert, about=about, rank=rank, deprecated=bool(type_.use))


def _has_no_handle(request: Request, type_: ElementType) -> bool:
    """Whether an element requires a ROS interface or a timer, and the machine declares none of the required kind."""
    name = type_.attributes.get("name")
    required_kinds = set(name.refers) & HANDLES if name else set()
    declared = {declaration.kind for declaration in request.machine.declarations} if request.machine else set()
    return bool(required_kinds) and not required_kinds & declared


# ------------------------------------------------------------------------ trees


def _tree_nodes(request: Request, parents: tuple[Typed, ...], *, bare: bool) -> Iterator[CompletionItem]:
    """Items for the plugins of the system, subtrees, and the nodes that libraries and models declare."""
    grammar = request.file.grammar
    for name, (path, outline) in plugins(request).items():
        about = Symbol(path, SymbolKind.MACHINE, name)
        has_children = outline.plugin.children > 0 or outline.plugin.any_child
        insert = _plugin(request, name, has_children=has_children) if bare else ""
        yield CompletionItem(name, ItemKind.PLUGIN, insert, port_list(outline), about, Rank.BEST)
    for name in request.trees.trees if bare else ():
        around = next((typed.element.get("ID") for typed in parents if typed.element.name == "BehaviorTree"), None)
        if name and (around is None or around.value != name):
            about = request.trees.tree_symbol(request.path, name)
            insert = str(Snippet().text(f'SubTree ID="{name}"').end().text("/>"))
            yield CompletionItem(f"SubTree {name}", ItemKind.PLUGIN, insert, "tree", about, Rank.LIKELY)
    for name, known in library_nodes(request):
        insert = _plugin(request, name, has_children=known.children[1] > 0) if bare else ""
        detail = f"{known.kind}, {known.library}" if known.library else str(known.kind)
        about = Symbol("", SymbolKind.JSON, name, describe_forest.node(known))
        rank = Rank.USUAL if known.library else Rank.BEST
        yield CompletionItem(name, ItemKind.PLUGIN, insert, detail, about, rank)
    for type_ in grammar.elements.values():
        if type_.node and type_.name in (*EXPLICIT, *SUBTREES[:1]):
            yield _node(request, type_, parents, bare=bare)


def _node(request: Request, type_: ElementType, parents: tuple[Typed, ...], *, bare: bool) -> CompletionItem:
    if type_.name in (*EXPLICIT, *SUBTREES):
        insert = snippet(request, type_, parents) if bare else ""
    else:
        insert = _plugin(request, type_.name, has_children=bool(type_.any_child)) if bare else ""
    rank = Rank.USUAL if type_.translated and not type_.use else Rank.LAST
    detail = str(type_.node) if type_.translated else f"{type_.node}, cannot be translated"
    about = Symbol(parents[-1].element.name, SymbolKind.ELEMENT, type_.name, request.file.grammar.schema)
    return CompletionItem(type_.name, ItemKind.ELEMENT, insert, detail, about, rank, deprecated=bool(type_.use))


def _plugin(request: Request, name: str, *, has_children: bool) -> str:
    """A node in the compact form, with its required ports."""
    made = Snippet().text(name)
    for port in ports_of(request, name):
        if port.required:
            add_port(made.text(" "), port)
    if has_children:
        made.text(">\n\t").end().text(f"\n</{name}>")
    else:
        made.text("/>").end()
    return str(made)

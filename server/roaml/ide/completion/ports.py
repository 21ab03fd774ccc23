# SPDX-License-Identifier: Apache-2.0
"""Completion of the ports of tree nodes, and of their values."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Symbol
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank, Snippet
from roaml.ide.completion.names import channels, plugins
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.ide.describe import forest as describe_forest
from roaml.ide.names.frames import names_in
from roaml.libraries import Node
from roaml.model.outline import MachineOutline
from roaml.model.system import CHILDREN_COUNT
from roaml.model.tree import EXPLICIT, SUBTREES, blackboard_variable, is_variable_name, port_key
from roaml.model.value_types import CHANNEL_KINDS
from roaml.record import Record
from roaml.roles import Direction, SymbolKind
from roaml.xml_syntax import Element


class SettablePort(Record, frozen=True):
    """A port that a node may set. `about` refers to its documentation."""

    key: str
    type: str
    direction: Direction
    required: bool
    default: str
    about: Symbol

    @property
    def detail(self) -> str:
        default = f" = {self.default}" if self.default else ""
        return f"{self.direction} {self.type}{default}".strip()


def ports_of(request: Request, name: str) -> tuple[SettablePort, ...]:
    """The ports of a node whose type is `name`: a type that a library or model declares, or a plugin."""
    known = request.forest.node(name) if request.forest else None
    if request.forest is not None and known is not None and not request.forest.is_machine(known):
        return tuple(_of_library(known))
    path, outline = plugins(request).get(name, ("", None))
    if outline is None:
        return ()
    defaults = request.trees.defaults.get(name, {})
    return tuple(
        SettablePort(
            port.key,
            port.type,
            port.direction,
            port.key not in defaults,
            defaults[port.key].value.value if port.key in defaults else "",
            Symbol(path, SymbolKind.PORT, port.key),
        )
        for port in outline.ports
        if port.key != CHILDREN_COUNT
    )


def _of_library(known: Node) -> Iterator[SettablePort]:
    for port in known.ports:
        if not port.alias_of:
            about = Symbol("", SymbolKind.JSON, port.name, describe_forest.port(known, port))
            default = port.default or ""
            yield SettablePort(port.name, port.type, port.direction, port.required, default, about)


def node_name(element: Element) -> str:
    """The name of the plugin of a node; "" if it is not written yet."""
    if element.name in (*EXPLICIT, *SUBTREES):
        id_ = element.get("ID")
        return id_.value if id_ else ""
    return element.name


def port_values(request: Request, subject: CompletionSubject, key: str) -> list[CompletionItem]:
    """The possible values of the port `key` of a node: blackboard variables, and for an input the default, the
    constants of its type, and the names of interfaces if the plugin uses the port as the name of an interface."""
    element = subject.element
    if element is None or not _in_tree(subject):
        return []
    name = node_name(element)
    if element.name in SUBTREES:
        known = subject.type.attributes.get(key)
        is_port = known is None
        port = None
    else:
        by_key = {port.key: port for port in ports_of(request, name)}
        port = by_key.get(port_key(name, key))
        is_port = port is not None
    if not is_port:
        return []
    items = [*_constants(request, name, port)] if port else []
    if element.name in SUBTREES:
        items.append(CompletionItem("{=}", ItemKind.VARIABLE, detail="the variable of the same name", rank=Rank.LIKELY))
    return [*items, *_variables(request, key, port)]


def _in_tree(subject: CompletionSubject) -> bool:
    return any(typed.element.name == "BehaviorTree" for typed in subject.parents)


def _variables(request: Request, key: str, port: SettablePort | None) -> Iterator[CompletionItem]:
    tree = next((t for t in request.trees.files[request.path].trees if _around(t.element, request.offset)), None)
    if tree is None:
        return
    own = dict.fromkeys(name for name in names_in(tree) if is_variable_name(name))
    id_ = tree.id.value if tree.id else ""
    for name in own:
        about = request.trees.variable(request.path, id_, name)
        yield CompletionItem(f"{{{name}}}", ItemKind.VARIABLE, detail="blackboard", about=about, rank=Rank.LIKELY)
    if key not in own and is_variable_name(key):
        yield CompletionItem(f"{{{key}}}", ItemKind.VARIABLE, detail="new blackboard variable", rank=Rank.USUAL)
    main = request.trees.main
    if main is not None and main[1] is not tree:
        for name in dict.fromkeys(names_in(main[1])):
            if is_variable_name(name) and not name.startswith("@"):
                yield CompletionItem(
                    f"{{@{name}}}", ItemKind.VARIABLE, detail="variable of the main tree", rank=Rank.LATE
                )


def _around(element: Element, offset: int) -> bool:
    return element.span.start < offset <= element.span.end


def _constants(request: Request, name: str, port: SettablePort) -> Iterator[CompletionItem]:
    if port.direction is Direction.OUT:
        return
    if port.default and blackboard_variable(port.default) is None:
        yield CompletionItem(port.default, ItemKind.VALUE, detail="default", rank=Rank.LIKELY)
    if port.type == "NodeStatus":
        for status in ("SUCCESS", "FAILURE", "RUNNING", "SKIPPED"):
            yield CompletionItem(status, ItemKind.VALUE, rank=Rank.LIKELY)
    if port.type == "bool":
        yield CompletionItem("true", ItemKind.VALUE, rank=Rank.LIKELY)
        yield CompletionItem("false", ItemKind.VALUE, rank=Rank.LIKELY)
    _, outline = plugins(request).get(name, ("", None))
    yield from _interfaces(request, outline, port.key)


def _interfaces(request: Request, outline: MachineOutline | None, key: str) -> Iterator[CompletionItem]:
    """The topics, services or actions of the workspace, if the plugin uses the port as the name of one."""
    for use in outline.interfaces if outline else ():
        if use.port == key and use.kind in CHANNEL_KINDS:
            yield from channels(request, CHANNEL_KINDS[use.kind], use.type)


def ports_to_add(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The attributes for ports that are not set: one item for each port, and one for all required ports if there are
    several."""
    element = subject.element
    assert element is not None
    given = {attribute.name for attribute in element.attributes}
    name = node_name(element)
    missing = [port for port in ports_of(request, name) if port.key not in given]
    required = [port for port in missing if port.required]
    if len(required) > 1:
        snippet = Snippet()
        for number, port in enumerate(required):
            snippet.text(" " if number else "")
            add_port(snippet, port)
        detail = ", ".join(port.key for port in required)
        yield CompletionItem("all ports", ItemKind.SKELETON, str(snippet), detail, rank=Rank.BEST)
    for port in missing:
        snippet = Snippet()
        add_port(snippet, port)
        rank = Rank.LIKELY if port.required else Rank.USUAL
        yield CompletionItem(port.key, ItemKind.PORT, str(snippet), port.detail, port.about, rank)


def add_port(snippet: Snippet, port: SettablePort) -> None:
    """Add an attribute `key="…"` to a snippet. The suggested value of an output is a variable with the name of the
    port, that of an input its default."""
    snippet.text(f'{port.key}="').stop([f"{{{port.key}}}"] if port.direction is Direction.OUT else [port.default]).text(
        '"'
    )

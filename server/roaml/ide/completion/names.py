# SPDX-License-Identifier: Apache-2.0
"""The names to which an attribute may refer, and names that are used but not defined."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from roaml.diagnostics import Symbol
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank
from roaml.ide.completion.model_parameters import parameters_of_input
from roaml.ide.completion.parameters import parameter_names
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.ide.describe import forest as describe_forest
from roaml.ide.names.occurrence import HANDLES
from roaml.ide.names.occurrences import uses
from roaml.libraries import Node
from roaml.model.kinds import FileKind
from roaml.model.machine import Declaration, Send
from roaml.model.outline import MachineOutline
from roaml.model.syntax import Name
from roaml.model.system import CHILDREN_COUNT, Channel, System
from roaml.roles import Direction, NodeKind, SymbolKind

_SHOWN = 3
"""The maximum number of names in the detail of an item; further names are counted."""


def referred(request: Request, kind: SymbolKind, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """Items for the symbols of the kind `kind` to which `subject` may refer."""
    if kind in HANDLES:
        yield from _handles(request, kind)
    elif kind in _PROVIDERS:
        yield from _PROVIDERS[kind](request, subject)


def undefined(request: Request, kind: SymbolKind, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """Suggestions for the name of a new definition, such as names that are used but not defined."""
    if kind is SymbolKind.EVENT:
        yield from _events_to_send(request)
    elif kind is SymbolKind.PARAMETER:
        yield from parameter_names(request, subject)
    elif kind is SymbolKind.MACHINE:
        yield from _machine_names(request)
    elif kind is SymbolKind.PORT:
        yield from _missing_ports(request)
    else:
        defined: set[Symbol] = set()
        used: dict[Symbol, None] = {}
        for occurrence in uses(request.analysis, request.path, request.system_path).all:
            if occurrence.symbol.kind is kind:
                if occurrence.defines:
                    defined.add(occurrence.symbol)
                else:
                    used[occurrence.symbol] = None
        for symbol in used:
            if symbol not in defined:
                yield CompletionItem(
                    symbol.name, _KINDS.get(kind, ItemKind.VALUE), detail="used, not defined", rank=Rank.BEST
                )


_KINDS = {SymbolKind.STATE: ItemKind.STATE, SymbolKind.VARIABLE: ItemKind.VARIABLE, SymbolKind.PORT: ItemKind.PORT}


# ------------------------------------------------------------------- machines


def _trees(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The names of the trees that the system executes; only inputs of plugins refer to them."""
    for listed in request.analysis.listed(request.path):
        if listed.required_kind is FileKind.TREE and listed.input.tree:
            about = Symbol(listed.path, SymbolKind.MACHINE, listed.input.tree)
            yield CompletionItem(listed.input.tree, ItemKind.VALUE, detail="behavior tree", about=about)


def _states(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    for state in request.chart.states if request.chart else ():
        if state.id is not None:
            about = Symbol(request.path, SymbolKind.STATE, state.id.value, request.chart.scope if request.chart else "")
            yield CompletionItem(state.id.value, ItemKind.STATE, about=about)


def _handles(request: Request, kind: SymbolKind) -> Iterator[CompletionItem]:
    for declaration in request.machine.declarations if request.machine else ():
        if declaration.kind is kind and declaration.handle is not None:
            about = Symbol(request.path, kind, declaration.handle.value)
            yield CompletionItem(declaration.handle.value, ItemKind.HANDLE, detail=_declared(declaration), about=about)


def _declared(declaration: Declaration) -> str:
    if declaration.kind is SymbolKind.TIMER:
        return f"{declaration.rate.value} Hz" if isinstance(declaration.rate, Name) else ""
    name = declaration.interface.value if isinstance(declaration.interface, Name) else ""
    return " : ".join(filter(None, (name, declaration.type.value if declaration.type else "")))


def _ports(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The ports of the plugin that the element of `subject` can read or write; in a tree file, the ports of the plugin
    that the enclosing model describes."""
    if request.machine is None:
        id_ = subject.parents[-1].element.get("ID") if subject.parents else None
        path, outline = plugins(request).get(id_.value if id_ else "", ("", None))
        for declared in outline.ports if outline else ():
            if subject.type.name == f"{declared.direction}put_port":
                about = Symbol(path, SymbolKind.PORT, declared.key)
                yield CompletionItem(declared.key, ItemKind.PORT, detail=declared.type, about=about)
        return
    direction = {"bt_get_input": Direction.IN, "bt_set_output": Direction.OUT}.get(subject.type.name)
    for port in request.machine.ports:
        if port.key is not None and direction in (None, port.direction):
            detail = port.type.text if port.type else ""
            yield CompletionItem(
                port.key.value,
                ItemKind.PORT,
                detail=detail,
                about=Symbol(request.path, SymbolKind.PORT, port.key.value),
            )


def _machine_names(request: Request) -> Iterator[CompletionItem]:
    stem = request.path.replace("\\", "/").rpartition("/")[2].partition(".")[0]
    yield CompletionItem(stem, ItemKind.VALUE, detail="the file's name", rank=Rank.LIKELY)
    for system in request.systems:
        for name in _unknown_plugins(system):
            yield CompletionItem(name, ItemKind.PLUGIN, detail="used in the tree", rank=Rank.BEST)


def _unknown_plugins(system: System) -> Iterator[str]:
    yield from dict.fromkeys(i.plugin for i in system.instances if system.plugin(i.plugin, i.tree)[1] is None)


def _missing_ports(request: Request) -> Iterator[CompletionItem]:
    """The ports that trees set for the plugin of the file but that the plugin does not declare, and
    `CHILDREN_COUNT`."""
    machine = request.machine
    if machine is None or machine.name is None:
        return
    known = {port.key.value for port in machine.ports if port.key}
    for system in request.systems:
        for instance in system.instances:
            if instance.plugin == machine.name.value:
                for key, _ in instance.ports:
                    if key not in known:
                        yield CompletionItem(key, ItemKind.PORT, detail="set in the tree", rank=Rank.BEST)
    yield CompletionItem(CHILDREN_COUNT, ItemKind.PORT, detail="the number of children of the node", rank=Rank.LATE)


# --------------------------------------------------------------------- events


def _events_received(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """Events that a handler can wait for. Events that machines send come first."""
    for system in request.systems:
        for event in system.events.values():
            senders = dict.fromkeys(automaton.name for automaton, _ in event.senders)
            detail = f"from {_some(senders)}" if senders else "never sent"
            yield _event(system.path, event.name, detail, sound=bool(senders))
    if not request.systems:
        sent = (s for chart in (request.machine.charts if request.machine else ()) for s in chart.statements)
        for name in dict.fromkeys(s.event.value for s in sent if isinstance(s, Send) and s.event):
            yield _event(request.path, name, "sent here", sound=True)


def _events_to_send(request: Request) -> Iterator[CompletionItem]:
    """Events that a machine can send. Events for which a machine waits come first."""
    for system in request.systems:
        for event in system.events.values():
            receivers = dict.fromkeys(automaton.name for automaton, _ in event.receivers)
            detail = f"to {_some(receivers)}" if receivers else "never received"
            yield _event(system.path, event.name, detail, sound=bool(receivers))
    if not request.systems:
        states = (state for chart in (request.machine.charts if request.machine else ()) for state in chart.states)
        handlers = (handler for state in states for handler in state.handlers)
        for name in dict.fromkeys(h.event.value for h in handlers if h.event):
            yield _event(request.path, name, "awaited here", sound=True)


def _event(owner: str, name: str, detail: str, *, sound: bool) -> CompletionItem:
    rank = Rank.USUAL if sound else Rank.LATE
    return CompletionItem(name, ItemKind.EVENT, detail=detail, about=Symbol(owner, SymbolKind.EVENT, name), rank=rank)


# ----------------------------------------------------------- ROS and the tree


def channels(request: Request, kind: SymbolKind, type_: str = "") -> Iterator[CompletionItem]:
    """The topics, services or actions of the workspace. Those with the ROS type `type_` come first; among them, those
    of the file's own systems come first."""
    seen = set()
    for system in request.all_systems:
        for name, channel in system.channels(kind).items():
            written = next((e.use.name for e in channel.endpoints if e.use.name), channel.name)
            if not written or written in seen:
                continue
            seen.add(written)
            types = dict.fromkeys(endpoint.use.type for endpoint in channel.endpoints)
            fitting = not type_ or type_ in types
            own = system in request.systems
            rank = Rank.LAST if not fitting else Rank.LIKELY if own else Rank.USUAL
            detail = " · ".join(filter(None, (", ".join(types), _some(_machines(channel)))))
            yield CompletionItem(
                written, ItemKind.INTERFACE, detail=detail, about=Symbol(system.path, kind, name), rank=rank
            )


def _machines(channel: Channel) -> dict[str, None]:
    return dict.fromkeys(endpoint.automaton.name for endpoint in channel.endpoints)


def _of_kind(kind: SymbolKind) -> Callable[[Request, CompletionSubject], Iterator[CompletionItem]]:
    def provide(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
        element = subject.element
        if subject.type.text and subject.parents:
            element = subject.parents[-1].element  # `<topic>` is inside of the declaration
        type_ = element.get("type") if element else None
        yield from channels(request, kind, type_.value if type_ else "")

    return provide


def plugins(request: Request) -> dict[str, tuple[str, MachineOutline]]:
    """The plugins that the systems of a tree file list: name -> path of the file and outline of the machine."""
    by_name: dict[str, tuple[str, MachineOutline]] = {}
    for system in request.systems:
        for path, outline in system.plugins:
            if outline.name:
                by_name.setdefault(outline.name, (path, outline))
    return by_name


def _plugin_names(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    for name, (path, outline) in plugins(request).items():
        about = Symbol(path, SymbolKind.MACHINE, name)
        yield CompletionItem(name, ItemKind.PLUGIN, detail=port_list(outline), about=about, rank=Rank.LIKELY)
    category = next((kind for kind in NodeKind if kind.value == subject.type.name.lower()), None)
    for name, known in library_nodes(request):
        if known.kind is category:
            about = Symbol("", SymbolKind.JSON, name, describe_forest.node(known))
            yield CompletionItem(name, ItemKind.PLUGIN, detail=known.library, about=about, rank=Rank.LIKELY)


def library_nodes(request: Request) -> Iterator[tuple[str, Node]]:
    """The nodes that libraries and models describe, by name."""
    forest = request.forest
    for name in dict.fromkeys(forest.names) if forest is not None else ():
        known = forest.node(name) if forest is not None else None
        if forest is not None and known is not None and not forest.is_machine(known):
            yield name, known


def port_list(outline: MachineOutline) -> str:
    """The directions, keys and types of the ports of a plugin, in one line, without the port `CHILDREN_COUNT`."""
    return ", ".join(
        f"{port.direction} {port.key}: {port.type}" for port in outline.ports if port.key != CHILDREN_COUNT
    )


def _tree_names(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The names of trees. Inside a tree, the name of this tree is left out, because a tree cannot contain itself."""
    around = [typed.element.get("ID") for typed in subject.parents if typed.element.name == "BehaviorTree"]
    own = {id_.value for id_ in around if id_ is not None}
    for name, (path, _) in request.trees.trees.items():
        if name and name not in own:
            file = path.replace("\\", "/").rpartition("/")[2]
            yield CompletionItem(
                name, ItemKind.PLUGIN, detail=file, about=request.trees.tree_symbol(request.path, name)
            )


def _some(names: Iterable[str]) -> str:
    listed = list(names)
    more = f" and {len(listed) - _SHOWN} more" if len(listed) > _SHOWN else ""
    return ", ".join(listed[:_SHOWN]) + more


_PROVIDERS: Mapping[SymbolKind, Callable[[Request, CompletionSubject], Iterator[CompletionItem]]] = {
    SymbolKind.MACHINE: _trees,
    SymbolKind.STATE: _states,
    SymbolKind.MODEL_PARAMETER: parameters_of_input,
    SymbolKind.PORT: _ports,
    SymbolKind.EVENT: _events_received,
    SymbolKind.TOPIC: _of_kind(SymbolKind.TOPIC),
    SymbolKind.SERVICE: _of_kind(SymbolKind.SERVICE),
    SymbolKind.ACTION: _of_kind(SymbolKind.ACTION),
    SymbolKind.PLUGIN: _plugin_names,
    SymbolKind.TREE: _tree_names,
}

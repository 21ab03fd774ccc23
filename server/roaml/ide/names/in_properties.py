# SPDX-License-Identifier: Apache-2.0
"""The names in property files in JANI: the symbols from which the parts of a global variable's name come.

Names have forms such as `EVENT.valid`, `EVENT__parameter__member` and `EVENT__parameter.d1_len`. The name of the event
is written by the user, or generated from a topic, service, action, automaton or blackboard variable.
`roaml.model.globals` defines the names.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from roaml.diagnostics import Symbol
from roaml.expr.types import UNKNOWN, Struct, StructKind, Type, unwrap
from roaml.ide.names.frames import Piece, Trees
from roaml.ide.names.in_machine import interface_symbol
from roaml.ide.names.occurrence import Access, Form, Occurrence, parameter, tree_node
from roaml.jani.properties import Property, identifiers
from roaml.model.globals import FindInterface, GlobalVariable
from roaml.model.system import Channel, System, SystemAutomaton
from roaml.model.value_types import INTERFACE_KINDS
from roaml.roles import SymbolKind
from roaml.scxml.names import (
    BLACKBOARD_WRITE_PREFIX,
    CANCEL_PREFIX,
    FIELD_PREFIX,
    FLAG,
    NODE_PREFIX,
    is_blackboard_answer,
    safe_name,
    sanitise,
)
from roaml.text import Span

# The events of a service or action -> the part of the interface that they carry.
_SERVICE = {"request": "request", "response": "response"}
_SERVICE_CLIENT = {"req": "request", "response": "response"}
_ACTION = {
    "goal_accepted": "",
    "goal_rejected": "",
    "feedback": "feedback",
    "result": "result",
    "thread_start": "goal",
    "thread_free": "",
    "goal_handle": "goal",
}
_ACTION_CLIENT = {
    "goal_req": "goal",
    "goal_accept": "",
    "goal_reject": "",
    "feedback_handle": "feedback",
    "result_handle": "result",
}


def in_properties(
    text: str, properties: Iterable[Property], table: Mapping[str, tuple[Piece, ...]]
) -> Iterator[Occurrence]:
    """The occurrences of symbols in the names of global variables. `table` is the result of `names`."""
    for prop in properties:
        for identifier, span in identifiers(prop.expression):
            if text[span.start : span.end] == identifier:
                yield from _occurrences(table.get(identifier, ()), span.start)


def _occurrences(pieces: tuple[Piece, ...], at: int) -> Iterator[Occurrence]:
    for written, symbol, form in pieces:
        if symbol is not None:
            yield Occurrence(Span(at, at + len(written)), symbol, access=Access.READ, form=form)
        at += len(written)


def names(
    system: System, variables: Mapping[str, GlobalVariable], trees: Trees, interface: FindInterface
) -> Mapping[str, tuple[Piece, ...]]:
    """The name of each global variable of the translation -> its parts."""
    events = {_text(pieces): (pieces, part) for pieces, part in _events(system, trees, interface)}
    pieces_by_name = {}
    for name, variable in variables.items():
        event, part = events.get(variable.event, ((_plain(variable.event),), UNKNOWN))
        pieces_by_name[name] = (*event, *_rest(name[len(variable.event) :], variable, part, system, trees))
    return pieces_by_name


def _text(pieces: Iterable[Piece]) -> str:
    return "".join(piece[0] for piece in pieces)


def _plain(text: str) -> Piece:
    return text, None, Form.AS_IS


_Event = tuple[tuple[Piece, ...], Type]
"""The parts of the name of an event, and the part of a ROS interface that the event carries; `UNKNOWN` if it carries
none."""


def _events(system: System, trees: Trees, interface: FindInterface) -> Iterator[_Event]:
    for event in system.events:
        yield ((event, Symbol(system.path, SymbolKind.EVENT, event), Form.AS_IS),), UNKNOWN
    for topic, channel in system.topics.items():
        symbol = interface_symbol(system.path, SymbolKind.PUBLISHER, topic)
        name: tuple[Piece, ...] = (_plain("topic_"), (topic, symbol, Form.SANITISED), _plain("_msg"))
        yield name, _part(channel, "message", interface)
    for service in system.services.values():
        symbol = interface_symbol(system.path, SymbolKind.SERVICE_SERVER, service.name)
        head = (_plain("srv_"), (sanitise(service.name), symbol, Form.SANITISED))
        yield from _protocol(head, service, _SERVICE, _SERVICE_CLIENT, trees, interface)
    for action in system.actions.values():
        symbol = interface_symbol(system.path, SymbolKind.ACTION_SERVER, action.name)
        head = (_plain("action_"), (sanitise(action.name), symbol, Form.SANITISED))
        yield from _protocol(head, action, _ACTION, _ACTION_CLIENT, trees, interface)
        yield (_plain(CANCEL_PREFIX), (sanitise(action.name), symbol, Form.SANITISED)), UNKNOWN
    for pieces in trees.full_names.values():
        yield (_plain(BLACKBOARD_WRITE_PREFIX), *pieces), UNKNOWN


def _part(channel: Channel, part: str, interface: FindInterface) -> Type:
    """The fields of a part of a topic, service or action; `UNKNOWN` if the part has no fields or the type is not
    found."""
    for endpoint in channel.endpoints:
        definition = interface(INTERFACE_KINDS[endpoint.use.kind], endpoint.use.type) if part else None
        if definition is not None:
            return dict(definition.parts).get(part, UNKNOWN)
    return UNKNOWN


def _protocol(
    head: tuple[Piece, ...],
    channel: Channel,
    common: Mapping[str, str],
    of_clients: Mapping[str, str],
    trees: Trees,
    interface: FindInterface,
) -> Iterator[_Event]:
    for event, part in common.items():
        yield (*head, _plain(f"_{event}")), _part(channel, part, interface)
    for event, part in of_clients.items():
        fields = _part(channel, part, interface)
        for client in channel.users:
            yield (*head, _plain(f"_{event}_client_"), *_automaton(client.automaton, trees)), fields


def _automaton(automaton: SystemAutomaton, trees: Trees) -> tuple[Piece, ...]:
    """The name of an automaton as a part of an event name."""
    machine = Symbol(automaton.path, SymbolKind.MACHINE, automaton.outline.name)
    instance = automaton.instance
    if instance is None:
        return ((safe_name(automaton.name), machine, Form.SAFE),)
    head = [_plain(f"{NODE_PREFIX}{instance.number}_")]
    if instance.tree:
        head += [(instance.tree, trees.instance(instance.tree), Form.AS_IS), _plain(".")]
    _, node = trees.nodes.get(instance.number, (None, None))
    if node is not None and node.name is not None:
        source = instance.source
        machine = tree_node(source.path, source.tree, source.position, node.name.value)
    return *head, (safe_name(instance.name), machine, Form.SAFE)


def _rest(rest: str, variable: GlobalVariable, part: Type, system: System, trees: Trees) -> Iterator[Piece]:
    """The parts of a global variable's name after the event. `part` is the part of the interface that the event
    carries."""
    if rest == f".{FLAG}":
        yield _plain(rest)
    elif variable.event in system.events:
        yield from _parameter(rest, variable, system)
    elif is_blackboard_answer(variable.event):
        yield _plain("__")
        pieces = trees.full_names.get(variable.parameter, (_plain(variable.parameter),))
        yield from pieces
        yield _plain(rest[2 + len(_text(pieces)) :])
    elif rest.startswith(f"__{FIELD_PREFIX}"):
        lead = f"__{FIELD_PREFIX}".removesuffix("__")
        yield _plain(lead)
        yield from _members(rest.removeprefix(lead), part, "")
    else:
        yield _plain(rest)


def _parameter(rest: str, variable: GlobalVariable, system: System) -> Iterator[Piece]:
    for name, type_ in system.events[variable.event].data.members:
        if name.replace(".", "__") == variable.parameter:
            yield _plain("__")
            yield variable.parameter, parameter(system.path, variable.event, name), Form.FLAT
            yield from _members(rest[2 + len(variable.parameter) :], type_, system.path)
            return
    yield _plain(rest)


def _members(rest: str, type_: Type, owner: str) -> Iterator[Piece]:
    """The members of structs, or the fields of messages, on the path to a leaf."""
    inner, _ = unwrap(type_)
    if isinstance(inner, Struct):
        for name, member in inner.members:
            if rest == f"__{name}" or rest.startswith((f"__{name}__", f"__{name}.")):
                yield _plain("__")
                kind = SymbolKind.MEMBER if inner.kind is StructKind.DECLARED else SymbolKind.FIELD
                yield name, Symbol(owner, kind, name, inner.name), Form.AS_IS
                yield from _members(rest[2 + len(name) :], member, owner)
                return
    yield _plain(rest)

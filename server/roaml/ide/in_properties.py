# SPDX-License-Identifier: Apache-2.0
"""The names in property files: what the parts of a global variable's name come from.

`EVENT.valid`, `EVENT__parameter__member`, `EVENT__parameter.d1_len`: the event may be a user's own or made of a topic,
service, action, automaton or blackboard variable. The names themselves are those of `roaml.model.globals`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from roaml.diagnostics import Symbol
from roaml.expr.types import Struct, Type, unwrap
from roaml.ide.frames import Piece, Trees
from roaml.ide.in_machine import interface_symbol
from roaml.ide.occurrence import Access, Form, Occurrence, parameter, tree_node
from roaml.jani.properties import Property, identifiers
from roaml.model.globals import GlobalVariable
from roaml.model.system import Automaton, Channel, System, safe_name, sanitise
from roaml.text import Span

_SERVICE = ("request", "response")
_SERVICE_CLIENT = ("req", "response")
_ACTION = ("goal_accepted", "goal_rejected", "feedback", "result", "thread_start", "thread_free", "goal_handle")
_ACTION_CLIENT = ("goal_req", "goal_accept", "goal_reject", "feedback_handle", "result_handle")

_NO_VARIABLES: Mapping[str, tuple[Piece, ...]] = {}


def in_properties(
    text: str,
    properties: Iterable[Property],
    system: System,
    variables: Mapping[str, GlobalVariable],
    trees: Trees,
) -> Iterator[Occurrence]:
    table = names(system, variables, trees)
    for each in properties:
        for identifier, span in identifiers(each.expression):
            if text[span.start : span.end] == identifier:
                yield from _occurrences(table.get(identifier, ()), span.start)


def _occurrences(pieces: tuple[Piece, ...], at: int) -> Iterator[Occurrence]:
    for written, symbol, form in pieces:
        if symbol is not None:
            yield Occurrence(Span(at, at + len(written)), symbol, access=Access.READ, form=form)
        at += len(written)


def names(system: System, variables: Mapping[str, GlobalVariable], trees: Trees) -> Mapping[str, tuple[Piece, ...]]:
    """The name of each global variable of the translation -> what it is made of."""
    events = {_text(pieces): pieces for pieces in _events(system, trees)}
    found = {}
    for name, variable in variables.items():
        event = events.get(variable.event, (_plain(variable.event),))
        found[name] = (*event, *_rest(name[len(variable.event) :], variable, system, trees))
    return found


def _text(pieces: Iterable[Piece]) -> str:
    return "".join(piece[0] for piece in pieces)


def _plain(text: str) -> Piece:
    return text, None, Form.AS_IS


def _events(system: System, trees: Trees) -> Iterator[tuple[Piece, ...]]:
    for event in system.events:
        yield ((event, Symbol(system.path, "event", event), Form.AS_IS),)
    for topic in system.topics:
        symbol = interface_symbol(system.path, "publisher", topic)
        yield _plain("topic_"), (topic, symbol, Form.SANITISED), _plain("_msg")
    for service in system.services.values():
        symbol = interface_symbol(system.path, "service-server", service.name)
        head = (_plain("srv_"), (sanitise(service.name), symbol, Form.SANITISED))
        yield from _protocol(head, service, _SERVICE, _SERVICE_CLIENT, trees)
    for action in system.actions.values():
        symbol = interface_symbol(system.path, "action-server", action.name)
        head = (_plain("action_"), (sanitise(action.name), symbol, Form.SANITISED))
        yield from _protocol(head, action, _ACTION, _ACTION_CLIENT, trees)
    for pieces in trees.full_names.values():
        yield _plain("bt_blackboard_set_"), *pieces


def _protocol(
    head: tuple[Piece, ...], channel: Channel, common: Iterable[str], of_clients: Iterable[str], trees: Trees
) -> Iterator[tuple[Piece, ...]]:
    for part in common:
        yield *head, _plain(f"_{part}")
    for client in channel.users:
        for part in of_clients:
            yield *head, _plain(f"_{part}_client_"), *_automaton(client.automaton, trees)


def _automaton(automaton: Automaton, trees: Trees) -> tuple[Piece, ...]:
    """The name of an automaton as a part of an event name."""
    machine = Symbol(automaton.path, "machine", automaton.outline.name)
    instance = automaton.instance
    if instance is None:
        return ((safe_name(automaton.name), machine, Form.SAFE),)
    head = _plain(f"BT_plugin_{instance.number}_")
    _, node = trees.nodes.get(instance.number, (None, None))
    if node is not None and node.name is not None:
        source = instance.source
        machine = tree_node(source.path, source.tree, source.position, node.name.value)
    return head, (safe_name(instance.name), machine, Form.SAFE)


def _rest(rest: str, variable: GlobalVariable, system: System, trees: Trees) -> Iterator[Piece]:
    """What stands behind the event."""
    if rest == ".valid":
        yield _plain(rest)
    elif variable.event in system.events:
        yield from _parameter(rest, variable, system)
    elif variable.event == "bt_blackboard_get":
        yield _plain("__")
        pieces = trees.full_names.get(variable.parameter, (_plain(variable.parameter),))
        yield from pieces
        yield _plain(rest[2 + len(_text(pieces)) :])
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
    """The members of structs on the way to a leaf."""
    inner, _ = unwrap(type_)
    if isinstance(inner, Struct):
        for name, member in inner.members:
            if rest == f"__{name}" or rest.startswith((f"__{name}__", f"__{name}.")):
                yield _plain("__")
                yield name, Symbol(owner, "member", name, inner.name), Form.AS_IS
                yield from _members(rest[2 + len(name) :], member, owner)
                return
    yield _plain(rest)

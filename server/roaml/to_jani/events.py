# SPDX-License-Identifier: Apache-2.0
"""Collects all events of a network, with their senders, their receivers and the types of their parameters
(docs/spec/jani.md#global-variables)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

from roaml.exhaustive import assert_never
from roaml.expr.infer import infer
from roaml.expr.tree import Expr, Name, walk
from roaml.expr.types import UNKNOWN, EmptyArray, Struct, Type, type_of_empty
from roaml.record import Record, field
from roaml.scxml.event_data import Round, infer_in_rounds, parameter_types
from roaml.scxml.events import EventRole, ScxmlEvent
from roaml.scxml.model import Assign, Body, If, Param, Send, statements
from roaml.text import Location
from roaml.to_jani.moves import AutomatonMoves, Move


class EventUsage(Record):
    """An event of a network with its uses.

    Attributes:
        origin: the origin of the first `<send>` of the event; if there is none, of the first transition on it.
        params: parameter -> its type, in the order in which the parameters are first sent.
        places: parameter -> the place where it is first sent.
        senders, receivers: the indexes of automata, in order; the values of the dictionaries are not used.
    """

    event: ScxmlEvent
    origin: Location
    params: dict[str, Type] = field(default_factory=dict)
    places: dict[str, Location] = field(default_factory=dict)
    senders: dict[int, None] = field(default_factory=dict)
    receivers: dict[int, None] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return self.event.name

    @property
    def role(self) -> EventRole:
        return self.event.role


def event_table(behaviors: Sequence[AutomatonMoves]) -> dict[str, EventUsage]:
    """Name of an event -> its usage, in the order of the first occurrences."""
    table = _occurrences(behaviors)
    for name, params in infer_in_rounds(lambda known: _infer_params(behaviors, known)).items():
        table[name].params.update(params)
    return table


def _occurrences(behaviors: Sequence[AutomatonMoves]) -> dict[str, EventUsage]:
    table: dict[str, EventUsage] = {}
    for index, behavior in enumerate(behaviors):
        for _, moves in behavior.moves:
            for move in moves:
                if (awaited := move.transition.event) is not None:
                    event = EventUsage(awaited, move.transition.origin)
                    table.setdefault(awaited.name, event).receivers[index] = None
                for outcome in move.outcomes:
                    _sent(outcome.body, index, table)
        _sent(behavior.start or (), index, table)
    return table


def _sent(body: Body, index: int, table: dict[str, EventUsage]) -> None:
    for statement in statements(body):
        if isinstance(statement, Send):
            sent = statement.event
            event = table.setdefault(sent.name, EventUsage(sent, statement.origin))
            if not event.senders:
                event.origin = statement.origin
            event.senders[index] = None
            for param in statement.params:
                event.places.setdefault(param.name, param.origin)


EventParams: TypeAlias = Mapping[str, Mapping[str, Type]]
"""Name of an event -> parameter -> its type."""


def _infer_params(behaviors: Sequence[AutomatonMoves], known: EventParams) -> Round[EventParams, Mapping[str, Type]]:
    """One round of the inference: the types of all parameters that are sent, on the assumption that received events
    have the parameters `known`."""
    sent: dict[str, list[tuple[str, Type]]] = {}
    forwarded: set[str] = set()
    read = _read_events(behaviors)
    for behavior in behaviors:
        variables: dict[str, Type] = {data.id: data.type for data in behavior.automaton.data}
        for trigger, body in behavior.bodies():
            scope = dict(variables)
            if trigger:
                data = Struct("", tuple(known[trigger].items())) if trigger in known else UNKNOWN
                scope["_event"] = Struct("", (("data", data),))
            for statement in statements(body):
                if isinstance(statement, Send):
                    values = sent.setdefault(statement.event.name, [])
                    is_read = statement.event.name in read
                    values += ((param.name, _sent_type(param, scope, is_read)) for param in statement.params)
                    if any(_reads_event(param.value) for param in statement.params):
                        forwarded.add(trigger)
    types = {event: parameter_types(values) for event, values in sent.items()}
    return Round(types, types, frozenset(forwarded))


def _sent_type(param: Param, scope: Mapping[str, Type], is_read: bool) -> Type:
    """The type of a value that is sent; that of `[]` is the type of the ROS field if a receiver reads the event."""
    type_, _ = infer(param.value, scope.get)
    if isinstance(type_, EmptyArray) and is_read and param.declared is not None:
        return type_of_empty(param.declared)
    return type_


def _read_events(behaviors: Sequence[AutomatonMoves]) -> frozenset[str]:
    """The names of the events whose data a receiver reads."""
    return frozenset(
        move.event
        for behavior in behaviors
        for _, moves in behavior.moves
        for move in moves
        if move.event and any(map(_reads_event, _expressions(move)))
    )


def _expressions(move: Move) -> Iterator[Expr]:
    if move.transition.cond is not None:
        yield move.transition.cond
    for outcome in move.outcomes:
        for statement in statements(outcome.body):
            match statement:
                case Assign():
                    yield from (statement.location, statement.value)
                case Send():
                    yield from (param.value for param in statement.params)
                case If():
                    yield from (branch.cond for branch in statement.branches)
                case _:
                    assert_never(statement)


def _reads_event(value: Expr) -> bool:
    return any(isinstance(node, Name) and node.name == "_event" for node in walk(value))

# SPDX-License-Identifier: Apache-2.0
"""All events of a network: their senders, their receivers, and the types of their parameters
(docs/spec/jani.md#global-variables)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from roaml.expr.infer import infer
from roaml.expr.types import UNKNOWN, Struct, Type, join
from roaml.scxml.model import Body, EventRole, ScxmlEvent, Send, statements
from roaml.text import Location
from roaml.to_jani.moves import AutomatonMoves


@dataclass(slots=True)
class EventUsage:
    """
    Attributes:
        params: name -> type, in the order of their first sending.
        senders, receivers: indexes of automata, in order.
        origin: the origin of the first `<send>`; otherwise of the first transition on it.
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

    @property
    def data(self) -> Struct:
        return Struct("", (("data", Struct("", tuple(self.params.items()))),))


def event_table(behaviors: Sequence[AutomatonMoves]) -> dict[str, EventUsage]:
    """All events by name, in the order of their first occurrence."""
    table = _occurrences(behaviors)
    for _ in range(_ROUNDS):
        if not _infer_params(behaviors, table):
            break
    return table


_ROUNDS = 4
"""The maximum number of rounds in which types are passed from the data of one event to the parameters of another."""


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


def _infer_params(behaviors: Sequence[AutomatonMoves], table: Mapping[str, EventUsage]) -> bool:
    """Infer types once from everything that is sent; return whether an unknown type remains that another round may
    infer."""
    waiting = False
    for behavior in behaviors:
        local: dict[str, Type] = {data.id: data.type for data in behavior.automaton.data}
        for trigger, body in behavior.bodies():
            scope = dict(local)
            if trigger:
                scope["_event"] = table[trigger].data
            for statement in statements(body):
                if isinstance(statement, Send):
                    params = table[statement.event.name].params
                    for param in statement.params:
                        type_, _ = infer(param.value, scope.get)
                        known = params.get(param.name, UNKNOWN)
                        params[param.name] = join(known, type_) or known
                        waiting = waiting or params[param.name] == UNKNOWN
    return waiting

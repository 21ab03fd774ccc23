# SPDX-License-Identifier: Apache-2.0
"""Common parts of the handlers of services and actions. A handler stores the fields of an event in its own variables,
and forwards them."""

from __future__ import annotations

from collections.abc import Iterable, Set

from roaml.expr.types import Type
from roaml.lower.build import event_data, name
from roaml.lower.data import lower_data
from roaml.lower.program import TranslatableSystem
from roaml.model.system import Channel, ChannelEndpoint
from roaml.scxml.events import ScxmlEvent
from roaml.scxml.model import Assign, Body, Data, Param, Statement, Target, Transition
from roaml.text import Location


def copied(fields: Iterable[str], sent: Set[str], origin: Location) -> Body:
    """Assignments that store `fields` of the received event, except those that its sender does not send."""
    return tuple(Assign(name(field), event_data(field), origin) for field in fields if field in sent)


def stored(fields: Iterable[str], origin: Location) -> tuple[Param, ...]:
    """The stored fields as parameters of an event."""
    return tuple(Param(field, name(field), origin) for field in fields)


def variables(fields: dict[str, Type], origin: Location) -> tuple[Data, ...]:
    return tuple(data for field, type_ in fields.items() for data in lower_data(field, type_, None, origin))


def on(event: ScxmlEvent, target: str, body: Iterable[Statement], origin: Location) -> Transition:
    return Transition(event, None, (Target(target, 1.0, tuple(body), origin),), origin)


def declared_at(endpoint: ChannelEndpoint, program: TranslatableSystem) -> Location:
    """The place where a client or server is declared."""
    machine = program.machines.get(endpoint.automaton.path)
    for declaration in machine.declarations if machine else ():
        if (
            declaration.kind == endpoint.use.kind
            and declaration.handle
            and declaration.handle.value == endpoint.use.handle
        ):
            return Location(endpoint.automaton.path, declaration.element.span)
    return program.place_of(endpoint.automaton)


def handler_place(channel: Channel, program: TranslatableSystem) -> Location:
    """The place of the declaration that is the origin of a handler: the declaration of the server or, without a server,
    that of the first client. A rule reports a missing server."""
    return declared_at(channel.endpoints[0], program)

# SPDX-License-Identifier: Apache-2.0
"""The handler between the clients and the server of a ROS service. It handles one request at a time
(docs/spec/plain-scxml.md#service-automaton)."""

from __future__ import annotations

from roaml.lower.handlers import copied, declared_at, handler_place, on, stored, variables
from roaml.lower.interfaces import ServiceEvents, fields, sent_parameters
from roaml.lower.program import TranslatableSystem
from roaml.model.system import Channel
from roaml.roles import ProtocolPart
from roaml.scxml.events import Role
from roaml.scxml.model import Automaton, Send, State
from roaml.scxml.names import SERVICE_HANDLER_PREFIX, handling, sanitise

_PARTS = (ProtocolPart.REQUEST, ProtocolPart.RESPONSE)


def service_handler(service: Channel, program: TranslatableSystem) -> Automaton:
    events = ServiceEvents(service.name)
    request, response = (fields(service, part, program.environment) for part in _PARTS)
    answered = set[str]().union(*(sent_parameters(server, ProtocolPart.RESPONSE) for server in service.sources))
    origin = handler_place(service, program)
    waiting, processing = [], []
    for client in service.users:
        place = declared_at(client, program)
        busy = handling(client.automaton.name)
        asked = copied(request, sent_parameters(client, ProtocolPart.REQUEST), place)
        passed_on = Send(events.request, stored(request, place), place)
        waiting.append(on(events.request_of(client.automaton), busy, (*asked, passed_on), place))
        given = copied(response, answered, place)
        passed_back = Send(events.response_to(client.automaton), stored(response, place), place)
        back = on(events.response, "waiting", (*given, passed_back), place)
        processing.append(State(busy, (), (), (back,), place))
    states = (State("waiting", (), (), tuple(waiting), origin), *processing)
    data = variables({**request, **response}, origin)
    return Automaton(f"{SERVICE_HANDLER_PREFIX}{sanitise(service.name)}", Role.HANDLER, "waiting", data, states, origin)

# SPDX-License-Identifier: Apache-2.0
"""The handler between the clients and the server of a ROS action (docs/spec/plain-scxml.md#action-automaton). It passes
on one goal at a time, and waits until the server has accepted or rejected it.

All goals of a client have the same id: the index of the client among the clients of the action.
"""

from __future__ import annotations

from collections.abc import Callable

from roaml.expr.types import BASE_TYPES
from roaml.expr.zero import zero
from roaml.lower.build import equal, event_data, integer, name
from roaml.lower.handlers import copied, declared_at, handler_place, on, stored, variables
from roaml.lower.interfaces import ActionEvents, fields, sent_parameters
from roaml.lower.program import TranslatableSystem
from roaml.model.system import Channel, SystemAutomaton
from roaml.roles import ProtocolPart
from roaml.scxml.events import Role, ScxmlEvent
from roaml.scxml.model import Assign, Automaton, Body, Branch, Data, If, Param, Send, State, Statement
from roaml.scxml.names import ACTION_HANDLER_PREFIX, sanitise
from roaml.text import Location

GOAL_ID = "goal_id"
CODE = "code"
_PARTS = (ProtocolPart.GOAL, ProtocolPart.FEEDBACK, ProtocolPart.RESULT)


def action_handler(action: Channel, program: TranslatableSystem) -> Automaton:
    events = ActionEvents(action.name)
    goal, feedback, result = (fields(action, part, program.environment) for part in _PARTS)
    origin = handler_place(action, program)
    requests = []
    for number, client in enumerate(action.users):
        place = declared_at(client, program)
        asked = copied(goal, sent_parameters(client, ProtocolPart.GOAL), place)
        passed_on = Send(events.goal, (Param(GOAL_ID, integer(number), place), *stored(goal, place)), place)
        requests.append(on(events.goal_of(client.automaton), "goal_requested", (*asked, passed_on), place))

    def sent(part: ProtocolPart) -> set[str]:
        return set[str]().union(*(sent_parameters(server, part) for server in action.sources))

    remember = _store(GOAL_ID, origin)
    reported = on(
        events.feedback,
        "waiting",
        (
            remember,
            *copied(feedback, sent(ProtocolPart.FEEDBACK), origin),
            *_to_client(action, events.feedback_for, stored(feedback, origin), origin),
        ),
        origin,
    )
    code = Param(CODE, name(CODE), origin)
    finished = on(
        events.result,
        "waiting",
        (
            _store(CODE, origin),
            remember,
            *copied(result, sent(ProtocolPart.RESULT), origin),
            *_to_client(action, events.result_for, (code, *stored(result, origin)), origin),
        ),
        origin,
    )
    decided = (
        on(events.accepted, "waiting", (remember, *_to_client(action, events.accept_for, (), origin)), origin),
        on(events.rejected, "waiting", (remember, *_to_client(action, events.reject_for, (), origin)), origin),
    )
    states = (
        State("waiting", (), (), (*requests, reported, finished), origin),
        State("goal_requested", (), (), decided, origin),
    )
    int32 = BASE_TYPES["int32"]
    own = tuple(Data(variable, int32, zero(int32), origin) for variable in (GOAL_ID, CODE))
    data = (*variables({**goal, **feedback, **result}, origin), *own)
    return Automaton(f"{ACTION_HANDLER_PREFIX}{sanitise(action.name)}", Role.HANDLER, "waiting", data, states, origin)


def _store(parameter: str, origin: Location) -> Statement:
    return Assign(name(parameter), event_data(parameter), origin)


def _to_client(
    action: Channel, event: Callable[[SystemAutomaton], ScxmlEvent], params: tuple[Param, ...], origin: Location
) -> Body:
    """The statements that send an event to the client with the stored goal id. `event` returns the event for a client.
    There are none for an action without clients, which also has a handler."""
    branches = tuple(
        Branch(equal(name(GOAL_ID), integer(number)), (Send(event(client.automaton), params, origin),), origin)
        for number, client in enumerate(action.users)
    )
    return (If(branches, (), origin),) if branches else ()

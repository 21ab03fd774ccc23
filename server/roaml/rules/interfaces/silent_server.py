# SPDX-License-Identifier: Apache-2.0
"""The rule `silent-server`, which silent_server.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import last_in
from roaml.model.behavior.phases import Duty, DutyKind
from roaml.model.gaps import InterfaceAct
from roaml.model.machine import Declaration, RosSend
from roaml.model.ros import InterfaceType
from roaml.model.system import Channel, ChannelEndpoint, System, SystemAutomaton
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import behaviors, misdirected, missed, named_right
from roaml.rules.support.interfaces import declared, find_use, name_span, response
from roaml.text import Span


def check(context: MachineContext) -> Iterator[Finding]:
    if context.system is None:
        return
    for declaration, automaton, channel in declared(context, SymbolKind.SERVICE_SERVER):
        clients = [c for c in channel.users if ProtocolPart.REQUEST in c.use.sends]
        if clients and not _may_do_more(context.system, automaton, SymbolKind.SERVICE_SERVER, channel):
            yield from _service(context, declaration, automaton, channel, clients)
    for declaration, automaton, channel in declared(context, SymbolKind.ACTION_SERVER):
        clients = [c for c in channel.users if ProtocolPart.GOAL in c.use.sends]
        if clients and not _may_do_more(context.system, automaton, SymbolKind.ACTION_SERVER, channel):
            yield from _action(context, declaration, automaton, channel, clients)


def _may_do_more(system: System, automaton: SystemAutomaton, kind: SymbolKind, channel: Channel) -> bool:
    """Whether a server may receive or answer requests or goals in a part of its machine that cannot be read."""
    return any(system.may(InterfaceAct(kind, part), channel.name, automaton) for part in _PARTS)


_PARTS = (
    ProtocolPart.REQUEST,
    ProtocolPart.RESPONSE,
    ProtocolPart.GOAL,
    ProtocolPart.GOAL_ACCEPTED,
    ProtocolPart.GOAL_REJECTED,
    ProtocolPart.RESULT,
)


def _service(
    context: MachineContext,
    declaration: Declaration,
    automaton: SystemAutomaton,
    channel: Channel,
    clients: list[ChannelEndpoint],
) -> Iterator[Finding]:
    related = [Related(clients[0].symbol, "a client")]
    subject = f"the service `{channel.name}` is called but"
    if not sends(automaton, declaration, ProtocolPart.RESPONSE):
        duty = Duty(DutyKind.REQUEST, declaration.handle.value if declaration.handle else "")
        for behavior in behaviors(context):
            wrong = misdirected(behavior, duty)
            if wrong is not None:
                span, message, fix = named_right(wrong, duty)
                yield RULE.at(span, message, fix, related=related)
                return
        message = f"{subject} never answers: `<ros_service_send_response>` is missing"
        span = _lost(context, declaration, DutyKind.REQUEST)
        yield RULE.at(span, message, *_answer(context, declaration), related=related)
    elif not receives(automaton, declaration, ProtocolPart.REQUEST):
        message = f"{subject} does not handle requests: `<ros_service_handle_request>` is missing"
        yield RULE.at(name_span(declaration), message, related=related)


def _action(
    context: MachineContext,
    declaration: Declaration,
    automaton: SystemAutomaton,
    channel: Channel,
    clients: list[ChannelEndpoint],
) -> Iterator[Finding]:
    related = [Related(clients[0].symbol, "a client")]
    if not sends(automaton, declaration, ProtocolPart.GOAL_ACCEPTED):
        rejects = sends(automaton, declaration, ProtocolPart.GOAL_REJECTED)
        omission = "accepts no goal" if rejects else "neither accepts nor rejects its goals"
        message = f"the action `{channel.name}` {omission}: `<ros_action_accept_goal>` is missing"
        yield RULE.at(_lost(context, declaration, DutyKind.GOAL), message, related=related)
    elif not receives(automaton, declaration, ProtocolPart.GOAL):
        message = f"the action `{channel.name}` does not handle goals: `<ros_action_handle_goal>` is missing"
        yield RULE.at(name_span(declaration), message, related=related)
    waiting = [c for c in clients if ProtocolPart.RESULT in c.use.receives]
    if waiting and not sends(automaton, declaration, ProtocolPart.RESULT):
        message = (
            f"the action `{channel.name}` never ends its goals: `<ros_action_succeed>`, `<ros_action_canceled>` or "
            "`<ros_action_aborted>` is missing"
        )
        related = [Related(waiting[0].symbol, "this client waits for the result")]
        yield RULE.at(_lost(context, declaration, DutyKind.RESULT), message, related=related)


def _lost(context: MachineContext, declaration: Declaration, kind: DutyKind) -> Span:
    """The first place where an answer is missing; the name of the service or action if nothing is received. A goal is
    decided on where it arrives."""
    if declaration.handle is not None:
        for behavior in behaviors(context):
            for path in missed(context, behavior, Duty(kind, declaration.handle.value)):
                is_decision = kind is DutyKind.GOAL and path.loss.path
                return path.loss.path[0].handler.element.name_span if is_decision else path.span
    return name_span(declaration)


def _answer(context: MachineContext, declaration: Declaration) -> Iterator[Fix]:
    """A fix that sends a response with zero values at the end of each handler of requests."""
    assert declaration.handle is not None
    interface = context.interface("srv", declaration.type.value) if declaration.type else None
    handlers = [h for chart in context.machine.charts for state in chart.states for h in state.handlers]
    places = [
        target.element or handler.element
        for handler in handlers
        if handler.trigger is ProtocolPart.REQUEST and find_handle(context.machine, handler) is declaration
        for target in handler.targets
    ]
    answers = (s for chart in context.machine.charts for s in chart.statements if isinstance(s, RosSend))
    is_misnamed = any(
        statement.part is ProtocolPart.RESPONSE and place.span.contains(statement.element.span.start)
        for statement in answers
        for place in places
    )
    if (
        is_misnamed
        or not places
        or not isinstance(interface, InterfaceType)
        or not all(place.complete for place in places)
    ):
        return
    lines = response(declaration, interface)
    edits = tuple(last_in(context.document, place, *lines) for place in places)
    yield Fix("Answer each request with `<ros_service_send_response>`", edits, preferred=False)


def sends(automaton: SystemAutomaton, declaration: Declaration, part: ProtocolPart) -> bool:
    use = find_use(automaton, declaration)
    return use is not None and part in use.sends


def receives(automaton: SystemAutomaton, declaration: Declaration, part: ProtocolPart) -> bool:
    use = find_use(automaton, declaration)
    return use is not None and part in use.receives


RULE = Rule("silent-server", Severity.ERROR, "A server never answers.", machine=check, whole=True)

# SPDX-License-Identifier: Apache-2.0
"""The rule `unhandled-cancel`, which unhandled_cancel.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.behavior.phases import Duty, DutyKind, ProtocolEvent
from roaml.model.gaps import InterfaceAct
from roaml.model.machine import Declaration, Handler, RosSend, State
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import answers_at_once, behaviors
from roaml.rules.support.interfaces import declared

_HANDLES = InterfaceAct(SymbolKind.ACTION_SERVER, ProtocolPart.CANCEL)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report cancel requests that the server handles in none of its states, so that it rejects all of them."""
    system = context.system
    if system is None:
        return
    yield from _rejected(context)
    reported: set[RosSend] = set()
    for declaration, _, action in declared(context, SymbolKind.ACTION_CLIENT):
        if not action.sources or any(ProtocolPart.CANCEL in server.use.receives for server in action.sources):
            continue
        if any(system.may(_HANDLES, action.name, server.automaton) for server in action.sources):
            continue
        for chart in context.machine.charts:
            for statement in chart.statements:
                if (
                    not isinstance(statement, RosSend)
                    or statement.part is not ProtocolPart.CANCEL
                    or statement in reported
                ):
                    continue
                if find_handle(context.machine, statement) is declaration:
                    reported.add(statement)
                    message = (
                        f"the server of `{action.name}` rejects every request to cancel a goal: "
                        "it has no `<ros_action_handle_cancel_goal>`; add one to the states in which a goal can be "
                        "canceled"
                    )
                    related = (Related(action.sources[0].symbol, "the server"),)
                    yield RULE.at(statement.element.name_span, message, related=related)


def _rejected(context: MachineContext) -> Iterator[Finding]:
    """Report the only state of a server in which a goal is executed and requests to cancel it are rejected."""
    servers = {declaration: action for declaration, _, action in declared(context, SymbolKind.ACTION_SERVER)}
    for declaration, action in servers.items():
        if declaration.handle is None or not any(ProtocolPart.CANCEL in user.use.sends for user in action.users):
            continue
        for behavior in behaviors(context):
            executing = {
                configuration.state
                for configuration in behavior.configurations
                if configuration.owes(Duty(DutyKind.RESULT, declaration.handle.value))
            }
            waiting = [s for s in behavior.chart.states if s.id and s.id.value in executing and _waits(context, s)]
            rejecting = [state for state in waiting if not _handles_cancel(context, state, declaration)]
            if len(rejecting) == 1 and len(waiting) > 1 and rejecting[0].id is not None:
                name = rejecting[0].id.value
                message = (
                    f"a request to cancel a goal that arrives in the state `{name}` is rejected, unlike in the other "
                    "states in which a goal is executed; add a `<ros_action_handle_cancel_goal>`"
                )
                yield RULE.at(rejecting[0].id.span, message)


def _waits(context: MachineContext, state: State) -> bool:
    """Whether a machine stays in a state until something arrives that takes time."""
    handlers = [handler for handler in state.handlers if handler.effective]
    is_left = any(handler.trigger is None or _arrives_at_once(context, handler) for handler in handlers)
    return bool(handlers) and not is_left


def _arrives_at_once(context: MachineContext, handler: Handler) -> bool:
    """Whether a handler takes the response of a service that always answers at once."""
    service = find_handle(context.machine, handler) if handler.trigger is ProtocolPart.RESPONSE else None
    if service is None or service.handle is None:
        return False
    return answers_at_once(context, ProtocolEvent(ProtocolPart.RESPONSE, service.handle.value))


def _handles_cancel(context: MachineContext, state: State, declaration: Declaration) -> bool:
    return any(
        handler.trigger is ProtocolPart.CANCEL and find_handle(context.machine, handler) is declaration
        for handler in state.handlers
    )


RULE = Rule(
    "unhandled-cancel",
    Severity.WARNING,
    "A client cancels a goal, but the server rejects the request.",
    machine=check,
    whole=True,
)

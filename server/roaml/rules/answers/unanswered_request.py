# SPDX-License-Identifier: Apache-2.0
"""The rule `unanswered-request`, which unanswered_request.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.language import HL_SCXML
from roaml.model.behavior.duties import forward
from roaml.model.behavior.explore import Behavior
from roaml.model.behavior.phases import Duty, DutyKind
from roaml.model.machine import Handler, State
from roaml.model.ros import InterfaceType
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import (
    OpenPath,
    answered,
    answered_in,
    behaviors,
    is_spelled,
    misdirected,
    missed,
    named_right,
)
from roaml.rules.support.interfaces import response
from roaml.xml_syntax import Element


def check(context: MachineContext) -> Iterator[Finding]:
    """Report services that answer a request only on some paths. Services that never answer are reported by
    silent-server."""
    for behavior in behaviors(context):
        handlers = {
            step.event.name: step.handler
            for step in behavior.steps
            if step.event and step.event.part is ProtocolPart.REQUEST
        }
        for name, handler in handlers.items():
            duty = Duty(DutyKind.REQUEST, name)
            if answered_in(context.machine, duty) == {behavior.chart.scope} and is_spelled(context, duty):
                yield from _missed(context, behavior, duty, handler)
        yield from _waiting(context, behavior)


def _waiting(context: MachineContext, behavior: Behavior) -> Iterator[Finding]:
    """Report a state that handles one of two requests of a client and waits for nothing else, although all other states
    that handle this request handle both: the client that sends the other request waits for ever."""
    yield from _ended(context, behavior)
    entered = {configuration.state for configuration in behavior.configurations}
    requests = {state: _requests(context, state) for state in behavior.chart.states}
    for state, handled in requests.items():
        if state.id is None or state.id.value not in entered or len(handled) != 1 or not _handles_only_requests(state):
            continue
        (name,) = handled
        others = [names for other, names in requests.items() if other is not state and name in names]
        for missing in sorted(frozenset.intersection(*others) - {name}) if len(others) > 1 else ():
            if _clients(context, name) & _clients(context, missing):
                message = (
                    f"a request for `{missing}` that arrives in the state `{state.id.value}` is never answered: the "
                    f"state handles only `{name}`, and all other states that handle `{name}` handle both; add a "
                    "`<ros_service_handle_request>`"
                )
                yield RULE.at(state.id.span, message, severity=Severity.WARNING)


def _ended(context: MachineContext, behavior: Behavior) -> Iterator[Finding]:
    """Report states without handlers of a server, which it enters although a client may send further requests. A server
    of one service may answer once, if its client asks once, so it is reported only if it answers again and again before
    it enters the state."""
    names = {step.event.name for step in behavior.steps if step.event and step.event.part is ProtocolPart.REQUEST}
    requested = sorted(name for name in names if _clients(context, name))
    entered = {configuration.state for configuration in behavior.configurations}
    for state in behavior.chart.states if len(requested) > 1 or (requested and _answers_again(behavior)) else ():
        if state.id is None or state.id.value not in entered or any(h.effective for h in state.handlers):
            continue
        if state.element.complete and not any(map(_is_unknown, state.element.elements)):
            message = (
                f"the machine never leaves the state `{state.id.value}`, which handles no requests, so a request for "
                f"`{requested[0]}` that arrives in it is never answered; add a `<transition>`"
            )
            yield RULE.at(state.id.span, message, severity=Severity.WARNING)


def _answers_again(behavior: Behavior) -> bool:
    """Whether a request can arrive after an earlier one."""
    requests = [step for step in behavior.steps if step.event and step.event.part is ProtocolPart.REQUEST]
    later = forward({step.target for step in requests}, behavior.steps)
    return any(step.source in later for step in requests)


def _is_unknown(element: Element) -> bool:
    return not element.is_foreign and HL_SCXML.find(element.name) is None


def _requests(context: MachineContext, state: State) -> frozenset[str]:
    """The services whose requests a state handles in any case."""
    handlers = (h for h in state.handlers if h.effective and h.trigger is ProtocolPart.REQUEST and h.cond is None)
    declarations = (find_handle(context.machine, handler) for handler in handlers)
    return frozenset(d.handle.value for d in declarations if d is not None and d.handle is not None)


def _handles_only_requests(state: State) -> bool:
    return all(h.trigger is ProtocolPart.REQUEST and h.cond is None for h in state.handlers if h.effective)


def _clients(context: MachineContext, name: str) -> frozenset[str]:
    """The paths of the machines that send requests to the service with the handle `name`."""
    clients: set[str] = set()
    for automaton in context.automata:
        use = automaton.outline.use(SymbolKind.SERVICE_SERVER, name)
        channel = context.system.channel(automaton, use) if context.system is not None and use is not None else None
        clients |= {endpoint.automaton.path for endpoint in channel.users} if channel is not None else set()
    return frozenset(clients)


def _missed(context: MachineContext, behavior: Behavior, duty: Duty, handler: Handler) -> Iterator[Finding]:
    for path in missed(context, behavior, duty):
        wrong = misdirected(behavior, duty)
        if wrong is not None:
            span, message, fix = named_right(wrong, duty)
            yield RULE.at(span, message, fix, related=path.related)
            return
        fixes = _fixes(context, behavior, path, handler)
        yield RULE.at(path.span, _message(path), *fixes, severity=path.severity, related=path.related)


def _message(path: OpenPath) -> str:
    step, name = path.step, path.loss.duty.handle
    if step.ignored:
        reason = f"a request for `{name}` that arrives while this condition does not hold is dropped and"
        if not path.receives:
            reason = f"{path.dropped}, so the request for `{name}` is"
        tag = f"<{step.handler.element.name}>"
        return f"{reason} never answered, and the client waits for ever; add a `{tag}` without `cond` after it"
    where = (
        "a request that is handled here"
        if path.receives
        else f"the request for `{name}` that arrived in the state `{path.received_in}`"
    )
    how = "is not answered on every path" if path.choice or not path.certain else "is never answered"
    when = f" {path.order}" if path.order else ""
    return f"{where} {how}{when}, so the client waits for ever; send one `<ros_service_send_response>` on every path"


def _fixes(context: MachineContext, behavior: Behavior, path: OpenPath, request_handler: Handler) -> Iterator[Fix]:
    """A fix that sends a response with zero values in all fields on the path."""
    declaration = find_handle(context.machine, request_handler)
    if declaration is None or declaration.type is None:
        return
    interface = context.interface("srv", declaration.type.value)
    if isinstance(interface, InterfaceType):
        lines, title = response(declaration, interface), "Answer with `<ros_service_send_response>`"
        yield from answered(context, path, behavior, title, lines, preferred=False)


RULE = Rule("unanswered-request", Severity.ERROR, "A request is not answered on every path.", machine=check, whole=True)

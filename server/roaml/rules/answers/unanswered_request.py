# SPDX-License-Identifier: Apache-2.0
"""The rule `unanswered-request`, which unanswered_request.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import last_in
from roaml.model.behavior.explore import Behavior, BehaviorStep
from roaml.model.behavior.phases import Duty, DutyKind
from roaml.model.machine import Handler
from roaml.model.ros import InterfaceType
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import answered_in, behaviors, is_spelled, missed, place, target_of
from roaml.rules.support.interfaces import response


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


def _missed(context: MachineContext, behavior: Behavior, duty: Duty, handler: Handler) -> Iterator[Finding]:
    for step, certain in missed(context, behavior, duty):
        severity = None if certain else Severity.WARNING
        message = _message(step, duty, certain)
        fixes = _fixes(context, step, handler)
        yield RULE.at(place(step.handler), message, *fixes, severity=severity, related=target_of(step))


def _message(step: BehaviorStep, duty: Duty, certain: bool) -> str:
    handles_request = step.event is not None and step.event.part is ProtocolPart.REQUEST
    if step.ignored:
        reason = f"a request for `{duty.handle}` that arrives while this condition does not hold is dropped and"
        if not handles_request:
            reason = f"events are dropped while this condition does not hold, so the request for `{duty.handle}` is"
        tag = f"<{step.handler.element.name}>"
        return f"{reason} never answered, and the client waits for ever; add a `{tag}` without `cond` after it"
    where = (
        "a request that is handled here" if handles_request else f"the request for `{duty.handle}` that is pending here"
    )
    how = "is not answered on every path" if step.handler.is_probabilistic or not certain else "is never answered"
    return f"{where} {how}, so the client waits for ever; send one `<ros_service_send_response>` on every path"


def _fixes(context: MachineContext, step: BehaviorStep, request_handler: Handler) -> Iterator[Fix]:
    """A fix that sends a response with zero values in all fields at the end of the handler."""
    place = step.handler.targets[step.choice].element or step.handler.element
    declaration = find_handle(context.machine, request_handler)
    if not step.certain or step.ignored or not place.complete or declaration is None or declaration.type is None:
        return
    interface = context.interface("srv", declaration.type.value)
    if isinstance(interface, InterfaceType):
        lines = response(declaration, interface)
        yield Fix(
            "Answer with `<ros_service_send_response>`", (last_in(context.document, place, *lines),), preferred=False
        )


RULE = Rule("unanswered-request", Severity.ERROR, "A request is not answered on every path.", machine=check)

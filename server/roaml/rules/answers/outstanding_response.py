# SPDX-License-Identifier: Apache-2.0
"""The rule `outstanding-response`, which outstanding_response.md describes."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.behavior.duties import forward
from roaml.model.behavior.explore import Behavior, BehaviorStep
from roaml.model.behavior.phases import Phase, ProtocolEvent, Subject
from roaml.model.machine import Handler, State
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import answers_at_once, behaviors


def check(context: MachineContext) -> Iterator[Finding]:
    """Report steps after which a machine does not wait for a response any more, if it may send the next request before
    the response arrives."""
    if context.system is None:
        return
    for behavior in behaviors(context):
        if not behavior.approximate:
            for name in sorted({e.name for s in behavior.steps for e in s.sent if e.part is ProtocolPart.REQUEST}):
                yield from _of_client(context, behavior, name)


def _of_client(context: MachineContext, behavior: Behavior, name: str) -> Iterator[Finding]:
    waiting = {s.id.value: h for s in behavior.chart.states if s.id for h in _awaiting(context, s, name)}
    again = {step.source: step for step in _overtaking(behavior, name, waiting.keys())}
    if not again:
        return
    left = {n for n in range(behavior.size) if _is_left(behavior, n, name, waiting.keys())}
    kept = [step for step in behavior.steps if step.source in left and step.target in left]
    takes_time = not answers_at_once(context, ProtocolEvent(ProtocolPart.RESPONSE, name))
    reported: set[Handler] = set()
    for step in behavior.steps:
        if step.handler in reported or not _leaves(behavior, step, name, waiting.keys()):
            continue
        overtaking = [again[number] for number in forward({step.target}, kept) if number in again]
        if overtaking:
            reported.add(step.handler)
            later = behavior.configurations[overtaking[0].target].state
            message = (
                f"the response to a request for `{name}` may still be outstanding here, and the state "
                f"`{behavior.configurations[step.target].state}` does not wait for it, so the state `{later}` may take "
                "it for the response to the next request; wait for it before the next request"
            )
            related = [
                Related(overtaking[0].handler.element.name_span, "sends the next request"),
                Related(waiting[later].element.name_span, "takes the earlier response"),
            ]
            is_sure = takes_time or step.event is None or (_sends(step, name) and _passes(behavior, step))
            severity = None if is_sure else Severity.INFORMATION
            yield RULE.at(step.handler.element.name_span, message, related=related, severity=severity)


def _awaiting(context: MachineContext, state: State, name: str) -> Iterator[Handler]:
    """The handlers with which a state reacts to a response."""
    for handler in state.handlers:
        if handler.effective and handler.trigger is ProtocolPart.RESPONSE:
            declaration = find_handle(context.machine, handler)
            if declaration is not None and declaration.handle is not None and declaration.handle.value == name:
                yield handler


def _is_left(behavior: Behavior, number: int, name: str, waiting: Collection[str]) -> bool:
    """Whether a response is outstanding in a configuration that does not wait for it."""
    configuration = behavior.configurations[number]
    return configuration.phase(Subject.RESPONSE, name) is Phase.AWAITED and configuration.state not in waiting


def _overtaking(behavior: Behavior, name: str, waiting: Collection[str]) -> Iterator[BehaviorStep]:
    """The steps that send a request and wait for its response, although an earlier one is outstanding."""
    for step in behavior.steps:
        is_waiting = behavior.configurations[step.target].state in waiting
        if _sends(step, name) and is_waiting and _is_left(behavior, step.source, name, waiting):
            yield step


def _sends(step: BehaviorStep, name: str) -> bool:
    return ProtocolEvent(ProtocolPart.REQUEST, name) in step.sent


def _leaves(behavior: Behavior, step: BehaviorStep, name: str, waiting: Collection[str]) -> bool:
    """Whether a step leaves a state that waits for a response, or sends a request, without waiting for the response.
    After the response to another request, such as one to stop, the server probably forgets the earlier one."""
    if step.event is not None and step.event.part is ProtocolPart.RESPONSE:
        return False
    before = behavior.configurations[step.source]
    begins = before.state in waiting and before.phase(Subject.RESPONSE, name) is Phase.AWAITED
    begins = begins or (_sends(step, name) and before.phase(Subject.RESPONSE, name) is None)
    return begins and _is_left(behavior, step.target, name, waiting)


def _passes(behavior: Behavior, step: BehaviorStep) -> bool:
    """Whether the state that a step enters only leads to another one, so that it probably should wait there."""
    name = behavior.configurations[step.target].state
    entered = next((state for state in behavior.chart.states if state.id is not None and state.id.value == name), None)
    return entered is not None and all(h.trigger is None for h in entered.handlers) and bool(entered.handlers)


RULE = Rule(
    "outstanding-response",
    Severity.WARNING,
    "The response to an earlier request may be taken for that to a later one.",
    machine=check,
    whole=True,
)

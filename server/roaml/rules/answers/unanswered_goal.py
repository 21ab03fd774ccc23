# SPDX-License-Identifier: Apache-2.0
"""The rule `unanswered-goal`, which unanswered_goal.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.behavior.explore import Behavior, BehaviorStep
from roaml.model.behavior.phases import Duty, DutyKind
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import answered_in, behaviors, is_spelled, missed, place, target_of
from roaml.rules.support.interfaces import declared


def check(context: MachineContext) -> Iterator[Finding]:
    """Report goals that are neither accepted nor rejected on some path, or accepted and never ended. Actions that never
    accept or end a goal are reported by silent-server."""
    awaited = _awaited(context)
    for behavior in behaviors(context):
        handles = {
            s.event.name
            for s in behavior.steps
            if s.event and s.event.part in (ProtocolPart.GOAL, ProtocolPart.THREAD_START)
        }
        for name in sorted(handles):
            for kind in (DutyKind.GOAL, DutyKind.RESULT):
                duty = Duty(kind, name)
                if kind is DutyKind.RESULT and name not in awaited:
                    continue
                if answered_in(context.machine, duty) == {behavior.chart.scope} and is_spelled(context, duty):
                    yield from _missed(context, behavior, duty)


def _awaited(context: MachineContext) -> set[str]:
    """The handles of the actions whose results at least one client waits for."""
    return {
        declaration.handle.value
        for declaration, _, channel in declared(context, SymbolKind.ACTION_SERVER)
        if declaration.handle and any(ProtocolPart.RESULT in client.use.receives for client in channel.users)
    }


def _missed(context: MachineContext, behavior: Behavior, duty: Duty) -> Iterator[Finding]:
    for step, certain in missed(context, behavior, duty):
        severity = None if certain else Severity.WARNING
        message = _message(step, duty, certain)
        yield RULE.at(place(step.handler), message, severity=severity, related=target_of(step))


def _message(step: BehaviorStep, duty: Duty, certain: bool) -> str:
    tag, ends = f"<{step.handler.element.name}>", duty.kind is DutyKind.RESULT
    never = "is never ended" if ends else "is neither accepted nor rejected"
    if step.ignored:
        reason = "events are dropped while this condition does not hold, so a goal"
        return f"{reason} {never} and its client waits for ever; add a `{tag}` without `cond` after it"
    how = never if certain and not step.handler.is_probabilistic else f"{never} on some path"
    results = "`<ros_action_succeed>`, `<ros_action_aborted>` or `<ros_action_canceled>`"
    end = f"end it with {results}" if ends else "accept or reject it"
    which = "a goal that is accepted here" if ends else "a goal that is handled here"
    if (ends and not {e.part for e in step.sent} & {ProtocolPart.GOAL_ACCEPTED}) or not (ends or _handles_goal(step)):
        which = "the goal that is pending here"
    return f"{which} {how}, so its client waits for ever; {end} on every path"


def _handles_goal(step: BehaviorStep) -> bool:
    return step.event is not None and step.event.part is ProtocolPart.GOAL


RULE = Rule(
    "unanswered-goal", Severity.ERROR, "A goal is not accepted or rejected, or not ended, on every path.", machine=check
)

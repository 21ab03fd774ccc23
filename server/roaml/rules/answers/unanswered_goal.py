# SPDX-License-Identifier: Apache-2.0
"""The rule `unanswered-goal`, which unanswered_goal.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.behavior.explore import Behavior
from roaml.model.behavior.phases import Duty, DutyKind
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import OpenPath, answered_in, behaviors, is_spelled, missed
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
    for path in missed(context, behavior, duty):
        yield RULE.at(path.span, _message(path), severity=path.severity, related=path.related)


def _message(path: OpenPath) -> str:
    step, ends = path.step, path.loss.duty.kind is DutyKind.RESULT
    tag, when = f"<{step.handler.element.name}>", f" {path.order}" if path.order else ""
    if path.loss.overwritten is not None:
        lost = (
            f"this overwrites the id of a running goal{when}, so that goal is never ended and its client waits for ever"
        )
        return f"{lost}; store the ids of all running goals, or reject a goal while another one is running"
    never = "is never ended" if ends else "is neither accepted nor rejected"
    if step.ignored:
        reason = f"{path.dropped}, so a goal"
        return f"{reason} {never} and its client waits for ever; add a `{tag}` without `cond` after it"
    how = never if path.certain and not path.choice else f"{never} on some path"
    results = "`<ros_action_succeed>`, `<ros_action_aborted>` or `<ros_action_canceled>`"
    end = f"end it with {results}" if ends else "accept or reject it"
    which = "a goal that is accepted here" if ends else "a goal that is handled here"
    if not path.receives:
        how_begun = "was accepted" if ends else "arrived"
        which = f"the goal that {how_begun} in the state `{path.received_in}`"
    return f"{which} {how}{when}, so its client waits for ever; {end} on every path"


RULE = Rule(
    "unanswered-goal",
    Severity.ERROR,
    "A goal is not accepted or rejected, or not ended, on every path.",
    machine=check,
    whole=True,
)

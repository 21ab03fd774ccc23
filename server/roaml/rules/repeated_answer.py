# SPDX-License-Identifier: Apache-2.0
"""repeated-answer: see repeated_answer.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.model.behavior.explore import Behavior, Duty, Event, Fault, Step
from roaml.model.machine import Handler, ReturnStatus, Statement
from roaml.rules.answers import SENT, answered_in, behaviors, place, plugins
from roaml.rules.elements import removal
from roaml.rules.rule import MachineContext, Rule
from roaml.text import TextEdit

KINDS = ("unasked", "wrong-kind")


def check(context: MachineContext) -> Iterator[Finding]:
    """What is answered twice, or without having been asked for, counts as the answer to the next question."""
    told: set[tuple[Handler, Duty]] = set()
    in_tree = bool(plugins(context))
    for behavior in behaviors(context):
        for step in behavior.steps:
            for fault in step.faults:
                if (step.handler, fault.duty) in told or not _counts(context, behavior, step, fault, in_tree):
                    continue
                told.add((step.handler, fault.duty))
                yield _finding(context, step, fault)


def _counts(context: MachineContext, behavior: Behavior, step: Step, fault: Fault, in_tree: bool) -> bool:
    if fault.kind not in KINDS:
        return False
    if fault.duty.kind in ("tick", "halt"):
        if not in_tree or behavior.chart is not context.machine.chart:
            return False
        takes = "bt-tick" if isinstance(fault.statement, ReturnStatus) else "bt-halt"
        if not any(s.event and s.event.part == takes for s in behavior.steps) and not _twice(step, fault):
            return False  # the handler that is missing is reported
    elif len(answered_in(context.machine, fault.duty)) > 1 or not _is_asked(behavior, fault.duty):
        return False
    elif fault.duty.kind == "request" and _owes_another(behavior, step, fault.duty):
        return False  # the request that is not answered is reported
    return not behavior.approximate or _twice(step, fault)


def _is_asked(behavior: Behavior, duty: Duty) -> bool:
    """Whether this chart takes what is answered."""
    kinds = ("goal", "thread-start") if duty.kind == "result" else (duty.kind,)
    return any(step.event and step.event.part in kinds and step.event.name == duty.handle for step in behavior.steps)


def _owes_another(behavior: Behavior, step: Step, duty: Duty) -> bool:
    phases = behavior.configurations[step.target].phases
    return any(kind == duty.kind and handle != duty.handle for (kind, handle), _ in phases)


def _twice(step: Step, fault: Fault) -> bool:
    """Whether the answer is sent more than once in the very same step."""
    if fault.duty.kind == "goal":
        parts = {"goal-accepted", "goal-rejected"}
    elif fault.duty.kind in ("tick", "halt"):
        parts = {"bt-status", "bt-halted"}
    else:
        parts = {SENT[fault.duty.kind]}
    handle = "" if fault.duty.kind in ("tick", "halt") else fault.duty.handle
    return sum(event in {Event(part, handle) for part in parts} for event in step.sent) > 1


def _finding(context: MachineContext, step: Step, fault: Fault) -> Finding:
    where = place(step.handler, fault.statement)
    related = [Related(fault.statement.element.name_span, "this answer")]
    # What is sent when a state is entered may be meant for another way into it.
    shared = where == fault.statement.element.name_span and not _twice(step, fault)
    severity = Severity.INFORMATION if shared else None
    return RULE.at(where, _message(step, fault), *_fixes(context, step, fault), severity=severity, related=related)


def _message(step: Step, fault: Fault) -> str:
    what, tag = _QUESTION[fault.duty.kind], fault.statement.element.name
    if fault.kind == "wrong-kind":
        right = "bt_return_halted" if isinstance(fault.statement, ReturnStatus) else "bt_return_status"
        return f"a {what} is answered with `<{tag}>`, which its parent does not wait for; send `<{right}>` instead"
    if _twice(step, fault):
        how = {"result": "ends", "goal": "is accepted or rejected"}.get(fault.duty.kind, "is answered")
        return f"on a path through this a {what} {how} twice: the second answer is taken for that to the next; send one"
    return (
        f"`<{tag}>` is sent here though no {what} is waiting for it: it was answered before, or has not come yet; "
        "send the answer where it is taken"
    )


_QUESTION = {"tick": "tick", "halt": "halt", "request": "request", "goal": "goal", "result": "goal"}


def _fixes(context: MachineContext, step: Step, fault: Fault) -> Iterator[Fix]:
    element = fault.statement.element
    if fault.kind == "wrong-kind":
        right = (
            "<bt_return_halted />"
            if isinstance(fault.statement, ReturnStatus)
            else '<bt_return_status status="SUCCESS" />'
        )
        yield Fix(f"Change to `{right}`", (TextEdit(element.span, right),), preferred=False)
    elif _is_last(step.handler, fault.statement):
        yield Fix(f"Remove this `<{element.name}>`", (removal(context.source.text, element.span),), preferred=False)


def _is_last(handler: Handler, statement: Statement) -> bool:
    """Whether the statement stands in the handler itself, so that taking it away leaves no empty `<if>`."""
    return any(statement in target.body for target in handler.targets)


RULE = Rule(
    "repeated-answer", Severity.WARNING, "Something is answered twice, or without having been asked.", machine=check
)

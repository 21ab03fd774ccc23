# SPDX-License-Identifier: Apache-2.0
"""The rule `repeated-answer`, which repeated_answer.md describes."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import last_in, level_of, removal
from roaml.model.behavior.explore import Behavior, BehaviorStep, Fault, FaultKind
from roaml.model.behavior.phases import OWED, Duty, DutyKind, ProtocolEvent
from roaml.model.machine import Handler, If, ReturnHalted, ReturnStatus, RosSend, Statement, statements
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import SENT, answered_in, behaviors, place, plugins
from roaml.text import TextEdit

KINDS = (FaultKind.UNASKED, FaultKind.WRONG_KIND)
_REQUESTS_OF = {
    DutyKind.REQUEST: (ProtocolPart.REQUEST,),
    DutyKind.GOAL: (ProtocolPart.GOAL,),
    DutyKind.RESULT: (ProtocolPart.GOAL, ProtocolPart.THREAD_START),
}
"""The kind of a duty -> the events that require its answer."""


def check(context: MachineContext) -> Iterator[Finding]:
    """Report answers that are sent twice or without a request: they are used as the answer to the next request."""
    reported: set[tuple[Handler, Duty]] = set()
    in_tree = bool(plugins(context))
    for behavior in behaviors(context):
        for step in behavior.steps:
            for fault in step.faults:
                if (step.handler, fault.duty) in reported or not _counts(context, behavior, step, fault, in_tree):
                    continue
                reported.add((step.handler, fault.duty))
                yield _finding(context, behavior, step, fault)


def _counts(context: MachineContext, behavior: Behavior, step: BehaviorStep, fault: Fault, in_tree: bool) -> bool:
    if fault.kind not in KINDS:
        return False
    if fault.duty.kind.is_of_tree:
        if not in_tree or behavior.chart is not context.machine.chart:
            return False
        takes = ProtocolPart.BT_TICK if isinstance(fault.statement, ReturnStatus) else ProtocolPart.BT_HALT
        if not any(s.event and s.event.part is takes for s in behavior.steps) and not _twice(step, fault):
            return False  # the missing handler is reported instead
    elif len(answered_in(context.machine, fault.duty)) > 1 or not _handles_requests(behavior, fault.duty):
        return False
    elif fault.duty.kind is DutyKind.REQUEST and _owes_another(behavior, step, fault.duty):
        return False  # the unanswered request is reported instead
    return not behavior.approximate or _twice(step, fault)


def _handles_requests(behavior: Behavior, duty: Duty) -> bool:
    """Whether this chart handles the events that the duty requires an answer to."""
    parts = _REQUESTS_OF[duty.kind]
    return any(step.event and step.event.part in parts and step.event.name == duty.handle for step in behavior.steps)


def _owes_another(behavior: Behavior, step: BehaviorStep, duty: Duty) -> bool:
    subject, phases = OWED[duty.kind], behavior.configurations[step.target].phases
    return any(other is subject and handle != duty.handle for (other, handle), _ in phases)


def _twice(step: BehaviorStep, fault: Fault) -> bool:
    """Whether the answer is sent more than once in one step."""
    return sum(event in _answers(fault) for event in step.sent) > 1


def _answers(fault: Fault) -> set[ProtocolEvent]:
    """The events that are answers to the duty of a fault: for a tick or halt, a status and a confirmation; for a goal,
    both decisions."""
    if fault.duty.kind is DutyKind.GOAL:
        parts = {ProtocolPart.GOAL_ACCEPTED, ProtocolPart.GOAL_REJECTED}
    elif fault.duty.kind.is_of_tree:
        parts = {ProtocolPart.BT_STATUS, ProtocolPart.BT_HALTED}
    else:
        parts = {SENT[fault.duty.kind]}
    handle = "" if fault.duty.kind.is_of_tree else fault.duty.handle
    return {ProtocolEvent(part, handle) for part in parts}


def _finding(context: MachineContext, behavior: Behavior, step: BehaviorStep, fault: Fault) -> Finding:
    where = place(step.handler, fault.statement)
    first = _first_answer(context, behavior, step, fault)
    related = [Related(first.element.name_span, "the first answer")] if first is not None else []
    again = "the second answer" if first is not None else "this answer"
    related.append(Related(fault.statement.element.name_span, again))
    # An answer that is sent when a state is entered may be correct on another path into the state.
    shared = where == fault.statement.element.name_span and not _twice(step, fault)
    if shared and _is_certain(behavior, step, fault):
        state, tag = behavior.configurations[step.target].state, fault.statement.element.name
        message = f"this leads to the state `{state}`, which sends `<{tag}>`, but no {_QUESTION[fault.duty.kind]} waits"
        return RULE.at(step.handler.element.name_span, f"{message} for it; go to another state", related=related[-1:])
    severity = Severity.INFORMATION if shared else None
    message = _message(behavior, step, fault, first)
    return RULE.at(
        fault.statement.element.name_span,
        message,
        *_fixes(context, step, fault, first),
        severity=severity,
        related=related,
    )


def _is_certain(behavior: Behavior, step: BehaviorStep, fault: Fault) -> bool:
    """Whether nothing waits for the answer whenever the handler of a step is taken, unlike on other paths to it."""

    def is_wrong(other: BehaviorStep) -> bool:
        return any(f.statement is fault.statement for f in other.faults)

    own = [s for s in behavior.steps if (s.handler, s.choice) == (step.handler, step.choice) and not s.ignored]
    events = _answers(fault)
    others = (s for s in behavior.steps if s not in own and not events.isdisjoint(s.sent))
    return all(map(is_wrong, own)) and any(s.target == step.target and not is_wrong(s) for s in others)


def _message(behavior: Behavior, step: BehaviorStep, fault: Fault, first: Statement | None) -> str:
    event, tag = _QUESTION[fault.duty.kind], fault.statement.element.name
    if fault.kind is FaultKind.WRONG_KIND:
        right = "bt_return_halted" if isinstance(fault.statement, ReturnStatus) else "bt_return_status"
        return f"a {event} is answered with `<{tag}>`, but its parent waits for `<{right}>`; send `<{right}>` instead"
    how = {DutyKind.RESULT: "ended", DutyKind.GOAL: "accepted or rejected"}.get(fault.duty.kind, "answered")
    tail = f"the second answer is used as the answer to the next {event}; send only one answer"
    if first is None:
        if _twice(step, fault):
            return f"a {event} is {how} twice on one path: {tail}"
        return f"`<{tag}>` is sent while no {event} waits for it; send it where the {event} is handled"
    earlier, place, other = f"`<{first.element.name}>`", _where(behavior, first), _where(behavior, fault.statement)
    if not _twice(step, fault):
        why = f"on a path to this place the {event} was already {how} by {earlier} {place}"
        return f"`<{tag}>` is sent while no {event} waits for it: {why}; {tail}"
    by = f"first by {earlier} {place}, then by `<{tag}>` {other}"
    if place == other:
        by = f"by {earlier} and then by `<{tag}>`, both {place}"
    return f"a {event} is {how} twice on one path, {by}: {tail}"


def _first_answer(context: MachineContext, behavior: Behavior, step: BehaviorStep, fault: Fault) -> Statement | None:
    """The last statement that answered the request before the statement of `fault`, in the same step or in the nearest
    step before it. `None` if there is none, and for an answer of the wrong kind."""
    if fault.kind is FaultKind.WRONG_KIND:
        return None
    events = _answers(fault)
    earlier = _executed_before(behavior, step, fault.statement)
    if sum(event in events for event in step.sent) > 1:
        answers = [s for s in earlier if _event(context, s) in events]
        if answers:
            return answers[-1]
    incoming: dict[int, list[BehaviorStep]] = {}
    for candidate in behavior.steps:
        incoming.setdefault(candidate.target, []).append(candidate)
    seen, waiting = {step.source}, [step.source]
    for here in waiting:
        for candidate in incoming.get(here, ()):
            if any(event in events for event in candidate.sent):
                sent = [s for s in _executed_before(behavior, candidate, None) if _event(context, s) in events]
                if sent:
                    return sent[-1]
            if candidate.source not in seen:
                seen.add(candidate.source)
                waiting.append(candidate.source)
    return None


def _executed_before(behavior: Behavior, step: BehaviorStep, statement: Statement | None) -> list[Statement]:
    """The statements that a step may execute before `statement`, in order; all statements that it may execute if
    `statement` is `None`."""
    states = {state.id.value: state for state in behavior.chart.states if state.id}
    left = states.get(behavior.configurations[step.source].state)
    target = step.handler.targets[step.choice]
    entered = states.get(target.state.value) if target.state else None
    executed: list[Statement] = []
    leave = left.exit.statements if left and left.exit else ()
    enter = entered.entry.statements if entered and entered.entry else ()
    for body in (leave, target.body, enter):
        if not _append(executed, body, statement):
            break
    return executed


def _append(executed: list[Statement], body: tuple[Statement, ...], last: Statement | None) -> bool:
    """Append the statements that a body executes before `last`, without those in other branches; return whether the
    body does not contain `last`."""
    for child in body:
        if child is last:
            return False
        if isinstance(child, If):
            parts = [part.body for part in (*child.branches, child.otherwise) if part is not None]
            chosen = [part for part in parts if last is not None and last in statements(part)]
            for part in chosen or parts:
                if not _append(executed, part, last):
                    return False
        else:
            executed.append(child)
    return True


def _event(context: MachineContext, statement: Statement) -> ProtocolEvent | None:
    if isinstance(statement, ReturnStatus):
        return ProtocolEvent(ProtocolPart.BT_STATUS, "")
    if isinstance(statement, ReturnHalted):
        return ProtocolEvent(ProtocolPart.BT_HALTED, "")
    if isinstance(statement, RosSend):
        declaration = find_handle(context.machine, statement)
        return ProtocolEvent(statement.part, declaration.handle.value) if declaration and declaration.handle else None
    return None


def _where(behavior: Behavior, statement: Statement) -> str:
    """A phrase for the place of a statement."""
    at = statement.element.span
    for state in behavior.chart.states:
        name = state.id.value if state.id else ""
        for content, tag in ((state.entry, "onentry"), (state.exit, "onexit")):
            if content is not None and any(candidate is statement for candidate in statements(content.statements)):
                return f"in the `<{tag}>` of the state `{name}`"
        for handler in state.handlers:
            if handler.element.span.start <= at.start and at.end <= handler.element.span.end:
                return f"in the `<{handler.element.name}>` of the state `{name}`"
    return "before"


_QUESTION = {
    DutyKind.TICK: "tick",
    DutyKind.HALT: "halt",
    DutyKind.REQUEST: "request",
    DutyKind.GOAL: "goal",
    DutyKind.RESULT: "goal",
}


def _fixes(context: MachineContext, step: BehaviorStep, fault: Fault, first: Statement | None) -> Iterator[Fix]:
    element = fault.statement.element
    if fault.kind is FaultKind.WRONG_KIND:
        right = (
            "<bt_return_halted />"
            if isinstance(fault.statement, ReturnStatus)
            else '<bt_return_status status="SUCCESS" />'
        )
        yield Fix(f"Change to `{right}`", (TextEdit(element.span, right),), preferred=False)
    elif (before := _if_before(step.handler, fault.statement, first)) is not None:
        text = context.source.text[slice(*element.span)]
        level = level_of(context.document)
        added = last_in(context.document, before.element, "<else />", f"{level}{text}")
        yield Fix("Move this answer into `<else />`", (added, removal(context.source.text, element.span)))
    elif _is_last(step.handler, fault.statement):
        yield Fix(f"Remove this `<{element.name}>`", (removal(context.source.text, element.span),), preferred=False)


def _if_before(handler: Handler, statement: Statement, first: Statement | None) -> If | None:
    """The `<if>` without `<else/>` directly before a statement, if the first answer is in one of its branches: the
    second answer is probably that of the other paths."""
    for target in handler.targets:
        for before, after in itertools.pairwise(target.body):
            if after is statement and isinstance(before, If) and before.otherwise is None and before.element.complete:
                return before if any(inner is first for inner in statements((before,))) else None
    return None


def _is_last(handler: Handler, statement: Statement) -> bool:
    """Whether the statement is in the body of the handler and not in an `<if>`, so that its removal leaves no empty
    `<if>`."""
    return any(statement in target.body for target in handler.targets)


RULE = Rule(
    "repeated-answer", Severity.WARNING, "A machine answers twice, or without a request.", machine=check, whole=True
)

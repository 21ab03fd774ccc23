# SPDX-License-Identifier: Apache-2.0
"""The rule `cancel-without-goal`, which cancel_without_goal.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.edit.elements import remove
from roaml.language import HL_SCXML
from roaml.model.behavior.explore import Behavior, BehaviorStep, FaultKind
from roaml.model.machine import Declaration, RosSend, statements
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support import misspelled
from roaml.rules.support.answers import behaviors

_SENDS_GOALS = "ros_action_send_goal"


def check(context: MachineContext) -> Iterator[Finding]:
    """Report cancel requests that are sent only while the client has no accepted goal."""
    requests = list(_requests(context))
    if not requests or misspelled.among(context.machine.element.walk(), _SENDS_GOALS, HL_SCXML):
        return
    sending = _declarations(context, ProtocolPart.GOAL)
    for statement in requests:
        declaration = find_handle(context.machine, statement)
        if declaration is not None and declaration not in sending:
            yield _finding(context, statement, f"there is no `<{_SENDS_GOALS}>` for its client")
    for behavior in behaviors(context):
        for statement in _useless(context, behavior):
            if find_handle(context.machine, statement) in sending:
                reason = "no goal of this client is accepted here on any path"
                yield _finding(context, statement, reason)


def _finding(context: MachineContext, statement: RosSend, reason: str) -> Finding:
    message = (
        f"this request is always rejected: {reason}; cancel a goal between its acceptance, which "
        "`<ros_action_handle_goal_response>` handles, and its result"
    )
    return RULE.at(statement.element.name_span, message, remove(context.document, statement.element))


def _requests(context: MachineContext) -> Iterator[RosSend]:
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, RosSend) and statement.part is ProtocolPart.CANCEL:
                yield statement


def _declarations(context: MachineContext, part: ProtocolPart) -> set[Declaration | None]:
    """The declarations for which the machine sends `part`; with `None` if one cannot be read."""
    return {
        find_handle(context.machine, statement)
        for chart in context.machine.charts
        for statement in chart.statements
        if isinstance(statement, RosSend) and statement.part is part
    }


def _useless(context: MachineContext, behavior: Behavior) -> Iterator[RosSend]:
    """The cancel requests that are never sent while the client has an accepted goal. Requests of actions whose goal
    responses this chart does not handle are left out."""
    handled = {
        find_handle(context.machine, handler)
        for state in behavior.chart.states
        for handler in state.handlers
        if handler.trigger is ProtocolPart.GOAL_RESPONSE
    }
    useless: dict[RosSend, None] = {}
    useful: set[RosSend] = set()
    for step in behavior.steps:
        if any(event.part is ProtocolPart.CANCEL for event in step.sent):
            wrong = {fault.statement for fault in step.faults if fault.kind is FaultKind.NO_GOAL}
            for statement in _sent_in(behavior, step):
                if statement in wrong:
                    useless[statement] = None
                else:
                    useful.add(statement)
    yield from (s for s in useless if s not in useful and find_handle(context.machine, s) in handled)


def _sent_in(behavior: Behavior, step: BehaviorStep) -> Iterator[RosSend]:
    """The cancel requests that a step may send."""
    states = {state.id.value: state for state in behavior.chart.states if state.id}
    target = step.handler.targets[step.choice]
    left = states.get(behavior.configurations[step.source].state)
    entered = states.get(behavior.configurations[step.target].state)
    bodies = (
        left.exit.statements if left and left.exit else (),
        target.body,
        entered.entry.statements if entered and entered.entry else (),
    )
    for body in bodies:
        for statement in statements(body):
            if isinstance(statement, RosSend) and statement.part is ProtocolPart.CANCEL:
                yield statement


RULE = Rule(
    "cancel-without-goal",
    Severity.WARNING,
    "A client sends a cancel request while it has no accepted goal.",
    machine=check,
    whole=True,
)

# SPDX-License-Identifier: Apache-2.0
"""The rule `unanswered-cancel`, which unanswered_cancel.md describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import last_in
from roaml.expr.tree import Name
from roaml.language import HL_SCXML
from roaml.model.behavior.duties import unfinished
from roaml.model.behavior.phases import Duty, DutyKind
from roaml.model.machine import Chart, Declaration, Handler, Machine, RosSend, State, Statement, statements
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support import misspelled
from roaml.rules.support.answers import behaviors
from roaml.text import Edit, TextEdit

_ANSWER = "ros_action_canceled"
_NEW_GOAL = (ProtocolPart.GOAL, ProtocolPart.THREAD_START)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report handlers of cancel requests after which no path ends the goal as canceled."""
    handlers = list(_handlers(context))
    if not handlers or misspelled.among(context.machine.element.walk(), _ANSWER, HL_SCXML):
        return
    unended = set(_unended(context))
    for chart, state, handler in handlers:
        declaration = find_handle(context.machine, handler)
        if declaration is None or handler in unended:
            continue
        if not _may_cancel(context.machine, chart, state, handler, declaration):
            message = (
                "the goal is never ended as canceled after this request, so the client cannot know whether it was "
                f"canceled; end it with `<{_ANSWER}>`, or set a `cond` if this state rejects requests"
            )
            yield RULE.at(handler.element.name_span, message, *_fixes(context, chart, handler, declaration))


def _handlers(context: MachineContext) -> Iterator[tuple[Chart, State, Handler]]:
    for chart in context.machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                if handler.trigger is ProtocolPart.CANCEL and handler.effective:
                    yield chart, state, handler


def _unended(context: MachineContext) -> Iterator[Handler]:
    """The handlers after which the goal is never ended at all; unanswered-goal reports them."""
    for behavior in behaviors(context):
        for step in behavior.steps:
            if step.event is None or step.event.part is not ProtocolPart.CANCEL:
                continue
            if step.target in unfinished(behavior, Duty(DutyKind.RESULT, step.event.name)):
                yield step.handler


def _may_cancel(machine: Machine, chart: Chart, state: State, handler: Handler, declaration: Declaration) -> bool:
    """Whether the goal may be ended as canceled in the handler, or later, before a new goal arrives."""
    states = {state.id.value: state for state in chart.states if state.id}
    seen: set[str] = set()
    waiting: list[tuple[State, Handler]] = [(state, handler)]
    while waiting:
        left, taken = waiting.pop()
        bodies = [target.body for target in taken.targets]
        if _cancels(machine, (left.exit.statements if left.exit else (), *bodies), declaration):
            return True
        for target in taken.targets:
            entered = states.get(target.state.value) if target.state else None
            if entered is None:
                return True  # the state is unknown, so the goal may be ended there
            if _cancels(machine, (entered.entry.statements if entered.entry else (),), declaration):
                return True
            assert entered.id is not None
            if entered.id.value not in seen:
                seen.add(entered.id.value)
                waiting += [
                    (entered, later)
                    for later in entered.handlers
                    if later.effective
                    and not (later.trigger in _NEW_GOAL and find_handle(machine, later) is declaration)
                ]
    return False


def _cancels(machine: Machine, bodies: Iterable[tuple[Statement, ...]], declaration: Declaration) -> bool:
    return any(
        isinstance(statement, RosSend)
        and statement.element.name == _ANSWER
        and find_handle(machine, statement) is declaration
        for body in bodies
        for statement in statements(body)
    )


def _fixes(context: MachineContext, chart: Chart, handler: Handler, declaration: Declaration) -> Iterator[Fix]:
    """A fix that ends the goal as canceled: instead of otherwise, if the handler ends it. No fix is offered unless
    exactly one variable of the chart holds ids of goals of the action."""
    ids = {
        statement.goal_id.tree.name
        for statement in chart.statements
        if isinstance(statement, RosSend) and statement.goal_id and isinstance(statement.goal_id.tree, Name)
        if find_handle(context.machine, statement) is declaration
    }
    places = [target.element or handler.element for target in handler.targets]
    if len(ids) == 1 and handler.handle and all(place.complete for place in places):
        line = f'<{_ANSWER} name="{handler.handle.value}" goal_id="{ids.pop()}" />'
        ends = [end for target in handler.targets for end in _ends(context.machine, target.body, declaration)]
        if ends:
            edits: tuple[Edit, ...] = tuple(TextEdit(end.element.span, line) for end in ends)
        else:
            edits = tuple(last_in(context.document, place, line) for place in places)
        yield Fix(f"End the goal with `<{_ANSWER}>`", edits, preferred=False)


def _ends(machine: Machine, body: tuple[Statement, ...], declaration: Declaration) -> Iterator[RosSend]:
    """The statements that end a goal of the action."""
    sent = (statement for statement in statements(body) if isinstance(statement, RosSend))
    results = (statement for statement in sent if statement.part is ProtocolPart.RESULT)
    yield from (statement for statement in results if find_handle(machine, statement) is declaration)


RULE = Rule(
    "unanswered-cancel",
    Severity.WARNING,
    "A server handles cancel requests, but never ends a goal as canceled.",
    machine=check,
    whole=True,
)

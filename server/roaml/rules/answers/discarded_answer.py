# SPDX-License-Identifier: Apache-2.0
"""The rule `discarded-answer`, which discarded_answer.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import after
from roaml.language import HL_SCXML
from roaml.model.behavior.explore import Behavior, BehaviorStep
from roaml.model.behavior.phases import OWED, Phase, ProtocolEvent, Subject
from roaml.model.machine import Handler, RosSend, State
from roaml.model.value_types import GOAL_STATUSES, find_handle
from roaml.model.values.analyse import RESULT_CODE, DataChannel
from roaml.model.values.describe import described
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support import misspelled
from roaml.rules.support.answers import behaviors

_CANCELED = 5
_HANDLERS = {
    4: "ros_action_handle_success_result",
    _CANCELED: "ros_action_handle_canceled_result",
    6: "ros_action_handle_aborted_result",
}
"""The code of a result -> the element that handles it (docs/spec/ros.md#action-client)."""


def check(context: MachineContext) -> Iterator[Finding]:
    """Report states that handle some of the answers that can arrive in them, and discard others."""
    if context.system is None:
        return
    for behavior in behaviors(context):
        yield from _unhandled(context, behavior)
        yield from _exchanged(context, behavior)
        for state in behavior.chart.states:
            yield from _results(context, behavior, state)
            yield from _responses(context, behavior, state)


def _results(context: MachineContext, behavior: Behavior, state: State) -> Iterator[Finding]:
    for name, handlers in _by_handle(context, state, ProtocolPart.RESULT).items():
        sent = context.values.arriving.get(DataChannel(ProtocolPart.RESULT, name), {}).get(RESULT_CODE)
        handled = {handler.type.code for handler in handlers}
        if sent is None or sent.only is None or 0 in handled or not _is_awaited(behavior, state, name):
            continue
        if not any(_has_effect(state, handler) for handler in handlers):
            continue  # the state expects results of earlier goals, and discards them on purpose
        for code in sorted(code for code in sent.only if isinstance(code, int) and code not in handled):
            if (
                code in _HANDLERS
                and not _is_reported(context, name, code)
                and _may_arrive(context, behavior, state, name, code)
            ):
                message = (
                    f"a result with the code {code} ({GOAL_STATUSES[code]}), which the server sends, is discarded in "
                    f"this state, so the machine waits for ever; add a `<{_HANDLERS[code]}>`"
                )
                assert state.id is not None
                yield RULE.at(state.id.span, message, *_fixes(context, handlers, code))


def _may_arrive(context: MachineContext, behavior: Behavior, state: State, name: str, code: int) -> bool:
    """Whether a result with a code can arrive in a state. That of a canceled goal follows a request to cancel it."""
    if code != _CANCELED or any(
        isinstance(statement, RosSend)
        and statement.part is ProtocolPart.CANCEL
        and statement.handle is not None
        and statement.handle.value == name
        for chart in context.machine.charts
        for statement in (chart.executed if chart is not behavior.chart else ())
    ):
        return True
    return state.id is not None and state.id.value in _canceling(behavior, name)


def _canceling(behavior: Behavior, name: str) -> set[str]:
    """The names of the states in which a goal that the machine has asked to cancel may still be active."""

    def is_awaited(number: int) -> bool:
        subjects = (Subject.OUTCOME, Subject.DECISION)
        return any(behavior.configurations[number].phase(subject, name) is not None for subject in subjects)

    cancel, outgoing = ProtocolEvent(ProtocolPart.CANCEL, name), behavior.outgoing()
    reached: set[int] = set()
    new = [step.target for step in behavior.steps if cancel in step.sent]
    while new:
        number = new.pop()
        if number not in reached and is_awaited(number):
            reached.add(number)
            new += [step.target for step in outgoing[number]]
    return {behavior.configurations[number].state for number in reached}


def _unhandled(context: MachineContext, behavior: Behavior) -> Iterator[Finding]:
    """Report the goals whose results no state handles."""
    handled = {
        find_handle(context.machine, handler)
        for state in behavior.chart.states
        for handler in state.handlers
        if handler.trigger is ProtocolPart.RESULT
    }
    tags = tuple(_HANDLERS.values())
    if any(misspelled.among(context.machine.element.walk(), tag, HL_SCXML) for tag in tags):
        return
    for statement in behavior.chart.statements:
        if isinstance(statement, RosSend) and statement.part is ProtocolPart.GOAL:
            declaration = find_handle(context.machine, statement)
            if declaration is not None and declaration not in handled:
                handled.add(declaration)
                message = "no state handles the result of this goal, so the machine does not notice when the goal ends"
                yield RULE.at(statement.element.name_span, f"{message}; add a `<{tags[0]}>`")


def _exchanged(context: MachineContext, behavior: Behavior) -> Iterator[Finding]:
    """Report handlers of decisions on goals after which only a rejected goal's results are handled."""
    waiting = {
        state.id.value: _by_handle(context, state, ProtocolPart.RESULT).keys()
        for state in behavior.chart.states
        if state.id is not None
    }
    for handler in (handler for state in behavior.chart.states for handler in state.handlers):
        declaration = find_handle(context.machine, handler)
        if handler.trigger is not ProtocolPart.GOAL_RESPONSE or declaration is None or declaration.handle is None:
            continue
        names = [target.state.value if target.state else "" for target in handler.targets]
        handles = [declaration.handle.value in waiting.get(name, ()) for name in names]
        if handles == [False, True]:
            message = (
                f"an accepted goal leads to `{names[0]}`, where its result is discarded, and a rejected one, which has "
                f"no result, to `{names[1]}`, which waits for it; exchange `accept` and `reject`"
            )
            yield RULE.at(handler.element.name_span, message)


def _is_reported(context: MachineContext, name: str, code: int) -> bool:
    """Whether unhandled-canceled-result reports that no state handles a result; it concerns canceled goals only."""
    if code != _CANCELED:
        return False
    return not any(
        handler.trigger is ProtocolPart.RESULT and handler.type.code == code
        for chart in context.machine.charts
        for state in chart.states
        for handler in state.handlers
    )


def _responses(context: MachineContext, behavior: Behavior, state: State) -> Iterator[Finding]:
    values = context.values.charts.get(behavior.chart.scope)
    for handlers in _by_handle(context, state, ProtocolPart.RESPONSE).values():
        cond = handlers[-1].cond
        left = values.uncovered.get(cond.span) if values is not None and cond is not None else None
        if left is None or cond is None:
            continue
        ignored = [step for step in behavior.steps if step.ignored and step.handler is handlers[-1]]
        if ignored and (_may_leave(state, handlers) or any(_owes(behavior, step) for step in ignored)):
            continue  # a timer ends the wait, or unanswered-tick and unanswered-request report the lost answer
        known = {place: v for place, v in left.items() if place.startswith("_res.") and v.only}
        compared = [place for place in known if place in cond.text]
        if compared:
            place = compared[0]
            message = (
                f"a response whose `{place.removeprefix('_res.')}` is {described(known[place])} is discarded: no "
                f"condition in this state holds, so the machine waits for ever; handle it after this condition"
            )
            yield RULE.at(cond.span, message)


def _may_leave(state: State, handlers: Sequence[Handler]) -> bool:
    """Whether other handlers than `handlers` lead out of a state."""
    others = (handler for handler in state.handlers if handler.effective and handler not in handlers)
    own = state.id.value if state.id is not None else ""
    return any(target.state is None or target.state.value != own for h in others for target in h.targets)


def _owes(behavior: Behavior, step: BehaviorStep) -> bool:
    """Whether a tick, a halt, a request or a goal waits for an answer before a step."""
    before = behavior.configurations[step.source]
    return before.tree in (Phase.TICKED, Phase.HALTING) or any(
        subject in OWED.values() for (subject, _), _ in before.phases
    )


def _by_handle(context: MachineContext, state: State, part: ProtocolPart) -> dict[str, list[Handler]]:
    result: dict[str, list[Handler]] = {}
    for handler in state.handlers:
        if handler.effective and handler.trigger is part and state.id is not None:
            declaration = find_handle(context.machine, handler)
            if declaration is not None and declaration.handle is not None:
                result.setdefault(declaration.handle.value, []).append(handler)
    return result


def _is_awaited(behavior: Behavior, state: State, name: str) -> bool:
    return any(
        state.id is not None and c.state == state.id.value and c.phase(Subject.OUTCOME, name) is not None
        for c in behavior.configurations
    )


def _has_effect(state: State, handler: Handler) -> bool:
    return any(
        target.body or (target.state is not None and state.id is not None and target.state.value != state.id.value)
        for target in handler.targets
    )


def _fixes(context: MachineContext, handlers: list[Handler], code: int) -> Iterator[Fix]:
    """A fix that handles the result like the last one that the state handles, without its body."""
    last = handlers[-1]
    target = last.targets[0].state if last.targets else None
    if last.handle is not None and target is not None and last.element.complete:
        line = f'<{_HANDLERS[code]} name="{last.handle.value}" target="{target.value}" />'
        yield Fix(f"Add `<{_HANDLERS[code]}>`", (after(context.document, last.element, line),), preferred=False)


RULE = Rule(
    "discarded-answer",
    Severity.WARNING,
    "A state that waits for an answer discards some of the answers.",
    machine=check,
    whole=True,
)

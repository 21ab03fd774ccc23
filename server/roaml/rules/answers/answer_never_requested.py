# SPDX-License-Identifier: Apache-2.0
"""The rule `answer-never-requested`, which answer_never_requested.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.behavior.explore import Behavior, ChartConfiguration
from roaml.model.behavior.phases import AWAITED_ANSWER, Phase, Subject
from roaml.model.machine import Chart, Handler, If, ReturnStatus, RosSend, State, statements
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import behaviors
from roaml.rules.support.removed_events import uses_removed_events

_WAITING = (*AWAITED_ANSWER, ProtocolPart.FEEDBACK)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report transitions into states that wait only for answers, none of which the machine has requested."""
    if uses_removed_events(context.machine):
        return
    for behavior in behaviors(context):
        if not behavior.approximate:
            yield from _dead_waits(context, behavior)
    for chart in context.machine.charts:
        yield from _after_the_end(chart)


def _dead_waits(context: MachineContext, behavior: Behavior) -> Iterator[Finding]:
    waiting = {s.id.value: s for s in behavior.chart.states if s.id is not None and _waits_for_answers(context, s)}
    in_vain = [_waits_in_vain(context, waiting.get(c.state), c) for c in behavior.configurations]
    elsewhere = {c.state for c, is_vain in zip(behavior.configurations, in_vain, strict=True) if not is_vain}
    handlers = (h for state in behavior.chart.states for h in state.handlers if h.effective)
    is_server = any(h.trigger in (ProtocolPart.REQUEST, ProtocolPart.GOAL) for h in handlers)
    reported: set[Handler] = set()
    for step in behavior.steps:
        target = behavior.configurations[step.target]
        state = waiting.get(target.state)
        if state is None or state.id is None or step.handler in reported or not step.certain:
            continue
        if not in_vain[step.target] or _owes(target):
            continue  # another rule reports the answer that the machine owes
        is_inside = behavior.configurations[step.source].state == target.state
        if is_inside and (in_vain[step.source] or not (_serves(state) or is_server)):
            continue  # the step that leads to the state is reported; a client may have nothing more to do
        if _serves(state) and target.state not in elsewhere:
            continue  # a state that serves requests waits for an answer only if it is requested on another path
        reported.add(step.handler)
        message = (
            f"the machine waits for ever in the state `{target.state}`: on this path, it has not requested any of the "
            "answers that the state waits for"
        )
        what = "this state handles only answers, and requests" if _serves(state) else "this state handles only answers"
        related = [Related(state.id.span, what)]
        yield RULE.at(step.handler.element.name_span, message, related=related)


def _after_the_end(chart: Chart) -> Iterator[Finding]:
    """Report a tick that returns SUCCESS or FAILURE and enters a state in which a plugin waits for a message, if all
    other handlers that enter it send something first: nothing causes the message that the next tick waits for."""
    states = {state.id.value: state for state in chart.states if state.id is not None}
    entering: dict[str, list[tuple[Handler, bool]]] = {}
    for state in chart.states:
        for handler in state.handlers if state.id is not None else ():
            for target in handler.targets if handler.effective else ():
                if state.id is not None and target.state is not None and target.state.value != state.id.value:
                    sends = any(isinstance(s, RosSend) and s.part in _CAUSES for s in statements(target.body))
                    entering.setdefault(target.state.value, []).append((handler, sends))
    for name, handlers in entering.items():
        awaits = states.get(name)
        silent = [handler for handler, sends in handlers if not sends]
        if awaits is None or awaits.id is None or awaits.entry is not None or len(silent) != 1 or len(handlers) < 2:
            continue
        (handler,) = silent
        if _waits_for_message(awaits) and _ends(handler):
            message = (
                f"after this, the plugin waits in the state `{name}` for a message, and it has not sent what is sent "
                "on the other paths to this state"
            )
            yield RULE.at(handler.element.name_span, message, related=[Related(awaits.id.span, "the state")])


_CAUSES = (ProtocolPart.MESSAGE, ProtocolPart.REQUEST, ProtocolPart.GOAL)


def _waits_for_message(state: State) -> bool:
    """Whether a message ends a state, and ticks return only RUNNING and stay there."""
    ticks = [h for h in state.handlers if h.effective and h.trigger is ProtocolPart.BT_TICK]
    return (
        bool(ticks)
        and all(_keeps_running(state, handler) for handler in ticks)
        and any(h.effective and h.trigger is ProtocolPart.MESSAGE and not _stays(state, h) for h in state.handlers)
    )


def _ends(handler: Handler) -> bool:
    """Whether a handler of ticks returns SUCCESS or FAILURE on each path."""
    inside = [s for target in handler.targets for s in statements(target.body) if isinstance(s, ReturnStatus)]
    return (
        handler.trigger is ProtocolPart.BT_TICK
        and bool(inside)
        and all(s.status is not None and s.status.value in ("SUCCESS", "FAILURE") for s in inside)
    )


def _waits_in_vain(context: MachineContext, state: State | None, configuration: ChartConfiguration) -> bool:
    """Whether `state`, in which only answers end the waiting, is entered without a request for one of them."""
    return state is not None and not any(
        configuration.phase(AWAITED_ANSWER[part], name) is not None for part, name in _awaited(context, state)
    )


def _waits_for_answers(context: MachineContext, state: State) -> bool:
    """Whether only answers end a state, besides halts. A tick that returns RUNNING and stays there does not end it. In
    a state that answers requests meanwhile, requests do not end the waiting, but an answer must."""
    handlers = [h for h in state.handlers if h.effective and h.trigger is not ProtocolPart.BT_HALT]
    waiting = [h for h in handlers if not _keeps_running(state, h)]
    if _serves(state):
        waiting = [h for h in waiting if h.trigger is not ProtocolPart.REQUEST]
        if all(_stays(state, h) for h in waiting if h.trigger in AWAITED_ANSWER):
            return False
    return any(h.trigger in AWAITED_ANSWER for h in waiting) and all(
        handler.trigger in _WAITING and find_handle(context.machine, handler) is not None for handler in waiting
    )


def _keeps_running(state: State, handler: Handler) -> bool:
    """Whether a handler of ticks stays in its state and returns only RUNNING."""
    if handler.trigger is not ProtocolPart.BT_TICK:
        return False
    inside = [s for target in handler.targets for s in statements(target.body) if isinstance(s, ReturnStatus)]
    return (
        _stays(state, handler)
        and bool(inside)
        and all(s.status is not None and s.status.value == "RUNNING" for s in inside)
    )


def _serves(state: State) -> bool:
    """Whether a state only answers some request and stays, as a skill that returns RUNNING while it waits."""
    return any(
        handler.effective
        and handler.trigger is ProtocolPart.REQUEST
        and _stays(state, handler)
        and all(
            isinstance(statement, If) or (isinstance(statement, RosSend) and statement.part is ProtocolPart.RESPONSE)
            for target in handler.targets
            for statement in statements(target.body)
        )
        for handler in state.handlers
    )


def _stays(state: State, handler: Handler) -> bool:
    """Whether a handler leads only to its own state."""
    return all(
        t.state is not None and state.id is not None and t.state.value == state.id.value for t in handler.targets
    )


def _awaited(context: MachineContext, state: State) -> Iterator[tuple[ProtocolPart, str]]:
    """The answers that a state waits for. A result may arrive while the decision on the goal is awaited."""
    for handler in state.handlers:
        declaration = find_handle(context.machine, handler)
        if handler.trigger in AWAITED_ANSWER and declaration is not None and declaration.handle is not None:
            assert handler.trigger is not None
            yield handler.trigger, declaration.handle.value


def _owes(configuration: ChartConfiguration) -> bool:
    owed = (Subject.REQUEST, Subject.GOAL, Subject.RESULT)
    is_due = any(subject in owed for (subject, _), _ in configuration.phases)
    return is_due or configuration.tree in (Phase.TICKED, Phase.HALTING)


RULE = Rule(
    "answer-never-requested",
    Severity.WARNING,
    "A machine waits for an answer that it has not requested.",
    machine=check,
    whole=True,
)

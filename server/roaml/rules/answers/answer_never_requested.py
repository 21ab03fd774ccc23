# SPDX-License-Identifier: Apache-2.0
"""The rule `answer-never-requested`, which answer_never_requested.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.behavior.explore import Behavior, ChartConfiguration
from roaml.model.behavior.phases import AWAITED_ANSWER, Phase, Subject
from roaml.model.machine import Handler, ReturnStatus, State, statements
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


def _dead_waits(context: MachineContext, behavior: Behavior) -> Iterator[Finding]:
    waiting = {s.id.value: s for s in behavior.chart.states if s.id is not None and _waits_for_answers(context, s)}
    reported: set[Handler] = set()
    for step in behavior.steps:
        target = behavior.configurations[step.target]
        state = waiting.get(target.state)
        if state is None or state.id is None or step.handler in reported or not step.certain:
            continue
        if behavior.configurations[step.source].state == target.state or _owes(target):
            continue  # another rule reports the answer that the machine owes
        if any(target.phase(AWAITED_ANSWER[part], name) is not None for part, name in _awaited(context, state)):
            continue
        reported.add(step.handler)
        message = (
            f"the machine waits for ever in the state `{target.state}`: on this path, it has not requested any of the "
            "answers that the state waits for"
        )
        related = [Related(state.id.span, "this state handles only answers")]
        yield RULE.at(step.handler.element.name_span, message, related=related)


def _waits_for_answers(context: MachineContext, state: State) -> bool:
    """Whether only answers end a state, besides halts. A tick that returns RUNNING and stays there does not end it."""
    handlers = [h for h in state.handlers if h.effective and h.trigger is not ProtocolPart.BT_HALT]
    waiting = [h for h in handlers if not _keeps_running(state, h)]
    return any(h.trigger in AWAITED_ANSWER for h in waiting) and all(
        handler.trigger in _WAITING and find_handle(context.machine, handler) is not None for handler in waiting
    )


def _keeps_running(state: State, handler: Handler) -> bool:
    """Whether a handler of ticks stays in its state and returns only RUNNING."""
    if handler.trigger is not ProtocolPart.BT_TICK:
        return False
    stays = all(
        t.state is not None and state.id is not None and t.state.value == state.id.value for t in handler.targets
    )
    inside = [s for target in handler.targets for s in statements(target.body) if isinstance(s, ReturnStatus)]
    return stays and bool(inside) and all(s.status is not None and s.status.value == "RUNNING" for s in inside)


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

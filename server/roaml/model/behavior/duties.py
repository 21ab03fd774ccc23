# SPDX-License-Identifier: Apache-2.0
"""Finds the paths on which a machine never sends a required answer, or sends it only after an event that cannot occur.

All functions are pure functions of a graph (`Behavior`). The parameter `possible` of some of them is a function that
returns whether a step can be taken; by default, every step can be taken.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeAlias

from roaml.expr.tree import Name
from roaml.model.behavior.explore import UNKNOWN_STATE, Behavior, BehaviorStep, ChartConfiguration
from roaml.model.behavior.phases import Duty, DutyKind, GoalStatus, Phase, ProtocolEvent
from roaml.model.machine import RosSend, State
from roaml.roles import ProtocolPart

Possible: TypeAlias = Callable[[BehaviorStep], bool]

TAKING = {
    DutyKind.TICK: ProtocolPart.BT_TICK,
    DutyKind.HALT: ProtocolPart.BT_HALT,
    DutyKind.REQUEST: ProtocolPart.REQUEST,
    DutyKind.GOAL: ProtocolPart.GOAL,
    DutyKind.RESULT: ProtocolPart.THREAD_START,
}
"""The kind of a duty -> the event that creates it; a goal creates the duty to send a result when it is accepted."""


_FOLLOWING = (
    ProtocolPart.RESPONSE,
    ProtocolPart.RESULT,
    ProtocolPart.GOAL_RESPONSE,
    ProtocolPart.CHILD_STATUS,
    ProtocolPart.CHILD_HALTED,
)
"""Events that are answers to an event that the machine has sent. Other events arrive without a cause in the machine."""


def always(_: BehaviorStep) -> bool:
    return True


def unfinished(behavior: Behavior, duty: Duty, possible: Possible = always) -> frozenset[int]:
    """The configurations that owe the answer to `duty` and from which no sequence of possible steps leads to this
    answer."""
    owing = frozenset(n for n, c in enumerate(behavior.configurations) if _is_due(c, duty))
    steps = [step for step in behavior.steps if step.source in owing and possible(step)]
    answered = backward({step.source for step in steps if _is_answered(behavior, step, duty, owing)}, steps)
    return owing - answered


def _is_answered(behavior: Behavior, step: BehaviorStep, duty: Duty, owing: frozenset[int]) -> bool:
    """Whether the answer to `duty` that the source of a step owes is sent in the step, or can still be sent after it
    although the machine owes several answers then."""
    target = behavior.configurations[step.target]
    if target.answering(duty) is Phase.SEVERAL:
        return keeps_goals(behavior, target, duty.handle)
    if duty.kind is DutyKind.RESULT and ProtocolEvent(ProtocolPart.RESULT, duty.handle) in step.sent:
        return True  # the goal is ended, and possibly the next one accepted
    return step.target not in owing


def keeps_goals(behavior: Behavior, configuration: ChartConfiguration, handle: str) -> bool:
    """Whether a server that executes several goals may hold the ids of all of them: in two variables, or where the
    graph does not follow them, such as in an array."""
    ended_by = [
        statement.goal_id.tree
        for statement in behavior.chart.statements
        if isinstance(statement, RosSend) and statement.goal_id is not None and statement.part is ProtocolPart.RESULT
    ]
    if not all(isinstance(tree, Name) for tree in ended_by):
        return True
    held = [held for _, held in configuration.ids]
    running = sum(id_.status is GoalStatus.ACCEPTED and id_.of == handle for id_ in held)
    return running > 1 or any(id_.status is GoalStatus.ANY for id_ in held)


def _is_due(configuration: ChartConfiguration, duty: Duty) -> bool:
    """Whether a configuration owes the answer to `duty`. The result is false if there are several goals at once,
    because it is unknown to which of them an answer belongs."""
    if configuration.state == UNKNOWN_STATE or configuration.answering(duty) is Phase.SEVERAL:
        return False
    return configuration.owes(duty)


def untaken(behavior: Behavior, duty: Duty, possible: Possible = always) -> frozenset[int]:
    """The configurations in which the machine never handles the event of `duty`: a tick, halt, request or goal.

    The event may arrive in each of these configurations, but no sequence of possible steps leads from there to a
    handler for the event. Steps that handle a tick or halt are left out of the sequences, because the tree sends
    neither until it has received the answer to the previous one.
    """
    waiting = frozenset(
        n
        for n, c in enumerate(behavior.configurations)
        if c.state != UNKNOWN_STATE and not c.owes(duty) and c.tree not in (Phase.TICKED, Phase.HALTING)
    )
    taking = {step.source for step in behavior.steps if step.event and step.event.part is TAKING[duty.kind]}
    known = {n for n, c in enumerate(behavior.configurations) if c.state == UNKNOWN_STATE}
    between = [
        step
        for step in behavior.steps
        if possible(step) and not (step.event and step.event.part in (ProtocolPart.BT_TICK, ProtocolPart.BT_HALT))
    ]
    lost = waiting - backward((taking & waiting) | known, between)
    # Leave out configurations that the machine leaves on an event that follows without a further tick or request.
    left = {
        step.source
        for step in between
        if step.source in lost and step.target in lost and follows(step) and moves(behavior, step)
    }
    return (lost - left) or lost


def follows(step: BehaviorStep) -> bool:
    """Whether a step is eventless or receives an answer that the machine waits for."""
    return step.event is None or step.event.part in _FOLLOWING


def moves(behavior: Behavior, step: BehaviorStep) -> bool:
    """Whether a step leads to another state."""
    return behavior.configurations[step.source].state != behavior.configurations[step.target].state


def is_suspicious(behavior: Behavior) -> bool:
    """Whether the chart may contain an error: its graph has a fault, an answer that may never be sent, or a tick or
    halt that may never be handled. The result is also true if the chart starts threads, because their numbers may be
    wrong, and if it may stay in a state while it owes an answer, because no condition holds."""
    known = behavior.chart.__dict__.setdefault("suspicion", {})
    if behavior not in known:
        events = {step.event for step in behavior.steps if step.event is not None}
        duties = {
            Duty(kind, e.name) for e in events for kind, part in TAKING.items() if e.part in (part, ProtocolPart.GOAL)
        }
        tree_duties = [duty for duty in duties if duty.kind.is_of_tree]
        known[behavior] = (
            any(step.faults for step in behavior.steps)
            or any(unfinished(behavior, duty) for duty in duties)
            or any(untaken(behavior, duty) for duty in tree_duties)
            or any(event.part is ProtocolPart.THREAD_START for step in behavior.steps for event in step.sent)
            or (bool(duties) and any(map(_may_stay, behavior.chart.states)))
        )
    return bool(known[behavior])


def _may_stay(state: State) -> bool:
    """Whether a state has eventless handlers, all of them with conditions, so that a machine may stay in it."""
    eventless = [handler for handler in state.handlers if handler.effective and handler.trigger is None]
    return bool(eventless) and all(handler.cond is not None for handler in eventless)


def entering(behavior: Behavior, configurations: frozenset[int]) -> Iterator[BehaviorStep]:
    """The steps that lead into a set of configurations from outside."""
    return (step for step in behavior.steps if step.target in configurations and step.source not in configurations)


def distances(behavior: Behavior, configurations: frozenset[int]) -> dict[int, int]:
    """Configuration -> the least number of steps that lead from it out of the set `configurations`; only for
    configurations from which a path leads out. The first configurations outside the set have the number 0."""
    incoming: dict[int, list[int]] = {}
    for step in behavior.steps:
        if step.source in configurations:
            incoming.setdefault(step.target, []).append(step.source)
    distance = {number: 0 for number in incoming if number not in configurations}
    waiting = list(distance)
    for here in waiting:
        for source in incoming.get(here, ()):
            if source not in distance:
                distance[source] = distance[here] + 1
                waiting.append(source)
    return distance


def backward(goals: set[int], steps: Iterable[BehaviorStep]) -> set[int]:
    """`goals`, and the configurations from which a path of `steps` leads to one of them."""
    return _reached(goals, ((step.target, step.source) for step in steps))


def forward(first: set[int], steps: Iterable[BehaviorStep]) -> set[int]:
    """`first`, and the configurations to which a path of `steps` leads from one of them."""
    return _reached(first, ((step.source, step.target) for step in steps))


def _reached(first: set[int], pairs: Iterable[tuple[int, int]]) -> set[int]:
    following: dict[int, list[int]] = {}
    for here, there in pairs:
        following.setdefault(here, []).append(there)
    reached, waiting = set(first), list(first)
    while waiting:
        for there in following.get(waiting.pop(), ()):
            if there not in reached:
                reached.add(there)
                waiting.append(there)
    return reached

# SPDX-License-Identifier: Apache-2.0
"""Finds the paths on which a machine never sends a required answer, or sends it only after an event that cannot occur.

All functions are pure functions of a graph (`Behavior`). The parameter `possible` of some of them is a function that
returns whether a step can be taken; by default, every step can be taken.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeAlias

from roaml.model.behavior.explore import UNKNOWN_STATE, Behavior, BehaviorStep, ChartConfiguration
from roaml.model.behavior.phases import Duty, DutyKind, Phase
from roaml.roles import ProtocolPart

Possible: TypeAlias = Callable[[BehaviorStep], bool]

_TAKING = {
    DutyKind.TICK: ProtocolPart.BT_TICK,
    DutyKind.HALT: ProtocolPart.BT_HALT,
    DutyKind.REQUEST: ProtocolPart.REQUEST,
    DutyKind.GOAL: ProtocolPart.GOAL,
    DutyKind.RESULT: ProtocolPart.THREAD_START,
}


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
    answered = _back({step.source for step in steps if step.target not in owing}, steps)
    return owing - answered


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
    taking = {step.source for step in behavior.steps if step.event and step.event.part is _TAKING[duty.kind]}
    known = {n for n, c in enumerate(behavior.configurations) if c.state == UNKNOWN_STATE}
    between = [
        step
        for step in behavior.steps
        if possible(step) and not (step.event and step.event.part in (ProtocolPart.BT_TICK, ProtocolPart.BT_HALT))
    ]
    lost = waiting - _back((taking & waiting) | known, between)
    # Leave out configurations that the machine leaves on an event that follows without a further tick or request.
    left = {
        step.source
        for step in between
        if step.source in lost and step.target in lost and _follows(step) and _moves(behavior, step)
    }
    return (lost - left) or lost


def _follows(step: BehaviorStep) -> bool:
    return step.event is None or step.event.part in _FOLLOWING


def _moves(behavior: Behavior, step: BehaviorStep) -> bool:
    """Whether a step leads to another state."""
    return behavior.configurations[step.source].state != behavior.configurations[step.target].state


def dead_ends(behavior: Behavior, duty: Duty) -> Iterator[BehaviorStep]:
    """The steps to report because the answer to `duty` is not sent after them.

    After the step that makes the answer impossible, the machine may still wait for events that it has caused, such as
    the response to a request. Then the step that handles the last of these events is returned, because the answer is
    missing there. But if the machine waits in a state that handles the next event of `duty`, such as the next tick, the
    step that leads into this state is returned.
    """
    lost = unfinished(behavior, duty)
    inside = [step for step in behavior.steps if step.source in lost and step.target in lost]
    following = [step for step in inside if _follows(step)]
    going_on = _back({step.source for step in following if step.source != step.target}, inside)
    if going_on >= lost:
        going_on, following = set(), []  # the steps form endless cycles: report the steps that lead into them
    takers = (s for s in behavior.chart.states if any(h.trigger is _TAKING[duty.kind] for h in s.handlers))
    ready = {state.id.value for state in takers if state.id}
    early: set[int] = set()
    for step in entering(behavior, lost):
        if step.target not in going_on:
            yield step
        elif behavior.configurations[step.target].state in ready and _moves(behavior, step):
            early.add(step.target)
            yield step
    reported = _forward(early, inside)
    for step in following:
        if step.target not in going_on and step.source not in reported and (step.source in going_on or step.ignored):
            yield step


def waiting_behind(behavior: Behavior, duty: Duty, step: BehaviorStep) -> set[int]:
    """The configurations that owe an answer to `duty` that is never sent, and that are the target of `step` or can be
    reached from it."""
    lost = unfinished(behavior, duty)
    return _forward({step.target} & lost, (s for s in behavior.steps if s.source in lost and s.target in lost))


def is_suspicious(behavior: Behavior) -> bool:
    """Whether the chart may contain an error: its graph has a fault, an answer that may never be sent, or a tick or
    halt that may never be handled. The result is also true if the chart starts threads, because their numbers may be
    wrong."""
    known = behavior.chart.__dict__.setdefault("suspicion", {})
    if behavior not in known:
        events = {step.event for step in behavior.steps if step.event is not None}
        duties = {
            Duty(kind, e.name) for e in events for kind, part in _TAKING.items() if e.part in (part, ProtocolPart.GOAL)
        }
        tree_duties = [duty for duty in duties if duty.kind.is_of_tree]
        known[behavior] = (
            any(step.faults for step in behavior.steps)
            or any(unfinished(behavior, duty) for duty in duties)
            or any(untaken(behavior, duty) for duty in tree_duties)
            or any(event.part is ProtocolPart.THREAD_START for step in behavior.steps for event in step.sent)
        )
    return bool(known[behavior])


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


def _back(goals: set[int], steps: Iterable[BehaviorStep]) -> set[int]:
    """`goals`, and the configurations from which a path of `steps` leads to one of them."""
    return _reached(goals, ((step.target, step.source) for step in steps))


def _forward(first: set[int], steps: Iterable[BehaviorStep]) -> set[int]:
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

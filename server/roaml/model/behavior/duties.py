# SPDX-License-Identifier: Apache-2.0
"""Exactly once on every path: where an answer never comes, or comes only if something happens that cannot.

All functions are pure functions of a graph (`Behavior`). `possible` tells which steps may be taken; it is left out
where all may.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeAlias

from roaml.model.behavior.explore import NOWHERE, Behavior, BehaviorStep, ChartConfiguration, Duty
from roaml.roles import ProtocolPart

Possible: TypeAlias = Callable[[BehaviorStep], bool]

TICK, HALT = Duty("tick", ""), Duty("halt", "")
_TAKING = {
    "tick": ProtocolPart.BT_TICK,
    "halt": ProtocolPart.BT_HALT,
    "request": ProtocolPart.REQUEST,
    "goal": ProtocolPart.GOAL,
    "result": ProtocolPart.THREAD_START,
}


_FOLLOWING = (
    ProtocolPart.RESPONSE,
    ProtocolPart.RESULT,
    ProtocolPart.GOAL_RESPONSE,
    ProtocolPart.CHILD_STATUS,
    ProtocolPart.CHILD_HALTED,
)
"""What comes because of something that was sent; other events come of their own accord."""


def always(_: BehaviorStep) -> bool:
    return True


def unfinished(behavior: Behavior, duty: Duty, possible: Possible = always) -> frozenset[int]:
    """The configurations that owe an answer and from which no sequence of possible steps leads to it."""
    owing = frozenset(n for n, c in enumerate(behavior.configurations) if _is_due(c, duty))
    steps = [step for step in behavior.steps if step.source in owing and possible(step)]
    answered = _back({step.source for step in steps if step.target not in owing}, steps)
    return owing - answered


def _is_due(configuration: ChartConfiguration, duty: Duty) -> bool:
    """Of several goals at once it is not known which one an answer is for."""
    if configuration.state == NOWHERE or configuration.phase(duty.kind, duty.handle) == "several":
        return False
    return configuration.owes(duty)


def untaken(behavior: Behavior, duty: Duty, possible: Possible = always) -> frozenset[int]:
    """The configurations to which a tick or halt (a request, a goal) may come, and from which no sequence of possible
    steps leads to a handler for it. Meanwhile nothing else is asked by the tree."""
    waiting = frozenset(
        n
        for n, c in enumerate(behavior.configurations)
        if c.state != NOWHERE and not c.owes(duty) and c.tree not in ("ticked", "halting")
    )
    taking = {step.source for step in behavior.steps if step.event and step.event.part == _TAKING[duty.kind]}
    known = {n for n, c in enumerate(behavior.configurations) if c.state == NOWHERE}
    between = [
        step
        for step in behavior.steps
        if possible(step) and not (step.event and step.event.part in (ProtocolPart.BT_TICK, ProtocolPart.BT_HALT))
    ]
    lost = waiting - _back((taking & waiting) | known, between)
    # Where something still follows without being asked for, the machine does not stay.
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
    """The steps behind which the answer never comes.

    Where the answer was missed early, but more was still to follow from it (the response to a request that was sent),
    the last step counts: that is where the answer is missing. But if the machine waits for it in a state that takes the
    next tick, the answer is missing in the first step.
    """
    lost = unfinished(behavior, duty)
    inside = [step for step in behavior.steps if step.source in lost and step.target in lost]
    following = [step for step in inside if _follows(step)]
    going_on = _back({step.source for step in following if step.source != step.target}, inside)
    if going_on >= lost:
        going_on, following = set(), []  # it never ends: what leads there counts
    takers = (s for s in behavior.chart.states if any(h.trigger == _TAKING[duty.kind] for h in s.handlers))
    ready = {state.id.value for state in takers if state.id}
    early: set[int] = set()
    for step in entering(behavior, lost):
        if step.target not in going_on:
            yield step
        elif behavior.configurations[step.target].state in ready and _moves(behavior, step):
            early.add(step.target)
            yield step
    told = _forward(early, inside)
    for step in following:
        if step.target not in going_on and step.source not in told and (step.source in going_on or step.ignored):
            yield step


def waiting_behind(behavior: Behavior, duty: Duty, step: BehaviorStep) -> set[int]:
    """The configurations to which a step leads, itself or by further ones, and which owe an answer that never comes."""
    lost = unfinished(behavior, duty)
    return _forward({step.target} & lost, (s for s in behavior.steps if s.source in lost and s.target in lost))


def is_suspicious(behavior: Behavior) -> bool:
    """Whether there may be a mistake in what the chart answers, or in which thread it starts."""
    known = behavior.chart.__dict__.setdefault("suspicion", {})
    if behavior not in known:
        events = {step.event for step in behavior.steps if step.event is not None}
        duties = {
            Duty(kind, e.name) for e in events for kind, part in _TAKING.items() if e.part in (part, ProtocolPart.GOAL)
        }
        asked = [duty for duty in duties if duty.kind in ("tick", "halt")]
        known[behavior] = (
            any(step.faults for step in behavior.steps)
            or any(unfinished(behavior, duty) for duty in duties)
            or any(untaken(behavior, duty) for duty in asked)
            or any(event.part is ProtocolPart.THREAD_START for step in behavior.steps for event in step.sent)
        )
    return bool(known[behavior])


def entering(behavior: Behavior, configurations: frozenset[int]) -> Iterator[BehaviorStep]:
    """The steps that lead into a set of configurations from outside."""
    return (step for step in behavior.steps if step.target in configurations and step.source not in configurations)


def distances(behavior: Behavior, configurations: frozenset[int]) -> dict[int, int]:
    """How many steps lead out of a set of configurations from each of them, and from what lies outside: 0."""
    incoming: dict[int, list[int]] = {}
    for step in behavior.steps:
        if step.source in configurations:
            incoming.setdefault(step.target, []).append(step.source)
    found = {number: 0 for number in incoming if number not in configurations}
    waiting = list(found)
    for here in waiting:
        for source in incoming.get(here, ()):
            if source not in found:
                found[source] = found[here] + 1
                waiting.append(source)
    return found


def _back(goals: set[int], steps: Iterable[BehaviorStep]) -> set[int]:
    """The configurations from which some of `steps` lead to `goals`, these included."""
    return _reached(goals, ((step.target, step.source) for step in steps))


def _forward(first: set[int], steps: Iterable[BehaviorStep]) -> set[int]:
    """The configurations to which some of `steps` lead from `first`, these included."""
    return _reached(first, ((step.source, step.target) for step in steps))


def _reached(first: set[int], pairs: Iterable[tuple[int, int]]) -> set[int]:
    following: dict[int, list[int]] = {}
    for here, there in pairs:
        following.setdefault(here, []).append(there)
    found, waiting = set(first), list(first)
    while waiting:
        for there in following.get(waiting.pop(), ()):
            if there not in found:
                found.add(there)
                waiting.append(there)
    return found

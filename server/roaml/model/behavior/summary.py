# SPDX-License-Identifier: Apache-2.0
"""What other machines see of a graph: what each answer waits for, and what makes a machine send something.

It holds names of states and handles, but no places, so that most changes of a file leave it as it was.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeAlias

from roaml.model.behavior.explore import NOWHERE, Behavior, Duty, Event, Step, explore
from roaml.model.machine import Chart, Machine

Needs: TypeAlias = frozenset[frozenset[Event]]
"""Alternatives: each is a set of events that suffice together. No alternative: it never comes."""

AT_ONCE: frozenset[Event] = frozenset()
START = Event("start", "")
"""What comes before the first event of a machine."""

MOST_ALTERNATIVES = 6
MOST_EVENTS = 4
REPEATED = ("message", "event", "feedback", "thread-start", "thread-free")


@dataclass(frozen=True, slots=True)
class Promise:
    """An answer of a server that does not come at once.

    Attributes:
        duty: "request", "goal" or "result".
        state: where the machine waits; `scope` tells the threads of a file apart.
        taken: the request has been taken; else the machine does not even take it there.
        busy: the result of an earlier goal is still owed there.
        needs: what has to happen before the answer is sent, or before the request is taken.
    """

    duty: Duty
    state: str
    scope: str
    taken: bool
    busy: bool
    needs: Needs


@dataclass(frozen=True, slots=True)
class ChartOutline:
    """
    Attributes:
        promises: the answers that do not come at once, for each configuration in which they are awaited.
        reactions: pairs: on the first event, in some state, the second one is sent.
        repeats: for each event that is sent, what has to happen before it is sent again.
    """

    promises: tuple[Promise, ...]
    reactions: frozenset[tuple[Event, Event]]
    repeats: tuple[tuple[Event, Needs], ...]


UNKNOWN = ChartOutline((), frozenset(), ())


def summarised(machine: Machine, chart: Chart) -> ChartOutline:
    """The outline of a chart, kept with it; it says nothing where there is no graph."""
    known: dict[str, ChartOutline] = chart.__dict__.setdefault("summary", {})
    if "outline" not in known:
        behavior = explore(machine, chart)
        known["outline"] = UNKNOWN if behavior is None else summarise(behavior)
    return known["outline"]


def summarise(behavior: Behavior) -> ChartOutline:
    promises = dict.fromkeys(
        promise for duty in _duties(behavior) for promise in _promises(behavior, duty) if AT_ONCE not in promise.needs
    )
    return ChartOutline(tuple(promises), _reactions(behavior), tuple(_repeats(behavior)))


def _duties(behavior: Behavior) -> list[Duty]:
    """What the machine answers as a server."""
    found: dict[Duty, None] = {}
    for step in behavior.steps:
        if step.event is not None and step.event.part in ("request", "goal"):
            found[Duty(step.event.part, step.event.name)] = None
            if step.event.part == "goal":
                found[Duty("result", step.event.name)] = None
        elif step.event is not None and step.event.part == "thread-start":
            found[Duty("result", step.event.name)] = None
    return list(found)


def _promises(behavior: Behavior, duty: Duty) -> Iterable[Promise]:
    """Where an answer is owed, and where a request is not even taken."""
    taking, scope = Event(duty.kind, duty.handle), behavior.chart.scope
    owing = [c.owes(duty) for c in behavior.configurations]

    def answers(step: Step) -> bool:
        unknown = behavior.configurations[step.target].state == NOWHERE
        return owing[step.source] and (unknown or not owing[step.target])

    needs = _needs(behavior, answers, lambda step: _one(step.event) if owing[step.source] else None)
    for number, configuration in enumerate(behavior.configurations):
        if needs[number] and configuration.phase(duty.kind, duty.handle) != "several":
            yield Promise(duty, configuration.state, scope, True, False, needs[number])
    if duty.kind == "result":
        return

    def idle(step: Step) -> Needs | None:
        if step.event == taking:
            return frozenset((AT_ONCE,))
        return None if owing[step.source] or owing[step.target] else _one(step.event)

    needs = _needs(behavior, lambda step: step.event == taking, idle)
    for number, configuration in enumerate(behavior.configurations):
        if needs[number] and not owing[number]:
            busy = bool(configuration.phase("result", duty.handle))
            yield Promise(duty, configuration.state, scope, False, busy, needs[number])


def _repeats(behavior: Behavior) -> Iterable[tuple[Event, Needs]]:
    sent = dict.fromkeys(e for step in behavior.steps for e in step.sent if e.part in REPEATED)
    for event in (*sent, *(e for e in behavior.at_start if e.part in REPEATED and e not in sent)):
        needs = _needs(behavior, lambda step, event=event: event in step.sent, lambda step: _one(step.event))  # type: ignore[misc]
        found: Needs = frozenset()
        for step in behavior.steps:
            if event in step.sent:
                twice = step.sent.count(event) > 1
                found = _least((*found, *needs[step.target], *((AT_ONCE,) if twice else ())))
        if event in behavior.at_start:
            again = (needs[start] for start in range(behavior.starts))
            found = _least((*found, *(each for alternatives in again for each in alternatives)))
        yield event, found


def _reactions(behavior: Behavior) -> frozenset[tuple[Event, Event]]:
    before: list[set[Event]] = [set() for _ in behavior.configurations]
    for start in range(behavior.starts):
        before[start].add(START)
    changed = True
    while changed:
        changed = False
        for step in behavior.steps:
            causes = {step.event} if step.event is not None else before[step.source]
            if not causes <= before[step.target]:
                before[step.target] |= causes
                changed = True
    found = {(START, event) for event in behavior.at_start}
    for step in behavior.steps:
        causes = {step.event} if step.event is not None else before[step.source]
        found |= {(cause, event) for cause in causes for event in step.sent}
    return frozenset(found)


def _needs(behavior: Behavior, reaches: Callable[[Step], bool], cost: Callable[[Step], Needs | None]) -> list[Needs]:
    """For each configuration the least sets of events by which a step that `reaches` the goal is taken."""
    incoming: list[list[tuple[Step, Needs]]] = [[] for _ in behavior.configurations]
    found: list[Needs] = [frozenset() for _ in behavior.configurations]
    waiting: dict[int, None] = {}
    for step in behavior.steps:
        price = cost(step)
        if price is None:
            continue
        if reaches(step):
            found[step.source] = _least((*found[step.source], *price))
            waiting[step.source] = None
        else:
            incoming[step.target].append((step, price))
    while waiting:
        target = next(iter(waiting))
        del waiting[target]
        for step, price in incoming[target]:
            through = (one | other for one in price for other in found[target])
            least = _least((*found[step.source], *through))
            if least != found[step.source]:
                found[step.source] = least
                waiting[step.source] = None
    return found


def _one(event: Event | None) -> Needs:
    return frozenset((AT_ONCE if event is None else frozenset((event,)),))


def _least(alternatives: Iterable[frozenset[Event]]) -> Needs:
    """Without those that contain another one; of many, the smallest."""
    found: list[frozenset[Event]] = []
    for each in sorted(set(alternatives), key=lambda each: (len(each), sorted(each))):
        if len(each) <= MOST_EVENTS and not any(known <= each for known in found):
            found.append(each)
    return frozenset(found[:MOST_ALTERNATIVES])

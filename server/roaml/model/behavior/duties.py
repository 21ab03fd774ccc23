# SPDX-License-Identifier: Apache-2.0
"""Exactly once on every path: where an answer never comes, or comes only if something happens that cannot.

All functions are pure functions of a graph (`Behavior`). `possible` tells which steps may be taken; it is left out
where all may.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeAlias

from roaml.model.behavior.explore import NOWHERE, Behavior, Configuration, Duty, Step

Possible: TypeAlias = Callable[[Step], bool]

TICK, HALT = Duty("tick", ""), Duty("halt", "")
_TAKING = {"tick": "bt-tick", "halt": "bt-halt", "request": "request", "goal": "goal", "result": "thread-start"}


def always(_: Step) -> bool:
    return True


def unfinished(behavior: Behavior, duty: Duty, possible: Possible = always) -> frozenset[int]:
    """The configurations that owe an answer and from which no sequence of possible steps leads to it."""
    owing = frozenset(n for n, c in enumerate(behavior.configurations) if _is_due(c, duty))
    steps = [step for step in behavior.steps if step.source in owing and possible(step)]
    answered = _back({step.source for step in steps if step.target not in owing}, steps)
    return owing - answered


def _is_due(configuration: Configuration, duty: Duty) -> bool:
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
        if possible(step) and not (step.event and step.event.part in ("bt-tick", "bt-halt"))
    ]
    return waiting - _back((taking & waiting) | known, between)


def dead_ends(behavior: Behavior, duty: Duty) -> Iterator[Step]:
    """The steps behind which the answer never comes and nothing else is left to happen on the way to it.

    Where the answer was missed earlier, but more is handled before the path ends, the last step counts: that is where
    the answer is missing.
    """
    lost = unfinished(behavior, duty)
    if not lost:
        return
    component = _components(lost, behavior.steps)
    final = set(component.values()) - {
        component[step.source]
        for step in behavior.steps
        if step.source in lost and step.target in lost and component[step.source] != component[step.target]
    }
    for step in behavior.steps:
        inside = step.source in lost and step.target in lost and component[step.source] == component[step.target]
        if step.target in lost and component[step.target] in final and not inside:
            yield step


def entering(behavior: Behavior, configurations: frozenset[int]) -> Iterator[Step]:
    """The steps that lead into a set of configurations from outside."""
    return (step for step in behavior.steps if step.target in configurations and step.source not in configurations)


def _back(goals: set[int], steps: Iterable[Step]) -> set[int]:
    """The configurations from which some of `steps` lead to `goals`, these included."""
    sources: dict[int, list[int]] = {}
    for step in steps:
        sources.setdefault(step.target, []).append(step.source)
    found, waiting = set(goals), list(goals)
    while waiting:
        for source in sources.get(waiting.pop(), ()):
            if source not in found:
                found.add(source)
                waiting.append(source)
    return found


def _components(nodes: frozenset[int], steps: Iterable[Step]) -> dict[int, int]:
    """The strongly connected component of each node, as a number (Kosaraju's algorithm)."""
    forward: dict[int, list[int]] = {node: [] for node in nodes}
    backward: dict[int, list[int]] = {node: [] for node in nodes}
    for step in steps:
        if step.source in nodes and step.target in nodes:
            forward[step.source].append(step.target)
            backward[step.target].append(step.source)
    order: list[int] = []
    seen: set[int] = set()
    for node in sorted(nodes):
        stack = [] if node in seen else [(node, iter(forward[node]))]
        seen.add(node)
        while stack:
            following = next((n for n in stack[-1][1] if n not in seen), None)
            if following is None:
                order.append(stack.pop()[0])
            else:
                seen.add(following)
                stack.append((following, iter(forward[following])))
    component: dict[int, int] = {}
    for node in reversed(order):
        waiting = [] if node in component else [node]
        while waiting:
            each = waiting.pop()
            if each not in component:
                component[each] = node
                waiting += [n for n in backward[each] if n not in component]
    return component

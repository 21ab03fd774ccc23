# SPDX-License-Identifier: Apache-2.0
"""The states of a machine to which the locations of its automaton belong.

A translation adds locations between two states, in which an automaton executes the statements of a handler
(docs/spec/jani.md#locations), or waits for the blackboard (docs/spec/plain-scxml.md#blackboard-read).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from roaml.jani.model import Automaton, Edge
from roaml.scxml.names import CLOCK_ACTION, is_blackboard_answer, received_by


def states_of(automaton: Automaton) -> Mapping[str, str]:
    """Location -> the state to which it belongs: while the automaton executes a handler, the state in which it has
    received the event; before the first state, the initial state. A location that the translation has not added belongs
    to itself."""
    leaving: dict[str, list[Edge]] = {}
    for edge in automaton.edges:
        leaving.setdefault(edge.source, []).append(edge)
    names = [location.name for location in automaton.locations]
    states = {name: name for name in names if _is_state(name, leaving.get(name, ()))}
    belongs = dict(states)
    for state in states:
        for location in _following(state, leaving, belongs):
            if location.startswith((f"{state}-", f"{state}_")):
                belongs[location] = state
    for location in automaton.initial_locations:
        if location in belongs:
            continue
        before = list(_following(location, leaving, belongs))
        ends = {d.location for name in before for e in leaving.get(name, ()) for d in e.destinations} & states.keys()
        first = next((state for state in ends if location.startswith(f"{state}-")), None)
        if first is not None:
            belongs |= dict.fromkeys(before, first)
    return {name: belongs.get(name, name) for name in names}


def _is_state(location: str, edges: Sequence[Edge]) -> bool:
    """Whether an automaton waits for events in a location, or leaves it by an eventless transition."""
    actions = [edge.action or "" for edge in edges]
    if any(is_blackboard_answer(received_by(edge.action or "")) and _leaves(edge) for edge in edges):
        return False
    return all(action == CLOCK_ACTION or received_by(action) or _is_eventless(location, action) for action in actions)


def _is_eventless(location: str, action: str) -> bool:
    """Whether an action is that of an eventless transition of a location: its name and a number."""
    number = action.removeprefix(f"{location}-")
    return number != action and number.isascii() and number.isdigit()


def _leaves(edge: Edge) -> bool:
    return any(destination.location != edge.source for destination in edge.destinations)


def _following(location: str, leaving: Mapping[str, Sequence[Edge]], known: Mapping[str, str]) -> Iterator[str]:
    """The location and those that follow, up to the known ones."""
    visited = {location}
    remaining = [location]
    while remaining:
        current = remaining.pop()
        if current == location or current not in known:
            yield current
            for edge in leaving.get(current, ()):
                after = [d.location for d in edge.destinations if d.location not in visited]
                visited.update(after)
                remaining += after

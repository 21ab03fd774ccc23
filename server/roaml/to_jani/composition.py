# SPDX-License-Identifier: Apache-2.0
"""Event automata, and the synchronisation of all automata (docs/spec/jani.md#event-automata).

- Each event has one buffer: a sent event waits in its automaton until all receivers take it at once.
- The clock steps, and timers fire, only while no event waits; the blackboard is read only while no write to it waits.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from roaml.jani.model import Automaton, Destination, Edge, Element, Location, Sync, System
from roaml.model.translated import (
    BLACKBOARD_REQUEST,
    BLACKBOARD_WRITE_PREFIX,
    CLOCK_ACTION,
    CLOCK_STEP,
    RECEIVED,
    WAITING,
    is_internal,
    is_timer,
    on_receive,
    on_send,
)
from roaml.to_jani.events import Event

CLOCK_ENABLE = "__as2fm__global_timer_enable"
BLACKBOARD_ENABLE = "__as2fm__blackboard_requests_enable"


def has_automaton(event: Event) -> bool:
    return bool(event.senders) and not is_internal(event.name)


def event_automaton(event: Event, has_clock: bool) -> Automaton:
    """The buffer of an event; if the event has no receiver, the buffer accepts everything."""
    origin = event.origin

    def edge(source: str, action: str, target: str) -> Edge:
        return Edge(source, (Destination(target, origin=origin),), action, origin=origin)

    names = [WAITING]
    if event.receivers:
        names = [RECEIVED, WAITING]
        edges = [edge(WAITING, on_send(event.name), RECEIVED), edge(RECEIVED, on_receive(event.name), WAITING)]
        if has_clock:
            edges.append(edge(WAITING, CLOCK_ENABLE, WAITING))
        if event.name.startswith(BLACKBOARD_WRITE_PREFIX):
            edges.append(edge(WAITING, BLACKBOARD_ENABLE, WAITING))
    else:
        edges = [edge(WAITING, on_send(event.name), WAITING)]
    locations = tuple(Location(name, origin=origin) for name in names)
    return Automaton(event.name, locations, (WAITING,), tuple(edges), origin=origin)


def compose(automata: Sequence[Automaton], buffers: Mapping[str, int], table: Mapping[str, Event]) -> System:
    """
    Args:
        automata: all of them, those of events included.
        buffers: event -> index of its automaton.
    """
    waited_for = {name: index for name, index in buffers.items() if table[name].receivers}
    # Created once: every timer waits for all of them.
    calm = {name: (index, CLOCK_ENABLE) for name, index in waited_for.items()}
    syncs: list[Sync] = []
    for event in table.values():
        if event.name == CLOCK_STEP:
            others = [each for name, each in calm.items() if name != BLACKBOARD_REQUEST]
            syncs += [_sync(CLOCK_ACTION, [(clock, CLOCK_ACTION), *others]) for clock in event.receivers]
        elif is_timer(event.name):
            ticked = [(i, on_receive(event.name)) for i in event.receivers]
            for clock in event.senders:
                syncs.append(_sync(on_receive(event.name), [(clock, on_send(event.name)), *ticked, *calm.values()]))
        elif event.name in buffers:
            syncs += _communication(event, buffers)
    known = {action for event in table.values() for action in (on_send(event.name), on_receive(event.name))}
    known -= {CLOCK_STEP}
    for index, automaton in enumerate(automata[: len(automata) - len(buffers)]):
        own = dict.fromkeys(edge.action for edge in automaton.edges if edge.action and edge.action not in known)
        syncs += [Sync(((index, action),), action) for action in own]
    syncs.sort(key=lambda sync: (sync.result or "", sync.participants))
    return System(tuple(Element(automaton.name) for automaton in automata), tuple(syncs))


def _communication(event: Event, buffers: Mapping[str, int]) -> Iterable[Sync]:
    send, receive, buffer = on_send(event.name), on_receive(event.name), buffers[event.name]
    settled: list[tuple[int, str]] = []
    if event.name == BLACKBOARD_REQUEST:
        settled = [(i, BLACKBOARD_ENABLE) for name, i in buffers.items() if name.startswith(BLACKBOARD_WRITE_PREFIX)]
    for sender in event.senders:
        yield _sync(send, [(sender, send), (buffer, send), *settled])
    if event.receivers:
        yield _sync(receive, [(buffer, receive), *((receiver, receive) for receiver in event.receivers)])


def _sync(result: str, participants: Iterable[tuple[int, str]]) -> Sync:
    return Sync(tuple(sorted(participants)), result)

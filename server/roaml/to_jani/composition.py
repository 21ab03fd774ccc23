# SPDX-License-Identifier: Apache-2.0
"""Creates the automata of events, and the synchronisations of all automata (docs/spec/jani.md#event-automata).

- The automaton of an event is its buffer: a sent event waits there until all receivers receive it in one step.
- The clock makes a step, and timers fire, only while no event waits. The blackboard is read only while no write to it
  waits. A goal is received only while no cancel request waits (`ScxmlEvent.after`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from roaml.jani.model import Automaton, Destination, Edge, Element, Location, Sync, System
from roaml.scxml.events import EventRole
from roaml.scxml.names import (
    CLOCK_ACTION,
    RECEIVED,
    WAITING,
    on_receive,
    on_send,
)
from roaml.to_jani.events import EventUsage

CLOCK_ENABLE = "__as2fm__global_timer_enable"
BLACKBOARD_ENABLE = "__as2fm__blackboard_requests_enable"
ORDER_ENABLE = "__as2fm__later_events_enable"


def has_automaton(event: EventUsage) -> bool:
    return bool(event.senders) and not event.role.is_internal


def event_automaton(event: EventUsage, has_clock: bool, others_wait: bool) -> Automaton:
    """The automaton that buffers an event. If the event has no receiver, the automaton discards it.

    Args:
        has_clock: whether the model has a clock, which must wait for the event.
        others_wait: whether there are events that are received only while this event does not wait.
    """
    origin = event.origin

    def edge(source: str, action: str, target: str) -> Edge:
        return Edge(source, (Destination(target, origin=origin),), action, origin=origin)

    names = [WAITING]
    if event.receivers:
        names = [RECEIVED, WAITING]
        edges = [edge(WAITING, on_send(event.event), RECEIVED), edge(RECEIVED, on_receive(event.event), WAITING)]
        if has_clock:
            edges.append(edge(WAITING, CLOCK_ENABLE, WAITING))
        if event.role is EventRole.BLACKBOARD_WRITE:
            edges.append(edge(WAITING, BLACKBOARD_ENABLE, WAITING))
        if others_wait:
            edges.append(edge(WAITING, ORDER_ENABLE, WAITING))
    else:
        edges = [edge(WAITING, on_send(event.event), WAITING)]
    locations = tuple(Location(name, origin=origin) for name in names)
    return Automaton(event.name, locations, (WAITING,), tuple(edges), origin=origin)


def compose(automata: Sequence[Automaton], buffers: Mapping[str, int], table: Mapping[str, EventUsage]) -> System:
    """The parallel composition of all automata, with their synchronisations.

    Args:
        automata: all automata, including those of events.
        buffers: name of an event -> the index of its automaton.
        table: name of an event -> its usage.
    """
    waited_for = {name: index for name, index in buffers.items() if table[name].receivers}
    # The entries are created only once, because every timer waits for all events.
    calm = {name: (index, CLOCK_ENABLE) for name, index in waited_for.items()}
    syncs: list[Sync] = []
    for event in table.values():
        if event.role is EventRole.CLOCK_STEP:
            others = [wait for name, wait in calm.items() if table[name].role is not EventRole.BLACKBOARD_READ]
            syncs += [_sync(CLOCK_ACTION, [(clock, CLOCK_ACTION), *others]) for clock in event.receivers]
        elif event.role is EventRole.TIMER_TICK:
            ticked = [(i, on_receive(event.event)) for i in event.receivers]
            for clock in event.senders:
                syncs.append(_sync(on_receive(event.event), [(clock, on_send(event.event)), *ticked, *calm.values()]))
        elif event.name in buffers:
            syncs += _communication(event, buffers, table)
    known = {on_receive(event.event) for event in table.values()}
    # The clock sends its step only to itself, so the action is not synchronised with an event automaton.
    known |= {on_send(event.event) for event in table.values() if event.role is not EventRole.CLOCK_STEP}
    for index, automaton in enumerate(automata[: len(automata) - len(buffers)]):
        own = dict.fromkeys(edge.action for edge in automaton.edges if edge.action and edge.action not in known)
        syncs += [Sync(((index, action),), action) for action in own]
    syncs.sort(key=lambda sync: (sync.result or "", sync.participants))
    return System(tuple(Element(automaton.name) for automaton in automata), tuple(syncs))


def _communication(event: EventUsage, buffers: Mapping[str, int], table: Mapping[str, EventUsage]) -> Iterable[Sync]:
    send, receive, buffer = on_send(event.event), on_receive(event.event), buffers[event.name]
    settled: list[tuple[int, str]] = []
    if event.role is EventRole.BLACKBOARD_READ:
        written = ((i, table[name]) for name, i in buffers.items() if table[name].role is EventRole.BLACKBOARD_WRITE)
        settled = [(i, BLACKBOARD_ENABLE) for i, write in written if set(write.receivers) == set(event.receivers)]
    for sender in event.senders:
        yield _sync(send, [(sender, send), (buffer, send), *settled])
    if event.receivers:
        before = event.event.after
        is_waited_for = before in buffers and bool(table[before].receivers)
        delivered = [(buffers[before], ORDER_ENABLE)] if is_waited_for else []
        yield _sync(receive, [(buffer, receive), *((receiver, receive) for receiver in event.receivers), *delivered])


def _sync(result: str, participants: Iterable[tuple[int, str]]) -> Sync:
    return Sync(tuple(sorted(participants)), result)

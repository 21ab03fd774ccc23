# SPDX-License-Identifier: Apache-2.0
"""Exchanges of events that never end: each machine sends an event whenever it has received another one, and so on until
the first machine receives its event again. No time passes meanwhile if machines react at once
(docs/spec/semantics.md#time-stops)."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.model.behavior.instants import is_readable, senders
from roaml.model.behavior.phases import ProtocolEvent
from roaml.model.system import System, SystemAutomaton
from roaml.record import Record


class Reaction(Record, frozen=True):
    """One step of an exchange: `automaton` sends `sent` whenever it has received `received`. Both events are named as
    in this automaton."""

    automaton: SystemAutomaton
    received: ProtocolEvent
    sent: ProtocolEvent


def endless_exchange(system: System, automaton: SystemAutomaton, event: ProtocolEvent) -> tuple[Reaction, ...]:
    """A shortest exchange that leads from the reaction of `automaton` to `event` back to the same event, in the order
    of its steps; empty if there is none, or if nothing outside of the exchange begins it."""
    waiting: list[tuple[Reaction, ...]] = [()]
    seen: set[tuple[int, ProtocolEvent]] = set()
    while waiting:
        links = waiting.pop(0)
        here, awaited = (links[0].automaton, links[0].received) if links else (automaton, event)
        for link in _before(system, here, awaited):
            path = (link, *links)
            if link.automaton is automaton and link.received == event:
                if _begins(path):
                    return path
            elif (id(link.automaton), link.received) not in seen:
                seen.add((id(link.automaton), link.received))
                waiting.append(path)
    return ()


def _before(system: System, automaton: SystemAutomaton, event: ProtocolEvent) -> Iterator[Reaction]:
    """The steps after which `automaton` receives `event`."""
    for sender, sent in senders(system, automaton, event):
        if is_readable(system, sender):
            for chart in sender.outline.charts:
                for cause, reaction in sorted(chart.certain_reactions):
                    if reaction == sent:
                        yield Reaction(sender, cause, sent)


def _begins(links: tuple[Reaction, ...]) -> bool:
    """Whether one of the events of an exchange is also sent for another reason, so that the exchange can begin."""
    return any(
        event == link.sent and cause != link.received
        for link in links
        for chart in link.automaton.outline.charts
        for cause, event in chart.reactions
    )

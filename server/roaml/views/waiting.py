# SPDX-License-Identifier: Apache-2.0
"""Which automata wait for each other in a translated system that is stuck.

The search begins with the clock, or with an event that is not received. An automaton waits for the event that leads it,
with the fewest events, to the action that the previous automaton waits for. The sender of this event is next.
Conditions are evaluated only at the current location. Handlers of services and actions and the inner nodes of a tree
only pass events on, so they are omitted.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from roaml.durations import short_moment
from roaml.jani.model import Edge
from roaml.jani.node import Origin
from roaml.record import Record
from roaml.scxml.events import Role
from roaml.scxml.names import (
    ACTION_HANDLER_PREFIX,
    CLOCK,
    RECEIVED,
    SERVICE_HANDLER_PREFIX,
    TOPIC_PREFIX,
    TREE_ROOT_PREFIX,
    TreeEventKind,
    answered_by,
    automaton_role,
    is_timer,
    named,
    on_receive,
    on_send,
    received_by,
    sent_by,
)
from roaml.smc.standstill import Standstill
from roaml.views.actors import actors_of
from roaml.views.ends import is_event
from roaml.views.event_words import event_phrase
from roaml.views.turns import is_inner


class Wait(NamedTuple):
    """An automaton that waits, and a description of the event or condition for which it waits.

    Attributes:
        origin: the place in the source where it waits.
        who: the name of the automaton for users.
        what: the description, a phrase that continues `who`.
        automaton, location, role: the name of the automaton in the model, its location, and its role in the system.
        whom: the names for users of the automata for which it waits, joined by `and`; "" if there are none.
        unanswered: tick or halt if it waits for the answer to one of these; `origin` is then the place in the tree
            of the node that must answer.
        for_timer: whether it waits for a timer.
    """

    who: str
    what: str
    origin: Origin | None
    automaton: str
    location: str
    role: Role
    whom: str = ""
    unanswered: TreeEventKind | None = None
    for_timer: bool = False


class _Link(Record, frozen=True):
    """An automaton that waits, and the event for which it waits: each of `others` must receive or send the event.

    Attributes:
        action: the action that the previous automaton waits for; "" for the first one.
        event: the event; "" if the automaton waits for a condition, `None` if it never executes the action.
        is_taken: whether the automaton waits until the event is received, instead of until it is sent.
        others: the numbers of the next automata, and the action that each must execute.
    """

    automaton: int
    action: str
    event: str | None
    origin: Origin | None
    is_taken: bool = False
    others: tuple[tuple[int, str], ...] = ()


def waits(standstill: Standstill, time: float | None = None) -> tuple[Wait, ...]:
    """The chain of waiting automata, beginning with the clock if there is one; empty if no automaton waits.

    Args:
        time: the time of the model, in s.
    """
    return tuple(_Chain(standstill, time).waits())


NEEDS_TIME = "answer-needs-time"
"""The rule that reports a tick or halt whose answer takes time, without running the model."""


def rule(waiting: Sequence[Wait]) -> str:
    """The rule that documents the problem, if time cannot pass because a node that must answer the tree waits for a
    timer; "" otherwise."""
    is_late = any(wait.unanswered for wait in waiting) and any(wait.for_timer for wait in waiting)
    return NEEDS_TIME if is_late and any(wait.role is Role.CLOCK for wait in waiting) else ""


def advice(waiting: Sequence[Wait]) -> str:
    """The fix for a node that does not answer the tree in time; "" if the system is stuck for another reason."""
    late = next((wait for wait in waiting if wait.unanswered), None)
    if late is None or not any(wait.role is Role.CLOCK for wait in waiting):
        return ""
    if late.unanswered is TreeEventKind.HALT:
        return f"a halt must end before the next tick is due; let {late.whom} confirm it at once"
    what = f"let {late.whom} return RUNNING, and the result at a later tick"
    return f"a tick must end before the next one is due; {what}"


def help_line(waiting: Sequence[Wait]) -> str:
    """The fix of the system as a line, with the rule that documents it; "" if no fix is known."""
    text, code = advice(waiting), rule(waiting)
    return f"help: {text}{f' [{code}]' if code else ''}" if text else ""


class _Chain:
    def __init__(self, standstill: Standstill, time: float | None) -> None:
        self.automata = standstill.automata
        self._actors = actors_of(self.automata)
        self.locations = standstill.locations
        self.enabled = standstill.enabled
        self.ready = {(n, edge.action) for n, edges in enumerate(standstill.enabled) for edge in edges}
        self.syncs = standstill.system.syncs
        self.time = time
        self.index = {automaton.name: number for number, automaton in enumerate(self.automata)}
        self.events = {automaton.name: n for n, automaton in enumerate(self.automata) if is_event(automaton)}
        self.does: dict[str, list[int]] = {}
        for number, automaton in enumerate(self.automata):
            if automaton.name not in self.events:
                for action in dict.fromkeys(edge.action for edge in automaton.edges if edge.action):
                    self.does.setdefault(action, []).append(number)
        self.links: dict[int, list[_Link]] = {}

    # ------------------------------------------------------------------ the search

    def waits(self) -> Iterator[Wait]:
        clock = self.index.get(CLOCK)
        if clock is not None:
            self.follow(clock, "")
        else:
            for event in filter(self.is_pending, self.events):
                for receiver in self.not_taking(event):
                    self.follow(receiver, on_receive(named(event)))
        for number, links in self.links.items():
            if self.is_shown(number):
                yield from (self.words(link) for link in links)

    def follow(self, first: int, action: str) -> None:
        """All links that can be reached from an automaton, depth first. Each automaton occurs once."""
        stack = [(first, action)]
        while stack:
            number, action = stack.pop()
            if number in self.links:
                continue
            self.links[number] = list(self.blocked(number, action)) or list(self.waiting(number, action))
            stack += reversed([other for link in self.links[number] for other in link.others])

    def edges(self, number: int) -> list[Edge]:
        return [edge for edge in self.automata[number].edges if edge.source == self.locations[number]]

    def is_pending(self, event: str) -> bool:
        return event in self.events and self.locations[self.events[event]] == RECEIVED

    def not_taking(self, event: str) -> list[int]:
        """The automata that should receive an event and cannot."""
        action = on_receive(named(event))
        return [number for number in self.does.get(action, ()) if (number, action) not in self.ready]

    def blocked(self, number: int, awaited_action: str) -> Iterator[_Link]:
        """The links from an automaton that is about to send an event or to advance the time."""
        links: dict[tuple[str, int], _Link] = {}
        for edge in self.edges(number):
            if edge.action is None or received_by(edge.action) or (number, edge.action) not in self.ready:
                continue
            for sync in self.syncs:
                if (number, edge.action) not in sync.participants:
                    continue
                for other, action in sync.participants:
                    if (other, action) in self.ready:
                        continue
                    event = self.automata[other].name
                    late = [(event, busy) for busy in self.not_taking(event)] if self.is_pending(event) else []
                    if event not in self.events:
                        late = [(received_by(action), other)]
                    for name, busy in late:
                        link = _Link(
                            number, awaited_action, name, edge.origin, True, ((busy, on_receive(named(name))),)
                        )
                        links.setdefault((name, busy), link)
        yield from links.values()

    def waiting(self, number: int, action: str) -> Iterator[_Link]:
        """The links from an automaton that stays in a state until it receives an event."""
        best = self.awaited(number, action)
        if not best:
            automaton, here = self.automata[number], self.locations[number]
            origin = next((location.origin for location in automaton.locations if location.name == here), None)
            yield _Link(number, action, None, origin)
        active = {event: edge for event, edge in best.items() if not self.is_asleep(event, number)}
        for event, edge in (active or best).items():
            if self.is_pending(event):
                others = tuple((other, on_receive(named(event))) for other in self.not_taking(event) if other != number)
                yield _Link(number, action, event, edge.origin, True, others)
            else:
                others = tuple((sender, on_send(named(event))) for sender in self.senders(event))
                yield _Link(number, action, event, edge.origin, others=others)

    def senders(self, event: str) -> list[int]:
        return self.does.get(on_send(named(event)), []) if event else []

    def is_asleep(self, event: str, asker: int) -> bool:
        """Whether all possible senders of an event are nodes that the automaton that waits for the event would have to
        tick first."""
        senders = self.senders(event)
        return bool(senders) and all(
            not any(True for _ in self.blocked(sender, ""))
            and (awaited := self.awaited(sender, on_send(named(event))))
            and all(self.senders(event) == [asker] for event in awaited)
            for sender in senders
        )

    def awaited(self, number: int, action: str) -> dict[str, Edge]:
        """The events that lead an automaton to the action in the fewest steps, each with the edge that receives it. The
        key "" means that the edge waits for a condition."""
        distances = self.distances(number, action)
        here = self.locations[number]
        ways: list[tuple[tuple[int, int], Edge]] = []
        for edge in self.edges(number):
            targets = [way.location for way in edge.destinations if way.location != here]
            costs = [distances[target] for target in targets if target in distances]
            if costs:
                is_ready = any(edge is enabled for enabled in self.enabled[number])
                ways.append(((2 - _cost(edge) - is_ready, min(costs)), edge))
        least = min((cost for cost, _ in ways), default=None)
        return {received_by(edge.action or ""): edge for cost, edge in reversed(ways) if cost == least}

    def distances(self, number: int, action: str) -> dict[str, int]:
        """Location -> the number of events that lead the automaton from there to a location where it can execute
        `action`."""
        edges = self.automata[number].edges
        distances: dict[str, int] = {}
        queue = [(0, source) for source in dict.fromkeys(e.source for e in edges if e.action == action)]
        before: dict[str, list[Edge]] = {}
        for edge in edges:
            for way in edge.destinations:
                before.setdefault(way.location, []).append(edge)
        while queue:
            distance, location = heapq.heappop(queue)
            if location not in distances:
                distances[location] = distance
                for edge in before.get(location, ()):
                    heapq.heappush(queue, (distance + _cost(edge), edge.source))
        return distances

    # ------------------------------------------------------------------ in words

    def is_shown(self, number: int) -> bool:
        """Whether to show an automaton. Automata that only pass events on are not shown."""
        automaton = self.automata[number]
        if automaton.name.startswith(TREE_ROOT_PREFIX) or all(not link.others for link in self.links[number]):
            return True
        if automaton.name.startswith((SERVICE_HANDLER_PREFIX, ACTION_HANDLER_PREFIX)):
            return any(received_by(link.action) for link in self.links[number])
        return not is_inner(automaton)

    def who(self, number: int) -> str:
        return self._actors[self.automata[number].name]

    def role(self, number: int) -> Role:
        return automaton_role(self.automata[number].name)

    def shown_from(self, number: int, event: str) -> tuple[int, str]:
        """The automaton whose event another automaton passes on, and the event for which it waits."""
        seen = set()
        while number not in seen and number in self.links and not self.is_shown(number):
            seen.add(number)
            link = self.links[number][0]
            number, event = link.others[0][0], link.event or event
        return number, event

    def words(self, link: _Link) -> Wait:
        number = link.automaton
        who, role, here = self.who(number), self.role(number), self.locations[number]
        is_state = any(received_by(edge.action or "") for edge in self.edges(number)) or not self.edges(number)
        where = f" in `{here}`" if is_state and role is Role.MACHINE else ""
        if role is Role.CLOCK and self.time is not None:
            where = f" at {short_moment(self.time)}"
        shown = [self.shown_from(other, link.event or "") for other, _ in link.others]
        others = list(dict.fromkeys(self.who(other) for other, _ in shown))
        them = " and ".join(others)
        unanswered: TreeEventKind | None = None
        origin, for_timer = link.origin, False
        if link.event is None:
            does = "takes" if received_by(link.action) else "sends"
            event = received_by(link.action) or sent_by(link.action)
            text = f"stays{where} and never {does} {event_phrase(event, self.clients(), role)}"
        elif not link.event:
            text = f"waits{where} for a condition that can never become true"
        elif link.is_taken:
            takers = {self.role(other) for other, _ in shown}
            taker = Role.TREE_ROOT if takers == {Role.TREE_ROOT} else Role.MACHINE
            event = event_phrase(link.event, self.clients(), taker, taken=True)
            text = f"waits{where} for {them or 'another automaton'} to take {event}"
        elif answered_by(link.event):
            is_halt = any(event.endswith("_halt_response") for _, event in shown)
            unanswered = TreeEventKind.HALT if is_halt else TreeEventKind.TICK
            origin = self.place_in_tree(shown[0][1]) or origin
            text = f"waits{where} for {them} to {'halt' if is_halt else 'return a status'}"
        else:
            is_message = link.event.startswith(TOPIC_PREFIX)
            senders = f" from {' or '.join(others)}" if is_message and others else ""
            text = f"waits{where} for {event_phrase(link.event, self.clients(), role)}{senders}"
            for_timer = is_timer(link.event)
            if for_timer:
                text += ", which ticks when the clock advances"
        return Wait(who, text, origin, self.automata[number].name, here, role, them, unanswered, for_timer)

    def place_in_tree(self, answer: str) -> Origin | None:
        """The place in the tree of the node that sends an answer. The node that ticks it has this place."""
        called = answered_by(answer)
        return self.automata[self.index[called]].origin if called in self.index else None

    def clients(self) -> frozenset[str]:
        return frozenset(self.index)


def _cost(edge: Edge) -> int:
    return 1 if received_by(edge.action or "") else 0

# SPDX-License-Identifier: Apache-2.0
"""The orders in which the clients of a machine send requests and goals.

A client sends a request while it waits for the answer to another one only if a path of its graph contains this order.
The nodes of a behavior tree are ticked and halted one after the other: while a leaf owes an answer to its tick, no
other leaf acts. A client whose graph is not known may send anything at any time.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterator

from roaml.model.behavior.explore import Behavior, BehaviorStep, ChartConfiguration
from roaml.model.behavior.instants import channel_of, is_readable, may_be_sent
from roaml.model.behavior.phases import Duty, DutyKind, ProtocolEvent, Subject
from roaml.model.behavior.summary import Awaited
from roaml.model.gaps import GapAct
from roaml.model.system import ChannelEndpoint, System, SystemAutomaton
from roaml.record import Record, field
from roaml.roles import ProtocolPart

_ASKED_BY = {
    DutyKind.REQUEST: (ProtocolPart.REQUEST, (Subject.RESPONSE,)),
    DutyKind.GOAL: (ProtocolPart.GOAL, (Subject.DECISION,)),
    DutyKind.RESULT: (ProtocolPart.GOAL, (Subject.DECISION, Subject.OUTCOME)),
}
"""A duty of a server -> the event that creates it, and the answers that its client waits for meanwhile."""
_DUE = {Subject.REQUEST: DutyKind.REQUEST, Subject.GOAL: DutyKind.GOAL, Subject.RESULT: DutyKind.RESULT}
_ASKS = (ProtocolPart.REQUEST, ProtocolPart.GOAL)


class Interleaving(Record, frozen=True):
    """An event that may arrive while an answer is due.

    Attributes:
        duty: the answer that is due.
        event: the request or goal that arrives.
        asker, sender: the names of the automata that wait for the answer and that send the event; "" if unknown.
    """

    duty: Duty
    event: ProtocolEvent
    asker: str
    sender: str

    @property
    def is_of_one_client(self) -> bool:
        return bool(self.asker) and self.asker == self.sender


class ClientProtocols(Record, frozen=True, eq=False, dict=True):
    """What the clients of the automata of one machine may send. Without a system, everything is possible.

    Attributes:
        owner: refers to the system. The reference is weak, because the system caches these protocols.
        automata: the automata of the machine in the system.
    """

    owner: weakref.ref[System] | None
    automata: tuple[SystemAutomaton, ...]
    known: dict[tuple[Duty, ProtocolEvent], Interleaving | None] = field(default_factory=dict)

    @property
    def system(self) -> System | None:
        if self.owner is None:
            return None
        system = self.owner()
        assert system is not None, "the protocols are used only while their system is in use"
        return system

    def possible(self, behavior: Behavior, step: BehaviorStep) -> bool:
        """Whether the clients can send the event of a step while the answers are due that its source owes."""
        return all(between is not None for between in self.interleavings(behavior, step))

    def interleavings(self, behavior: Behavior, step: BehaviorStep) -> Iterator[Interleaving | None]:
        """For each answer that is due when the request or goal of a step arrives: how this can happen, or `None` if it
        cannot."""
        if step.event is None or step.event.part not in _ASKS:
            return
        for duty in due(behavior.configurations[step.source]):
            yield self.interleaving(duty, step.event)

    def interleaving(self, duty: Duty, event: ProtocolEvent) -> Interleaving | None:
        """How `event` can arrive while the answer to `duty` is due; `None` if it cannot."""
        key = (duty, event)
        if key not in self.known:
            self.known[key] = self._interleaving(duty, event)
        return self.known[key]

    def _interleaving(self, duty: Duty, event: ProtocolEvent) -> Interleaving | None:
        if self.system is None or not self.automata:
            return Interleaving(duty, event, "", "")
        part, answers = _ASKED_BY[duty.kind]
        found: Interleaving | None = None
        for automaton in self.automata:
            asked = ProtocolEvent(part, duty.handle)
            if may_be_sent(self.system, automaton, event) or may_be_sent(self.system, automaton, asked):
                return Interleaving(duty, event, "", "")
            for asker in self._clients(automaton, asked):
                for sender in self._clients(automaton, event):
                    if _overlap(self.system, asker, answers, sender, event.part):
                        between = Interleaving(duty, event, asker.automaton.name, sender.automaton.name)
                        if not between.is_of_one_client:
                            return between
                        found = between
        return found

    def _clients(self, automaton: SystemAutomaton, event: ProtocolEvent) -> Iterator[ChannelEndpoint]:
        assert self.system is not None
        channel = channel_of(self.system, automaton, event)
        for endpoint in channel.users if channel else ():
            if event.part in endpoint.use.sends:
                yield endpoint

    def is_sent(self, step: BehaviorStep) -> bool:
        """Whether a machine may send the plain event of a step; true for other events."""
        if self.system is None or step.event is None or step.event.part is not ProtocolPart.EVENT:
            return True
        known = self.system.events.get(step.event.name)
        return bool(known and known.senders) or self.system.may(GapAct.SENDS, step.event.name)


def due(configuration: ChartConfiguration) -> Iterator[Duty]:
    """The answers that a machine owes as a server."""
    for (subject, handle), _ in configuration.phases:
        kind = _DUE.get(subject)
        if kind is not None:
            yield Duty(kind, handle)


def _overlap(
    system: System, asker: ChannelEndpoint, answers: tuple[Subject, ...], sender: ChannelEndpoint, part: ProtocolPart
) -> bool:
    """Whether `sender` may send a request or goal while `asker` waits for one of the answers."""
    first, second = asker.automaton, sender.automaton
    if not is_readable(system, first) or not is_readable(system, second):
        return True
    awaited = {(answer, asker.use.handle) for answer in answers}
    sent = ProtocolEvent(part, sender.use.handle)
    if first is second:
        charts = first.outline.charts  # several charts of a machine, its threads, act independently
        if len(charts) != 1 or charts[0].overlaps is None:
            return True
        return any((subject, sent) in charts[0].overlaps for subject in awaited)
    if _is_leaf(first) and _is_leaf(second):
        meanwhile = {(_ANSWERS[part], sender.use.handle)}
        return _is_unhurried(first, awaited) or _is_unhurried(second, meanwhile)
    return True


_ANSWERS = {ProtocolPart.REQUEST: Subject.RESPONSE, ProtocolPart.GOAL: Subject.DECISION}


def _is_leaf(automaton: SystemAutomaton) -> bool:
    return automaton.instance is not None and not automaton.instance.children


def _is_unhurried(automaton: SystemAutomaton, awaited: set[Awaited]) -> bool:
    return any(chart.overlaps is None or not awaited.isdisjoint(chart.unhurried) for chart in automaton.outline.charts)

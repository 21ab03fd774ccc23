# SPDX-License-Identifier: Apache-2.0
"""The part of a graph that other machines depend on: the events that must occur before each answer, and the events
after which a machine sends events.

The summary contains names of states and handles, but no positions, so most changes of a file do not change it.
"""

from __future__ import annotations

from collections.abc import Collection, Container, Iterable, Iterator, Mapping, Sequence, Set
from typing import TypeAlias

from roaml.interruption import checkpoint
from roaml.model.behavior.explore import UNKNOWN_STATE, Behavior, BehaviorStep, explore
from roaml.model.behavior.phases import AWAITED_ANSWER, Duty, DutyKind, Phase, ProtocolEvent, Subject
from roaml.model.machine import Chart, Machine
from roaml.record import Record, replace
from roaml.roles import ProtocolPart

Needs: TypeAlias = frozenset[frozenset[ProtocolEvent]]
"""Alternative sets of events. It is sufficient that all events of one of the sets occur. If there is no set, no events
are sufficient."""

AT_ONCE: frozenset[ProtocolEvent] = frozenset()
START = ProtocolEvent(ProtocolPart.START, "")
"""A pseudo-event: the start of a machine, before its first event."""

MAX_ALTERNATIVES = 6
"""The maximum number of sets in `Needs`; further sets are left out."""

MAX_EVENTS = 4
"""The maximum number of events in a set of `Needs`; larger sets are left out."""

REPEATED = (
    ProtocolPart.MESSAGE,
    ProtocolPart.EVENT,
    ProtocolPart.CANCEL,
    ProtocolPart.FEEDBACK,
    ProtocolPart.THREAD_START,
    ProtocolPart.THREAD_FREE,
    ProtocolPart.REQUEST,
    ProtocolPart.GOAL,
)
_ASKS = {ProtocolPart.REQUEST: Subject.RESPONSE, ProtocolPart.GOAL: Subject.DECISION}
"""An event that a client sends -> the answer that it then waits for."""
_AWAITED = frozenset(AWAITED_ANSWER.values())
_DUTIES = {
    ProtocolPart.REQUEST: (DutyKind.REQUEST,),
    ProtocolPart.GOAL: (DutyKind.GOAL, DutyKind.RESULT),
    ProtocolPart.THREAD_START: (DutyKind.RESULT,),
}
"""An event that a server receives -> the kinds of duties that it creates."""
_ASKED_BY = {DutyKind.REQUEST: ProtocolPart.REQUEST, DutyKind.GOAL: ProtocolPart.GOAL}


Awaited: TypeAlias = tuple[Subject, str]
"""An answer that a client waits for: `RESPONSE`, `DECISION` or `OUTCOME`, and the handle of the client."""


class Promise(Record, frozen=True):
    """A delayed answer of a server.

    Attributes:
        duty: the duty that the answer fulfils, of the kind REQUEST, GOAL or RESULT.
        state: the state in which the machine waits.
        scope: the scope of the chart that the state is in; it distinguishes the threads of a file.
        taken: whether the machine has received the request or goal; otherwise it must first reach a state that handles
            it.
        busy: the handles of the actions for which the machine still owes the result of an earlier goal in this state.
        needs: the events that must occur before the answer is sent, or before the request or goal is received.
    """

    duty: Duty
    state: str
    scope: str
    taken: bool
    busy: frozenset[str]
    needs: Needs


class ChartOutline(Record, frozen=True):
    """The summary of the graph of a chart.

    Attributes:
        promises: the delayed answers, at most one for each duty and configuration that owes the answer or cannot
            receive the request yet. Answers that need no event are left out.
        reactions: pairs of events: the machine may send the second after it has received the first, and before it
            receives another event.
        repeats: for each event of a kind in `REPEATED` that the machine sends, the events that must occur before it is
            sent again.
        overlaps: pairs of an answer that the machine waits for and a request or goal that it may send meanwhile;
            `None` if there is no graph.
        unhurried: the answers that a plugin may wait for while it owes no answer to a tick or halt.
        certain_reactions: pairs of events: whenever the machine handles the first, it sends the second before it
            receives another event, whatever the conditions are.
        repeated_reactions: pairs of a tick and a message: in some configurations, the machine sends the message at each
            tick, whatever the conditions are, and the tick leads to such a configuration again.
    """

    promises: tuple[Promise, ...]
    reactions: frozenset[tuple[ProtocolEvent, ProtocolEvent]]
    repeats: tuple[tuple[ProtocolEvent, Needs], ...]
    overlaps: frozenset[tuple[Awaited, ProtocolEvent]] | None = None
    unhurried: frozenset[Awaited] = frozenset()
    certain_reactions: frozenset[tuple[ProtocolEvent, ProtocolEvent]] = frozenset()
    repeated_reactions: frozenset[tuple[ProtocolEvent, ProtocolEvent]] = frozenset()


UNKNOWN = ChartOutline((), frozenset(), ())


def summarised(machine: Machine, chart: Chart) -> ChartOutline:
    """The outline of a chart, cached with it; it is empty if there is no graph."""
    known: dict[str, ChartOutline] = chart.__dict__.setdefault("summary", {})
    if "outline" not in known:
        behavior = explore(machine, chart)
        known["outline"] = UNKNOWN if behavior is None else summarise(behavior)
    return known["outline"]


def summarise(behavior: Behavior) -> ChartOutline:
    return _Summary(behavior).outline()


class _Edge(Record, frozen=True):
    """Steps that do not differ in the summary.

    Attributes:
        event: the bit of the received event; 0 if there is none.
        taken: the received event; `None` if there is none.
        sent: the events that are sent.
    """

    source: int
    target: int
    event: int
    taken: ProtocolEvent | None
    sent: frozenset[ProtocolEvent]


class _Summary:
    """Computes the outline of one chart. Sets of events are integers with one bit for each event."""

    def __init__(self, behavior: Behavior) -> None:
        self.behavior = behavior
        self.events: dict[ProtocolEvent, int] = {}
        self.edges = list(dict.fromkeys(self._edge(step) for step in behavior.steps))
        self.names = {bit: event for event, bit in self.events.items()}

    def _edge(self, step: BehaviorStep) -> _Edge:
        bit = 0 if step.event is None else self.events.setdefault(step.event, 1 << len(self.events))
        return _Edge(step.source, step.target, bit, step.event, frozenset(step.sent))

    def outline(self) -> ChartOutline:
        promises = dict.fromkeys(
            promise for duty in self._duties() for promise in self._promises(duty) if AT_ONCE not in promise.needs
        )
        return ChartOutline(
            tuple(promises),
            self._reactions(),
            tuple(self._repeats()),
            frozenset(self._overlaps()),
            self._unhurried(),
            frozenset(self._certain_reactions()),
            frozenset(self._repeated_reactions()),
        )

    def _overlaps(self) -> Iterator[tuple[Awaited, ProtocolEvent]]:
        yield from _meanwhile(set(), self.behavior.at_start)
        for step in self.behavior.steps:
            checkpoint()
            if any(event.part in _ASKS for event in step.sent):
                source = self.behavior.configurations[step.source]
                awaited = {subject for subject, _ in source.phases if subject[0] in _AWAITED}
                answer = AWAITED_ANSWER.get(step.event.part) if step.event else None
                if step.event is not None and answer and source.phase(answer, step.event.name) is not Phase.SEVERAL:
                    awaited.discard((answer, step.event.name))
                yield from _meanwhile(awaited, step.sent)

    def _unhurried(self) -> frozenset[Awaited]:
        return frozenset(
            subject
            for configuration in self.behavior.configurations
            if configuration.tree not in (Phase.TICKED, Phase.HALTING)
            for subject, _ in configuration.phases
            if subject[0] in _AWAITED
        )

    def _duties(self) -> list[Duty]:
        """The duties of the machine as a server."""
        duties: dict[Duty, None] = {}
        for event in self.events:
            for kind in _DUTIES.get(event.part, ()):
                duties[Duty(kind, event.name)] = None
        return list(duties)

    def _promises(self, duty: Duty) -> Iterator[Promise]:
        """The promises for the configurations that owe an answer, and for those without a handler for the request."""
        configurations = self.behavior.configurations
        owing = [c.owes(duty) for c in configurations]
        on_the_way = [edge for edge in self.edges if owing[edge.source]]
        answers = [e for e in on_the_way if not owing[e.target] or configurations[e.target].state == UNKNOWN_STATE]
        needs = _needs(_incoming(on_the_way), answers)
        for number, alternatives in needs.items():
            checkpoint()
            if configurations[number].answering(duty) is not Phase.SEVERAL:
                yield self._promise(duty, number, True, alternatives)
        asked_by = _ASKED_BY.get(duty.kind)
        if asked_by is not None:
            taking = ProtocolEvent(asked_by, duty.handle)
            takes = [replace(edge, event=0) for edge in self.edges if edge.taken == taking]
            idle = [edge for edge in self.edges if not owing[edge.source] and not owing[edge.target]]
            for number, alternatives in _needs(_incoming([*idle, *takes]), takes).items():
                yield self._promise(duty, number, False, alternatives)

    def _promise(self, duty: Duty, number: int, taken: bool, alternatives: tuple[int, ...]) -> Promise:
        configuration = self.behavior.configurations[number]
        owed = [handle for (subject, handle), _ in configuration.phases if subject is Subject.RESULT]
        busy = frozenset[str]() if taken else frozenset(owed)
        scope = self.behavior.chart.scope
        return Promise(duty, configuration.state, scope, taken, busy, frozenset(map(self._set, alternatives)))

    def _set(self, mask: int) -> frozenset[ProtocolEvent]:
        return frozenset(event for bit, event in self.names.items() if mask & bit)

    def _repeats(self) -> Iterator[tuple[ProtocolEvent, Needs]]:
        at_start = [event for event in self.behavior.at_start if event.part in REPEATED]
        twice = {e for step in self.behavior.steps for e in step.sent if step.sent.count(e) > 1}
        edges_that_send: dict[ProtocolEvent, list[_Edge]] = {}
        for edge in self.edges:
            for event in sorted(edge.sent):
                if event.part in REPEATED:
                    edges_that_send.setdefault(event, []).append(edge)
        incoming = _incoming(self.edges)
        for event in dict.fromkeys([*edges_that_send, *at_start]):
            sending = edges_that_send.get(event, [])
            needs = _needs(incoming, sending)
            after = {edge.target for edge in sending}
            if event in at_start:
                after.update(range(self.behavior.starts))
            masks = {mask for number in after for mask in needs.get(number, ())} | ({0} if event in twice else set())
            yield event, frozenset(map(self._set, _least(masks)))

    def _reactions(self) -> frozenset[tuple[ProtocolEvent, ProtocolEvent]]:
        before: list[set[ProtocolEvent]] = [set() for _ in self.behavior.configurations]
        for start in range(self.behavior.starts):
            before[start].add(START)
        changed = True
        while changed:
            changed = False
            checkpoint()
            for edge in self.edges:
                causes = before[edge.source] if edge.taken is None else {edge.taken}
                if not causes <= before[edge.target]:
                    before[edge.target] |= causes
                    changed = True
        pairs = {(START, event) for event in self.behavior.at_start}
        for edge in self.edges:
            causes = before[edge.source] if edge.taken is None else {edge.taken}
            pairs |= {(cause, event) for cause in causes for event in edge.sent}
        return frozenset(pairs)

    def _certain_reactions(self) -> Iterator[tuple[ProtocolEvent, ProtocolEvent]]:
        outgoing = self.behavior.outgoing()
        groups: dict[ProtocolEvent, list[list[BehaviorStep]]] = {}
        for steps in outgoing:
            by_event: dict[ProtocolEvent, list[BehaviorStep]] = {}
            for step in steps:
                if step.event is not None:
                    by_event.setdefault(step.event, []).append(step)
            for event, alternatives in by_event.items():
                if not all(step.ignored for step in alternatives):
                    groups.setdefault(event, []).append(alternatives)
        for event, configurations in groups.items():
            # If all handlers have conditions, the event may be discarded.
            if all(any(step.handler.cond is None for step in alternatives) for alternatives in configurations):
                always = [_always_sent(step, outgoing) for alternatives in configurations for step in alternatives]
                yield from ((event, sent) for sent in frozenset.intersection(*always))

    def _repeated_reactions(self) -> Iterator[tuple[ProtocolEvent, ProtocolEvent]]:
        outgoing = self.behavior.outgoing()
        steps: dict[ProtocolEvent, list[BehaviorStep]] = {}
        for step in self.behavior.steps:
            if step.event is not None and step.event.part is ProtocolPart.TICK:
                steps.setdefault(step.event, []).append(step)
        for event, handled in steps.items():
            always = {id(step): _always_sent(step, outgoing) for step in handled}
            for message in frozenset[ProtocolEvent]().union(*always.values()):
                if message.part is ProtocolPart.MESSAGE:
                    sending = {id(step) for step in handled if message in always[id(step)]}
                    if self._repeats_in_some(event, sending, outgoing):
                        yield event, message

    def _repeats_in_some(
        self, event: ProtocolEvent, sending: Set[int], outgoing: Sequence[Sequence[BehaviorStep]]
    ) -> bool:
        """Whether there are configurations in which all steps with `event` have an `id()` in `sending` and lead to
        such configurations again, perhaps through transitions without event."""
        entered: list[list[int]] = [[] for _ in outgoing]
        for step in self.behavior.steps:
            entered[step.target].append(step.source)
        lasting = set(range(len(outgoing)))
        open_ = list(lasting)
        while open_:
            checkpoint()
            number = open_.pop()
            if number in lasting and not _lasts(event, outgoing[number], sending, lasting):
                lasting.discard(number)
                open_ += entered[number]
        return any(step.event == event for number in lasting for step in outgoing[number])


def _lasts(event: ProtocolEvent, outgoing: Sequence[BehaviorStep], sending: Set[int], lasting: Container[int]) -> bool:
    """Whether a configuration with the steps `outgoing` reacts to `event` with a step in `sending`, whatever the
    conditions are, and goes on to a configuration in `lasting`."""
    at_once = [step for step in outgoing if step.event is None]
    if any(step.target not in lasting and not step.ignored for step in at_once):
        return False
    if any(step.handler.cond is None for step in at_once):
        return True
    handled = [step for step in outgoing if step.event == event]
    return any(step.handler.cond is None for step in handled) and all(
        id(step) in sending and step.target in lasting for step in handled
    )


def _always_sent(step: BehaviorStep, outgoing: Sequence[Sequence[BehaviorStep]]) -> frozenset[ProtocolEvent]:
    """The events that are sent by a step, or by each of the eventless transitions that certainly follow it at once."""
    if step.ignored:
        return frozenset()
    following = [after for after in outgoing[step.target] if after.event is None]
    if not any(after.handler.cond is None for after in following):
        return frozenset(step.sent)
    return frozenset(step.sent) | frozenset.intersection(*(frozenset(after.sent) for after in following))


def _meanwhile(awaited: set[Awaited], sent: Iterable[ProtocolEvent]) -> Iterator[tuple[Awaited, ProtocolEvent]]:
    """The overlaps of one step, which begins while some answers are awaited and sends events in an order."""
    for event in sent:
        answer = _ASKS.get(event.part)
        if answer is not None:
            yield from ((subject, event) for subject in awaited)
            awaited.add((answer, event.name))


def _incoming(edges: Iterable[_Edge]) -> dict[int, list[_Edge]]:
    """Configuration -> the edges that lead to it from other configurations."""
    incoming: dict[int, list[_Edge]] = {}
    for edge in edges:
        if edge.source != edge.target:
            incoming.setdefault(edge.target, []).append(edge)
    return incoming


def _needs(incoming: Mapping[int, Sequence[_Edge]], reaching: Collection[_Edge]) -> dict[int, tuple[int, ...]]:
    """Configuration -> the smallest sets of events on the paths from it to an edge of `reaching`, including this edge.
    Configurations without a path to one of these edges are left out."""
    goals = set(reaching)
    needs: dict[int, tuple[int, ...]] = {}
    waiting: dict[int, None] = {}
    for edge in reaching:
        needs[edge.source] = _least((*needs.get(edge.source, ()), edge.event))
        waiting[edge.source] = None
    while waiting:
        checkpoint()
        target = next(iter(waiting))
        del waiting[target]
        for edge in incoming.get(target, ()):
            known = needs.get(edge.source, ())
            if known == (0,) or edge in goals:
                continue
            least = _least((*known, *(edge.event | mask for mask in needs[target])))
            if least != known:
                needs[edge.source] = least
                waiting[edge.source] = None
    return needs


def _least(masks: Iterable[int]) -> tuple[int, ...]:
    """The sets that contain no other set of `masks`, the smallest first, within `MAX_ALTERNATIVES` and `MAX_EVENTS`."""
    smallest: list[int] = []
    for mask in sorted(set(masks), key=lambda mask: (mask.bit_count(), mask)):
        if mask.bit_count() > MAX_EVENTS:
            break
        if not any(known & mask == known for known in smallest):
            smallest.append(mask)
    return tuple(smallest[:MAX_ALTERNATIVES])

# SPDX-License-Identifier: Apache-2.0
"""The events that certainly occur during a tick of the behavior tree, and those that need time
(docs/spec/semantics.md#time).

During a tick, the clock stops when the next tick is due, which waits for the answer to the current tick. In some traces
this is so from the start. So during a tick a plugin certainly receives only events that it causes itself, for example
by its request, or by the requests that the server then sends.

An event is assumed to arrive at once if an unreadable part of the system might send it, or if its sender is a machine
with an unreadable part that handles or sends events.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from roaml.model.behavior.explore import BehaviorStep
from roaml.model.behavior.phases import DutyKind, ProtocolEvent
from roaml.model.behavior.summary import START, ChartOutline, Needs, Promise
from roaml.model.expand import Instance
from roaml.model.gaps import Act, GapAct, InterfaceAct
from roaml.model.system import CLOCK_TOPIC, Channel, ChannelEndpoint, System, SystemAutomaton
from roaml.record import Record, field
from roaml.roles import ProtocolPart, SymbolKind
from roaml.scxml.names import sanitise

_PROMISED = {
    ProtocolPart.RESPONSE: DutyKind.REQUEST,
    ProtocolPart.GOAL_RESPONSE: DutyKind.GOAL,
    ProtocolPart.RESULT: DutyKind.RESULT,
}
"""An event that a client receives -> the duty of the server that it answers."""
_KINDS = {
    ProtocolPart.MESSAGE: (SymbolKind.SUBSCRIBER,),
    ProtocolPart.REQUEST: (SymbolKind.SERVICE_SERVER,),
    ProtocolPart.RESPONSE: (SymbolKind.SERVICE_CLIENT,),
    ProtocolPart.GOAL: (SymbolKind.ACTION_SERVER,),
    ProtocolPart.CANCEL: (SymbolKind.ACTION_SERVER,),
    ProtocolPart.GOAL_RESPONSE: (SymbolKind.ACTION_CLIENT,),
    ProtocolPart.FEEDBACK: (SymbolKind.ACTION_CLIENT,),
    ProtocolPart.RESULT: (SymbolKind.ACTION_CLIENT,),
}
_SENDERS = {
    ProtocolPart.MESSAGE: SymbolKind.PUBLISHER,
    ProtocolPart.REQUEST: SymbolKind.SERVICE_CLIENT,
    ProtocolPart.GOAL: SymbolKind.ACTION_CLIENT,
    ProtocolPart.CANCEL: SymbolKind.ACTION_CLIENT,
    ProtocolPart.FEEDBACK: SymbolKind.ACTION_SERVER,
}

_SERVERS = {
    ProtocolPart.RESPONSE: SymbolKind.SERVICE_SERVER,
    ProtocolPart.GOAL_RESPONSE: SymbolKind.ACTION_SERVER,
    ProtocolPart.RESULT: SymbolKind.ACTION_SERVER,
}
_ANSWERS = {
    ProtocolPart.RESPONSE: (ProtocolPart.RESPONSE,),
    ProtocolPart.GOAL_RESPONSE: (ProtocolPart.GOAL_ACCEPTED, ProtocolPart.GOAL_REJECTED),
    ProtocolPart.RESULT: (ProtocolPart.RESULT,),
}
"""An event that a client receives -> the events by which a server sends it."""

_Fact = tuple[int, ProtocolEvent]


class EventDelay(Record, frozen=True):
    """The reason why an event takes time.

    Attributes:
        automaton: the automaton that waits for the event.
        event: the awaited event.
        server: the server that sends the event; `None` if the event is not an answer of a server.
        promise: the delayed answer of `server`.
        next: the delay of the event after which this event is sent; `None` if this event does not depend on another
            event, such as the event of a timer.
    """

    automaton: SystemAutomaton
    event: ProtocolEvent
    server: ChannelEndpoint | None = None
    promise: Promise | None = None
    next: EventDelay | None = None


class _Solver(Record, eq=False, dict=True):
    """The least solution of the facts "this event reaches this automaton", which depend on each other; found by
    iteration."""

    system: System
    holds: Callable[[_Solver, int, ProtocolEvent], bool]
    facts: dict[_Fact, bool] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.index = {id(automaton): n for n, automaton in enumerate(self.system.automata)}

    def read(self, number: int, event: ProtocolEvent) -> bool:
        return self.facts.setdefault((number, event), False)

    def solve(self, number: int, event: ProtocolEvent) -> bool:
        self.read(number, event)
        changed = True
        while changed:
            before = len(self.facts)
            changed = False
            for fact, known in list(self.facts.items()):
                if not known and self.holds(self, *fact):
                    self.facts[fact] = changed = True
            changed = changed or len(self.facts) > before
        return self.facts[number, event]

    def number(self, automaton: SystemAutomaton) -> int:
        return self.index[id(automaton)]

    # -------------------------------------------------------------- who sends

    def senders(
        self, automaton: SystemAutomaton, event: ProtocolEvent
    ) -> Iterator[tuple[SystemAutomaton, ProtocolEvent]]:
        """As `senders`; without the answers of servers, which need more than the event that causes them."""
        return senders(self.system, automaton, event, answers=False)

    def causes(self, automaton: SystemAutomaton, sent: ProtocolEvent) -> Iterator[ProtocolEvent]:
        """The events after which an automaton sends `sent`."""
        for chart in automaton.outline.charts:
            for cause, event in chart.reactions:
                if event == sent:
                    yield cause


def senders(
    system: System, automaton: SystemAutomaton, event: ProtocolEvent, *, answers: bool = True
) -> Iterator[tuple[SystemAutomaton, ProtocolEvent]]:
    """The automata that may send the event that `automaton` receives as `event`, each with the event as this automaton
    names it.

    Args:
        answers: whether servers are included that send `event` as an answer.
    """
    if event.part is ProtocolPart.EVENT:
        known = system.events.get(event.name)
        for sender in {id(a): a for a, _ in known.senders}.values() if known else ():
            yield sender, event
        return
    if event.part in (ProtocolPart.THREAD_START, ProtocolPart.THREAD_FREE):
        yield automaton, event
        return
    channel = channel_of(system, automaton, event)
    kind = _SENDERS.get(event.part)
    for endpoint in channel.endpoints if channel else ():
        if kind is not None and endpoint.use.kind is kind:
            yield endpoint.automaton, ProtocolEvent(event.part, endpoint.use.handle)
    if answers and kind is None and event.part in _ANSWERS:
        server = server_of(system, automaton, event)
        if server is not None:
            yield from ((server.automaton, ProtocolEvent(part, server.use.handle)) for part in _ANSWERS[event.part])


def channel_of(system: System, automaton: SystemAutomaton, event: ProtocolEvent) -> Channel | None:
    """The topic, service or action of an event of an automaton; `None` if there is none."""
    for use in automaton.outline.interfaces:
        if use.handle == event.name and use.kind in _KINDS.get(event.part, ()):
            return system.channel(automaton, use)
    return None


# ------------------------------------------------------- without time passing


class Instants(Record, eq=False, dict=True):
    """The events that can occur after `plugin` has been ticked or halted, without the passing of time."""

    system: System
    plugin: SystemAutomaton

    def __post_init__(self) -> None:
        self.solver = _Solver(self.system, self._holds)
        self.own = self.solver.number(self.plugin)
        self.below = {id(automaton) for automaton in _below(self.system, self.plugin)}

    def can_arrive(self, event: ProtocolEvent) -> bool:
        """Whether an event that the plugin waits for can arrive."""
        return self.solver.solve(self.own, event)

    def possible(self, step: BehaviorStep) -> bool:
        """Whether the plugin can take a step: its event can arrive, and if it handles the acceptance or rejection of a
        goal, the server sends that answer."""
        if step.event is None or step.event.part in (ProtocolPart.BT_TICK, ProtocolPart.BT_HALT):
            return True
        if step.event.part is ProtocolPart.GOAL_RESPONSE:
            server = server_of(self.system, self.plugin, step.event)
            answer = (ProtocolPart.GOAL_ACCEPTED, ProtocolPart.GOAL_REJECTED)[step.choice]
            if server is not None and answer not in server.use.sends:
                return False
        return self.can_arrive(step.event)

    def _holds(self, solver: _Solver, number: int, event: ProtocolEvent) -> bool:
        automaton = self.system.automata[number]
        match event.part:
            case ProtocolPart.CHILD_STATUS | ProtocolPart.CHILD_HALTED:
                return True
            case ProtocolPart.BT_TICK | ProtocolPart.BT_HALT:
                return id(automaton) in self.below
            case ProtocolPart.RESPONSE | ProtocolPart.GOAL_RESPONSE | ProtocolPart.RESULT:
                server = server_of(self.system, automaton, event)
                if server is None or may_be_sent(self.system, automaton, event):
                    return True
                if not is_readable(self.system, server.automaton):
                    return True
                return not any(self._takes_time(server, p) for p in self._kept(server, event))
        if event == START or event.part is ProtocolPart.TICK or is_clock(self.system, automaton, event):
            return False
        if may_be_sent(self.system, automaton, event):
            return True
        for sender, sent in solver.senders(automaton, event):
            if not is_readable(self.system, sender):
                return True
            for cause in solver.causes(sender, sent):
                if sender is self.plugin or solver.read(solver.number(sender), cause):
                    return True
        return False

    def _kept(self, server: ChannelEndpoint, event: ProtocolEvent) -> Iterator[Promise]:
        """The delayed answers of a server that the plugin may depend on. Those for which the server is still busy with
        an earlier goal are left out if this goal has ended when the plugin asks."""
        for promise in promises(server, event):
            if not any(self._has_ended(server, handle) for handle in promise.busy):
                yield promise

    def _has_ended(self, server: ChannelEndpoint, handle: str) -> bool:
        """Whether the earlier goal of an action has ended when the server is asked: the only client of the action is
        the one that asks, or a node that has ended when the plugin is ticked."""
        uses = server.automaton.outline.interfaces
        action = next((u for u in uses if u.handle == handle and u.kind is SymbolKind.ACTION_SERVER), None)
        channel = self.system.channel(server.automaton, action) if action is not None else None
        if action is None or channel is None or len(channel.users) != 1:
            return False
        return action == server.use or _ends_before(self.system, channel.users[0].automaton, self.plugin)

    def _takes_time(self, server: ChannelEndpoint, promise: Promise) -> bool:
        number = self.solver.number(server.automaton)
        return not any(all(self.solver.read(number, event) for event in needs) for needs in promise.needs)

    def delay(self, event: ProtocolEvent) -> EventDelay:
        """The reason why an event cannot arrive without the passing of time."""
        self.can_arrive(event)
        return self._delay(self.plugin, event, frozenset())

    def _delay(self, automaton: SystemAutomaton, event: ProtocolEvent, seen: frozenset[_Fact]) -> EventDelay:
        fact = (self.solver.number(automaton), event)
        if fact in seen:
            return EventDelay(automaton, event)
        seen |= {fact}
        if event.part in _PROMISED:
            server = server_of(self.system, automaton, event)
            for promise in self._kept(server, event) if server else ():
                if server and self._takes_time(server, promise):
                    awaited = self._first(server.automaton, promise.needs)
                    return EventDelay(automaton, event, server, promise, self._delay(server.automaton, awaited, seen))
        if event.part is not ProtocolPart.TICK and not is_clock(self.system, automaton, event):
            for sender, sent in self.solver.senders(automaton, event):
                for cause in sorted(self.solver.causes(sender, sent)):
                    return EventDelay(automaton, event, next=self._delay(sender, cause, seen))
        return EventDelay(automaton, event)

    def _first(self, automaton: SystemAutomaton, needs: Needs) -> ProtocolEvent:
        """The first event that does not arrive in the smallest set of `needs`."""
        number = self.solver.number(automaton)
        least = min(needs, key=lambda events: (len(events), sorted(events)))
        return next(event for event in sorted(least) if not self.solver.read(number, event))


def may_be_sent(system: System, automaton: SystemAutomaton, event: ProtocolEvent) -> bool:
    """Whether an unreadable part of the system may send `event` to `automaton`."""
    if event.part is ProtocolPart.EVENT:
        return system.may(GapAct.SENDS, event.name)
    if event.part in (ProtocolPart.THREAD_START, ProtocolPart.THREAD_FREE):
        acts: tuple[Act, ...] = (InterfaceAct(SymbolKind.ACTION_SERVER, event.part),)
        name = next(
            (automaton.interface_name(use) for use in automaton.outline.interfaces if use.handle == event.name), ""
        )
    else:
        sender = _SENDERS.get(event.part) or _SERVERS[event.part]
        acts = tuple(InterfaceAct(sender, part) for part in _ANSWERS.get(event.part, (event.part,)))
        channel = channel_of(system, automaton, event)
        name = channel.name if channel else ""
    return any(system.may(act, name or "") for act in acts)


def is_readable(system: System, automaton: SystemAutomaton) -> bool:
    """Whether everything that an automaton receives and sends can be read; the fields of sent messages are ignored."""
    return id(automaton) not in system.partly_read


def promises(server: ChannelEndpoint, event: ProtocolEvent) -> Iterator[Promise]:
    """The delayed answers of a server that a client receives as `event`."""
    for chart in server.automaton.outline.charts:
        for promise in chart.promises:
            if promise.duty == (_PROMISED[event.part], server.use.handle):
                yield promise


def server_of(system: System, automaton: SystemAutomaton, event: ProtocolEvent) -> ChannelEndpoint | None:
    channel = channel_of(system, automaton, event)
    return channel.sources[0] if channel and channel.sources else None


def is_clock(system: System, automaton: SystemAutomaton, event: ProtocolEvent) -> bool:
    if event.part is not ProtocolPart.MESSAGE:
        return False
    uses = (
        use for use in automaton.outline.interfaces if use.kind is SymbolKind.SUBSCRIBER and use.handle == event.name
    )
    return any(sanitise(automaton.interface_name(use) or "") == CLOCK_TOPIC for use in uses)


def _below(system: System, plugin: SystemAutomaton) -> Iterator[SystemAutomaton]:
    """The automata of the nodes below the node of `plugin` in the tree."""
    waiting = list(plugin.instance.children) if plugin.instance else []
    while waiting:
        automaton = system.by_instance.get(waiting.pop())
        if automaton is not None and automaton.instance is not None:
            yield automaton
            waiting += automaton.instance.children


_ENDING = frozenset(["Sequence", "SequenceWithMemory", "SequenceStar", "Fallback"])
"""The nodes that tick a child only after the one that they have ticked before has ended."""


def _ends_before(system: System, earlier: SystemAutomaton, plugin: SystemAutomaton) -> bool:
    """Whether a node of the tree has ended or is halted when `plugin` is ticked: both are below different children of a
    node that continues only after a child has ended."""
    above, own = _path(system, earlier), _path(system, plugin)
    shared = [node for node in above if node in own]
    return bool(shared) and shared[0] not in (above[0], own[0]) and shared[0].plugin in _ENDING


def _path(system: System, automaton: SystemAutomaton) -> list[Instance]:
    """The node of an automaton and all nodes above it, the root last."""
    path: list[Instance] = []
    found: SystemAutomaton | None = automaton
    while found is not None and found.instance is not None:
        path.append(found.instance)
        parent = found.instance.parent
        found = system.by_instance.get(parent) if parent is not None else None
    return path


# ------------------------------------------- while a machine stays in one state


def can_arrive_again(
    system: System, receiver: SystemAutomaton, chart: int, event: ProtocolEvent, sent: frozenset[ProtocolEvent]
) -> bool:
    """Whether `event` may be sent a second time while a chart of `receiver` stays in one state. The chart has received
    `event` once and has sent the events `sent` since then. Time may pass (docs/spec/semantics.md#time).

    Args:
        chart: the index of the chart in the outline. If it is a thread with several copies, the other copies may still
            move.
    """
    copies = [1, *(thread.count for thread in receiver.outline.threads)]
    frozen = receiver.outline.charts[chart] if copies[chart] == 1 else None
    again = _Again(system, receiver, frozen, sent)
    solver = _Solver(system, again.holds)
    if is_clock(system, receiver, event) or (event.part is ProtocolPart.EVENT and event in sent):
        return True
    senders = list(solver.senders(receiver, event))
    if may_be_sent(system, receiver, event) or not all(is_readable(system, sender) for sender, _ in senders):
        return True
    if any(sender is receiver and sent_event in sent for sender, sent_event in senders):
        return True
    # Each copy of a thread is a separate sender.
    several = len(senders) > 1 or (event.part is ProtocolPart.THREAD_FREE and max(copies[1:], default=1) > 1)
    for sender, sent_event in senders:
        number = solver.number(sender)
        if several and any(solver.solve(number, cause) for cause in again.causes(sender, sent_event)):
            return True
        for outline in again.moving(sender):
            needs = dict(outline.repeats).get(sent_event, frozenset())
            if any(all(solver.solve(number, need) for need in alternative) for alternative in needs):
                return True
    return False


def may_be_sent_repeatedly(system: System, receiver: SystemAutomaton, event: ProtocolEvent) -> bool:
    """Whether an automaton may send `event`, which `receiver` receives, more than once."""
    if is_clock(system, receiver, event) or may_be_sent(system, receiver, event):
        return True
    for sender, sent_event in senders(system, receiver, event):
        repeats = [dict(chart.repeats).get(sent_event) for chart in sender.outline.charts]
        known = [needs for needs in repeats if needs is not None]
        if not known or any(known) or not is_readable(system, sender):
            return True
    return False


class _Again(Record, frozen=True, eq=False):
    """What can happen while one chart stays in one state (`can_arrive_again`).

    Attributes:
        frozen: the outline of this chart; `None` if other copies of the thread may move.
    """

    system: System
    receiver: SystemAutomaton
    frozen: ChartOutline | None
    sent: frozenset[ProtocolEvent]

    def moving(self, automaton: SystemAutomaton) -> Iterator[ChartOutline]:
        """The charts of an automaton that may change their states."""
        for outline in automaton.outline.charts:
            if automaton is not self.receiver or outline is not self.frozen:
                yield outline

    def causes(self, automaton: SystemAutomaton, sent_event: ProtocolEvent) -> Iterator[ProtocolEvent]:
        """The events in reaction to which an automaton sends an event."""
        for outline in self.moving(automaton):
            yield from (cause for cause, event in outline.reactions if event == sent_event)

    def holds(self, solver: _Solver, number: int, awaited: ProtocolEvent) -> bool:
        """Whether an event may arrive at an automaton of the system."""
        automaton = self.system.automata[number]
        if awaited == START or awaited.part in _OF_THE_TREE:
            return True
        if is_clock(self.system, automaton, awaited) or may_be_sent(self.system, automaton, awaited):
            return True
        if awaited.part in _PROMISED:
            server = server_of(self.system, automaton, awaited)
            if server is None:
                return False
            answers = [(server.automaton, ProtocolEvent(part, server.use.handle)) for part in _ANSWERS[awaited.part]]
        else:
            answers = list(solver.senders(automaton, awaited))
        for sender, answer in answers:
            if (sender is self.receiver and answer in self.sent) or not is_readable(self.system, sender):
                return True
            if any(solver.read(solver.number(sender), cause) for cause in self.causes(sender, answer)):
                return True
        return False


_OF_THE_TREE = (
    ProtocolPart.TICK,
    ProtocolPart.BT_TICK,
    ProtocolPart.BT_HALT,
    ProtocolPart.CHILD_STATUS,
    ProtocolPart.CHILD_HALTED,
)

# SPDX-License-Identifier: Apache-2.0
"""The content of a timeline, read from the steps of a run.

Steps are read once and in their order, so that a timeline of a long run can be continued. If the steps after an earlier
position are replaced, because the user has chosen another step there, the timeline is read again from the start.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator

from roaml.record import Record, field
from roaml.scxml.names import (
    ACTION_HANDLER_PREFIX,
    CLOCK,
    NODE_AUTOMATON,
    SERVICE_HANDLER_PREFIX,
    STATUS_NAMES,
    TreeEventKind,
    is_blackboard,
    is_length,
    is_timer,
    read_tree_event,
    received_by,
    sent_by,
)
from roaml.simulation.session import Session
from roaml.smc.record import TraceStep
from roaml.views.event_words import interface_name
from roaml.views.events import EventReader
from roaml.views.shared_names import field_name

IDLE = "IDLE"


class LaneKind(enum.Enum):
    MACHINE = "machine"
    NODE = "node"


class Lane(Record):
    """The states of a machine or plugin, or the statuses of a tree node.

    Attributes:
        automaton: the name of the automaton that is in these states.
        starts: the numbers of the steps that changed the state; the first is 0, for the initial state.
        states: the state after each of these steps.
        ranks: state -> its number, from 0, in the order in which states are first entered.
    """

    name: str
    kind: LaneKind
    automaton: str
    starts: list[int] = field(default_factory=list)
    states: list[str] = field(default_factory=list)
    ranks: dict[str, int] = field(default_factory=dict)

    def enter(self, step: int, state: str) -> None:
        if not self.states or self.states[-1] != state:
            self.starts.append(step)
            self.states.append(state)
            self.ranks.setdefault(state, len(self.ranks))


class SentMessage(Record, frozen=True):
    """An event from one lane to others.

    Attributes:
        name: the name of the topic, of the part of a service or action, such as `/hand_over response`, or of the event.
        sent, received: the numbers of the steps that sent and received the event.
        sender, receivers: the indexes of the lanes in `Timeline.lanes`.
    """

    name: str
    sent: int
    received: int
    sender: int
    receivers: tuple[int, ...]


class Plot(Record):
    """The values of a number or a Boolean, each with the number of the step that assigned it; the first is the value
    before the run, with step 0. It is a variable, or a field of the last message of a topic, service or action.
    `is_flag` states whether it is a Boolean."""

    name: str
    is_flag: bool
    steps: list[int]
    values: list[float]


class Timeline:
    """The content of a timeline.

    Attributes:
        count: the number of steps that have been read.
        times: the time in s before the first step, and after each step; empty if the model has no clock.
        lanes: first those of the machines, then those of the tree nodes.
        messages: the messages that have been received, in this order.
    """

    def __init__(self, session: Session) -> None:
        self._begin(session)

    def _begin(self, session: Session) -> None:
        self._last: TraceStep | None = None
        self.count = 0
        automata = session.automata_of_model
        self._automata = [automaton.name for automaton in automata]
        self._events = EventReader(automata, session.start)
        self._clock = session.clock
        self._clock_values = dict.fromkeys(self._clock, 0.0)
        self.times: list[float] = [0.0] if self._clock else []
        self._is_state = session.is_state
        self.lanes: list[Lane] = []
        self._lane_of: dict[int, int] = {}
        self._nodes: dict[int, int] = {}
        self._begin_lanes(session)
        self.messages: list[SentMessage] = []
        self._sent: dict[str, tuple[int, int]] = {}
        self._held: dict[int, tuple[int, int]] = {}
        self._plots: dict[tuple[int, str], Plot] = {}

    def _begin_lanes(self, session: Session) -> None:
        """The lanes before the first step: first the machines, then the nodes of the tree by their numbers."""
        machines = [instance for instance in range(len(self._automata)) if session.is_machine(instance)]
        nodes = {i: match for i, name in enumerate(self._automata) if (match := NODE_AUTOMATON.fullmatch(name))}
        self._machines = frozenset(machines) - nodes.keys()
        for instance in machines:
            if instance in self._machines:
                self._add(session, instance, LaneKind.MACHINE)
                self.lanes[-1].enter(0, session.state_of(instance, session.first_locations[instance]))
        for instance, match in sorted(nodes.items(), key=lambda node: int(node[1][1])):
            self._nodes[int(match[1])] = len(self.lanes)
            self._add(session, instance, LaneKind.NODE)
            self.lanes[-1].enter(0, IDLE)
        self._plotted = {
            instance: "" if is_blackboard(name) else f"{session.names[name]}."
            for instance, name in enumerate(self._automata)
            if is_blackboard(name) or instance in machines
        }
        self._phrases = {instance: session.phrases(self._automata[instance]) for instance in self._plotted}
        self._names = dict.fromkeys(self._automata, "")
        self._fields = dict(self._field_names())

    def _field_names(self) -> Iterator[tuple[str, str]]:
        """The variables with the fields of messages, and their names for users, such as `/arm/command.data`."""
        for event, variable, part in self._events.fields():
            if name := field_name(event, part, self._names):
                yield variable, name

    def _add(self, session: Session, instance: int, kind: LaneKind) -> None:
        automaton = self._automata[instance]
        self._lane_of[instance] = len(self.lanes)
        self.lanes.append(Lane(session.names[automaton], kind, automaton))

    @property
    def plots(self) -> list[Plot]:
        """The plots of what changes in the run: the variables, ordered by automaton and name, then the fields of
        messages."""
        return [self._plots[key] for key in sorted(self._plots)]

    def follow(self, session: Session) -> None:
        """Read the steps of the run that have not been read yet."""
        steps = session.steps
        if self.count > len(steps) or (self.count and steps[self.count - 1] is not self._last):
            self._begin(session)
        for index in range(self.count, len(steps)):
            self._read(steps[index])
        self.count = len(steps)
        self._last = steps[-1] if steps else None

    def _read(self, step: TraceStep) -> None:
        number = step.number
        self._events.read(step)
        for change in step.changes:
            instance, name = change.variable
            if instance < 0:
                if name in self._clock_values and isinstance(change.after, (int, float)):
                    self._clock_values[name] = change.after
                elif name in self._fields:
                    # The clients of a service have variables of their own for the same field.
                    shown = self._fields[name]
                    self._plot(number, (len(self._automata), shown), shown, change.before, change.after)
            elif instance in self._plotted:
                shown = self._plotted[instance] + self._phrases[instance].get(name, name)
                self._plot(number, change.variable, shown, change.before, change.after)
        if self._clock:
            self.times.append(self._clock_values[self._clock[0]] + self._clock_values[self._clock[1]] / 1e9)
        for part in step.parts:
            if part.instance in self._machines:
                location = part.destination.location
                if self._is_state(part.instance, location):
                    self.lanes[self._lane_of[part.instance]].enter(number, location)
        action = step.action or ""
        if event := sent_by(action):
            self._send(number, event, step)
        elif event := received_by(action):
            self._receive(number, event, step)

    def _plot(self, number: int, key: tuple[int, str], shown: str, before: object, after: object) -> None:
        if not isinstance(before, (bool, int, float)) or not isinstance(after, (bool, int, float)):
            return
        if is_length(key[1]):
            return
        plot = self._plots.get(key)
        if plot is None:
            plot = self._plots[key] = Plot(shown, isinstance(after, bool), [0], [float(before)])
        plot.steps.append(number)
        plot.values.append(float(after))

    def _send(self, number: int, event: str, step: TraceStep) -> None:
        tree = read_tree_event(event)
        if tree is not None:
            if tree.kind is TreeEventKind.RESPONSE:
                status = self._events.parameters(event).get("status")
                self._enter(tree.number, number, STATUS_NAMES.get(status, IDLE) if isinstance(status, int) else IDLE)
            elif tree.kind is TreeEventKind.HALT_RESPONSE:
                self._enter(tree.number, number, IDLE)
            return
        if is_timer(event):
            return
        actors = self._events.actors(step)
        if not actors or actors[0].automaton == CLOCK:
            return
        instance = actors[0].instance
        if instance in self._lane_of:
            self._sent[event] = number, self._lane_of[instance]
        elif instance in self._held:
            self._sent[event] = self._held.pop(instance)

    def _enter(self, node: int, step: int, status: str) -> None:
        if node in self._nodes:
            self.lanes[self._nodes[node]].enter(step, status)

    def _receive(self, number: int, event: str, step: TraceStep) -> None:
        sent = self._sent.pop(event, None)
        if sent is None:
            return
        actors = self._events.actors(step)
        for part in actors:
            if part.automaton.startswith((SERVICE_HANDLER_PREFIX, ACTION_HANDLER_PREFIX)):
                self._held[part.instance] = sent  # it passes the call on
        receivers = tuple(self._lane_of[part.instance] for part in actors if part.instance in self._lane_of)
        if receivers:
            name = field_name(event, "", self._names) or interface_name(event, self._automata)
            name = name or self._events.name(event)
            self.messages.append(SentMessage(name, sent[0], number, sent[1], receivers))

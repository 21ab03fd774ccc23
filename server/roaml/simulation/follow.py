# SPDX-License-Identifier: Apache-2.0
"""Reads the steps of a run and keeps the parts of the state that are not in variables: messages, calls and ticks."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence

from roaml.exhaustive import assert_never
from roaml.jani.model import Automaton
from roaml.jani.node import Origin
from roaml.scxml.names import (
    CLOCK,
    NODE_AUTOMATON,
    RECEIVED,
    STATUS_NAMES,
    TreeEventKind,
    is_blackboard,
    is_generated,
    is_length,
    is_observer,
    is_timer,
    read_tree_event,
    received_by,
    sent_by,
)
from roaml.simulation.state import (
    EventState,
    MachineState,
    NodeState,
    NodeStatus,
    SystemState,
)
from roaml.simulation.words import who
from roaml.smc.record import Plain, RecordedVariable, TraceStep
from roaml.views.arrays import DeclaredValue
from roaml.views.event_words import event_phrase, interface_name
from roaml.views.events import EventReader
from roaml.views.locations import states_of
from roaml.views.turns import is_inner


class Follower:
    """Reads the steps of a run, in their order.

    Attributes:
        position: the number of the steps read so far.
        events: the reader of events, with the last parameters of each event.
        time: the time of the clock in s; `None` if the model has no clock.
        names: the name of each automaton -> its name in texts for users.
    """

    def __init__(
        self, automata: Sequence[Automaton], start: Mapping[str, Plain], clock: tuple[str, str] | None
    ) -> None:
        self.position = 0
        self.events = EventReader(automata, start)
        self.time: float | None = None if clock is None else 0.0
        self._clock = clock
        self._clock_values = dict.fromkeys(clock or (), 0.0)
        self._automata = automata
        self._names = [automaton.name for automaton in automata]
        self._holders = {automaton.name: number for number, automaton in enumerate(automata)}
        self.names = who(automata)
        self._is_machine = [self._executes_machine(automaton) for automaton in automata]
        self._states = [states_of(automaton) for automaton in automata]
        self._sent: dict[str, tuple[int, str, dict[str, DeclaredValue]]] = {}
        self._status: dict[int, NodeStatus] = {}
        self._origin: dict[int, Origin | None] = {}
        self._handles: dict[int, str] = {}
        self._handler: dict[int, Origin | None] = {}

    def copied(self) -> Follower:
        """A follower that has read the same steps and continues independently."""
        other = copy.copy(self)
        other.events = self.events.copied()
        other._clock_values = dict(self._clock_values)
        other._sent, other._status = dict(self._sent), dict(self._status)
        other._origin, other._handles, other._handler = dict(self._origin), dict(self._handles), dict(self._handler)
        return other

    def is_machine(self, instance: int) -> bool:
        """Whether an instance is a state machine or a plugin, not an automaton added by the translation or an
        observer."""
        return self._is_machine[instance]

    def _executes_machine(self, automaton: Automaton) -> bool:
        is_added = is_generated(automaton.name) or is_observer(automaton.name) or self.events.is_event(automaton.name)
        return not is_added and not is_inner(automaton)

    def state_of(self, instance: int, location: str) -> str:
        """The state of a machine to which a location of an instance belongs."""
        return self._states[instance].get(location, location)

    def is_named(self, event: str, name: str) -> bool:
        """Whether `name` denotes an event: it is the name of the event, or of its topic, service or action, with or
        without the leading `/`."""
        interface = interface_name(event, self._names)
        return name in (event, self.events.name(event)) or (bool(interface) and interface == f"/{name.lstrip('/')}")

    def read(self, step: TraceStep) -> None:
        """Read the next step."""
        self.position = step.number
        self.events.read(step)
        for change in step.changes:
            if change.variable.instance < 0 and change.variable.name in self._clock_values:
                assert isinstance(change.after, (int, float))
                self._clock_values[change.variable.name] = change.after
        if self._clock is not None:
            self.time = self._clock_values[self._clock[0]] + self._clock_values[self._clock[1]] / 1e9
        actors = self.events.actors(step)
        received = received_by(step.action or "")
        for part in actors:
            self._origin[part.instance] = part.destination.origin or part.edge.origin
            if received:
                self._handles[part.instance] = received
                self._handler[part.instance] = part.edge.origin
        event = sent_by(step.action or "")
        if event:
            sender = actors[0].automaton if actors else ""
            self._sent.pop(event, None)
            self._sent[event] = step.number, sender, self.events.parameters(event)
            self._follow_tree(event)

    def _follow_tree(self, event: str) -> None:
        tree = read_tree_event(event)
        if tree is None:
            return
        match tree.kind:
            case TreeEventKind.TICK:
                self._status[tree.number] = NodeStatus.TICKED
            case TreeEventKind.RESPONSE:
                status = self.events.parameters(event).get("status")
                name = STATUS_NAMES.get(status, "") if isinstance(status, int) else ""
                self._status[tree.number] = NodeStatus.__members__.get(name, NodeStatus.IDLE)
            case TreeEventKind.HALT_RESPONSE:
                self._status[tree.number] = NodeStatus.IDLE
            case TreeEventKind.HALT:
                pass
            case _:
                assert_never(tree.kind)

    def state(
        self,
        step: int,
        locations: Sequence[str],
        values: Sequence[tuple[RecordedVariable, Plain]],
        resting: Sequence[frozenset[str]],
    ) -> SystemState:
        """The state after the steps read so far.

        Args:
            locations: the location of each instance.
            values: the values of all variables.
            resting: for each instance, the locations in which it waits for events.
        """
        own: dict[int, dict[str, Plain]] = {}
        shared: dict[str, Plain] = {}
        for (instance, name), value in values:
            if instance >= 0:
                if not is_length(name):
                    own.setdefault(instance, {})[name] = value
            elif not self.events.carries_event(name) and not is_length(name):
                shared[name] = value
        boards = [instance for name, instance in self._holders.items() if is_blackboard(name)]
        return SystemState(
            step,
            self.time,
            tuple(self._machines(locations, own, resting)),
            tuple(self._nodes()),
            tuple(self._events(locations)),
            {name: value for board in boards for name, value in own.get(board, {}).items()},
            shared,
        )

    def _machines(
        self, locations: Sequence[str], own: Mapping[int, dict[str, Plain]], resting: Sequence[frozenset[str]]
    ) -> Iterator[MachineState]:
        for number, automaton in enumerate(self._automata):
            if not self._is_machine[number]:
                continue
            location = locations[number]
            is_resting = location in resting[number]
            handled = "" if is_resting else self._handles.get(number, "")
            yield MachineState(
                self.names[automaton.name],
                automaton.name,
                automaton.name if automaton.thread_of else self.names[automaton.name],
                self.state_of(number, location),
                own.get(number, {}),
                self.events.name(handled) if handled else "",
                self._origin.get(number, automaton.origin),
                handled,
                self._handler.get(number) if handled else None,
            )

    def _nodes(self) -> Iterator[NodeState]:
        nodes = [match for name in self._names if (match := NODE_AUTOMATON.fullmatch(name))]
        for match in sorted(nodes, key=lambda match: int(match[1])):
            number = int(match[1])
            yield NodeState(number, match[2], self.names[match[0]], self._status.get(number, NodeStatus.IDLE))

    def _events(self, locations: Sequence[str]) -> Iterator[EventState]:
        for event, (step, sender, parameters) in self._sent.items():
            if sender == CLOCK or is_timer(event) or read_tree_event(event):
                continue
            holder = self._holders.get(event)
            yield EventState(
                event,
                self.events.name(event),
                event_phrase(event, self._names),
                self.names[sender] if sender else "",
                parameters,
                step,
                holder is not None and locations[holder] == RECEIVED,
            )

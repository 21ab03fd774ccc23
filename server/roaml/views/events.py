# SPDX-License-Identifier: Apache-2.0
"""The events of a translated system: the variables that contain them, and the parameters with which they were last
sent."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence

from roaml.jani.model import Automaton
from roaml.scxml.names import (
    FIELD_PREFIX,
    client_of,
    flagged_by,
    is_length,
    read_tree_event,
    received_by,
    sent_by,
    without_client,
)
from roaml.smc.record import AutomatonStep, Plain, TraceStep
from roaml.views.arrays import DeclaredValue, declared


class EventReader:
    """Reads the steps of a trace, in their order.

    Args:
        automata: the automaton of each instance.
        start: the variables of the model before the first step.

    Attributes:
        hearing: whether each instance receives any event.
    """

    def __init__(self, automata: Sequence[Automaton], start: Mapping[str, Plain]) -> None:
        actions = [{edge.action or "" for edge in automaton.edges} for automaton in automata]
        self._automata = {automaton.name for automaton in automata}
        self._events = {event for used in actions for action in used if (event := sent_by(action))}
        self.hearing = [any(map(received_by, used)) for used in actions]
        self._values = dict(start)
        self._parameters: dict[str, list[str]] = {event: [] for event in self._events}
        self._variables: dict[str, list[str]] = {event: [] for event in self._events}
        self._of_events = {name for name in self._values if self._is_of_event(name)}

    def copied(self) -> EventReader:
        """A reader that has read the same steps and continues independently."""
        other = copy.copy(self)
        other._values = dict(self._values)
        return other

    def read(self, step: TraceStep) -> None:
        """Store the changes of a step."""
        for change in step.changes:
            if change.variable.instance < 0:
                self._values[change.variable.name] = change.after

    def actors(self, step: TraceStep) -> list[AutomatonStep]:
        """The parts of a step without those of automata that only buffer an event."""
        return [part for part in step.parts if part.automaton not in self._events]

    def is_event(self, name: str) -> bool:
        """Whether the name denotes an event of the system, and so also the automaton that buffers the event."""
        return name in self._events

    def carries_event(self, variable: str) -> bool:
        """Whether a variable of the model belongs to an event: it contains a parameter, a length, or whether the event
        is valid."""
        return variable in self._of_events

    def parameters(self, event: str) -> dict[str, DeclaredValue]:
        """The parameters with which an event was last sent, by their names in the interface."""
        return {
            variable.removeprefix(f"{event}__").removeprefix(FIELD_PREFIX): declared(
                variable, self._values[variable], self._values
            )
            for variable in self._parameters.get(event, ())
        }

    def fields(self) -> Iterator[tuple[str, str, str]]:
        """Each parameter of an event: the event, the variable that contains it, and its name in the interface."""
        for event in sorted(self._parameters):
            for variable in self._parameters[event]:
                yield event, variable, variable.removeprefix(f"{event}__").removeprefix(FIELD_PREFIX)

    def variables(self, event: str) -> Sequence[str]:
        """The variables of the model that contain the parameters of an event and their lengths."""
        return self._variables.get(event, ())

    def name(self, event: str) -> str:
        """The name of an event without the name of the client of a service or action."""
        return without_client(event, client_of(event, self._automata))

    def _is_of_event(self, name: str) -> bool:
        """Whether a variable of the model belongs to an event. If it does, its parameter is stored."""
        if event := flagged_by(name):
            return event in self._events or read_tree_event(event) is not None  # a tree may never send an event
        at = name.rfind("__")
        while at > 0:
            if name[:at] in self._events:
                self._variables[name[:at]].append(name)
                if not is_length(name):
                    self._parameters[name[:at]].append(name)
                return True
            at = name.rfind("__", 0, at)
        return False

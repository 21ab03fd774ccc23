# SPDX-License-Identifier: Apache-2.0
"""The steps of the automata of an explored model, and which of them are taken in some run."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence

from roaml.jani.expressions import Expression
from roaml.jani.model import Assignment, Destination, Edge, Model
from roaml.record import Record
from roaml.scxml.names import SERVICE_HANDLER_PREFIX, handling, received_by, sent_by
from roaml.views.ends import is_event


class ExploredWay(Record, frozen=True, eq=False):
    """A destination of an edge of an automaton.

    Attributes:
        automaton: the name of the automaton.
        is_taken: whether some run takes it.
        in_context: whether some run takes it in the context that is examined; `None` if this is the whole run.
    """

    automaton: str
    edge: Edge
    destination: Destination
    is_taken: bool
    in_context: bool | None = None


class ExploredStep(Record, frozen=True, eq=False):
    """One destination of an edge of an automaton.

    Attributes:
        automaton: the name of the automaton.
        edge: the edge; its destination `destination` is meant.
        order: the index of the edge among those of its location for the same event, or among those without an event.
        is_taken: whether some run takes the step, in the context that is examined.
        is_ever_taken: whether some run takes the step at all.
        is_contextual: whether the context restricts the steps of the automaton.
    """

    automaton: str
    edge: Edge
    destination: Destination
    order: int
    is_taken: bool
    is_ever_taken: bool
    is_contextual: bool

    @property
    def receives(self) -> str:
        """The event that the step receives; "" if there is none."""
        return received_by(self.edge.action or "")

    @property
    def sends(self) -> str:
        """The event that the step sends; "" if there is none."""
        return sent_by(self.edge.action or "")

    @property
    def guard(self) -> Expression | None:
        return None if self.edge.guard is None else self.edge.guard.exp


class ExploredWrite(Record, frozen=True, eq=False):
    """An assignment in a step."""

    step: ExploredStep
    assignment: Assignment


class ExploredVariable(Record, frozen=True):
    """A variable: of an automaton, or of the whole model, as the values that an event carries (`automaton` is "")."""

    automaton: str
    name: str


class ExploredSteps:
    """All steps of the automata of a model, except those that buffer events.

    Args:
        ways: the destinations of all edges.
    """

    def __init__(self, model: Model, ways: Iterable[ExploredWay]) -> None:
        self._automata = {automaton.name: automaton for automaton in model.automata if not is_event(automaton)}
        self._local = {name: {v.name for v in automaton.variables} for name, automaton in self._automata.items()}
        self._initial = {ExploredVariable("", v.name): v.initial_value for v in model.variables}
        for name, automaton in self._automata.items():
            self._initial.update({ExploredVariable(name, v.name): v.initial_value for v in automaton.variables})
        self._leaving: dict[tuple[str, str], list[ExploredStep]] = defaultdict(list)
        self._entering: dict[tuple[str, str], list[ExploredStep]] = defaultdict(list)
        self._sending: dict[str, list[ExploredStep]] = defaultdict(list)
        self._writing: dict[ExploredVariable, list[ExploredWrite]] = defaultdict(list)
        self._at: dict[object, list[ExploredStep]] = defaultdict(list)
        for step in _numbered(way for way in ways if way.automaton in self._automata):
            self._add(step)

    def _add(self, step: ExploredStep) -> None:
        self._leaving[step.automaton, step.edge.source].append(step)
        self._entering[step.automaton, step.destination.location].append(step)
        self._at[step.edge.origin].append(step)
        if step.sends:
            self._sending[step.sends].append(step)
        for assignment in step.destination.assignments:
            self._writing[self.variable(step, assignment.variable)].append(ExploredWrite(step, assignment))

    def leaving(self, automaton: str, location: str) -> Sequence[ExploredStep]:
        """The steps from a location."""
        return self._leaving.get((automaton, location), ())

    @property
    def automata(self) -> Collection[str]:
        return self._automata.keys()

    def waiting(self) -> Iterator[tuple[str, str]]:
        """The automata and their locations in which they can receive events."""
        return (place for place, steps in self._leaving.items() if any(step.receives for step in steps))

    def leaves(self, step: ExploredStep) -> bool:
        """Whether a step, with the steps that only end it, leads to another location that receives events, or to an
        end."""
        seen, open_ = set[str](), [step.destination.location]
        while open_:
            location = open_.pop()
            if location == step.edge.source or location in seen:
                continue
            seen.add(location)
            following = self.leaving(step.automaton, location)
            if not following or any(other.receives for other in following):
                return True
            open_ += [other.destination.location for other in following]
        return False

    def is_last(self, automaton: str, location: str) -> bool:
        """Whether an automaton in a location comes back to it from all locations that it reaches then in some run."""
        return all(location in self._following(automaton, other) for other in self._following(automaton, location))

    def _following(self, automaton: str, location: str) -> set[str]:
        """The locations that an automaton in a location reaches in some run, with this one."""
        seen, open_ = {location}, [location]
        while open_:
            taken = {step.destination.location for step in self.leaving(automaton, open_.pop()) if step.is_taken}
            open_ += taken - seen
            seen |= taken
        return seen

    def entering(self, automaton: str, location: str) -> Sequence[ExploredStep]:
        """The steps to a location from another one."""
        into = self._entering.get((automaton, location), ())
        return [step for step in into if step.edge.source != location]

    def is_entered(self, automaton: str, location: str) -> bool:
        """Whether some run enters a location."""
        leaving = self.leaving(automaton, location)
        if any(step.is_taken for step in (*leaving, *self._entering.get((automaton, location), ()))):
            return True
        is_contextual = any(step.is_contextual for step in leaving)
        return location in self._automata[automaton].initial_locations and not is_contextual

    def sending(self, event: str) -> Sequence[ExploredStep]:
        """The steps that send an event."""
        return self._sending.get(event, ())

    def events_sent(self) -> Iterable[str]:
        """The events that automata can send."""
        return self._sending.keys()

    def beside(self, step: ExploredStep) -> Sequence[ExploredStep]:
        """The steps, including this one, that are taken in its place for the same event; without an event, the steps
        without an event from the same location."""
        others = self.leaving(step.automaton, step.edge.source)
        return [other for other in others if other.receives == step.receives and bool(other.sends) == bool(step.sends)]

    def of_other_instances(self, step: ExploredStep) -> Iterator[ExploredStep]:
        """The steps of other automata that come from the same place in the source."""
        return (other for other in self._at[step.edge.origin] if other.automaton != step.automaton)

    def variable(self, step: ExploredStep, name: str) -> ExploredVariable:
        """The variable that an automaton means by a name."""
        return ExploredVariable(step.automaton if name in self._local[step.automaton] else "", name)

    def initial(self, variable: ExploredVariable) -> Expression | None:
        """The expression of the initial value of a variable; `None` if it is not known."""
        return self._initial.get(variable)

    def writing(self, variable: ExploredVariable) -> Sequence[ExploredWrite]:
        """The assignments to a variable, or to a part of it."""
        return self._writing.get(variable, ())


def _numbered(ways: Iterable[ExploredWay]) -> Iterator[ExploredStep]:
    edges: dict[tuple[str, str, str], list[Edge]] = defaultdict(list)
    for way in ways:
        known = edges[way.automaton, way.edge.source, received_by(way.edge.action or "")]
        if not known or known[-1] is not way.edge:
            known.append(way.edge)
        is_taken = way.is_taken if way.in_context is None else way.in_context
        yield ExploredStep(
            *(way.automaton, way.edge, way.destination, len(known) - 1),
            is_taken=is_taken,
            is_ever_taken=way.is_taken,
            is_contextual=way.in_context is not None,
        )


class ClientRequests(Record, frozen=True):
    """The requests of one client of a service.

    Attributes:
        handler: the automaton that passes requests and responses on.
        location: the location of the handler while the server handles the request.
        server: the automaton of the server.
    """

    handler: str
    location: str
    server: str


def requests_of(steps: ExploredSteps, client: str) -> Iterator[ClientRequests]:
    """The requests of an automaton, for each service with one server."""
    location = handling(client)
    for handler in steps.automata:
        answered = steps.leaving(handler, location) if handler.startswith(SERVICE_HANDLER_PREFIX) else ()
        servers = {sender.automaton for step in answered for sender in steps.sending(step.receives)}
        if len(servers) == 1:
            yield ClientRequests(handler, location, servers.pop())

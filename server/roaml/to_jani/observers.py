# SPDX-License-Identifier: Apache-2.0
"""Translates properties in XML to observers, and to JANI properties about the variables of the observers
(docs/spec/jani.md#observers).

- An observer is an automaton that takes part in existing synchronisations. It has one location and no guards, so it
  neither removes nor adds steps of the model.
- The assignments of an observer are executed after all others of a synchronisation, so they read the values that are
  sent.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from roaml.expr.format import format_expr
from roaml.jani.model import (
    Assignment,
    Model,
    Sync,
)
from roaml.jani.node import Origin
from roaml.jani.operators import BinaryOperator as JaniBinary
from roaml.jani.properties import (
    BinaryFormula,
    Filter,
    FilterFunction,
    Formula,
    Predicate,
    Probability,
    ProbabilityOperator,
    Property,
    StatePredicate,
)
from roaml.record import Record, replace
from roaml.scxml.names import (
    CLOCK,
    CLOCK_ACTION,
    TIME_OVER_ACTION,
    assumptions_of,
    named,
    on_send,
)
from roaml.scxml.observed import ObservedPort, ObservedProperty, PortEvent
from roaml.to_jani.end_of_time import with_end_of_time
from roaml.to_jani.observed_values import observed_values
from roaml.to_jani.observer_parts import ObserverParts, free_prefix, next_index, with_observer
from roaml.to_jani.shapes import ArrayShape


def observed(
    model: Model,
    properties: Sequence[ObservedProperty],
    shapes: Mapping[str, ArrayShape],
    size: int,
    owners: Mapping[str, str],
    *,
    has_activity: bool = False,
) -> Model:
    """A copy of the model with an observer and a JANI property for each of `properties`. A property with assumptions
    has a second JANI property, about its assumptions.

    Args:
        shapes: the shapes of the global variables.
        size: the capacity of arrays that are sent.
        owners: automaton of an action thread -> the automaton of its machine.
        has_activity: whether observers also store whether the property was triggered.
    """
    if not properties:
        return model
    model = with_end_of_time(model)
    first_index = next_index(model)
    paths: dict[str, Formula] = {}
    for property_ in (*_assumptions(properties), *properties):
        writer = _ObserverWriter(model, property_, shapes, size, owners, first_index, has_activity)
        model = writer.written()
        paths[property_.name] = writer.path()
    return replace(model, properties=(*model.properties, *_formulas(properties, paths)))


def _assumptions(properties: Iterable[ObservedProperty]) -> Iterable[ObservedProperty]:
    """The assumptions of all properties, without duplicates."""
    return {assumed.name: assumed for property_ in properties for assumed in property_.assumptions}.values()


def _formulas(properties: Iterable[ObservedProperty], paths: Mapping[str, Formula]) -> Iterator[Property]:
    for property_ in properties:
        assumed = [paths[assumption.name] for assumption in property_.assumptions]
        yield _minimum(property_.name, [paths[property_.name], *assumed], property_.origin, property_.comment or None)
        if assumed:
            yield _minimum(assumptions_of(property_.name), assumed, property_.origin)


def _minimum(name: str, paths: Sequence[Formula], origin: Origin, comment: str | None = None) -> Property:
    """The property `name`: the minimum probability that all path formulas hold."""
    path = paths[0]
    for another in paths[1:]:
        path = BinaryFormula(JaniBinary.AND, path, another)
    probability = Probability(ProbabilityOperator.PMIN, path, origin=origin)
    states = Predicate(StatePredicate.INITIAL)
    values = Filter(FilterFunction.VALUES, probability, states, origin=origin)
    return Property(name, values, comment=comment, origin=origin)


class _Listener(Record, frozen=True, eq=False):
    """A port together with one of its events. Listeners are compared by identity."""

    port: ObservedPort
    event: PortEvent


class _ObserverWriter:
    def __init__(
        self,
        model: Model,
        property_: ObservedProperty,
        shapes: Mapping[str, ArrayShape],
        size: int,
        owners: Mapping[str, str],
        first_index: int,
        has_activity: bool,
    ) -> None:
        self.model = model
        self.property = property_
        self.owners = owners
        self.first_index = first_index
        self.origin = property_.origin
        self.prefix = free_prefix(property_.name, model)
        self.values = observed_values(property_, self.prefix, shapes, size)
        self.parts = ObserverParts(
            property_.property,
            self.prefix,
            self.origin,
            has_clock=any(automaton.name == CLOCK for automaton in model.automata),
            has_activity=has_activity,
            conditions={name: format_expr(condition) for name, condition in property_.conditions.items()},
        )
        self.listeners: dict[str, list[_Listener]] = {}
        for port in property_.ports:
            for event in port.events:
                self.listeners.setdefault(on_send(named(event.name)), []).append(_Listener(port, event))
        self.edges: dict[str, list[Assignment]] = {}
        self.letters: dict[str, dict[tuple[_Listener, ...], str]] = {}

    def written(self) -> Model:
        model = self.model
        variables = (*self.values.declared, *self.parts.variables(self.values.at_start()))
        syncs = tuple(self._joined())
        return with_observer(model, self.prefix, self.edges, variables, syncs, self.origin)

    # --------------------------------------------------------------- edges

    def _joined(self) -> Iterator[Sync]:
        """All synchronisations, with the observer added to those that it observes. The edges of the observer for these
        synchronisations are added to `edges`."""
        index = len(self.model.automata)
        for sync in self.model.system.syncs:
            action = self._action_in(sync)
            yield replace(sync, participants=(*sync.participants, (index, action))) if action else sync

    def _action_in(self, sync: Sync) -> str:
        """The action of the observer in a synchronisation; "" if it does not take part. Its edge is added if it is
        new."""
        for participant, action in sync.participants:
            if action in self.listeners and sync.result == action:
                return self._heard(action, sync)
            if action == CLOCK_ACTION and self.model.automata[participant].name == CLOCK:
                if action not in self.edges:
                    self._letter(action, (), is_tick=True)
                return action
            if action == TIME_OVER_ACTION and self.parts.is_timed:
                if action not in self.edges:
                    self.edges[action] = list(self.parts.end_of_time(self.first_index))
                return action
        return ""

    def _heard(self, action: str, sync: Sync) -> str:
        """The action of the observer if an event is sent in a synchronisation; "" if no port listens to it. Each
        combination of listeners has its own action and edge."""
        heard = tuple(listener for listener in self.listeners[action] if self._is_sender(listener.event, sync))
        if not heard:
            return ""
        letters = self.letters.setdefault(action, {})
        if heard not in letters:
            letters[heard] = f"{action}_{self.prefix}_{len(letters)}" if letters else action
            self._letter(letters[heard], heard)
        return letters[heard]

    def _is_sender(self, event: PortEvent, sync: Sync) -> bool:
        """Whether the sender that the port selects, or a thread of it, takes part in a synchronisation."""
        if not event.sender:
            return True
        names = (self.model.automata[participant].name for participant, _ in sync.participants)
        return any(self.owners.get(name, name) == event.sender for name in names)

    def _letter(self, action: str, heard: Iterable[_Listener], is_tick: bool = False) -> None:
        assignments: list[Assignment] = []
        true_events: set[str] = set()
        for listener in heard:
            for variable in listener.port.variables:
                if variable.initial is None:
                    true_events.add(variable.id)
                for target, value in self.values.assigned_on(listener.event, variable):
                    assignments.append(Assignment(target, value, self.first_index, origin=self.origin))
        conditions = self.values.conditions(frozenset(true_events))
        letter = self.parts.letter(conditions, self.first_index + 1, is_tick=is_tick)
        self.edges[action] = [*assignments, *letter]

    def path(self) -> Formula:
        """The path formula that is true if the property holds."""
        return self.parts.path()

# SPDX-License-Identifier: Apache-2.0
"""Properties in XML -> automata that observe the others, and properties about their variables
(docs/spec/jani.md#observers).

- An observer joins existing synchronisations, in its only location and without a guard: it removes no step of the model
  and adds none.
- Its assignments are executed after all others of a synchronisation, so they read the values that are sent.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from roaml.jani import expressions as jani
from roaml.jani.expressions import Expression, Integer
from roaml.jani.model import (
    Action,
    Assignment,
    Automaton,
    Destination,
    Edge,
    Element,
    Location,
    Model,
    Sync,
    System,
    Variable,
)
from roaml.jani.node import Origin
from roaml.jani.operators import BinaryOperator as JaniBinary
from roaml.jani.operators import UnaryOperator as JaniUnary
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
    UnaryFormula,
    UnaryPath,
    UnaryPathOperator,
)
from roaml.jani.types import BOOL, INT, BoundedType, Type
from roaml.observers import program
from roaml.observers.build import begin, observer_of
from roaml.observers.program import Observer, simplified
from roaml.observers.properties import Pattern, PatternProperty, ScopeKind
from roaml.scxml.names import (
    ASKED,
    CLOCK,
    CLOCK_ACTION,
    OBSERVER_SUFFIX,
    OPEN,
    OPENED,
    PENDING,
    assumptions_of,
    named,
    observer_variable,
    on_send,
)
from roaml.scxml.observed import ObservedPort, ObservedProperty, PortEvent
from roaml.to_jani.end_of_time import TIME_OVER_ACTION, with_end_of_time
from roaml.to_jani.observed_values import observed_values
from roaml.to_jani.shapes import ArrayShape

_OBSERVING = "observing"
"""The only location of an observer."""
_OVER = "over"
"""A variable of the observer: the clock has ended."""


def observed(
    model: Model,
    properties: Sequence[ObservedProperty],
    shapes: Mapping[str, ArrayShape],
    size: int,
    owners: Mapping[str, str],
    *,
    has_activity: bool = False,
) -> Model:
    """The model with an observer and a property for each of the properties; two properties for one with assumptions.

    Args:
        has_activity: whether observers also say whether the property was triggered.
        shapes: the shapes of the global variables.
        size: the capacity of arrays that are sent.
        owners: the automaton of the machine, for each automaton that is a thread of one.
    """
    if not properties:
        return model
    model = with_end_of_time(model)
    first_index = 1 + max((assignment.index for assignment in _assignments(model)), default=-1)
    paths: dict[str, Formula] = {}
    for property_ in (*_assumptions(properties), *properties):
        writer = _ObserverWriter(model, property_, shapes, size, owners, first_index, has_activity)
        model = writer.written()
        paths[property_.name] = writer.path()
    return replace(model, properties=(*model.properties, *_formulas(properties, paths)))


def _assumptions(properties: Iterable[ObservedProperty]) -> Iterable[ObservedProperty]:
    """The assumptions of all properties, each once."""
    return {assumed.name: assumed for property_ in properties for assumed in property_.assumptions}.values()


def _formulas(properties: Iterable[ObservedProperty], paths: Mapping[str, Formula]) -> Iterator[Property]:
    for property_ in properties:
        assumed = [paths[assumption.name] for assumption in property_.assumptions]
        yield _minimum(property_.name, [paths[property_.name], *assumed], property_.origin, property_.comment or None)
        if assumed:
            yield _minimum(assumptions_of(property_.name), assumed, property_.origin)


def _minimum(name: str, paths: Sequence[Formula], origin: Origin, comment: str | None = None) -> Property:
    """The minimum probability that all formulas hold."""
    path = paths[0]
    for another in paths[1:]:
        path = BinaryFormula(JaniBinary.AND, path, another)
    probability = Probability(ProbabilityOperator.PMIN, path, origin=origin)
    states = Predicate(StatePredicate.INITIAL)
    values = Filter(FilterFunction.VALUES, probability, states, origin=origin)
    return Property(name, values, comment=comment, origin=origin)


def _assignments(model: Model) -> Iterator[Assignment]:
    return (
        assignment
        for automaton in model.automata
        for edge in automaton.edges
        for destination in edge.destinations
        for assignment in destination.assignments
    )


def _free_prefix(property_: str, model: Model) -> str:
    """A prefix of names, derived from the name of a property, that no automaton and no variable of the model has."""
    names = [*(automaton.name for automaton in model.automata), *(variable.name for variable in model.variables)]
    prefix = re.sub(r"[^A-Za-z0-9_.-]", "_", property_)
    while any(name == prefix or name.startswith((f"{prefix}__", f"{prefix}.")) for name in names):
        prefix += "_"
    return prefix


@dataclass(frozen=True, slots=True, eq=False)
class _Listener:
    """A port and one of its events. Listeners are compared by identity."""

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
        self.has_activity = has_activity
        self.model = model
        self.property = property_
        self.owners = owners
        self.first_index = first_index
        self.origin = property_.origin
        self.prefix = _free_prefix(property_.name, model)
        self.values = observed_values(property_, self.prefix, shapes, size)
        self.observer: Observer = observer_of(property_.property)
        self.outputs = self.observer.outputs
        self.has_clock = any(automaton.name == CLOCK for automaton in model.automata)
        self.is_timed = self.outputs.pending != self.outputs.due and self.has_clock
        self.is_reachability = not self.is_timed and _is_existence(property_)
        self.is_pending = self.outputs.pending != program.FALSE and not self.is_reachability
        self.needed = self._needed()
        self.listeners: dict[str, list[_Listener]] = {}
        for port in property_.ports:
            for event in port.events:
                self.listeners.setdefault(on_send(named(event.name)), []).append(_Listener(port, event))
        self.edges: dict[str, Edge] = {}
        self.letters: dict[str, dict[tuple[_Listener, ...], str]] = {}

    def written(self) -> Model:
        model = self.model
        variables = (*model.variables, *self.values.declared, *self._variables())
        syncs = tuple(self._joined())
        observer = Automaton(
            f"{self.prefix}{OBSERVER_SUFFIX}",
            (Location(_OBSERVING, origin=self.origin),),
            (_OBSERVING,),
            tuple(self.edges.values()),
            origin=self.origin,
        )
        known_actions = {action.name for action in model.actions}
        return replace(
            model,
            automata=(*model.automata, observer),
            system=System((*model.system.elements, Element(observer.name)), syncs),
            variables=variables,
            actions=(*model.actions, *(Action(action) for action in self.edges if action not in known_actions)),
        )

    def _named(self, register: str) -> str:
        outputs = self.outputs
        if outputs.exercised is not None and register == outputs.exercised.name:
            # Without requests, all that can be missing is the scope.
            register = ASKED if self._has_requests() else OPENED
        return observer_variable(self.prefix, register)

    def _has_requests(self) -> bool:
        pattern = self.property.property
        return isinstance(pattern, PatternProperty) and pattern.pattern.is_binary

    # ----------------------------------------------------------- variables

    def _needed(self) -> set[str]:
        """The registers on which the property depends."""
        if self.is_reachability:
            assert self.outputs.satisfied is not None
            needed = {self.outputs.satisfied.name}
        else:
            due = self.outputs.due if self.is_timed else program.FALSE
            needed = {self.outputs.violated.name} | _registers(self.outputs.pending) | _registers(due)
        if self.has_activity:
            needed |= {each.name for each in (self.outputs.exercised, self.outputs.opened) if each is not None}
        while True:
            read = {
                name
                for assignment in self.observer.assignments
                if assignment.register.name in needed
                for name in _registers(assignment.value)
            }
            if read <= needed:
                return needed
            needed |= read

    def _variables(self) -> Iterator[Variable]:
        state = begin(self.observer, self.values.at_start())
        for register in self.observer.registers:
            if register.name in self.needed:
                type_ = BOOL if register.limit is None else BoundedType(INT, Integer(0), Integer(register.limit))
                yield self._variable(self._named(register.name), type_, state[register.name])
        if self.is_pending:
            pending = program.evaluate(self.outputs.pending, state, {}, False)
            yield self._variable(observer_variable(self.prefix, PENDING), BOOL, pending)
            if self.is_timed:
                yield self._variable(self._named(_OVER), BOOL, False)
                yield self._variable(observer_variable(self.prefix, OPEN), BOOL, False)

    def _variable(self, name: str, type_: Type, value: bool | int) -> Variable:
        return Variable(name, type_, _literal(value), origin=self.origin)

    # --------------------------------------------------------------- edges

    def _joined(self) -> Iterator[Sync]:
        """All synchronisations; the observer has an edge for each combination of listeners to one."""
        index = len(self.model.automata)
        for sync in self.model.system.syncs:
            action = self._action_in(sync)
            yield replace(sync, participants=(*sync.participants, (index, action))) if action else sync

    def _action_in(self, sync: Sync) -> str:
        """The observer's action in a synchronisation; "" if the observer does not take part."""
        for participant, action in sync.participants:
            if action in self.listeners and sync.result == action:
                return self._heard(action, sync)
            if action == CLOCK_ACTION and self.model.automata[participant].name == CLOCK:
                if action not in self.edges:
                    self._letter(action, (), is_tick=True)
                return action
            if action == TIME_OVER_ACTION and self.is_timed:
                if action not in self.edges:
                    self._end_of_time()
                return action
        return ""

    def _heard(self, action: str, sync: Sync) -> str:
        """The observer's action when events are sent: one for each combination of listeners."""
        heard = tuple(listener for listener in self.listeners[action] if self._is_sender(listener.event, sync))
        if not heard:
            return ""
        letters = self.letters.setdefault(action, {})
        if heard not in letters:
            letters[heard] = f"{action}_{self.prefix}_{len(letters)}" if letters else action
            self._letter(letters[heard], heard)
        return letters[heard]

    def _is_sender(self, event: PortEvent, sync: Sync) -> bool:
        """Whether the sender of the event, or one of its threads, takes part in a synchronisation."""
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
        letter: dict[program.Expression, Expression] = {program.Tick(): _literal(is_tick)}
        for name, condition in self.values.conditions(frozenset(true_events)).items():
            letter[program.Input(name)] = condition
        known: dict[program.Expression, program.Expression] = {
            source: program.Literal(value.value) for source, value in letter.items() if isinstance(value, jani.Boolean)
        }
        index = self.first_index + 1
        for assignment in self.observer.assignments:
            simpler = simplified(assignment.value, known)
            if assignment.register.name in self.needed and simpler != assignment.register:
                assignments.append(self._assign(assignment.register.name, self._translated(simpler, letter), index))
                index += 1
        self._edge(action, [*assignments, *self._ends(index)])

    def _end_of_time(self) -> None:
        over = self._assign(_OVER, _literal(True), self.first_index)
        self._edge(TIME_OVER_ACTION, [over, *self._ends(self.first_index + 1)])

    def _ends(self, index: int) -> list[Assignment]:
        """The verdict of the property if the trace ends now."""
        if not self.is_pending:
            return []
        pending = self._translated(self.outputs.pending, {})
        if not self.is_timed:
            return [self._assign(PENDING, pending, index)]
        due, over = self._translated(self.outputs.due, {}), jani.Name(self._named(_OVER))
        is_due = _or(_not(over), due)
        is_open = _and(over, _and(pending, _not(due)))
        return [
            self._assign(PENDING, _and(pending, is_due), index),
            self._assign(OPEN, is_open, index),
        ]

    def _assign(self, register: str, value: Expression, index: int) -> Assignment:
        return Assignment(jani.Name(self._named(register)), value, index, origin=self.origin)

    def _edge(self, action: str, assignments: Iterable[Assignment]) -> None:
        destination = Destination(_OBSERVING, assignments=tuple(assignments), origin=self.origin)
        self.edges[action] = Edge(_OBSERVING, (destination,), action, origin=self.origin)

    def _translated(
        self, expression: program.Expression, letter: Mapping[program.Expression, Expression]
    ) -> Expression:
        """
        Args:
            letter: the inputs and the tick.
        """
        match expression:
            case program.Literal():
                return _literal(expression.value)
            case program.Register():
                return jani.Name(self._named(expression.name))
            case program.Input() | program.Tick():
                return letter[expression]
            case program.Negation():
                return _not(self._translated(expression.operand, letter))
            case program.Choice():
                parts = (expression.test, expression.then, expression.otherwise)
                return jani.Conditional(*(self._translated(part, letter) for part in parts))
            case program.Binary():
                left, right = (self._translated(part, letter) for part in (expression.left, expression.right))
                return jani.Binary(_OPERATORS[expression.operator], left, right)

    # ---------------------------------------------------------- the property

    def path(self) -> Formula:
        """The formula over paths that says that the property holds."""
        path: Formula
        if self.is_reachability:
            assert self.outputs.satisfied is not None
            path = UnaryPath(UnaryPathOperator.FINALLY, jani.Name(self._named(self.outputs.satisfied.name)))
        else:
            sound = _not(jani.Name(self._named(self.outputs.violated.name)))
            path = UnaryPath(UnaryPathOperator.GLOBALLY, sound)
            if self.is_pending:
                stays = UnaryPath(UnaryPathOperator.GLOBALLY, jani.Name(observer_variable(self.prefix, PENDING)))
                lasting = UnaryPath(UnaryPathOperator.FINALLY, stays)
                path = BinaryFormula(JaniBinary.AND, path, UnaryFormula(JaniUnary.NOT, lasting))
        return path


def _is_existence(property_: ObservedProperty) -> bool:
    """Whether the property requires an event or condition at some time."""
    pattern = property_.property
    return (
        isinstance(pattern, PatternProperty)
        and pattern.pattern is Pattern.EXISTENCE
        and pattern.scope is ScopeKind.GLOBALLY
    )


_OPERATORS = {
    program.BinaryOperator.AND: JaniBinary.AND,
    program.BinaryOperator.OR: JaniBinary.OR,
    program.BinaryOperator.EQUAL: JaniBinary.EQUAL,
    program.BinaryOperator.LESS_EQUAL: JaniBinary.LESS_EQUAL,
    program.BinaryOperator.ADD: JaniBinary.ADD,
    program.BinaryOperator.SUBTRACT: JaniBinary.SUBTRACT,
}


def _registers(expression: program.Expression) -> set[str]:
    match expression:
        case program.Register():
            return {expression.name}
        case program.Negation():
            return _registers(expression.operand)
        case program.Choice():
            return _registers(expression.test) | _registers(expression.then) | _registers(expression.otherwise)
        case program.Binary():
            return _registers(expression.left) | _registers(expression.right)
        case program.Literal() | program.Input() | program.Tick():
            return set()


def _literal(value: bool | int) -> Expression:
    return jani.Boolean(value) if isinstance(value, bool) else Integer(value)


def _not(operand: Expression) -> Expression:
    return jani.Unary(JaniUnary.NOT, operand)


def _and(left: Expression, right: Expression) -> Expression:
    return jani.Binary(JaniBinary.AND, left, right)


def _or(left: Expression, right: Expression) -> Expression:
    return jani.Binary(JaniBinary.OR, left, right)

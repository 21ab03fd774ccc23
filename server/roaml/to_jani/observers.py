# SPDX-License-Identifier: Apache-2.0
"""Properties in XML -> automata that observe the others, and properties about their variables
(docs/spec/jani.md#observers).

- An observer joins synchronisations that are there, in its only location and without a guard: it takes away no step of
  the model and adds none.
- Its assignments come after all others of a synchronisation, so they see what is sent.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from roaml.expr.transform import map_children
from roaml.expr.tree import Boolean, Conditional, Expr, Number
from roaml.expr.tree import Name as NameExpr
from roaml.expr.types import is_kind
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
from roaml.jani.semantics import evaluate
from roaml.jani.types import BOOL, INT, BoundedType
from roaml.observers import program
from roaml.observers.build import begin, observer_of
from roaml.observers.program import Observer, simplified
from roaml.observers.properties import ScopeKind
from roaml.scxml.names import CLOCK, CLOCK_ACTION, TIME_IS_OVER, named, on_send, open_variable
from roaml.scxml.observed import ObservedPort, ObservedProperty, ObservedVariable, PortEvent
from roaml.text import Span
from roaml.to_jani.assignments import stored_in
from roaml.to_jani.shapes import ArrayShape, jani_type, shape_of, zero
from roaml.to_jani.values import JaniScope, elements_as, lengths_as

TIME_OVER_ACTION = "__as2fm__time_is_over"
"""What the clock does at the end of time. It has an action of its own, because no time passes then."""
_OBSERVING = "observing"
_NOWHERE = Span(0, 0)


def observed(
    model: Model, properties: Sequence[ObservedProperty], shapes: Mapping[str, ArrayShape], size: int
) -> Model:
    """The model with an observer and a property for each of the properties.

    Args:
        shapes: of the global variables.
        size: the capacity of arrays that are sent.
    """
    if not properties:
        return model
    model = _with_end_of_time(model)
    taken = {name for a in model.automata for name in (a.name,)} | {v.name for v in model.variables}
    base = 1 + max((a.index for a in _assignments(model)), default=-1)
    for property_ in properties:
        prefix = _prefix(property_.name, taken)
        writer = _Writer(model, property_, prefix, shapes, size, base)
        model = writer.written()
        taken |= {prefix, *(v.name for v in model.variables)}
    return model


def _assignments(model: Model) -> Iterator[Assignment]:
    return (a for automaton in model.automata for e in automaton.edges for d in e.destinations for a in d.assignments)


def _prefix(name: str, taken: set[str]) -> str:
    prefix = re.sub(r"[^A-Za-z0-9_.-]", "_", name)
    while any(other.startswith((f"{prefix}__", f"{prefix}.")) or other == prefix for other in taken):
        prefix += "_"
    return prefix


def _with_end_of_time(model: Model) -> Model:
    """The same model, in which the clock's last step, which takes no time, has an action of its own."""
    index = next((i for i, a in enumerate(model.automata) if a.name == CLOCK), None)
    if index is None:
        return model
    clock = model.automata[index]

    def renamed(edge: Edge) -> Edge:
        is_last = edge.action == CLOCK_ACTION and edge.destinations[0].location == TIME_IS_OVER
        return replace(edge, action=TIME_OVER_ACTION) if is_last else edge

    syncs: list[Sync] = []
    for sync in model.system.syncs:
        syncs.append(sync)
        if (index, CLOCK_ACTION) in sync.participants:
            last = tuple((i, TIME_OVER_ACTION if i == index else action) for i, action in sync.participants)
            syncs.append(replace(sync, participants=last))
    clock = replace(clock, edges=tuple(renamed(edge) for edge in clock.edges))
    automata = (*model.automata[:index], clock, *model.automata[index + 1 :])
    actions = (*model.actions, Action(TIME_OVER_ACTION))
    return replace(model, automata=automata, system=replace(model.system, syncs=tuple(syncs)), actions=actions)


_SCALAR = ArrayShape(BOOL)


@dataclass(frozen=True, slots=True)
class _Source:
    """Where the value of a variable is: an expression over global variables; `copy` is a variable of the observer."""

    value: Expr
    copy: str = ""
    shape: ArrayShape = _SCALAR


class _Writer:
    def __init__(
        self,
        model: Model,
        property_: ObservedProperty,
        prefix: str,
        shapes: Mapping[str, ArrayShape],
        size: int,
        base: int,
    ) -> None:
        self.model = model
        self.property = property_
        self.prefix = prefix
        self.size = size
        self.base = base
        self.origin = property_.origin
        self.observer: Observer = observer_of(property_.property)
        self.shapes: dict[str, ArrayShape] = dict(shapes)
        self.sources: dict[str, _Source] = {}
        self.variables: list[Variable] = []
        self.edges: list[Edge] = []
        self.outputs = self.observer.outputs
        self.has_clock = any(automaton.name == CLOCK for automaton in model.automata)
        self.is_timed = self.outputs.pending != self.outputs.due and self.has_clock

    def written(self) -> Model:
        self._find_sources()
        state = begin(self.observer, self._at_start())
        needed = self._needed()
        for register in self.observer.registers:
            if register.name in needed:
                type_ = BOOL if register.limit is None else BoundedType(INT, Integer(0), Integer(register.limit))
                self._declare(register.name, type_, _literal(state[register.name]))
        self.needed = needed
        if self.outputs.pending != program.FALSE and not self._is_existence():
            pending = program.evaluate(self.outputs.pending, state, {}, False)
            self._declare("pending", BOOL, _literal(pending))
            if self.is_timed:
                self._declare("over", BOOL, _literal(False))
                self.variables.append(
                    Variable(open_variable(self.property.name), BOOL, _literal(False), origin=self.origin)
                )
        syncs = tuple(self._joined())
        observer = Automaton(
            f"{self.prefix}__observer",
            (Location(_OBSERVING, origin=self.origin),),
            (_OBSERVING,),
            tuple(self.edges),
            origin=self.origin,
        )
        model = self.model
        names = {action.name for action in model.actions}
        actions = dict.fromkeys(edge.action for edge in self.edges if edge.action and edge.action not in names)
        return replace(
            model,
            automata=(*model.automata, observer),
            system=System((*model.system.elements, Element(observer.name)), syncs),
            variables=(*model.variables, *self.variables),
            actions=(*model.actions, *(Action(action) for action in actions)),
            properties=(*model.properties, self._property()),
        )

    def _declare(self, name: str, type_: BoundedType | object, value: Expression) -> None:
        self.variables.append(Variable(self._named(name), type_, value, origin=self.origin))  # type: ignore[arg-type]

    def _named(self, register: str) -> str:
        return f"{self.prefix}__{register}"

    def _needed(self) -> set[str]:
        """The registers that the outputs depend on."""
        needed = {self.outputs.violated.name}
        if self._is_existence():
            assert self.outputs.satisfied is not None
            needed = {self.outputs.satisfied.name}
        else:
            for output in (self.outputs.pending, self.outputs.due if self.is_timed else program.FALSE):
                needed |= _registers(output)
        while True:
            more = {
                name
                for assignment in self.observer.assignments
                if assignment.register.name in needed
                for name in _registers(assignment.value)
            }
            if more <= needed:
                return needed
            needed |= more

    def _is_existence(self) -> bool:
        """Whether the property is that something happens at some time, which needs no more than reachability."""
        property_ = self.property.property
        return (
            getattr(getattr(property_, "pattern", None), "value", "") == "existence"
            and getattr(property_, "scope", None) is ScopeKind.GLOBALLY
            and not self.is_timed
        )

    # ------------------------------------------------------------- values

    def _find_sources(self) -> None:
        for port in self.property.ports:
            for variable in port.variables:
                if variable.initial is not None:
                    self.sources[variable.id] = self._source(port, variable)

    def _source(self, port: ObservedPort, variable: ObservedVariable) -> _Source:
        initial = variable.initial
        assert initial is not None
        shape = shape_of(variable.type, self.size, sent=True)
        if len(port.events) == 1 and not port.events[0].sender and not port.events[0].constants and variable.parameter:
            event = port.events[0].name
            name = f"{event}__{variable.parameter}"
            if name in self.shapes:
                value: Expr = NameExpr(_NOWHERE, name)
                if not self._is_zero(initial, shape):
                    value = Conditional(_NOWHERE, NameExpr(_NOWHERE, f"{event}.valid"), value, initial)
                return _Source(value)
        copy = self._named(variable.id)
        self._declare_copy(copy, shape, initial)
        return _Source(NameExpr(_NOWHERE, copy), copy, shape)

    def _declare_copy(self, name: str, shape: ArrayShape, initial: Expr) -> None:
        self.shapes[name] = shape
        scope = JaniScope({}, "", {})
        array = scope.array(initial)
        value = scope.scalar(initial) if array is None else elements_as(array, shape)
        self.variables.append(Variable(name, jani_type(shape), value, origin=self.origin))
        for k, (length, companion) in enumerate(shape.lengths(name)):
            lengths = Integer(0) if array is None else lengths_as(array, shape, k + 1)
            self.variables.append(Variable(length, jani_type(companion), lengths, origin=self.origin))

    def _is_zero(self, initial: Expr, shape: ArrayShape) -> bool:
        scope = JaniScope({}, "", {})
        array = scope.array(initial)
        if array is not None:
            return not getattr(array, "elements", (None,))
        return bool(evaluate(scope.scalar(initial), {}) == evaluate(zero(shape), {}))

    def _conditions(self, true_events: frozenset[str]) -> dict[program.Expression, Expression]:
        """The inputs of the observer in the letter in which these event variables are true."""
        scope = JaniScope(self.shapes, "", {})

        def change(expr: Expr) -> Expr:
            if isinstance(expr, NameExpr):
                if expr.name in self.sources:
                    return self.sources[expr.name].value
                return Boolean(expr.span, expr.name in true_events)
            return map_children(expr, change)

        return {
            program.Input(name): scope.scalar(change(condition)) for name, condition in self.property.conditions.items()
        }

    def _at_start(self) -> dict[str, bool]:
        initial = {v.id: v.initial for port in self.property.ports for v in port.variables}
        scope = JaniScope({}, "", {})

        def change(expr: Expr) -> Expr:
            if isinstance(expr, NameExpr):
                value = initial.get(expr.name)
                return Boolean(expr.span, False) if value is None else value
            return map_children(expr, change)

        return {
            name: bool(evaluate(scope.scalar(change(condition)), {}))
            for name, condition in self.property.conditions.items()
        }

    # ------------------------------------------------------------- edges

    def _joined(self) -> Iterator[Sync]:
        """All synchronisations; the observer has an edge for each combination of ports that listen to one."""
        index = len(self.model.automata)
        numbers: dict[str, dict[tuple[tuple[int, int], ...], str]] = {}
        events: dict[str, list[tuple[int, int, PortEvent]]] = {}
        for p, port in enumerate(self.property.ports):
            for e, event in enumerate(port.events):
                events.setdefault(on_send(named(event.name)), []).append((p, e, event))
        for sync in self.model.system.syncs:
            joined = ""
            for participant, action in sync.participants:
                if action in events and sync.result == action:
                    key = tuple((p, e) for p, e, event in events[action] if self._is_sender(event, sync))
                    if key:
                        known = numbers.setdefault(action, {})
                        if key not in known:
                            known[key] = action if not known else f"{action}_{self.prefix}_{len(known)}"
                            self._letter(known[key], [(self.property.ports[p], event) for p, event in self._of(key)])
                        joined = known[key]
                    break
                if self.model.automata[participant].name == CLOCK and action == CLOCK_ACTION:
                    if CLOCK_ACTION not in numbers:
                        numbers[CLOCK_ACTION] = {}
                        self._letter(CLOCK_ACTION, [], tick=True)
                    joined = CLOCK_ACTION
                    break
                if self.is_timed and action == TIME_OVER_ACTION:
                    if TIME_OVER_ACTION not in numbers:
                        numbers[TIME_OVER_ACTION] = {}
                        self._end_of_time()
                    joined = TIME_OVER_ACTION
                    break
            yield replace(sync, participants=(*sync.participants, (index, joined))) if joined else sync

    def _of(self, key: tuple[tuple[int, int], ...]) -> list[tuple[int, PortEvent]]:
        return [(p, self.property.ports[p].events[e]) for p, e in key]

    def _is_sender(self, event: PortEvent, sync: Sync) -> bool:
        if not event.sender:
            return True
        automata = self.model.automata
        own = next((a for a in automata if a.name == event.sender), None)
        for index, _ in sync.participants:
            automaton = automata[index]
            if automaton.name == event.sender:
                return True
            is_thread = own is not None and "_thread_" in automaton.name and automaton.origin and own.origin
            if is_thread and automaton.origin.path == own.origin.path:  # type: ignore[union-attr]
                return True
        return False

    def _letter(self, action: str, sent: Iterable[tuple[ObservedPort, PortEvent]], tick: bool = False) -> None:
        assignments: list[Assignment] = []
        true_events: set[str] = set()
        for port, event in sent:
            for variable in port.variables:
                if variable.initial is None:
                    true_events.add(variable.id)
                else:
                    assignments += self._copied(variable, event)
        known: dict[program.Expression, program.Expression] = {program.Tick(): program.Literal(tick)}
        inputs = self._conditions(frozenset(true_events))
        for source, expression in inputs.items():
            if isinstance(expression, jani.Boolean):
                known[source] = program.Literal(expression.value)
        index = self.base + 1
        for assignment in self.observer.assignments:
            value = simplified(assignment.value, known)
            if assignment.register.name in self.needed and value != assignment.register:
                assignments.append(self._assign(assignment.register.name, self._translated(value, inputs), index))
                index += 1
        assignments += self._ends(index)
        self._edge(action, assignments)

    def _copied(self, variable: ObservedVariable, event: PortEvent) -> Iterator[Assignment]:
        source = self.sources[variable.id]
        if not source.copy:
            return
        name = f"{event.name}__{variable.parameter}"
        constants = dict(event.constants)
        value: Expr
        if variable.kind in constants:
            constant = constants[variable.kind]
            value = Boolean(_NOWHERE, constant) if isinstance(constant, bool) else Number(_NOWHERE, constant, False)
        elif name in self.shapes:
            value = NameExpr(_NOWHERE, name)
        else:  # nobody sets the field
            value = Boolean(_NOWHERE, False) if is_kind(variable.type, "bool") else Number(_NOWHERE, 0, False)
        for target, written in stored_in(source.copy, source.shape, value, JaniScope(self.shapes, "", {})):
            yield Assignment(target, written, self.base, origin=self.origin)

    def _end_of_time(self) -> None:
        over = self._assign("over", _literal(True), self.base)
        self._edge(TIME_OVER_ACTION, [over, *self._ends(self.base + 1)])

    def _ends(self, index: int) -> list[Assignment]:
        """What the property says if the trace ends now."""
        if self.outputs.pending == program.FALSE or self._is_existence():
            return []
        pending = self._translated(self.outputs.pending, {})
        if not self.is_timed:
            return [self._assign("pending", pending, index)]
        due, over = self._translated(self.outputs.due, {}), jani.Name(self._named("over"))
        counts = _or(jani.Unary(JaniUnary.NOT, over), due)
        is_open = _and(over, _and(pending, jani.Unary(JaniUnary.NOT, due)))
        target = jani.Name(open_variable(self.property.name))
        return [
            self._assign("pending", _and(pending, counts), index),
            Assignment(target, is_open, index, origin=self.origin),
        ]

    def _assign(self, register: str, value: Expression, index: int) -> Assignment:
        return Assignment(jani.Name(self._named(register)), value, index, origin=self.origin)

    def _edge(self, action: str, assignments: Iterable[Assignment]) -> None:
        destination = Destination(_OBSERVING, assignments=tuple(assignments), origin=self.origin)
        self.edges.append(Edge(_OBSERVING, (destination,), action, origin=self.origin))

    def _translated(
        self, expression: program.Expression, inputs: Mapping[program.Expression, Expression]
    ) -> Expression:
        match expression:
            case program.Literal():
                return _literal(expression.value)
            case program.Register():
                return jani.Name(self._named(expression.name))
            case program.Input():
                return inputs[expression]
            case program.Negation():
                return jani.Unary(JaniUnary.NOT, self._translated(expression.operand, inputs))
            case program.Choice():
                parts = (expression.test, expression.then, expression.otherwise)
                return jani.Conditional(*(self._translated(part, inputs) for part in parts))
            case program.Binary():
                left, right = (self._translated(part, inputs) for part in (expression.left, expression.right))
                return jani.Binary(_OPERATORS[expression.operator], left, right)
            case program.Tick():
                raise AssertionError("it is known of each letter whether it is a step of the clock")

    # ---------------------------------------------------------- the property

    def _property(self) -> Property:
        path: Formula
        if self._is_existence():
            assert self.outputs.satisfied is not None
            path = UnaryPath(UnaryPathOperator.FINALLY, jani.Name(self._named(self.outputs.satisfied.name)))
        else:
            sound = jani.Unary(JaniUnary.NOT, jani.Name(self._named(self.outputs.violated.name)))
            path = UnaryPath(UnaryPathOperator.GLOBALLY, sound)
            if self.outputs.pending != program.FALSE:
                stays = UnaryPath(UnaryPathOperator.GLOBALLY, jani.Name(self._named("pending")))
                lasting = UnaryPath(UnaryPathOperator.FINALLY, stays)
                path = BinaryFormula(JaniBinary.AND, path, UnaryFormula(JaniUnary.NOT, lasting))
        probability = Probability(ProbabilityOperator.PMIN, path, origin=self.origin)
        states = Predicate(StatePredicate.INITIAL)
        return Property(
            self.property.name,
            Filter(FilterFunction.VALUES, probability, states, origin=self.origin),
            origin=self.origin,
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
        case _:
            return set()


def _literal(value: bool | int) -> Expression:
    return jani.Boolean(value) if isinstance(value, bool) else Integer(value)


def _and(left: Expression, right: Expression) -> Expression:
    return jani.Binary(JaniBinary.AND, left, right)


def _or(left: Expression, right: Expression) -> Expression:
    return jani.Binary(JaniBinary.OR, left, right)

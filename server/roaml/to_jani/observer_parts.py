# SPDX-License-Identifier: Apache-2.0
"""The parts of an observer in JANI: its variables, its assignments, and the path formula for its property
(docs/spec/jani.md#observers).

A letter (docs/spec/xml-properties.md#letters) is one step that an observer takes part in: a step of the clock, or the
sending of an event.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType

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
    Variable,
)
from roaml.jani.node import Origin
from roaml.jani.operators import BinaryOperator as JaniBinary
from roaml.jani.operators import UnaryOperator as JaniUnary
from roaml.jani.properties import BinaryFormula, Formula, UnaryFormula, UnaryPath, UnaryPathOperator
from roaml.jani.types import BOOL, INT, BoundedType, Type
from roaml.observers import program
from roaml.observers.build import begin, observer_of
from roaml.observers.program import Observer, simplified
from roaml.observers.properties import CLOSE, LEFT, RIGHT, Pattern, PatternProperty, Property, ScopeKind
from roaml.observers.properties import OPEN as CONDITION_OF_SCOPE
from roaml.record import replace
from roaml.scxml.names import ASKED, OPEN, OPENED, PENDING, observer_automaton, observer_variable, safe_name

_OBSERVING = "observing"
"""The only location of an observer."""
_OVER = "over"
"""The name of the variable of an observer that is true after the last step of the clock."""


def next_index(model: Model) -> int:
    """The smallest index of assignments that is greater than all indices in the model."""
    return 1 + max((assignment.index for assignment in _assignments(model)), default=-1)


def _assignments(model: Model) -> Iterator[Assignment]:
    return (
        assignment
        for automaton in model.automata
        for edge in automaton.edges
        for destination in edge.destinations
        for assignment in destination.assignments
    )


def free_prefix(property_: str, model: Model) -> str:
    """A prefix for the names of an observer, derived from the name of its property. No name of an automaton or variable
    in the model begins with it."""
    names = [*(automaton.name for automaton in model.automata), *(variable.name for variable in model.variables)]
    prefix = safe_name(property_)
    while any(name == prefix or name.startswith((f"{prefix}__", f"{prefix}.")) for name in names):
        prefix += "_"
    return prefix


def with_observer(
    model: Model,
    prefix: str,
    edges: Mapping[str, Iterable[Assignment]],
    variables: Iterable[Variable],
    syncs: Iterable[Sync],
    origin: Origin | None,
) -> Model:
    """A copy of the model with an observer as its last element. The observer is an automaton with one location.

    Args:
        prefix: the beginning of the name of the observer.
        edges: action of the observer -> the assignments of the edge.
        variables: the variables of the observer.
        syncs: all synchronisations of the new model.
    """
    automaton = Automaton(
        observer_automaton(prefix),
        (Location(_OBSERVING, origin=origin),),
        (_OBSERVING,),
        tuple(_edge(action, assignments, origin) for action, assignments in edges.items()),
        origin=origin,
    )
    known_actions = {action.name for action in model.actions}
    return replace(
        model,
        automata=(*model.automata, automaton),
        system=replace(model.system, elements=(*model.system.elements, Element(automaton.name)), syncs=tuple(syncs)),
        variables=(*model.variables, *variables),
        actions=(*model.actions, *(Action(action) for action in edges if action not in known_actions)),
    )


def _edge(action: str, assignments: Iterable[Assignment], origin: Origin | None) -> Edge:
    destination = Destination(_OBSERVING, assignments=tuple(assignments), origin=origin)
    return Edge(_OBSERVING, (destination,), action, origin=origin)


class ObserverParts:
    """Creates the parts of the observer of one property.

    Args:
        prefix: the beginning of the names of the variables of the observer.
        has_clock: whether the model has a clock.
        has_activity: whether the observer also stores whether the property was triggered.
        conditions: input of the observer -> its text, for comments.
    """

    def __init__(
        self,
        property_: Property,
        prefix: str,
        origin: Origin | None,
        *,
        has_clock: bool,
        has_activity: bool,
        conditions: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self.conditions = conditions
        self.property = property_
        self.prefix = prefix
        self.origin = origin
        self.has_activity = has_activity
        self.observer: Observer = observer_of(property_)
        self.outputs = self.observer.outputs
        self.is_timed = self.outputs.pending != self.outputs.due and has_clock
        self.is_reachability = not self.is_timed and _is_existence(property_)
        self.is_pending = self.outputs.pending != program.FALSE and not self.is_reachability
        self.needed = self._needed()

    def _named(self, register: str) -> str:
        outputs = self.outputs
        if outputs.exercised is not None and register == outputs.exercised.name:
            # Without requests, the property can only be vacuous because its scope is never opened.
            register = ASKED if self._has_requests() else OPENED
        return observer_variable(self.prefix, register)

    def _comment(self, register: str) -> str | None:
        """What must occur so that a variable becomes true, for the one that stores whether the property was triggered,
        and the one that stores whether its scope was evaluated; `None` for all others."""
        if not isinstance(self.property, PatternProperty):
            return None
        name, pattern = self._named(register), self.property.pattern
        if name == observer_variable(self.prefix, ASKED):
            inputs = [LEFT if pattern is Pattern.RESPONSE else RIGHT]
        elif name == observer_variable(self.prefix, OPENED):
            inputs = [CONDITION_OF_SCOPE, CLOSE]
        else:
            return None
        return " and ".join(f"`{self.conditions[input_]}`" for input_ in inputs if input_ in self.conditions) or None

    def _has_requests(self) -> bool:
        return isinstance(self.property, PatternProperty) and self.property.pattern.is_binary

    # ----------------------------------------------------------- variables

    def _needed(self) -> set[str]:
        """The registers on which the verdict depends and, with `has_activity`, those on which the activity depends."""
        if self.is_reachability:
            assert self.outputs.satisfied is not None
            needed = {self.outputs.satisfied.name}
        else:
            due = self.outputs.due if self.is_timed else program.FALSE
            needed = {self.outputs.violated.name} | _registers(self.outputs.pending) | _registers(due)
        if self.has_activity:
            activity = (self.outputs.exercised, self.outputs.opened)
            needed |= {register.name for register in activity if register is not None}
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

    def variables(self, at_start: Mapping[str, bool]) -> Iterator[Variable]:
        """The declarations of the variables of the observer, with their initial values.

        Args:
            at_start: the values of the inputs of the observer at the start of a trace.
        """
        state = begin(self.observer, at_start)
        for register in self.observer.registers:
            if register.name in self.needed:
                type_ = BOOL if register.limit is None else BoundedType(INT, Integer(0), Integer(register.limit))
                variable = self._variable(self._named(register.name), type_, state[register.name])
                yield replace(variable, comment=self._comment(register.name))
        if self.is_pending:
            pending = program.evaluate(self.outputs.pending, state, {}, False)
            yield self._variable(observer_variable(self.prefix, PENDING), BOOL, pending)
            if self.is_timed:
                yield self._variable(self._named(_OVER), BOOL, False)
                yield self._variable(observer_variable(self.prefix, OPEN), BOOL, False)

    def _variable(self, name: str, type_: Type, value: bool | int) -> Variable:
        return Variable(name, type_, _literal(value), origin=self.origin)

    # --------------------------------------------------------- assignments

    def letter(self, conditions: Mapping[str, Expression], index: int, *, is_tick: bool) -> Iterator[Assignment]:
        """The assignments of the observer at a letter.

        Args:
            conditions: input of the observer -> its value as an expression.
            index: the index of the first assignment; the others follow.
            is_tick: whether the letter is a step of the clock.
        """
        letter: dict[program.Expression, Expression] = {program.Tick(): _literal(is_tick)}
        for name, condition in conditions.items():
            letter[program.Input(name)] = condition
        known: dict[program.Expression, program.Expression] = {
            source: program.Literal(value.value) for source, value in letter.items() if isinstance(value, jani.Boolean)
        }
        for assignment in self.observer.assignments:
            simpler = simplified(assignment.value, known)
            if assignment.register.name in self.needed and simpler != assignment.register:
                yield self._assign(assignment.register.name, self._translated(simpler, letter), index)
                index += 1
        yield from self._ends(index)

    def end_of_time(self, index: int) -> Iterator[Assignment]:
        """The assignments of the observer at the last step of the clock. `index` is the index of the first one."""
        yield self._assign(_OVER, _literal(True), index)
        yield from self._ends(index + 1)

    def _ends(self, index: int) -> list[Assignment]:
        """The assignments that store the verdict of the property for the case that the trace ends now."""
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

    def _translated(
        self, expression: program.Expression, letter: Mapping[program.Expression, Expression]
    ) -> Expression:
        """An expression of the observer's program as a JANI expression.

        Args:
            letter: the values of the inputs, and whether the letter is a step of the clock.
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
        """The path formula, over the variables of the observer, that is true if the property holds."""
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


def _is_existence(property_: Property) -> bool:
    """Whether the property only requires that a condition is true at some time of the whole trace."""
    return (
        isinstance(property_, PatternProperty)
        and property_.pattern is Pattern.EXISTENCE
        and property_.scope is ScopeKind.GLOBALLY
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

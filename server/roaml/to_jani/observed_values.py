# SPDX-License-Identifier: Apache-2.0
"""The values that an observer reads: the variables of its property, and the conditions on them
(docs/spec/jani.md#observers).

The value of a variable is usually read from the global variable in which the translation stores the parameter of its
event. If several events, the events of a single sender, or constants of events determine the value, the observer has a
separate variable, a copy. It assigns the copy when an event is sent.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from roaml.expr.transform import map_children
from roaml.expr.tree import Boolean, Conditional, Expr, Index, Name, Number, walk
from roaml.expr.types import ScalarKind, is_kind
from roaml.jani.expressions import Expression, Integer, LValue
from roaml.jani.model import Variable
from roaml.jani.semantics import evaluate
from roaml.record import Record
from roaml.scxml.names import flag_of
from roaml.scxml.observed import ObservedPort, ObservedProperty, ObservedVariable, PortEvent
from roaml.text import NO_SPAN, Location
from roaml.to_jani.assignments import stored_in
from roaml.to_jani.shapes import ArrayShape, jani_type, shape_of, zero
from roaml.to_jani.values import JaniScope, Listed, elements_as, lengths_as

_CONSTANTS = JaniScope({}, "", {})


class _Copy(Record, frozen=True):
    """A variable of the observer in which it stores the value of a variable of the property."""

    name: str
    shape: ArrayShape


class ObservedValues(Record, frozen=True):
    """The values that the observer of one property reads.

    Attributes:
        values: id of a variable -> its value as an expression over global variables. Event variables are left out.
        copies: id of a variable -> its copy in the observer. Variables without a copy are left out.
        shapes: the shapes of the global variables, including the copies.
        declared: the declarations of the copies.
        initial: variables that are named like those of the property and have their initial values.
        initial_shapes: the shapes of these variables.
    """

    property: ObservedProperty
    values: Mapping[str, Expr]
    copies: Mapping[str, _Copy]
    shapes: Mapping[str, ArrayShape]
    declared: tuple[Variable, ...]
    initial: tuple[Variable, ...]
    initial_shapes: Mapping[str, ArrayShape]

    def conditions(self, true_events: frozenset[str]) -> dict[str, Expression]:
        """Input of the observer -> the condition of the property as an expression.

        Args:
            true_events: the ids of the event variables that are true in the step; the others are false.
        """
        scope = JaniScope(self.shapes, "", {})

        def value(name: Name) -> Expr:
            return self.values.get(name.name) or Boolean(name.span, name.name in true_events)

        return {name: scope.scalar(_replaced(condition, value)) for name, condition in self.property.conditions.items()}

    def at_start(self) -> dict[str, bool]:
        """Input of the observer -> whether the condition of the property is true at the start of the trace."""
        scope = JaniScope(self.initial_shapes, "", {})
        environment = {v.name: evaluate(v.initial_value, {}) for v in self.initial if v.initial_value is not None}

        def value(name: Name) -> Expr:
            return name if name.name in self.initial_shapes else Boolean(name.span, False)

        return {
            name: bool(evaluate(scope.scalar(_replaced(condition, value)), environment))
            for name, condition in self.property.conditions.items()
        }

    def assigned_on(self, event: PortEvent, variable: ObservedVariable) -> Iterator[tuple[LValue, Expression]]:
        """The assignments to the copy of a variable when `event` is sent; empty if the variable has no copy."""
        copy = self.copies.get(variable.id)
        if copy is not None:
            value = self._sent(event, variable)
            yield from stored_in(copy.name, copy.shape, value, JaniScope(self.shapes, "", {}))

    def _sent(self, event: PortEvent, variable: ObservedVariable) -> Expr:
        constant = dict(event.constants).get(variable.kind)
        if constant is not None:
            return Boolean(NO_SPAN, constant) if isinstance(constant, bool) else Number(NO_SPAN, constant, False)
        parameter = f"{event.name}__{variable.parameter}"
        if parameter in self.shapes:
            return Name(NO_SPAN, parameter)
        # No automaton sends this parameter, so it has its default value.
        return Boolean(NO_SPAN, False) if is_kind(variable.type, ScalarKind.BOOL) else Number(NO_SPAN, 0, False)


def observed_values(
    property_: ObservedProperty, prefix: str, shapes: Mapping[str, ArrayShape], size: int
) -> ObservedValues:
    """The values that the observer of a property reads.

    Args:
        prefix: the beginning of the names of the variables of the observer.
        shapes: the shapes of the global variables of the model.
        size: the capacity of arrays that are sent.
    """
    values: dict[str, Expr] = {}
    copies: dict[str, _Copy] = {}
    declared: list[Variable] = []
    at_start: list[Variable] = []
    initial_shapes: dict[str, ArrayShape] = {}
    for port in property_.ports:
        for variable in port.variables:
            if variable.initial is None:
                continue
            shape = shape_of(variable.type, size, sent=True)
            initial_shapes[variable.id] = shape
            at_start += _declared(_Copy(variable.id, shape), variable.initial, property_.origin)
            value = _stored(port, variable, variable.initial, shape, shapes)
            if isinstance(value, Conditional) and _is_indexed(property_, variable):
                value = None
            if value is None:
                copy = _Copy(f"{prefix}__{variable.id}", shape)
                copies[variable.id] = copy
                declared += _declared(copy, variable.initial, property_.origin)
                value = Name(NO_SPAN, copy.name)
            values[variable.id] = value
    known = {**shapes, **{copy.name: copy.shape for copy in copies.values()}}
    return ObservedValues(property_, values, copies, known, tuple(declared), tuple(at_start), initial_shapes)


def _stored(
    port: ObservedPort, variable: ObservedVariable, initial: Expr, shape: ArrayShape, shapes: Mapping[str, ArrayShape]
) -> Expr | None:
    """The global variable of the translation that contains the value of `variable`; `None` if the observer needs a
    copy."""
    if len(port.events) != 1 or not variable.parameter:
        return None
    (event,) = port.events
    parameter = f"{event.name}__{variable.parameter}"
    if event.sender or event.constants or parameter not in shapes:
        return None
    value = Name(NO_SPAN, parameter)
    if _is_zero(initial, shape):
        return value
    return Conditional(NO_SPAN, Name(NO_SPAN, flag_of(event.name)), value, initial)


def _is_indexed(property_: ObservedProperty, variable: ObservedVariable) -> bool:
    """Whether a condition reads an element of a variable. A choice between two arrays has no elements in JANI."""
    return any(
        isinstance(part, Index) and isinstance(part.object, Name) and part.object.name == variable.id
        for condition in property_.conditions.values()
        for part in walk(condition)
    )


def _declared(copy: _Copy, initial: Expr, origin: Location) -> Iterator[Variable]:
    array = _CONSTANTS.array(initial)
    value = _CONSTANTS.scalar(initial) if array is None else elements_as(array, copy.shape)
    yield Variable(copy.name, jani_type(copy.shape), value, origin=origin)
    for dimension, (name, shape) in enumerate(copy.shape.lengths(copy.name), 1):
        lengths = Integer(0) if array is None else lengths_as(array, copy.shape, dimension)
        yield Variable(name, jani_type(shape), lengths, origin=origin)


def _is_zero(initial: Expr, shape: ArrayShape) -> bool:
    """Whether `initial` is the value that a variable of this shape has before its first assignment."""
    array = _CONSTANTS.array(initial)
    if array is not None:
        return isinstance(array, Listed) and not array.elements
    return bool(evaluate(_CONSTANTS.scalar(initial), {}) == evaluate(zero(shape), {}))


def _replaced(expr: Expr, value: Callable[[Name], Expr]) -> Expr:
    """A copy of `expr` in which each name is replaced by its value."""
    return value(expr) if isinstance(expr, Name) else map_children(expr, lambda child: _replaced(child, value))

# SPDX-License-Identifier: Apache-2.0
"""A property in XML as a property in JANI."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from roaml.comparison import read_comparison
from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.tree import Binary, Boolean, Expr, Name, Number, Unary
from roaml.ide.property_conversion.forms import PatternForm, needs_first, path_of
from roaml.jani import expressions as jani
from roaml.jani.expressions import Expression
from roaml.jani.operators import BinaryOperator
from roaml.jani.operators import UnaryOperator as JaniUnary
from roaml.jani.write_formulas import FormulaWriter
from roaml.model.globals import GlobalVariable
from roaml.model.property_file import PortVariableKind
from roaml.model.property_links import LinkedProperty
from roaml.model.property_ports import LinkedPort, LinkedVariable
from roaml.observers.properties import LEFT, Pattern, PatternProperty
from roaml.scxml.names import flag_of
from roaml.to_jani.values import BINARY_OPERATORS

_CONVERTIBLE = BINARY_OPERATORS.keys() - {Operator.DIVIDE}
"""The operators that have the same meaning in conditions in XML and in JANI."""
_RELATIONS = {">=": "≥", "<=": "≤", ">": ">", "<": "<", "==": "="}
_ZEROS = (jani.Boolean(False), jani.Integer(0), jani.Real(0.0))
"""The initial values of the global variables of the translation."""


class NotConvertibleError(Exception):
    """A condition has no equivalent in the other language."""


def jani_property(linked: LinkedProperty, variables: Mapping[str, GlobalVariable], step: int | None) -> Any:
    """The property as a JSON value; `None` if no property in JANI is equivalent.

    Args:
        variables: the global variables of the translated system.
        step: the step of the clock in ns; `None` if there is no clock.
    """
    if not isinstance(linked.property, PatternProperty) or linked.is_assumption:
        return None
    conditions = _Conditions(linked, variables)
    try:
        converted = {
            name: conditions.converted(name, condition.tree, linked.property)
            for name, condition in linked.conditions.items()
        }
    except NotConvertibleError:
        return None
    path = path_of(PatternForm(linked.property, converted), step)
    if path is None:
        return None
    values: Any = {"op": "Pmin", "exp": json.loads(FormulaWriter().text(path))}
    if linked.written.expect is not None:
        comparison = read_comparison(linked.written.expect.value)
        if comparison is None:
            return None
        number = int(comparison.number) if comparison.number.is_integer() else comparison.number
        values = {"op": _RELATIONS[comparison.relation], "left": values, "right": number}
    initial = {"op": "initial"}
    return {"name": linked.name, "expression": {"op": "filter", "fun": "values", "values": values, "states": initial}}


class _Conditions:
    def __init__(self, linked: LinkedProperty, variables: Mapping[str, GlobalVariable]) -> None:
        self.variables = variables
        self.by_id: dict[str, tuple[LinkedPort, LinkedVariable]] = {
            variable.id: (port, variable) for port in linked.ports for variable in port.variables
        }

    def converted(self, name: str, tree: Expr, property_: PatternProperty) -> Expression:
        """The condition `name` of a property over global variables."""
        if not self.has_events(tree):
            return self.value(tree)
        if not needs_first(property_, name):
            raise NotConvertibleError
        if property_.pattern is Pattern.UNIVERSALITY and name == LEFT:
            return jani.Unary(JaniUnary.NOT, self.first(_negated(tree)))
        return self.first(tree)

    def has_events(self, tree: Expr) -> bool:
        match tree:
            case Name(name=name):
                return name in self.by_id and self.by_id[name][1].kind is PortVariableKind.EVENT
            case Unary(operand=operand):
                return self.has_events(operand)
            case Binary(left=left, right=right):
                return self.has_events(left) or self.has_events(right)
        return False

    def first(self, tree: Expr) -> Expression:
        """A condition that becomes true for the first time in the same step as `tree`. The flag of an event replaces
        the variable of the event."""
        if not self.has_events(tree):
            return self.value(tree)
        match tree:
            case Name(name=name):
                return self.flag(self.by_id[name][0])
            case Unary(operator=UnaryOperator.NOT, operand=Unary() | Binary() as operand):
                return self.first(_negated(operand))
            case Binary(operator=Operator.OR, left=left, right=right):
                return jani.Binary(BinaryOperator.OR, self.first(left), self.first(right))
            case Binary(operator=Operator.AND):
                return self.sent_with(tree)
        raise NotConvertibleError

    def sent_with(self, tree: Binary) -> Expression:
        """A conjunction of the flag of an event with conditions on the data of this event, which changes only when the
        event is sent."""
        parts = _conjuncts(tree)
        events = [part for part in parts if self.has_events(part)]
        (event, *more) = events
        if more or not isinstance(event, Name):
            raise NotConvertibleError
        port = self.by_id[event.name][0]
        if len(port.events) != 1:
            raise NotConvertibleError
        for part in parts:
            for name in _names(part):
                if self.by_id[name][0].events != port.events:
                    raise NotConvertibleError
        result = self.flag(port)
        for part in parts:
            if part is not event:
                result = jani.Binary(BinaryOperator.AND, result, self.value(part, is_sent=True))
        return result

    def flag(self, port: LinkedPort) -> Expression:
        """The condition that one of the events of a port has been sent at least once."""
        result: Expression | None = None
        for event in port.events:
            name = flag_of(event.name)
            if event.sender or name not in self.variables:
                raise NotConvertibleError
            flag = jani.Name(name)
            result = flag if result is None else jani.Binary(BinaryOperator.OR, result, flag)
        if result is None:
            raise NotConvertibleError
        return result

    def value(self, tree: Expr, *, is_sent: bool = False) -> Expression:
        """An expression without event variables. `is_sent` means that the events of its variables have been sent."""
        match tree:
            case Number():
                return jani.Real(float(tree.value)) if tree.is_real else jani.Integer(int(tree.value))
            case Boolean(value=value):
                return jani.Boolean(value)
            case Name(name=name) if name in self.by_id:
                return self.read(*self.by_id[name], is_sent=is_sent)
            case Unary(operator=UnaryOperator.NOT, operand=operand):
                return jani.Unary(JaniUnary.NOT, self.value(operand, is_sent=is_sent))
            case Unary(operator=UnaryOperator.NEGATE, operand=operand):
                operand_value = self.value(operand, is_sent=is_sent)
                return jani.Binary(BinaryOperator.SUBTRACT, jani.Integer(0), operand_value)
            case Binary(operator=operator, left=left, right=right) if operator in _CONVERTIBLE:
                values = (self.value(operand, is_sent=is_sent) for operand in (left, right))
                return jani.Binary(BINARY_OPERATORS[operator], *values)
        raise NotConvertibleError

    def read(self, port: LinkedPort, variable: LinkedVariable, *, is_sent: bool) -> Expression:
        written = variable.written.initial
        if len(port.events) != 1 or not variable.parameter or written is None:
            raise NotConvertibleError
        (event,) = port.events
        parameter = jani.Name(f"{event.name}__{variable.parameter}")
        is_array = f"{parameter.identifier}.d1_len" in self.variables
        if event.sender or parameter.identifier not in self.variables or is_array:
            raise NotConvertibleError
        initial = self.value(written.tree)
        if is_sent or initial in _ZEROS:
            return parameter
        return jani.Conditional(jani.Name(flag_of(event.name)), parameter, initial)


def _negated(tree: Expr) -> Expr:
    """The negation of a condition, with `!` moved inside of `&&` and `||`."""
    match tree:
        case Unary(operator=UnaryOperator.NOT, operand=operand):
            return operand
        case Binary(operator=Operator.AND | Operator.OR as operator, left=left, right=right):
            dual = Operator.OR if operator is Operator.AND else Operator.AND
            return Binary(tree.span, dual, tree.operator_span, _negated(left), _negated(right))
    return Unary(tree.span, UnaryOperator.NOT, tree)


def _conjuncts(tree: Expr) -> list[Expr]:
    match tree:
        case Binary(operator=Operator.AND, left=left, right=right):
            return [*_conjuncts(left), *_conjuncts(right)]
    return [tree]


def _names(tree: Expr) -> list[str]:
    match tree:
        case Name(name=name):
            return [name]
        case Unary(operand=operand):
            return _names(operand)
        case Binary(left=left, right=right):
            return [*_names(left), *_names(right)]
    return []

# SPDX-License-Identifier: Apache-2.0
"""Formulas of properties in JANI: the comparisons that have the same result for all values of a variable, and the
places of operators."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr import operators
from roaml.jani.expressions import Binary, Integer, Name, Real
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import (
    BinaryFormula,
    BinaryPath,
    BinaryPathOperator,
    Filter,
    Formula,
    Probability,
    UnaryPath,
    UnaryPathOperator,
    walk,
)
from roaml.json_syntax import JsonArray, JsonObject, JsonString, JsonValue
from roaml.model.values.describe import described
from roaml.model.values.domain import MAX_LISTED, TRUE, exactly
from roaml.model.values.evaluate import compared
from roaml.model.values.global_values import GlobalValues
from roaml.rules.rule import PropertiesContext
from roaml.rules.support.constant_conditions import ConstantPart
from roaml.rules.support.words import words_of
from roaml.text import Span

_OPERATORS = {
    BinaryOperator.EQUAL: operators.Operator.EQUAL,
    BinaryOperator.NOT_EQUAL: operators.Operator.NOT_EQUAL,
    BinaryOperator.LESS: operators.Operator.LESS,
    BinaryOperator.LESS_EQUAL: operators.Operator.LESS_EQUAL,
    BinaryOperator.GREATER: operators.Operator.GREATER,
    BinaryOperator.GREATER_EQUAL: operators.Operator.GREATER_EQUAL,
}


_NEVER = frozenset(("avoid", "avoids", "cannot", "never", "no", "not", "without"))
"""Words in the names of properties that state that something does not occur, as `Pmax` of `F` being 0."""


def constant_comparisons(context: PropertiesContext) -> Iterator[ConstantPart]:
    """The comparisons of an integer with a number that have the same result for all values of its type; and, in
    what has to occur at some time, those of equality that hold for none of the values that machines send."""
    for property_ in context.properties:
        is_never = not _NEVER.isdisjoint(words_of(property_.name))
        expected = () if is_never else {id(node) for node in _expected(property_.expression)}
        ranges = set(_ranges(property_.expression))
        for node in walk(property_.expression):
            sides = _sides(context, node)
            if sides is None or not isinstance(node, Binary) or node.origin is None:
                continue
            variable, number, operator = sides
            result = compared(operator, variable.by_type, exactly(number))
            if result.value is not None:
                if result == TRUE and id(node) in ranges:
                    continue
                how = "always" if result == TRUE else "never"
                why = f"the values of `{variable.type}` are {described(variable.by_type)}"
                yield ConstantPart(_place(context, node), f"this comparison is {how} true: {why}")
                continue
            # An order that never holds often states that a limit is never exceeded.
            never = operator is operators.Operator.EQUAL and not variable.sent.includes(number)
            if never and variable.sent.value is None and id(node) in expected:
                why = f"the values of the variable are {described(variable.sent, most=MAX_LISTED)}"
                yield ConstantPart(_place(context, node), f"this comparison is never true: {why}")


def _place(context: PropertiesContext, comparison: Binary) -> Span:
    """The number of an equality, and the operator of an order: these are probably wrong."""
    assert comparison.origin is not None
    place = comparison.origin.span
    if comparison.operator in (BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL):
        numbers = (side for side in (comparison.left, comparison.right) if isinstance(side, (Integer, Real)))
        return next((side.origin.span for side in numbers if side.origin is not None), place)
    operator = operator_at(context.value, place)
    return operator.span if operator is not None else place


def _sides(context: PropertiesContext, node: Formula) -> tuple[GlobalValues, int | float, operators.Operator] | None:
    """The variable and the number that a comparison compares, as if the variable were on the left."""
    if not isinstance(node, Binary) or node.operator not in _OPERATORS:
        return None
    operator = _OPERATORS[node.operator]
    match node.left, node.right:
        case Name(identifier), Integer(number) | Real(number):
            pass
        case Integer(number) | Real(number), Name(identifier):
            operator = operators.MIRRORED.get(operator, operator)
        case _:
            return None
    values = context.values.get(identifier)
    return None if values is None else (values, number, operator)


def _expected(formula: Formula) -> Iterator[Formula]:
    """The parts of a property without which what it expects at some time cannot hold."""
    while isinstance(formula, (Filter, Probability)):
        formula = formula.values if isinstance(formula, Filter) else formula.path
    match formula:
        case UnaryPath(operator=UnaryPathOperator.FINALLY, operand=part):
            yield from _joined(part)
        case BinaryPath(operator=BinaryPathOperator.UNTIL, right=part):
            yield from _joined(part)


def _ranges(formula: Formula) -> Iterator[int]:
    """The ids of the comparisons of a variable that `∧` joins with another comparison of it. There, one that is always
    true states a range completely: `0 ≤ x ∧ x ≤ 9`."""
    nested: set[int] = set()
    for node in walk(formula):
        if id(node) in nested:
            continue
        parts = list(_joined(node))
        nested |= {id(part) for part in parts}
        comparisons: dict[str, list[Formula]] = {}
        for part in parts:
            for side in (part.left, part.right) if isinstance(part, Binary) and part.operator in _OPERATORS else ():
                if isinstance(side, Name):
                    comparisons.setdefault(side.identifier, []).append(part)
        yield from (id(part) for alike in comparisons.values() if len(alike) > 1 for part in alike)


def _joined(formula: Formula) -> Iterator[Formula]:
    """A formula, and what it joins with `∧`."""
    stack = [formula]
    while stack:
        node = stack.pop()
        yield node
        if isinstance(node, (Binary, BinaryFormula)) and node.operator is BinaryOperator.AND:
            stack += (node.left, node.right)


def operator_at(value: JsonValue, place: Span) -> JsonString | None:
    """The operator of the formula at `place` in a file."""
    stack = [value]
    while stack:
        inner = stack.pop()
        if isinstance(inner, JsonObject):
            operator = inner.get("op")
            if inner.span == place and isinstance(operator, JsonString):
                return operator
            stack += [member.value for member in inner.members if member.value is not None]
        elif isinstance(inner, JsonArray):
            stack += inner.items
    return None

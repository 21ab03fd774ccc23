# SPDX-License-Identifier: Apache-2.0
"""The value of an expression in a state (docs/spec/expressions.md), for watches, conditions and log points."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from roaml.debugging.values import Value, bytes_of, shown, type_of
from roaml.expr import parse as parser
from roaml.expr.operators import FUNCTIONS, Operator, UnaryOperator
from roaml.expr.tree import (
    ArrayLiteral,
    Binary,
    Boolean,
    Call,
    Conditional,
    ErrorExpr,
    Expr,
    Index,
    Member,
    Name,
    Number,
    ObjectLiteral,
    String,
    Unary,
    walk,
)
from roaml.suggest import alternatives, close_names
from roaml.text import Decoded

Scope = Callable[[str], "Value | None"]
"""A function that returns the value of a name; `None` if there is no such name."""


class WatchError(ValueError):
    """An expression that has no value; the message contains the reason."""


def parsed(text: str) -> Expr:
    """The syntax tree of an expression.

    Raises:
        WatchError: the text is not an expression.
    """
    expr, findings = parser.parse(Decoded(text, 0))
    if findings:
        raise WatchError(findings[0].message)
    if any(isinstance(part, ErrorExpr) for part in walk(expr)):
        raise WatchError("the expression is not complete")
    return expr


def evaluate(expr: Expr, scope: Scope) -> Value:
    """The value of an expression.

    Raises:
        WatchError: the expression has no value, because of an unknown name, a wrong type, a division by zero, or an
            index outside of its array.
    """
    try:
        return _value(expr, scope)
    except (OverflowError, ValueError) as error:
        if isinstance(error, WatchError):
            raise
        raise WatchError(str(error)) from None


def condition(expr: Expr, scope: Scope) -> bool:
    """The value of a condition.

    Raises:
        WatchError: as for `evaluate`, or the value is not a `bool`.
    """
    return _boolean(evaluate(expr, scope))


def _value(expr: Expr, scope: Scope) -> Value:
    match expr:
        case Number() | String() | Boolean():
            return expr.value
        case Name():
            value = scope(expr.name)
            if value is None:
                raise WatchError(f"there is no variable `{expr.name}` here")
            return value
        case Member():
            return _member(expr, scope)
        case Index():
            return _element(_value(expr.object, scope), _value(expr.index, scope))
        case Call():
            return _call(expr, scope)
        case Unary():
            return _unary(expr.operator, _value(expr.operand, scope))
        case Binary():
            return _binary(expr, scope)
        case Conditional():
            return _value(expr.then if _boolean(_value(expr.test, scope)) else expr.otherwise, scope)
        case ArrayLiteral():
            return [_value(element, scope) for element in expr.elements]
        case ObjectLiteral():
            return {member.key: _value(member.value, scope) for member in expr.members}
        case ErrorExpr():
            raise WatchError("the expression is not complete")


def _member(expr: Member, scope: Scope) -> Value:
    path = dotted(expr)
    if path is not None:  # the name of a variable may contain dots
        value = scope(path)
        if value is not None:
            return value
    owner = _value(expr.object, scope)
    if expr.name == "length" and isinstance(owner, (list, str)):
        return len(bytes_of(owner) if isinstance(owner, str) else owner)
    if isinstance(owner, list):
        return [_part(element, expr.name) for element in owner]
    return _part(owner, expr.name)


def dotted(expr: Expr) -> str | None:
    """The text of a name with its members, such as `Arm.way`; `None` for another expression."""
    match expr:
        case Name():
            return expr.name
        case Member():
            owner = dotted(expr.object)
            return None if owner is None else f"{owner}.{expr.name}"
    return None


def _part(owner: Value, name: str) -> Value:
    if not isinstance(owner, Mapping):
        raise WatchError(f"{shown(owner)} has no member `{name}`: it is not a struct")
    if name not in owner:
        hint = alternatives(close_names(name, owner), owner, "member")
        raise WatchError(f"{shown(owner)} has no member `{name}`{hint}")
    return owner[name]


def _element(owner: Value, index: Value) -> Value:
    if not isinstance(owner, (list, str)):
        raise WatchError(f"{shown(owner)} is not an array")
    if not isinstance(index, int) or isinstance(index, bool):
        raise WatchError(f"the index {shown(index)} is not an integer")
    elements = bytes_of(owner) if isinstance(owner, str) else owner
    if not 0 <= index < len(elements):
        raise WatchError(f"index {index} is outside of the array, whose length is {len(elements)}")
    return elements[index]


def _unary(operator: UnaryOperator, operand: Value) -> Value:
    if operator is UnaryOperator.NOT:
        return not _boolean(operand)
    number = _number(operand, operator.symbol)
    return -number if operator is UnaryOperator.NEGATE else number


def _binary(expr: Binary, scope: Scope) -> Value:
    left = _value(expr.left, scope)
    if expr.operator is Operator.AND:
        return _boolean(left) and _boolean(_value(expr.right, scope))
    if expr.operator is Operator.OR:
        return _boolean(left) or _boolean(_value(expr.right, scope))
    right = _value(expr.right, scope)
    if expr.operator in (Operator.EQUAL, Operator.NOT_EQUAL):
        _check_comparable(left, right, expr.operator.symbol)
        return (left == right) is (expr.operator is Operator.EQUAL)
    symbol = expr.operator.symbol
    return _COMPUTED[expr.operator](_number(left, symbol), _number(right, symbol))


def _check_comparable(left: Value, right: Value, symbol: str) -> None:
    kinds = {"number" if type_of(value) in ("int", "real") else type(value).__name__ for value in (left, right)}
    if len(kinds) > 1 or isinstance(left, dict):
        raise WatchError(f"`{symbol}` cannot compare {shown(left)} with {shown(right)}")


def _quotient(a: float, b: float) -> float:
    if b == 0:
        raise WatchError("division by zero")
    return a / b


def _remainder(a: float, b: float) -> float:
    if b == 0:
        raise WatchError("division by zero")
    return a % abs(b)


_COMPUTED: Mapping[Operator, Callable[[float, float], Value]] = {
    Operator.LESS: lambda a, b: a < b,
    Operator.LESS_EQUAL: lambda a, b: a <= b,
    Operator.GREATER: lambda a, b: a > b,
    Operator.GREATER_EQUAL: lambda a, b: a >= b,
    Operator.ADD: lambda a, b: a + b,
    Operator.SUBTRACT: lambda a, b: a - b,
    Operator.MULTIPLY: lambda a, b: a * b,
    Operator.DIVIDE: _quotient,
    Operator.REMAINDER: _remainder,
}


def _call(expr: Call, scope: Scope) -> Value:
    match expr.function:
        case Member(object=Name(name="Math"), name=name) if name in FUNCTIONS:
            function = FUNCTIONS[name]
        case _:
            raise WatchError("only functions of `Math` can be called")
    if name == "random":
        raise WatchError("`Math.random()` has no value here, because each execution draws a new number")
    given = len(expr.arguments)
    if not len(function.parameters) - function.optional <= given <= len(function.parameters):
        raise WatchError(f"`{function.signature}` does not take {given} arguments")
    arguments = [_number(_value(argument, scope), f"Math.{name}") for argument in expr.arguments]
    return _FUNCTIONS[name](arguments)


def _power(arguments: Sequence[float]) -> float:
    power = arguments[0] ** arguments[1]
    if isinstance(power, complex):
        raise WatchError("a negative number to the power of a fraction is not a real number")
    return float(power)


_FUNCTIONS: Mapping[str, Callable[[Sequence[float]], Value]] = {
    "abs": lambda a: abs(a[0]),
    "ceil": lambda a: math.ceil(a[0]),
    "cos": lambda a: math.cos(a[0]),
    "floor": lambda a: math.floor(a[0]),
    "log": lambda a: math.log(*a),
    "max": max,
    "min": min,
    "pow": _power,
    "sin": lambda a: math.sin(a[0]),
}


def _number(value: Value, symbol: str) -> int | float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise WatchError(f"`{symbol}` needs numbers, not {shown(value)}")
    return value


def _boolean(value: Value) -> bool:
    if not isinstance(value, bool):
        raise WatchError(f"{shown(value)} is not a condition; compare it, for example with `==`")
    return value

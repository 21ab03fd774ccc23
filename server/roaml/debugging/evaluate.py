# SPDX-License-Identifier: Apache-2.0
"""The value of an expression in a state (docs/spec/expressions.md), for watches, conditions and log points."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence

from roaml.debugging.values import Value, bytes_of, shown, type_of
from roaml.exact_number import remainder
from roaml.expr import parse as parser
from roaml.expr.operators import FUNCTIONS, FunctionResult, Operator, UnaryOperator
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

MAX_STEPS = 100_000
"""The maximum number of steps of one evaluation: parts of the expression, and elements of arrays. They take
at most some 50 ms, after which the debugger handles the next request, such as `pause`."""

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
    """The value of an expression, computed as `verify` does: integers have 64 bits, and an operation with an integer
    and a real is one of reals.

    Raises:
        WatchError: the expression has no value, because of an unknown name, a wrong type, a division by zero, an index
            outside of its array, or a number that is too large; or its computation takes too many steps.
    """
    return _Evaluation(scope).value(expr)


def condition(expr: Expr, scope: Scope) -> bool:
    """The value of a condition.

    Raises:
        WatchError: as for `evaluate`, or the value is not a `bool`.
    """
    return _boolean(evaluate(expr, scope))


class _Evaluation:
    """The evaluation of one expression.

    Attributes:
        steps: the number of steps that are left.
    """

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.steps = MAX_STEPS

    def take(self, steps: int = 1) -> None:
        self.steps -= steps
        if self.steps < 0:
            raise WatchError(f"the expression needs more than {MAX_STEPS:,} steps")

    def value(self, expr: Expr) -> Value:
        self.take()
        match expr:
            case Number() | String() | Boolean():
                return expr.value
            case Name():
                value = self.scope(expr.name)
                if value is None:
                    raise WatchError(f"there is no variable `{expr.name}` here")
                return value
            case Member():
                return self.member(expr)
            case Index():
                return _element(self.value(expr.object), self.value(expr.index))
            case Call():
                return self.call(expr)
            case Unary():
                return _unary(expr.operator, self.value(expr.operand))
            case Binary():
                return self.binary(expr)
            case Conditional():
                return self.value(expr.then if _boolean(self.value(expr.test)) else expr.otherwise)
            case ArrayLiteral():
                return [self.value(element) for element in expr.elements]
            case ObjectLiteral():
                return {member.key: self.value(member.value) for member in expr.members}
            case ErrorExpr():
                raise WatchError("the expression is not complete")

    def member(self, expr: Member) -> Value:
        path = dotted(expr)
        if path is not None:  # the name of a variable may contain dots
            value = self.scope(path)
            if value is not None:
                return value
        owner = self.value(expr.object)
        if expr.name == "length" and isinstance(owner, (list, str)):
            return len(bytes_of(owner) if isinstance(owner, str) else owner)
        if isinstance(owner, list):
            self.take(len(owner))
            return [_part(element, expr.name) for element in owner]
        return _part(owner, expr.name)

    def binary(self, expr: Binary) -> Value:
        left = self.value(expr.left)
        if expr.operator is Operator.AND:
            return _boolean(left) and _boolean(self.value(expr.right))
        if expr.operator is Operator.OR:
            return _boolean(left) or _boolean(self.value(expr.right))
        right = self.value(expr.right)
        symbol = expr.operator.symbol
        if expr.operator in (Operator.EQUAL, Operator.NOT_EQUAL):
            _check_comparable(left, right, symbol)
            if isinstance(left, list):
                self.take(len(left))
            return _are_equal(left, right) is (expr.operator is Operator.EQUAL)
        return _computed(_OPERATORS[expr.operator], symbol, _number(left, symbol), _number(right, symbol))

    def call(self, expr: Call) -> Value:
        match expr.function:
            case Member(object=Name(name="Math"), name=name) if name in FUNCTIONS:
                function = FUNCTIONS[name]
            case _:
                raise WatchError("only functions of `Math` can be called")
        if name == "random":
            raise WatchError("`Math.random()` has no value here, because each execution draws a new number")
        given = len(expr.arguments)
        if not function.takes(given):
            raise WatchError(f"`{function.signature}` does not take {given} arguments")
        symbol = f"Math.{name}"
        arguments = [_number(self.value(argument), symbol) for argument in expr.arguments]
        if function.result is FunctionResult.REAL:
            arguments = [float(argument) for argument in arguments]
        return _computed(_FUNCTIONS[name], symbol, *arguments)


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


def _unary(sign: UnaryOperator, operand: Value) -> Value:
    if sign is UnaryOperator.NOT:
        return not _boolean(operand)
    number = _number(operand, sign.symbol)
    return _limited(-number, sign.symbol) if sign is UnaryOperator.NEGATE else number


def _check_comparable(left: Value, right: Value, symbol: str) -> None:
    kinds = {"number" if type_of(value) in ("int", "real") else type(value).__name__ for value in (left, right)}
    if len(kinds) > 1 or isinstance(left, dict):
        raise WatchError(f"`{symbol}` cannot compare {shown(left)} with {shown(right)}")


def _are_equal(left: Value, right: Value) -> bool:
    if isinstance(left, (int, float)) and isinstance(right, (int, float)):
        left, right = _alike((left, right))
    return left == right


def _computed(function: Callable[..., float], symbol: str, *operands: int | float) -> Value:
    """The result of an operation on numbers, with the limits of `verify`."""
    try:
        result = function(*_alike(operands))
    except ZeroDivisionError:
        raise WatchError("division by zero") from None
    except OverflowError:
        raise WatchError(f"the result of `{symbol}` is too large") from None
    except ValueError:
        raise WatchError(f"`{symbol}` has no value for {' and '.join(map(shown, operands))}") from None
    return _limited(result, symbol)


def _alike(operands: Sequence[int | float]) -> Sequence[int | float]:
    """The operands as reals, if one of them is real."""
    return [float(operand) for operand in operands] if float in map(type, operands) else operands


def _limited(number: int | float, symbol: str) -> int | float:
    if isinstance(number, int) and not _MIN_INT <= number <= _MAX_INT:
        raise WatchError(f"integer overflow: the result of `{symbol}` does not fit into 64 bits")
    return number


_MIN_INT, _MAX_INT = -(1 << 63), (1 << 63) - 1

_OPERATORS: Mapping[Operator, Callable[[float, float], float]] = {
    Operator.LESS: operator.lt,
    Operator.LESS_EQUAL: operator.le,
    Operator.GREATER: operator.gt,
    Operator.GREATER_EQUAL: operator.ge,
    Operator.ADD: operator.add,
    Operator.SUBTRACT: operator.sub,
    Operator.MULTIPLY: operator.mul,
    Operator.DIVIDE: operator.truediv,
    Operator.REMAINDER: remainder,
}

_FUNCTIONS: Mapping[str, Callable[..., float]] = {
    "abs": abs,
    "ceil": math.ceil,
    "cos": math.cos,
    "floor": math.floor,
    "log": math.log,
    "max": max,
    "min": min,
    "pow": math.pow,
    "sin": math.sin,
}


def _number(value: Value, symbol: str) -> int | float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise WatchError(f"`{symbol}` needs numbers, not {shown(value)}")
    return value


def _boolean(value: Value) -> bool:
    if not isinstance(value, bool):
        raise WatchError(f"{shown(value)} is not a condition; compare it, for example with `==`")
    return value

# SPDX-License-Identifier: Apache-2.0
"""Evaluates expressions in a state.

- This module defines the meaning of expressions; tests compare the faster engines with it.
- `∧`, `∨`, `⇒` and `ite` evaluate only the operands that they need, from left to right, so that `i < n ∧ a[i] = 0` is
  safe.
- Ints are exact, reals are IEEE 754 doubles. `/` divides reals, `%` is the Euclidean remainder, the right operand of
  `log` is the base, `floor` and `ceil` return ints (`roaml.jani.operators`).
- The evaluation of an expression without a value raises `EvaluationError` with a position. Causes are a division by
  zero, an index outside of its array, an undefined variable, a value of the wrong type, or a random or nondeterministic
  choice.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from roaml.exhaustive import assert_never
from roaml.jani.deep import Steps, run
from roaml.jani.expressions import (
    ArrayAccess,
    ArrayConstructor,
    ArrayValue,
    Binary,
    Boolean,
    Call,
    Conditional,
    DatatypeAccess,
    DatatypeValue,
    Derivative,
    EmptyOption,
    Expression,
    Integer,
    Missing,
    Name,
    NamedNumber,
    OptionAccess,
    OptionValue,
    Real,
    Sample,
    Selection,
    Unary,
)
from roaml.jani.model import Function
from roaml.jani.node import Origin
from roaml.jani.operators import BinaryOperator, Operator, Signature
from roaml.record import Record

MAX_ARRAY_LENGTH = 1_000_000
"""The maximum number of elements that one array constructor creates in its dimension."""
MAX_CALLS = 10_000
"""The maximum number of calls of functions that are nested in each other."""

_LARGE = 1e21
"""Messages contain only numbers whose absolute value is less than this."""


class DatatypeInstance(Record, frozen=True):
    """A value of a datatype."""

    datatype: str
    members: Mapping[str, Value]


class Some(Record, frozen=True):
    """An option with a value; the empty option is `None`."""

    content: Value


Value: TypeAlias = "bool | int | float | tuple[Value, ...] | DatatypeInstance | Some | None"


class EvaluationError(Exception):
    """Raised if an expression has no value. `origin` is the position of the part without a value; `None` if unknown."""

    def __init__(self, message: str, origin: Origin | None) -> None:
        super().__init__(message)
        self.message = message
        self.origin = origin


class DivisionByZeroError(EvaluationError):
    """Raised if a number is divided by zero."""


def evaluate(
    expression: Expression, variables: Mapping[str, Value], functions: Mapping[str, Function] | None = None
) -> Value:
    """The value of `expression` in a state.

    Args:
        variables: name of a variable or constant -> its value in the state.
        functions: name of a function -> the function.

    Raises:
        EvaluationError: the expression has no value.
    """
    return run(_Evaluation(variables, functions or {}).value(expression, {}))


_DECIDED_BY_LEFT = {
    BinaryOperator.AND: (False, False),
    BinaryOperator.OR: (True, True),
    BinaryOperator.IMPLIES: (False, True),
}
"""Logical operator -> the value of the left operand that decides the result, and the result."""


class _Evaluation:
    def __init__(self, variables: Mapping[str, Value], functions: Mapping[str, Function]) -> None:
        self.variables = variables
        self.functions = functions
        self.calls = 0

    def value(self, node: Expression, bound: Mapping[str, Value]) -> Steps[Value]:
        """The value of `node`. `bound` contains the values of parameters and of variables of array constructors."""
        match node:
            case Boolean() | Integer() | Real():
                return node.value
            case NamedNumber():
                return node.constant.number
            case Name(identifier):
                return self.lookup(identifier, bound, node.origin)
            case Unary(operator, operand):
                return _apply(node, operator, (yield self.value(operand, bound)))
            case Binary(operator, left, right):
                first = yield self.value(left, bound)
                if operator in _DECIDED_BY_LEFT:
                    decisive, result = _DECIDED_BY_LEFT[operator]
                    if _boolean(first, left) is decisive:
                        return result
                    return _boolean((yield self.value(right, bound)), right)
                return _apply(node, operator, first, (yield self.value(right, bound)))
            case Conditional(test, then, otherwise):
                holds = _boolean((yield self.value(test, bound)), test)
                chosen: Value = yield self.value(then if holds else otherwise, bound)
                return chosen
            case Sample():
                raise EvaluationError("a random value is not known in advance", node.origin)
            case Selection():
                raise EvaluationError("a nondeterministic choice has no single value", node.origin)
            case Derivative(variable):
                raise EvaluationError(f"the derivative of `{variable}` is not known in a state", node.origin)
            case Missing():
                raise EvaluationError("the expression is missing", node.origin)
            case Call():
                returned: Value = yield self.call(node, bound)
                return returned
            case _:
                structure: Value = yield self.structure(node, bound)
                return structure

    def structure(
        self,
        node: ArrayAccess
        | ArrayValue
        | ArrayConstructor
        | DatatypeAccess
        | DatatypeValue
        | OptionAccess
        | OptionValue
        | EmptyOption,
        bound: Mapping[str, Value],
    ) -> Steps[Value]:
        """The value of an operation on arrays, datatypes and options."""
        match node:
            case ArrayAccess(array, index):
                elements: Value = yield self.value(array, bound)
                if not isinstance(elements, tuple):
                    raise EvaluationError("this is not an array", array.origin)
                position = _integer((yield self.value(index, bound)), index)
                if not 0 <= position < len(elements):
                    message = f"index {position} is outside of the array, whose length is {len(elements)}"
                    raise EvaluationError(message, node.origin)
                return elements[position]
            case ArrayValue(parts):
                values: list[Value] = []
                for part in parts:
                    values.append((yield self.value(part, bound)))
                return tuple(values)
            case ArrayConstructor(variable, length, body):
                size = _integer((yield self.value(length, bound)), length)
                if not 0 <= size <= MAX_ARRAY_LENGTH:
                    raise EvaluationError(
                        f"an array cannot have {size} elements; from 0 to {MAX_ARRAY_LENGTH:,} are supported",
                        length.origin,
                    )
                values = []
                for i in range(size):
                    values.append((yield self.value(body, {**bound, variable: i})))
                return tuple(values)
            case DatatypeAccess(record, member):
                value: Value = yield self.value(record, bound)
                if not isinstance(value, DatatypeInstance) or member not in value.members:
                    raise EvaluationError(f"the value has no member `{member}`", node.origin)
                return value.members[member]
            case DatatypeValue(datatype, pairs):
                members: dict[str, Value] = {}
                for name, part in pairs:
                    members[name] = yield self.value(part, bound)
                return DatatypeInstance(datatype, members)
            case OptionAccess(option):
                value = yield self.value(option, bound)
                if not isinstance(value, Some):
                    raise EvaluationError("the option is empty", node.origin)
                return value.content
            case OptionValue(content):
                return Some((yield self.value(content, bound)))
            case EmptyOption():
                return None
            case _:
                return assert_never(node)

    def lookup(self, identifier: str, bound: Mapping[str, Value], origin: Origin | None) -> Value:
        if identifier in bound:
            return bound[identifier]
        try:
            return self.variables[identifier]
        except KeyError:
            raise EvaluationError(f"there is no variable `{identifier}`", origin) from None

    def call(self, node: Call, bound: Mapping[str, Value]) -> Steps[Value]:
        function = self.functions.get(node.function)
        if function is None:
            raise EvaluationError(f"there is no function `{node.function}`", node.origin)
        if len(node.arguments) != len(function.parameters):
            needed, given = len(function.parameters), len(node.arguments)
            raise EvaluationError(
                f"wrong number of arguments of `{node.function}`: {given} instead of {needed}", node.origin
            )
        self.calls += 1
        if self.calls > MAX_CALLS:
            raise EvaluationError(
                f"more than {MAX_CALLS:,} calls of functions are nested, the innermost one of `{node.function}`",
                node.origin,
            )
        arguments: dict[str, Value] = {}
        for parameter, argument in zip(function.parameters, node.arguments, strict=True):
            arguments[parameter.name] = yield self.value(argument, bound)
        result: Value = yield self.value(function.body, arguments)
        self.calls -= 1
        return result


def _apply(node: Unary | Binary, operator: Operator, *values: Value) -> Value:
    kinds = {_kind(value) for value in values}
    if operator.signature is Signature.LOGICAL:
        fitting = kinds == {"bool"}
    elif operator.signature is Signature.EQUALITY:
        fitting = len(kinds) == 1
    else:
        fitting = kinds == {"number"}
    if not fitting:
        given = " and ".join(_shown(value) for value in values)
        raise EvaluationError(f"`{operator.symbol}` cannot be applied to {given}", node.origin)
    try:
        return operator.function(*values)  # type: ignore[no-any-return]
    except ZeroDivisionError:
        raise DivisionByZeroError("division by zero", node.origin) from None
    except OverflowError:
        message = f"the result of `{operator.symbol}` is too large"
    except ValueError:
        message = f"`{operator.symbol}` has no value for {' and '.join(_shown(value) for value in values)}"
    raise EvaluationError(message, node.origin)


def _boolean(value: Value, node: Expression) -> bool:
    if not isinstance(value, bool):
        raise EvaluationError(f"this must be true or false, not {_shown(value)}", node.origin)
    return value


def _integer(value: Value, node: Expression) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise EvaluationError(f"this must be a whole number, not {_shown(value)}", node.origin)
    return value


def _kind(value: Value) -> str:
    """A word for the kind of a value. Values of different kinds cannot be compared."""
    match value:
        case bool():
            return "bool"
        case int() | float():
            return "number"
        case tuple():
            return "array"
        case DatatypeInstance():
            return f"record {value.datatype}"
        case Some() | None:
            return "option"


def _shown(value: Value) -> str:
    """The text of `value` for a message."""
    match value:
        case bool():
            return "true" if value else "false"
        case int() | float():
            return str(value) if abs(value) < _LARGE else "a very large number"
        case tuple():
            return f"an array of {len(value)} elements"
        case DatatypeInstance():
            return f"a `{value.datatype}`"
        case Some() | None:
            return "an option"

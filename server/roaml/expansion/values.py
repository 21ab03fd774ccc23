# SPDX-License-Identifier: Apache-2.0
"""Values of parameters, and constant expressions over them (docs/spec/parameters.md#values).

Numbers are exact fractions: `1 - 0.9` is 0.1, as an author expects of a probability.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from typing import TypeAlias

from roaml.exact_number import remainder
from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.parse import parse
from roaml.expr.tree import Binary, Boolean, Call, Conditional, Expr, Member, Name, Number, String, Unary
from roaml.expr.types import BASE_TYPES, INTEGER_RANGES, ScalarKind
from roaml.record import Record
from roaml.text import Decoded

Content: TypeAlias = "bool | Fraction | str"


class ParameterValue(Record, frozen=True):
    """The value of a parameter. `type` is the name of a base type; numbers are fractions."""

    type: str
    content: Content

    @property
    def kind(self) -> ScalarKind:
        return BASE_TYPES[self.type].kind

    @property
    def text(self) -> str:
        """The value as text without quotes, as in an attribute that is not an expression."""
        match self.content:
            case bool():
                return "true" if self.content else "false"
            case Fraction():
                return number_text(self.content, is_real=self.kind is ScalarKind.REAL)
        return self.content

    @property
    def literal(self) -> str:
        """The value as a part of an expression."""
        match self.content:
            case str():
                escaped = self.content.replace("\\", "\\\\").replace("'", "\\'").replace("\n", "\\n")
                return f"'{escaped}'"
            case Fraction() if self.content < 0:
                return f"({self.text})"
        return self.text

    @property
    def inside_literal(self) -> str:
        """The value as a part of a string literal, in single or double quotes."""
        return self.text.replace("\\", "\\\\").replace("'", "\\'").replace('"', '\\"').replace("\n", "\\n")


Scope: TypeAlias = Mapping[str, ParameterValue]
"""Name of a parameter -> its value."""


def number_text(value: Fraction, *, is_real: bool) -> str:
    """A number without an exponent. A real number has a point. A fraction that is not a finite decimal, such as 1/3, is
    rounded to a float64; downwards where reals and integers are the same, because periods of timers are rounded down:
    with a rate that is rounded up, 300 ms would become 299 ms."""
    if value.denominator == 1:
        return f"{value.numerator}.0" if is_real else str(value.numerator)
    rest = value.denominator
    for prime in (2, 5):
        while rest % prime == 0:
            rest //= prime
    digits = len(str(value.denominator))
    if rest == 1 and digits <= 18:
        scaled = Decimal(value.numerator) / Decimal(value.denominator)
        if Fraction(scaled) == value:
            return format(scaled, "f")
    text = repr(float(value))
    if not is_real and Fraction(text) > value:
        text = repr(math.nextafter(float(value), -math.inf))
    return format(Decimal(text), "f")


def read_value(text: str, type_: str, scope: Scope) -> ParameterValue | str:
    """The value of type `type_` that `text` states; an explanation if there is none.

    Args:
        type_: the name of a base type.
        text: the text of a string; otherwise a constant expression over the parameters in `scope`.
    """
    kind = BASE_TYPES[type_].kind
    if kind is ScalarKind.STRING:
        return ParameterValue(type_, text)
    tree, findings = parse(Decoded(text.strip(), 0))
    content = None if findings else evaluate(tree, scope)
    if content is None or isinstance(content, str) or isinstance(content, bool) != (kind is ScalarKind.BOOL):
        wanted = {ScalarKind.BOOL: "`true`, `false`", ScalarKind.INT: "an integer"}.get(kind, "a number")
        several = (
            "; `as2fm-lsp experiment` computes properties for several values" if ":" in text or "," in text else ""
        )
        return f"`{text}` is not {wanted} or an expression of constants and parameters with this result{several}"
    if isinstance(content, Fraction) and kind is ScalarKind.INT:
        least, most = INTEGER_RANGES[type_]
        if content.denominator != 1:
            return f"`{text}` is {number_text(content, is_real=True)}, which is not an integer"
        if not least <= content <= most:
            return f"`{text}` is not in the range of `{type_}`, {least} to {most}"
    return ParameterValue(type_, content)


def evaluate(expr: Expr, scope: Scope) -> Content | None:
    """The value of an expression of literals and parameters; `None` if it contains anything else, or has no value."""
    match expr:
        case Number():
            return Fraction(str(expr.value)) if math.isfinite(expr.value) else None
        case Boolean() | String():
            return expr.value
        case Name():
            return scope[expr.name].content if expr.name in scope else None
        case Unary():
            return _unary(expr.operator, evaluate(expr.operand, scope))
        case Binary():
            return _binary(expr.operator, evaluate(expr.left, scope), evaluate(expr.right, scope))
        case Conditional():
            test = evaluate(expr.test, scope)
            if not isinstance(test, bool):
                return None
            return evaluate(expr.then if test else expr.otherwise, scope)
        case Call(function=Member(object=Name(name="Math"), name=function)):
            values = [evaluate(argument, scope) for argument in expr.arguments]
            numbers = [value for value in values if isinstance(value, Fraction)]
            return _call(function, numbers) if numbers and len(numbers) == len(values) else None
    return None


def _unary(operator: UnaryOperator, value: Content | None) -> Content | None:
    match operator:
        case UnaryOperator.NOT if isinstance(value, bool):
            return not value
        case UnaryOperator.NEGATE if isinstance(value, Fraction):
            return -value
        case UnaryOperator.PLUS if isinstance(value, Fraction):
            return value
    return None


def _binary(operator: Operator, left: Content | None, right: Content | None) -> Content | None:
    if left is None or right is None or type(left) is not type(right):
        return None
    if operator in (Operator.EQUAL, Operator.NOT_EQUAL):
        return (left == right) == (operator is Operator.EQUAL)
    if isinstance(left, bool) and isinstance(right, bool):
        return {Operator.AND: left and right, Operator.OR: left or right}.get(operator)
    if isinstance(left, Fraction) and isinstance(right, Fraction):
        return _arithmetic(operator, left, right)
    return None


def _arithmetic(operator: Operator, left: Fraction, right: Fraction) -> Content | None:
    match operator:
        case Operator.ADD:
            return left + right
        case Operator.SUBTRACT:
            return left - right
        case Operator.MULTIPLY:
            return left * right
        case Operator.DIVIDE:
            return left / right if right else None
        case Operator.REMAINDER:
            return remainder(left, right) if right else None
        case Operator.LESS:
            return left < right
        case Operator.LESS_EQUAL:
            return left <= right
        case Operator.GREATER:
            return left > right
        case Operator.GREATER_EQUAL:
            return left >= right
    return None


def _call(name: str, numbers: list[Fraction]) -> Fraction | None:
    match name, numbers:
        case "floor", [number]:
            return Fraction(math.floor(number))
        case "ceil", [number]:
            return Fraction(math.ceil(number))
        case "abs", [number]:
            return abs(number)
        case "min", _:
            return min(numbers)
        case "max", _:
            return max(numbers)
        case "pow", [base, exponent] if exponent.denominator == 1 and abs(exponent) <= 64 and (base or exponent >= 0):
            return base**exponent.numerator
    return None

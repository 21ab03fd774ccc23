# SPDX-License-Identifier: Apache-2.0
"""The operators and functions of the expression language (docs/spec/expressions.md#grammar), with the types of their
operands and results.

This is the only list of them: parser, typing, completion, signature help and translation read it.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass


class Operator(enum.Enum):
    """A binary operator: its spelling, its precedence (greater binds tighter) and its kind."""

    OR = ("||", 1, "logical")
    AND = ("&&", 2, "logical")
    EQUAL = ("==", 3, "equality")
    NOT_EQUAL = ("!=", 3, "equality")
    LESS = ("<", 4, "order")
    LESS_EQUAL = ("<=", 4, "order")
    GREATER = (">", 4, "order")
    GREATER_EQUAL = (">=", 4, "order")
    ADD = ("+", 5, "arithmetic")
    SUBTRACT = ("-", 5, "arithmetic")
    MULTIPLY = ("*", 6, "arithmetic")
    DIVIDE = ("/", 6, "arithmetic")
    REMAINDER = ("%", 6, "arithmetic")

    def __init__(self, symbol: str, precedence: int, kind: str) -> None:
        self.symbol = symbol
        self.precedence = precedence
        self.kind = kind


class UnaryOperator(enum.Enum):
    NEGATE = "-"
    PLUS = "+"
    NOT = "!"

    @property
    def symbol(self) -> str:
        return self.value


BINARY = {operator.symbol: operator for operator in Operator} | {"===": Operator.EQUAL, "!==": Operator.NOT_EQUAL}
UNARY = {operator.symbol: operator for operator in UnaryOperator}

CONDITIONAL_PRECEDENCE = 0
UNARY_PRECEDENCE = 7


@dataclass(frozen=True, slots=True)
class Function:
    """A function of `Math`.

    Attributes:
        parameters: their names, in order.
        result: `int`, `real`, or `same` (real if any argument is real, otherwise int).
        documentation: a description of the result.
        optional: the number of parameters at the end that may be omitted.
    """

    name: str
    parameters: tuple[str, ...]
    result: str
    documentation: str
    optional: int = 0

    @property
    def signature(self) -> str:
        return f"Math.{self.name}({', '.join(self.parameters)})"


FUNCTIONS = {
    function.name: function
    for function in (
        Function("abs", ("x",), "same", "The absolute value of x."),
        Function("ceil", ("x",), "int", "The smallest integer that is not less than x."),
        Function("cos", ("x",), "real", "The cosine of x, x in radians."),
        Function("floor", ("x",), "int", "The greatest integer that is not greater than x."),
        Function(
            "log", ("x", "base"), "real", "The logarithm of x to a base; the default is the natural logarithm.", 1
        ),
        Function("max", ("a", "b"), "same", "The greater of a and b."),
        Function("min", ("a", "b"), "same", "The lesser of a and b."),
        Function("pow", ("x", "y"), "real", "x to the power of y."),
        Function(
            "random",
            (),
            "real",
            "One of 0.00, 0.01, …, 0.99, each equally probable; `<random_values>` of the system can "
            "increase their number. Only allowed where a value is stored.",
        ),
        Function("sin", ("x",), "real", "The sine of x, x in radians."),
    )
}

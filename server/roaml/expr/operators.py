# SPDX-License-Identifier: Apache-2.0
"""The operators and functions of the expression language (docs/spec/expressions.md#grammar), with the types of their
operands and results.

This is the only list of them: parser, typing, completion, signature help and translation read it.
"""

from __future__ import annotations

import enum

from roaml.exhaustive import Vocabulary
from roaml.record import Record


class OperatorKind(Vocabulary):
    """The kind of a binary operator, which determines the types of its operands and of its result."""

    LOGICAL = "logical"
    EQUALITY = "equality"
    ORDER = "order"
    ARITHMETIC = "arithmetic"


COMPARING = (OperatorKind.ORDER, OperatorKind.EQUALITY)
"""The kinds of comparisons."""


class Operator(enum.Enum):
    """A binary operator: its spelling, its precedence (greater binds tighter) and its kind."""

    OR = ("||", 1, OperatorKind.LOGICAL)
    AND = ("&&", 2, OperatorKind.LOGICAL)
    EQUAL = ("==", 3, OperatorKind.EQUALITY)
    NOT_EQUAL = ("!=", 3, OperatorKind.EQUALITY)
    LESS = ("<", 4, OperatorKind.ORDER)
    LESS_EQUAL = ("<=", 4, OperatorKind.ORDER)
    GREATER = (">", 4, OperatorKind.ORDER)
    GREATER_EQUAL = (">=", 4, OperatorKind.ORDER)
    ADD = ("+", 5, OperatorKind.ARITHMETIC)
    SUBTRACT = ("-", 5, OperatorKind.ARITHMETIC)
    MULTIPLY = ("*", 6, OperatorKind.ARITHMETIC)
    DIVIDE = ("/", 6, OperatorKind.ARITHMETIC)
    REMAINDER = ("%", 6, OperatorKind.ARITHMETIC)

    def __init__(self, symbol: str, precedence: int, kind: OperatorKind) -> None:
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


MIRRORED = {
    Operator.LESS: Operator.GREATER,
    Operator.LESS_EQUAL: Operator.GREATER_EQUAL,
    Operator.GREATER: Operator.LESS,
    Operator.GREATER_EQUAL: Operator.LESS_EQUAL,
    Operator.EQUAL: Operator.EQUAL,
    Operator.NOT_EQUAL: Operator.NOT_EQUAL,
}
"""Each comparison operator with the one that has the same meaning after an exchange of the operands."""
OPPOSITE = {
    Operator.LESS: Operator.GREATER_EQUAL,
    Operator.LESS_EQUAL: Operator.GREATER,
    Operator.GREATER: Operator.LESS_EQUAL,
    Operator.GREATER_EQUAL: Operator.LESS,
    Operator.EQUAL: Operator.NOT_EQUAL,
    Operator.NOT_EQUAL: Operator.EQUAL,
}
"""Each comparison operator with the one that holds if it does not."""

BINARY = {operator.symbol: operator for operator in Operator} | {"===": Operator.EQUAL, "!==": Operator.NOT_EQUAL}
UNARY = {operator.symbol: operator for operator in UnaryOperator}

CONDITIONAL_PRECEDENCE = 0
UNARY_PRECEDENCE = 7


class FunctionResult(Vocabulary):
    """The type of the result of a function, as hover texts show it."""

    INT = "int"
    REAL = "float"
    AS_ARGUMENTS = "int or float"
    """Real if any argument is real, otherwise int."""


class Function(Record, frozen=True):
    """A function of `Math`.

    Attributes:
        parameters: the names of the parameters, in order.
        documentation: a description of the result.
        optional: the number of parameters at the end that may be omitted.
        repeats: whether more arguments than parameters can be given.
    """

    name: str
    parameters: tuple[str, ...]
    result: FunctionResult
    documentation: str
    optional: int = 0
    repeats: bool = False

    @property
    def signature(self) -> str:
        more = ("…",) if self.repeats else ()
        return f"Math.{self.name}({', '.join((*self.parameters, *more))})"

    def takes(self, count: int) -> bool:
        """Whether the function can be called with `count` arguments."""
        needed = len(self.parameters) - self.optional
        return needed <= count and (self.repeats or count <= len(self.parameters))


FUNCTIONS = {
    function.name: function
    for function in (
        Function("abs", ("x",), FunctionResult.AS_ARGUMENTS, "The absolute value of x."),
        Function("ceil", ("x",), FunctionResult.INT, "The smallest integer that is not less than x."),
        Function("cos", ("x",), FunctionResult.REAL, "The cosine of x, x in radians."),
        Function("floor", ("x",), FunctionResult.INT, "The greatest integer that is not greater than x."),
        Function(
            "log",
            ("x", "base"),
            FunctionResult.REAL,
            "The logarithm of x to a base; the default is the natural logarithm.",
            1,
        ),
        Function("max", ("a", "b"), FunctionResult.AS_ARGUMENTS, "The greatest of the arguments.", repeats=True),
        Function("min", ("a", "b"), FunctionResult.AS_ARGUMENTS, "The least of the arguments.", repeats=True),
        Function("pow", ("x", "y"), FunctionResult.REAL, "x to the power of y."),
        Function(
            "random",
            (),
            FunctionResult.REAL,
            "One of the values 0, 1/n, 2/n, …, (n − 1)/n, each equally probable. n is the parameter `random_values` of "
            "the system, 100 by default. The function is allowed only in values that are assigned or sent.",
        ),
        Function("sin", ("x",), FunctionResult.REAL, "The sine of x, x in radians."),
    )
}

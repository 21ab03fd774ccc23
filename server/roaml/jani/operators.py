# SPDX-License-Identifier: Apache-2.0
"""The operators of JANI expressions, with their symbols, functions and types.

The reader, the writer, the inference of types, the evaluation and the tests use this one list. The functions take and
return Python values (bool, int, float). They raise the exceptions of Python: `ZeroDivisionError`, `OverflowError`, and
`ValueError` outside of the domain. `roaml.jani.semantics` converts these to errors with a position.
"""

from __future__ import annotations

import enum
import math
import operator
from collections.abc import Callable
from typing import Any

from roaml.exact_number import remainder
from roaml.jani.features import Feature

_DERIVED = Feature.DERIVED_OPERATORS
_TRIGONOMETRIC = Feature.TRIGONOMETRIC_FUNCTIONS
_HYPERBOLIC = Feature.HYPERBOLIC_FUNCTIONS

_MAX_BITS = 1 << 16
"""The maximum number of bits of an int that is a power."""


class Signature(enum.Enum):
    """The types of the operands and the result of an operator."""

    LOGICAL = "bool -> bool"
    EQUALITY = "two values of one type -> bool"
    ORDER = "numbers -> bool"
    ARITHMETIC = "numbers -> int if all are int, otherwise real"
    REAL = "numbers -> real"
    ROUNDING = "number -> int"


def power(base: float, exponent: float) -> float:
    """`base` to the power of `exponent`. The result is an int if both are ints and the exponent is not negative.

    Raises:
        OverflowError: the result is too large.
        ValueError: the result is not a real number.
    """
    if isinstance(base, int) and isinstance(exponent, int) and exponent >= 0:
        if base.bit_length() * exponent > _MAX_BITS:
            raise OverflowError
        return base**exponent  # type: ignore[no-any-return]
    return math.pow(base, exponent)


def sign(value: float) -> int:
    return (value > 0) - (value < 0)


class Operator(enum.Enum):
    """The base of all operators.

    Attributes:
        symbol: the symbol of the operator in JANI.
        function: the function that computes the result.
        signature: the types of the operands and the result.
        feature: the extension of JANI that a file with this operator must declare; `None` if it needs none.
        spellings: other symbols that the reader accepts. They are never written.
    """

    def __init__(
        self,
        symbol: str,
        function: Callable[..., Any],
        signature: Signature,
        feature: Feature | None = None,
        *spellings: str,
    ) -> None:
        self.symbol = symbol
        self.function = function
        self.signature = signature
        self.feature = feature
        self.spellings = spellings

    def __reduce_ex__(self, protocol: object) -> tuple[Any, ...]:
        """Pickle the operator by its name, because lambda functions cannot be pickled."""
        return getattr, (type(self), self.name)


class UnaryOperator(Operator):
    """An operator with one operand, which JANI names `exp`."""

    NOT = "¬", operator.not_, Signature.LOGICAL, None, "!"
    FLOOR = "floor", math.floor, Signature.ROUNDING
    CEIL = "ceil", math.ceil, Signature.ROUNDING
    ABS = "abs", abs, Signature.ARITHMETIC, _DERIVED
    SIGN = "sgn", sign, Signature.ROUNDING, _DERIVED
    TRUNCATE = "trc", math.trunc, Signature.ROUNDING, _DERIVED
    SIN = "sin", math.sin, Signature.REAL, _TRIGONOMETRIC
    COS = "cos", math.cos, Signature.REAL, _TRIGONOMETRIC
    TAN = "tan", math.tan, Signature.REAL, _TRIGONOMETRIC
    COT = "cot", lambda x: 1 / math.tan(x), Signature.REAL, _TRIGONOMETRIC
    SEC = "sec", lambda x: 1 / math.cos(x), Signature.REAL, _TRIGONOMETRIC
    CSC = "csc", lambda x: 1 / math.sin(x), Signature.REAL, _TRIGONOMETRIC
    ASIN = "asin", math.asin, Signature.REAL, _TRIGONOMETRIC
    ACOS = "acos", math.acos, Signature.REAL, _TRIGONOMETRIC
    ATAN = "atan", math.atan, Signature.REAL, _TRIGONOMETRIC
    ACOT = "acot", lambda x: math.pi / 2 - math.atan(x), Signature.REAL, _TRIGONOMETRIC
    ASEC = "asec", lambda x: math.acos(1 / x), Signature.REAL, _TRIGONOMETRIC
    ACSC = "acsc", lambda x: math.asin(1 / x), Signature.REAL, _TRIGONOMETRIC
    SINH = "sinh", math.sinh, Signature.REAL, _HYPERBOLIC
    COSH = "cosh", math.cosh, Signature.REAL, _HYPERBOLIC
    TANH = "tanh", math.tanh, Signature.REAL, _HYPERBOLIC
    COTH = "coth", lambda x: 1 / math.tanh(x), Signature.REAL, _HYPERBOLIC
    SECH = "sech", lambda x: 1 / math.cosh(x), Signature.REAL, _HYPERBOLIC
    CSCH = "csch", lambda x: 1 / math.sinh(x), Signature.REAL, _HYPERBOLIC
    ASINH = "asinh", math.asinh, Signature.REAL, _HYPERBOLIC
    ACOSH = "acosh", math.acosh, Signature.REAL, _HYPERBOLIC
    ATANH = "atanh", math.atanh, Signature.REAL, _HYPERBOLIC
    ACOTH = "acoth", lambda x: math.atanh(1 / x), Signature.REAL, _HYPERBOLIC
    ASECH = "asech", lambda x: math.acosh(1 / x), Signature.REAL, _HYPERBOLIC
    ACSCH = "acsch", lambda x: math.asinh(1 / x), Signature.REAL, _HYPERBOLIC


class BinaryOperator(Operator):
    """An operator with two operands, which JANI names `left` and `right`."""

    OR = "∨", operator.or_, Signature.LOGICAL, None, "||", "or"
    AND = "∧", operator.and_, Signature.LOGICAL, None, "&&", "and"
    IMPLIES = "⇒", lambda left, right: not left or right, Signature.LOGICAL, _DERIVED, "=>"
    EQUAL = "=", operator.eq, Signature.EQUALITY, None, "=="
    NOT_EQUAL = "≠", operator.ne, Signature.EQUALITY, None, "!="
    LESS = "<", operator.lt, Signature.ORDER
    LESS_EQUAL = "≤", operator.le, Signature.ORDER, None, "<="
    GREATER = ">", operator.gt, Signature.ORDER, _DERIVED
    GREATER_EQUAL = "≥", operator.ge, Signature.ORDER, _DERIVED, ">="
    ADD = "+", operator.add, Signature.ARITHMETIC
    SUBTRACT = "-", operator.sub, Signature.ARITHMETIC
    MULTIPLY = "*", operator.mul, Signature.ARITHMETIC
    REMAINDER = "%", remainder, Signature.ARITHMETIC
    DIVIDE = "/", operator.truediv, Signature.REAL
    POWER = "pow", power, Signature.ARITHMETIC
    LOGARITHM = "log", math.log, Signature.REAL
    MINIMUM = "min", min, Signature.ARITHMETIC, _DERIVED
    MAXIMUM = "max", max, Signature.ARITHMETIC, _DERIVED


class NumberConstant(enum.Enum):
    """A named real number: `{"constant": "π"}`."""

    E = "e", math.e
    PI = "π", math.pi

    def __init__(self, symbol: str, number: float) -> None:
        self.symbol = symbol
        self.number = number


class Distribution(enum.Enum):
    """A probability distribution to sample from."""

    DISCRETE_UNIFORM = "DiscreteUniform", 2, True
    BERNOULLI = "Bernoulli", 1, True
    BINOMIAL = "Binomial", 2, True
    NEGATIVE_BINOMIAL = "NegativeBinomial", 2, True
    POISSON = "Poisson", 1, True
    GEOMETRIC = "Geometric", 1, True
    HYPERGEOMETRIC = "Hypergeometric", 3, True
    CONWAY_MAXWELL_POISSON = "ConwayMaxwellPoisson", 2, True
    ZIPF = "Zipf", 2, True
    UNIFORM = "Uniform", 2
    NORMAL = "Normal", 2
    LOG_NORMAL = "LogNormal", 2
    BETA = "Beta", 2
    CAUCHY = "Cauchy", 2
    CHI = "Chi", 1
    CHI_SQUARED = "ChiSquared", 1
    ERLANG = "Erlang", 2
    EXPONENTIAL = "Exponential", 1
    FISHER_SNEDECOR = "FisherSnedecor", 2
    GAMMA = "Gamma", 2
    INVERSE_GAMMA = "InverseGamma", 2
    LAPLACE = "Laplace", 2
    PARETO = "Pareto", 2
    RAYLEIGH = "Rayleigh", 1
    STABLE = "Stable", 4
    STUDENT_T = "StudentT", 3
    WEIBULL = "Weibull", 2
    TRIANGULAR = "Triangular", 3

    def __init__(self, symbol: str, arity: int, is_discrete: bool = False) -> None:
        """`arity` is the number of arguments; a discrete distribution has int values, others real values."""
        self.symbol = symbol
        self.arity = arity
        self.is_discrete = is_discrete


UNARY_OPERATORS = {spelling: op for op in UnaryOperator for spelling in (op.symbol, *op.spellings)}
BINARY_OPERATORS = {spelling: op for op in BinaryOperator for spelling in (op.symbol, *op.spellings)}
"""Accepted symbol -> its operator."""

NUMBER_CONSTANTS = {constant.symbol: constant for constant in NumberConstant}
DISTRIBUTIONS = {distribution.symbol: distribution for distribution in Distribution}

# SPDX-License-Identifier: Apache-2.0
"""The table of operators."""

from __future__ import annotations

import math
import pickle

import pytest

from roaml.jani.operators import BINARY_OPERATORS, UNARY_OPERATORS, BinaryOperator, Operator, Signature, UnaryOperator


@pytest.mark.parametrize(
    ("spelling", "symbol"),
    [
        ("&&", "∧"),
        ("and", "∧"),
        ("||", "∨"),
        ("or", "∨"),
        ("=>", "⇒"),
        ("==", "="),
        ("!=", "≠"),
        ("<=", "≤"),
        (">=", "≥"),
        ("%", "%"),
    ],
)
def test_spellings(spelling: str, symbol: str) -> None:
    assert BINARY_OPERATORS[spelling].symbol == symbol
    assert UNARY_OPERATORS["!"].symbol == "¬"


def test_no_spelling_has_two_meanings() -> None:
    for operators in (UnaryOperator, BinaryOperator):
        spellings = [spelling for op in operators for spelling in (op.symbol, *op.spellings)]
        assert len(spellings) == len(set(spellings))


@pytest.mark.parametrize("operator", [*UnaryOperator, *BinaryOperator])
def test_operators_survive_pickling(operator: Operator) -> None:
    assert pickle.loads(pickle.dumps(operator)) is operator


INVERSES = [
    ("asin", "sin"),
    ("acos", "cos"),
    ("atan", "tan"),
    ("acot", "cot"),
    ("asec", "sec"),
    ("acsc", "csc"),
    ("asinh", "sinh"),
    ("acosh", "cosh"),
    ("atanh", "tanh"),
    ("acoth", "coth"),
    ("asech", "sech"),
    ("acsch", "csch"),
]


@pytest.mark.parametrize(("inverse", "function"), INVERSES)
def test_inverse_functions(inverse: str, function: str) -> None:
    x = 0.7
    assert math.isclose(UNARY_OPERATORS[inverse].function(UNARY_OPERATORS[function].function(x)), x)


@pytest.mark.parametrize(("function", "cofunction"), [("sin", "csc"), ("cos", "sec"), ("tan", "cot")])
def test_reciprocal_functions(function: str, cofunction: str) -> None:
    for suffix in ("", "h"):
        product = UNARY_OPERATORS[function + suffix].function(0.7) * UNARY_OPERATORS[cofunction + suffix].function(0.7)
        assert math.isclose(product, 1)


def test_every_trigonometric_function_is_real() -> None:
    features = {op.symbol: op.feature for op in UnaryOperator if op.signature is Signature.REAL}
    assert set(features) == {name for pair in INVERSES for name in pair}

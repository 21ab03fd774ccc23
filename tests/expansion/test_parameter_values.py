# SPDX-License-Identifier: Apache-2.0
"""Values of parameters: numbers are exact, and their texts are read back as the same values."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.expansion.values import ParameterValue, number_text, read_value
from roaml.expr.types import INTEGER_RANGES
from roaml.model.timing import period

SCOPE = {
    "n": ParameterValue("int32", Fraction(5)),
    "loss": ParameterValue("float64", Fraction(1, 10)),
    "on": ParameterValue("bool", True),
    "who": ParameterValue("string", "it's"),
}


@pytest.mark.parametrize(
    ("text", "type_", "expected"),
    [
        ("1 - 0.9", "float64", "0.1"),
        ("1 - 3 * loss", "float64", "0.7"),
        ("n / 2", "float64", "2.5"),
        ("2 * n", "int32", "10"),
        ("2 * n", "float64", "10.0"),
        ("-n % 3", "int32", "1"),
        ("Math.floor(n / 2) + Math.pow(2, 3)", "int32", "10"),
        ("Math.min(n, 2, 7)", "int32", "2"),
        ("n > 3 && !on ? 1 : 2", "int32", "2"),
        ("on || n == 6", "bool", "true"),
        ("who == 'x'", "bool", "false"),
        ("1 / 3", "float64", repr(1 / 3)),
        ("1e-7", "float64", "0.0000001"),
        ("  a b ", "string", "  a b "),
    ],
)
def test_a_value_is_exact(text: str, type_: str, expected: str) -> None:
    value = read_value(text, type_, SCOPE)
    assert isinstance(value, ParameterValue), value
    assert value.text == expected


@pytest.mark.parametrize(
    ("text", "type_", "reason"),
    [
        ("n / 2", "int32", "2.5, which is not an integer"),
        ("300", "uint8", "0 to 255"),
        ("m", "int32", "not an integer"),
        ("n", "bool", "`true`, `false`"),
        ("1 / 0", "float64", "not a number"),
        ("1 +", "float64", "not a number"),
        ("Math.random()", "float64", "not a number"),
        ("", "int32", "not an integer"),
    ],
)
def test_a_wrong_value_has_a_reason(text: str, type_: str, reason: str) -> None:
    value = read_value(text, type_, SCOPE)
    assert isinstance(value, str)
    assert reason in value


def test_literals() -> None:
    assert ParameterValue("string", "it's\\").literal == "'it\\'s\\\\'"
    assert ParameterValue("int32", Fraction(-3)).literal == "(-3)"
    assert ParameterValue("bool", False).literal == "false"


@given(st.integers(), st.integers(0, 12))
def test_a_decimal_is_written_exactly(digits: int, places: int) -> None:
    value = Fraction(digits % 10**12, 10**places)
    assert Fraction(number_text(value, is_real=True)) == value


@given(st.fractions())
def test_another_number_is_rounded_to_a_float(value: Fraction) -> None:
    text = number_text(value, is_real=True)
    assert "e" not in text
    assert float(text) == float(value)


@given(st.sampled_from(sorted(INTEGER_RANGES)), st.integers(-(2**70), 2**70))
def test_an_integer_is_in_the_range_of_its_type(type_: str, value: int) -> None:
    least, most = INTEGER_RANGES[type_]
    read = read_value(str(value), type_, {})
    assert isinstance(read, ParameterValue) == (least <= value <= most)


@given(st.integers(1, 10**6), st.sampled_from((1, 10**3, 10**6)))
def test_a_rate_keeps_its_period(count: int, unit: int) -> None:
    """`rate_hz="1 / period"`: periods are rounded down, so the rate must not be rounded up."""
    rate = Fraction(number_text(Fraction(10**9, count * unit), is_real=False))
    if rate <= 10**9:
        assert period(rate).nanoseconds == period(Fraction(10**9, count * unit)).nanoseconds

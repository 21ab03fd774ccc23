# SPDX-License-Identifier: Apache-2.0
"""The values that users write for a parameter."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.exact_number import exact_fraction
from roaml.experiments.sweeps import SweepError, number_text, settings_of, sweep_of, sweeps_of, values_in


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("20:200:60", ["20", "80", "140", "200"]),  # the step at the end
        ("0.1:0.1:0.5", ["0.1", "0.2", "0.3", "0.4", "0.5"]),  # in the middle, as in PRISM
        ("0:1/3:1", ["0", "1/3", "2/3", "1"]),
        ("1:5:10", ["1", "6"]),  # only one reading has two numbers
        ("0:5:5", ["0", "5"]),  # both readings are equal
        ("3:6", ["3", "4", "5", "6"]),
        ("-1:1:1", ["-1", "0", "1"]),
        ("0,0.01,1/20", ["0", "0.01", "1/20"]),
        ("1,1:3:1,9", ["1", "2", "3", "9"]),
        ("fast, slow", ["fast", "slow"]),
        ("1e-3:1e-3:3e-3", ["0.001", "0.002", "0.003"]),
        ("0:0.3:1", ["0", "0.3", "0.6", "0.9"]),  # the end is not a multiple of the step
    ],
)
def test_values(text: str, values: list[str]) -> None:
    assert list(values_in(text, "x")) == values


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x", "write `NAME=VALUES`"),
        ("x=", "write `NAME=VALUES`"),
        ("x=1,,2", "a value of `x` is missing"),
        ("x=1:2:3:4", "is not a range of `x`"),
        ("x=a:b:c", "is not a range of `x`"),
        ("x=5:1:2", "contains fewer than two numbers;"),
        ("x=1:0:1", "contains fewer than two numbers;"),
        ("x=0.8:0.9", "contains fewer than two numbers with the step 1;"),
        ("x=-1:2:2.5", "can be read with its step at the end and with its step in the middle"),
        ("x=0:1:0.000001", "more than 100,000 values"),
    ],
)
def test_what_is_refused(text: str, message: str) -> None:
    with pytest.raises(SweepError, match=message.replace("(", r"\(")):
        sweep_of(text)


def test_a_grid() -> None:
    sweeps = sweeps_of(["a=1,2", "b=x,y"])
    assert settings_of(sweeps) == [
        (("a", "1"), ("b", "x")),
        (("a", "1"), ("b", "y")),
        (("a", "2"), ("b", "x")),
        (("a", "2"), ("b", "y")),
    ]
    assert settings_of(()) == [()]
    with pytest.raises(SweepError, match="given twice"):
        sweeps_of(["a=1", "a=2"])
    with pytest.raises(SweepError, match="1,000,000 points"):
        sweeps_of(["a=0:999", "b=0:999"])


@given(st.fractions(max_denominator=10_000))
def test_a_number_survives_its_text(number: Fraction) -> None:
    assert exact_fraction(number_text(number)) == number

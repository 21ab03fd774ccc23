# SPDX-License-Identifier: Apache-2.0
"""Values of properties as text."""

import math

import pytest

from roaml.comparison import as_written
from roaml.smc.statistics import Bounds
from roaml.verification.expectations import parse
from roaml.verification.number_text import exact_number, number, with_interval, without_noise


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.0, "1"),
        (0.0, "0"),
        (0.5, "0.5"),
        (0.99999977, "1 - 2.3e-07"),
        (0.999999, "0.999999"),
        (1 - 1.1e-16, "almost 1"),
        (1 + 2.2e-16, "1"),
        (1 - 2e-12, "1 - 2e-12"),
        (1.00000023, "1 + 2.3e-07"),
        (2.3e-8, "2.3e-08"),
        (math.inf, "∞"),
    ],
)
def test_only_1_is_shown_as_1(value: float, text: str) -> None:
    assert number(value) == text


def test_a_value_that_may_be_1_is_shown_as_1() -> None:
    assert exact_number(1 - 1e-9, 1.0) == "1"
    assert exact_number(1 - 2e-8, 1 - 1e-8) == "1 - 1.5e-08"
    assert exact_number(0.0, 1e-9) == "0"


def test_1_is_a_number_like_others_for_rewards() -> None:
    assert number(0.99999977, is_probability=False) == "1"
    assert exact_number(1 - 2e-16, 1 - 1.1e-16, is_probability=False) == "1"
    assert without_noise(Bounds(1 - 2e-16, 1 - 1.1e-16)) == Bounds(1, 1)
    assert without_noise(Bounds(0.5, 0.999)) == Bounds(0.5, 0.999)


@pytest.mark.parametrize(
    ("value", "bounds", "text"),
    [
        (0.5, (0.4, 0.6), "0.5 in [0.4, 0.6]"),
        (5.0, (4.0, math.inf), "at least 4"),
        (5.0, (-math.inf, math.inf), "5"),
        (math.inf, (math.inf, math.inf), "infinite"),
    ],
)
def test_no_number_is_beside_an_interval_without_an_end(value: float, bounds: tuple[float, float], text: str) -> None:
    assert with_interval(value, Bounds(*bounds)) == text


@pytest.mark.parametrize("text", ["0.9999993", "0.8", "1", "12345678", "1e-07"])
def test_a_written_number_keeps_its_digits(text: str) -> None:
    assert as_written(float(text)) == text
    assert parse(f"p <= {text}").text == f"≤ {text}"

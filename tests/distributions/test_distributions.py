# SPDX-License-Identifier: Apache-2.0
"""The probabilities of distributions are those of SciPy; discretised ones keep the promised bounds."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from fractions import Fraction
from typing import TypeAlias

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from roaml.distributions.data import read_histogram
from roaml.distributions.laws import LAWS, Continuous, LawError
from roaml.distributions.outcomes import MAX_CUT, Outcomes, Rounding, outcomes

Call: TypeAlias = "tuple[str | int, ...]"


def drawn(
    name: str | int, *arguments: str | int, step: str | None = None, rounding: Rounding = Rounding.NEAREST
) -> Outcomes:
    law = LAWS[str(name)].law([Fraction(argument) for argument in arguments])
    return outcomes(law, None if step is None else Fraction(step), rounding)


COUNTED = [
    (("bernoulli", "0.3"), stats.bernoulli(0.3).pmf),
    (("binomial", 40, "0.2"), stats.binom(40, 0.2).pmf),
    (("binomial", 3, 1), stats.binom(3, 1).pmf),
    (("geometric", "0.05"), stats.geom(0.05).pmf),
    (("geometric", 1), stats.geom(1).pmf),
    (("poisson", "3.5"), stats.poisson(3.5).pmf),
    (("poisson", 400), stats.poisson(400).pmf),
    (("uniform_int", -2, 3), stats.randint(-2, 4).pmf),
]


@pytest.mark.parametrize(("call", "mass"), COUNTED)
def test_integers_have_the_probabilities_of_scipy(call: Call, mass: Callable[[int], float]) -> None:
    result = drawn(*call)
    assert math.fsum(result.probabilities) == pytest.approx(1, abs=1e-12)
    assert result.shift == 0
    for value, probability in zip(result.values[:-1], result.probabilities, strict=False):
        assert probability == pytest.approx(mass(int(value)), rel=1e-10, abs=1e-300)
    distance = math.fsum(
        abs(probability - mass(int(value)))
        for value, probability in zip(result.values, result.probabilities, strict=True)
    )
    outside = 1 - math.fsum(mass(int(value)) for value in result.values)
    assert (distance + max(outside, 0)) / 2 <= result.cut + 1e-12
    assert result.cut <= MAX_CUT


CONTINUOUS = [
    (("normal", 2, "0.3"), stats.norm(2, 0.3)),
    (("normal", -5, 4), stats.norm(-5, 4)),
    (("exponential", "1.5"), stats.expon(scale=1.5)),
    (("uniform", -1, "2.3"), stats.uniform(-1, 3.3)),
]


@pytest.mark.parametrize("rounding", Rounding)
@pytest.mark.parametrize("step", ["0.05", "0.3", "1", "7"])
@pytest.mark.parametrize(("call", "law"), CONTINUOUS)
def test_each_multiple_of_the_step_has_the_probability_of_its_cell(
    call: Call, law: stats.rv_continuous, step: str, rounding: Rounding
) -> None:
    result = drawn(*call, step=step, rounding=rounding)
    h = Fraction(step)
    up = h / 2 if rounding is Rounding.NEAREST else Fraction(0)
    assert all((value / h).denominator == 1 for value in result.values)
    assert list(result.values) == sorted(result.values)
    for value, probability in zip(result.values[1:-1], result.probabilities[1:-1], strict=True):
        high = float(value + up)
        exact = (
            law.cdf(high) - law.cdf(high - float(h)) if high < law.mean() else law.sf(high - float(h)) - law.sf(high)
        )
        assert probability == pytest.approx(exact, rel=1e-9, abs=1e-15)
    assert result.cut == pytest.approx(
        law.cdf(float(result.values[0] + up - h)) + law.sf(float(result.values[-1] + up)), abs=1e-15
    )
    assert result.cut <= MAX_CUT


@given(st.sampled_from(CONTINUOUS), st.fractions("1/50", 3, max_denominator=100), st.floats(1e-5, 1 - 1e-5))
def test_quantiles_are_shifted_by_at_most_half_a_step(
    case: tuple[Call, stats.rv_continuous], step: Fraction, share: float
) -> None:
    call, law = case
    result = drawn(*call, step=str(step))
    sums = itertools.accumulate(result.probabilities)
    value = next(value for value, total in zip(result.values, sums, strict=True) if total >= share)
    low, high = law.ppf(share - result.cut), law.ppf(share + result.cut)
    assert low - float(result.shift) - 1e-9 <= float(value) <= high + float(result.shift) + 1e-9


def test_listed_values_are_kept_or_rounded() -> None:
    exact = drawn("categorical", "0.1", "0.25", "0.7", "0.75")
    assert exact == Outcomes((Fraction(1, 10), Fraction(7, 10)), (0.25, 0.75))
    rounded = drawn("categorical", "0.1", "0.25", "0.7", "0.75", step="1", rounding=Rounding.UP)
    assert (rounded.values, rounded.probabilities) == ((Fraction(1),), (1.0,))


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (("normal", 1, 0), "standard deviation"),
        (("normal", 1), "`mean`, `deviation`"),
        (("uniform", 2, 2), "less than"),
        (("uniform_int", "0.5", 2), "integers"),
        (("exponential", 0), "mean"),
        (("bernoulli", "1.5"), "not 1.5"),
        (("categorical", 1, "0.5", 2, "0.3"), "add up to 0.8"),
        (("categorical", 1, "0.5", 1, "0.5"), "twice"),
        (("categorical", 1, "0.5", 2), "arguments"),
        (("binomial", "2.5", "0.5"), "trials"),
        (("geometric", 0), "above 0"),
        (("geometric", "0.00001"), "more than 2,000 values"),
        (("poisson", 0), "above 0"),
        (("uniform_int", 0, 1_000_000), "1,000,001 values"),
        (("binomial", 5000, "0.5"), "5,001 values"),
    ],
)
def test_invalid_distributions_are_refused(call: Call, reason: str) -> None:
    with pytest.raises(LawError, match=reason):
        drawn(*call)


def test_a_step_that_is_too_small_is_refused() -> None:
    with pytest.raises(LawError, match="97,833 values"):
        drawn("normal", 0, 1, step="0.0001")
    with pytest.raises(LawError, match="step"):
        drawn("normal", 0, 1)


def test_probabilities_below_and_above_a_number_are_precise_in_the_tails() -> None:
    for call, law in CONTINUOUS:
        made = LAWS[str(call[0])].law([Fraction(argument) for argument in call[1:]])
        assert isinstance(made, Continuous)
        for x in (-40.0, -2.0, 0.0, 0.5, 2.0, 3.5, 30.0):
            assert made.below(x) == pytest.approx(law.cdf(x), rel=1e-12, abs=1e-300)
            assert made.above(x) == pytest.approx(law.sf(x), rel=1e-12, abs=1e-300)


@pytest.mark.parametrize("number", ["1e9999999", "1e-9999999", "1/1e9999999"])
def test_numbers_in_data_have_limited_sizes(number: str) -> None:
    """Their fractions would have ten million digits."""
    with pytest.raises(LawError, match="line 2"):
        read_histogram(f"2\n{number}\n")

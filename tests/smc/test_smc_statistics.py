# SPDX-License-Identifier: Apache-2.0
"""Quantiles against sums and tables; intervals keep what they promise, also when sampling stops early."""

from __future__ import annotations

import math
import random
from functools import cache

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.smc.run import FIRST_BATCH, GROWTH, LARGEST_BATCH, PEEKING
from roaml.smc.statistics import (
    Mean,
    Ratio,
    beta_quantile,
    clopper_pearson,
    incomplete_beta,
    okamoto,
    student_quantile,
)


def binomial_tail(k: int, n: int, p: float) -> float:
    """The probability of at least k successes."""
    return math.fsum(math.comb(n, i) * p**i * (1 - p) ** (n - i) for i in range(k, n + 1))


@given(st.integers(1, 60), st.data(), st.floats(0.001, 0.999))
def test_incomplete_beta_is_a_tail_of_the_binomial(n: int, data: st.DataObject, p: float) -> None:
    k = data.draw(st.integers(1, n))
    assert incomplete_beta(p, k, n - k + 1) == pytest.approx(binomial_tail(k, n, p), rel=1e-9, abs=1e-12)


@given(st.floats(0.001, 0.999), st.floats(0.5, 5000), st.floats(0.5, 5000))
def test_quantiles_are_where_the_distribution_says(probability: float, a: float, b: float) -> None:
    assert incomplete_beta(beta_quantile(probability, a, b), a, b) == pytest.approx(probability, abs=1e-7)


def test_quantiles_of_tables() -> None:
    for probability, freedom, expected in (
        (0.975, 1, 12.706),
        (0.975, 9, 2.2622),
        (0.95, 30, 1.6973),
        (0.995, 5, 4.0321),
    ):
        assert student_quantile(probability, freedom) == pytest.approx(expected, abs=1e-3)
    assert student_quantile(0.975, 10**7) == pytest.approx(1.959964, abs=1e-4)


@given(st.integers(1, 80), st.data(), st.sampled_from([0.8, 0.95, 0.99]))
def test_intervals_end_where_the_tails_say(n: int, data: st.DataObject, confidence: float) -> None:
    k = data.draw(st.integers(0, n))
    lower, upper = clopper_pearson(k, n, confidence)
    tail = (1 - confidence) / 2
    assert lower <= k / n <= upper
    assert lower == 0 if k == 0 else binomial_tail(k, n, lower) == pytest.approx(tail, abs=1e-6)
    assert upper == 1 if k == n else 1 - binomial_tail(k + 1, n, upper) == pytest.approx(tail, abs=1e-6)


def test_known_intervals() -> None:
    assert clopper_pearson(3, 10, 0.95) == pytest.approx((0.0667395, 0.6524529), abs=1e-6)
    assert clopper_pearson(0, 0, 0.95) == (0, 1)
    assert clopper_pearson(500_000, 1_000_000, 0.95) == pytest.approx((0.49902, 0.50098), abs=1e-5)


def test_undecided_traces_widen_the_interval() -> None:
    sure, unsure = clopper_pearson(50, 100, 0.95), clopper_pearson(50, 100, 0.95, undecided=20)
    assert unsure.lower == sure.lower
    assert unsure.upper == clopper_pearson(70, 100, 0.95).upper


def test_number_of_traces_by_okamoto() -> None:
    assert okamoto(0.95, 0.01) == 18445


@pytest.mark.parametrize(("p", "confidence"), [(p, c) for p in (0.01, 0.1, 0.37, 0.5, 0.93) for c in (0.8, 0.95)])
def test_coverage_of_intervals(p: float, confidence: float) -> None:
    """Exactly, over all numbers of successes: the true value is in the interval often enough."""
    n = 150
    covered = math.fsum(
        binomial_tail(k, n, p) - binomial_tail(k + 1, n, p)
        for k in range(n + 1)
        if clopper_pearson(k, n, confidence).lower <= p <= clopper_pearson(k, n, confidence).upper
    )
    assert covered >= confidence - 1e-9


@cache
def stop(n: int, k: int, confidence: float, epsilon: float) -> tuple[float, float] | None:
    """The interval if sampling stops here."""
    found = clopper_pearson(k, n, 1 - (1 - confidence) * PEEKING)
    return found if found.half_width <= epsilon else None


@pytest.mark.parametrize("p", [0.02, 0.05, 0.08, 0.12, 0.29, 0.41, 0.5])
def test_coverage_when_stopping_as_soon_as_possible(p: float) -> None:
    """Exactly, over everything that can happen until the adaptive method stops."""
    confidence, epsilon = 0.95, 0.06
    open_: dict[int, float] = {0: 1.0}
    done, covered = 0, 0.0
    while open_:
        size = max(FIRST_BATCH, min(LARGEST_BATCH, int(done * GROWTH)))
        done += size
        chances = [math.comb(size, i) * p**i * (1 - p) ** (size - i) for i in range(size + 1)]
        after: dict[int, float] = {}
        for k, weight in open_.items():
            for i, chance in enumerate(chances):
                if weight * chance > 1e-13:
                    after[k + i] = after.get(k + i, 0.0) + weight * chance
        open_ = {}
        for k, weight in after.items():
            interval = stop(done, k, confidence, epsilon)
            if interval is None:
                open_[k] = weight
            elif interval[0] <= p <= interval[1]:
                covered += weight
    assert covered >= confidence


@pytest.mark.parametrize(("p", "above"), [(0.75, True), (0.65, False)])
def test_errors_of_the_sequential_test(p: float, above: bool) -> None:
    ratio, wrong, tests = Ratio(0.7, 0.05, 0.05), 0, 400
    source = random.Random(5)
    for _ in range(tests):
        successes = traces = 0
        decision = None
        while decision is None:
            traces += 1
            successes += source.random() < p
            decision = ratio.decision(successes, traces)
        wrong += decision is not above
    # At most 5 percent are expected; more than 9 percent would happen once in ten thousand times.
    assert wrong <= 0.09 * tests


@given(st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=50))
def test_moments(values: list[float]) -> None:
    mean = Mean()
    for value in values:
        mean = mean.add(value)
    average = math.fsum(values) / len(values)
    assert mean.mean == pytest.approx(average, abs=1e-6)
    assert mean.squares == pytest.approx(math.fsum((v - average) ** 2 for v in values), abs=1e-3)

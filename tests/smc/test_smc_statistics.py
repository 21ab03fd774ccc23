# SPDX-License-Identifier: Apache-2.0
"""Quantiles compared with SciPy, sums and tables. Intervals have the stated confidence, also if sampling stops
early."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
import scipy.special
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from roaml.smc.run import FIRST_BATCH_TRACES, MIN_REWARD_TRACES, batches, stopping_error_share
from roaml.smc.statistics import (
    Bounds,
    Mean,
    Ratio,
    beta_quantile,
    clopper_pearson,
    confidence_sequence,
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


SHAPES = st.floats(0.5, 5000)


@given(st.floats(0, 1), SHAPES, SHAPES)
def test_incomplete_beta_is_that_of_scipy(x: float, a: float, b: float) -> None:
    assert incomplete_beta(x, a, b) == pytest.approx(scipy.special.betainc(a, b, x), rel=1e-7, abs=1e-12)


@given(st.floats(1e-6, 1 - 1e-6), SHAPES, SHAPES)
def test_quantiles_are_those_of_scipy(probability: float, a: float, b: float) -> None:
    assert beta_quantile(probability, a, b) == pytest.approx(scipy.stats.beta.ppf(probability, a, b), abs=1e-8)


@given(st.floats(0.51, 1 - 1e-6), st.floats(1, 1e6))
def test_student_quantiles_are_those_of_scipy(probability: float, freedom: float) -> None:
    expected = scipy.stats.t.ppf(probability, freedom)
    assert student_quantile(probability, freedom) == pytest.approx(expected, rel=1e-5, abs=1e-5)


@given(st.integers(1, 100_000), st.data(), st.sampled_from([0.5, 0.9, 0.95, 0.99, 0.9999]))
def test_intervals_are_those_of_scipy(traces: int, data: st.DataObject, confidence: float) -> None:
    successes = data.draw(st.integers(0, traces))
    interval = scipy.stats.binomtest(successes, traces).proportion_ci(confidence, method="exact")
    assert clopper_pearson(successes, traces, confidence) == pytest.approx((interval.low, interval.high), abs=1e-8)


@given(st.lists(st.integers(-1000, 1000), min_size=2, max_size=200), st.sampled_from([0.9, 0.95, 0.99]))
def test_intervals_of_means_are_those_of_scipy(values: list[int], confidence: float) -> None:
    mean = Mean()
    for value in values:
        mean = mean.add(value)
    error = scipy.stats.sem(values)
    if len(set(values)) == 1:
        assert mean.bounds(confidence) == (-math.inf, math.inf)
    else:
        expected = scipy.stats.t.interval(confidence, len(values) - 1, sum(values) / len(values), error)
        assert mean.bounds(confidence) == pytest.approx(expected, rel=1e-6, abs=1e-6)


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
    """Computed exactly, over all numbers of successes: the probability that the interval contains the true value is
    high enough."""
    n = 150
    covered = math.fsum(
        binomial_tail(k, n, p) - binomial_tail(k + 1, n, p)
        for k in range(n + 1)
        if clopper_pearson(k, n, confidence).lower <= p <= clopper_pearson(k, n, confidence).upper
    )
    assert covered >= confidence - 1e-9


@cache
def stop(n: int, k: int, confidence: float, epsilon: float) -> Bounds | None:
    """The interval if sampling stops here."""
    bounds = clopper_pearson(k, n, 1 - (1 - confidence) * stopping_error_share(confidence))
    return bounds if bounds.half_width <= epsilon else None


def added(open_: dict[int, float], size: int, p: float) -> dict[int, float]:
    """The probability of each number of successes after `size` further traces, each of which succeeds with probability
    `p`."""
    chances = [math.comb(size, i) * p**i * (1 - p) ** (size - i) for i in range(size + 1)]
    after: dict[int, float] = {}
    for k, weight in open_.items():
        for i, chance in enumerate(chances):
            if weight * chance > 1e-13:
                after[k + i] = after.get(k + i, 0.0) + weight * chance
    return after


class Stops(NamedTuple):
    """The intervals of all numbers of successes after a number of traces, and whether sampling continues."""

    traces: int
    continues: np.ndarray
    lower: np.ndarray
    upper: np.ndarray


def stops(confidence: float, epsilon: float) -> list[Stops]:
    """The batches of the adaptive method, up to the one after which it stops in any case."""
    tail = (1 - confidence) * stopping_error_share(confidence) / 2
    rows: list[Stops] = []
    for first, size in batches(0, None):
        n = first + size
        k = np.arange(n + 1)
        lower = np.where(k == 0, 0.0, scipy.stats.beta.ppf(tail, np.maximum(k, 1), n - k + 1))
        upper = np.where(k == n, 1.0, scipy.stats.beta.ppf(1 - tail, k + 1, np.maximum(n - k, 1)))
        rows.append(Stops(n, (upper - lower) / 2 > epsilon + 1e-12, lower, upper))
        if not rows[-1].continues.any():
            break
    return rows


def missed(rows: list[Stops], p: float) -> float:
    """The probability that the adaptive method stops with an interval that does not contain `p`."""
    weights, first, before, wrong = np.array([1.0]), 0, 0, 0.0
    for row in rows:
        weights = np.convolve(
            weights, scipy.stats.binom.pmf(np.arange(row.traces - before + 1), row.traces - before, p)
        )
        likely = np.nonzero(weights > 1e-14)[0]
        first, weights, before = first + likely[0], weights[likely[0] : likely[-1] + 1], row.traces
        at = slice(first, first + len(weights))
        misses = (p < row.lower[at]) | (row.upper[at] < p)
        wrong += float(weights[~row.continues[at] & misses].sum())
        weights = np.where(row.continues[at], weights, 0.0)
        if weights.sum() < 1e-12:
            break
    return wrong


@pytest.mark.parametrize("epsilon", [0.2, 0.12, 0.08, 0.05])
@pytest.mark.parametrize("confidence", [0.8, 0.95, 0.99, 0.999, 0.9999])
def test_coverage_when_stopping_as_soon_as_possible(confidence: float, epsilon: float) -> None:
    """Computed exactly, over all runs until the adaptive method stops. The error is greatest beside an end of an
    interval, so such probabilities are tried, with a grid between them. It is symmetrical about 1/2."""
    rows = stops(confidence, epsilon)
    ends = sorted({float(end) for row in rows for end in (*row.lower[~row.continues], *row.upper[~row.continues])})
    beside = [end * factor for end in ends if 0 < end <= 0.5 for factor in (1 - 1e-9, 1 + 1e-9)]
    tried = [*beside[:: max(1, len(beside) // 60)], *np.linspace(0.001, 0.5, 40)]
    worst = max((missed(rows, p), p) for p in tried)
    assert worst[0] <= 1 - confidence, worst


@pytest.mark.parametrize("most", [100, 150, 200, 300])
@pytest.mark.parametrize("p", [0.05, 0.29, 0.5])
def test_coverage_when_stopping_at_a_limit_of_traces(p: float, most: int) -> None:
    """Computed exactly: the adaptive method has the stated confidence also if `--max-traces` ends it."""
    confidence, epsilon = 0.95, 0.06
    open_: dict[int, float] = {0: 1.0}
    done, covered = 0, 0.0
    while open_:
        size = min(FIRST_BATCH_TRACES, most - done)
        done += size
        after, open_ = added(open_, size, p), {}
        for k, weight in after.items():
            interval = stop(done, k, confidence, epsilon)
            if interval is None and done < most:
                open_[k] = weight
                continue
            lower, upper = clopper_pearson(k, done, 1 - (1 - confidence) * stopping_error_share(confidence))
            covered += weight if lower <= p <= upper else 0.0
    assert covered >= confidence


@given(st.integers(1, 3000), st.data(), st.sampled_from([0.8, 0.95, 0.999]))
def test_confidence_sequences_contain_the_estimate_and_the_interval_of_clopper_and_pearson(
    n: int, data: st.DataObject, confidence: float
) -> None:
    """An interval that is valid at any stopping time is never narrower than one for a fixed number of traces."""
    k = data.draw(st.integers(0, n))
    lower, upper = confidence_sequence(k, n, confidence)
    once = clopper_pearson(k, n, confidence)
    assert lower <= k / n <= upper
    assert lower <= once.lower + 1e-9
    assert once.upper <= upper + 1e-9
    assert confidence_sequence(n - k, n, confidence) == pytest.approx((1 - upper, 1 - lower), abs=1e-9)


def test_confidence_sequences_end_where_the_martingale_says() -> None:
    """At both ends the mixture of likelihoods is 1 / error times the likelihood."""
    for k, n in ((3, 10), (1, 50), (400, 1000)):
        mixture = math.lgamma(k + 0.5) + math.lgamma(n - k + 0.5) - math.lgamma(n + 1) - math.log(math.pi)
        for end in confidence_sequence(k, n, 0.95):
            likelihood = k * math.log(end) + (n - k) * math.log1p(-end)
            assert mixture - likelihood == pytest.approx(math.log(20), abs=1e-6)
    assert confidence_sequence(0, 0, 0.95) == (0, 1)


def test_undecided_traces_widen_a_confidence_sequence() -> None:
    sure, unsure = confidence_sequence(50, 100, 0.95), confidence_sequence(50, 100, 0.95, undecided=20)
    assert unsure.lower == sure.lower
    assert unsure.upper == confidence_sequence(70, 100, 0.95).upper


def covers(interval: Bounds, p: float) -> bool:
    return interval.lower <= p <= interval.upper


@pytest.mark.parametrize("p", [0.03, 0.2, 0.5, 0.9])
def test_coverage_when_somebody_stops_as_soon_as_the_interval_is_wrong(p: float) -> None:
    """Computed exactly, over all runs: even if sampling stops as soon as an interval misses the true value, this
    happens no more often than stated. An interval for a fixed number of traces fails this test."""
    for method, keeps in ((confidence_sequence, True), (clopper_pearson, False)):
        confidence, open_, missed = 0.9, {0: 1.0}, 0.0
        for n in range(1, 250):
            after: dict[int, float] = {}
            for k, weight in open_.items():
                after[k] = after.get(k, 0.0) + weight * (1 - p)
                after[k + 1] = after.get(k + 1, 0.0) + weight * p
            likely = {k: weight for k, weight in after.items() if weight >= 1e-12}
            # Both bounds increase with the number of successes, so it is enough to search from both ends.
            counts = sorted(likely)
            while counts and not covers(method(counts[0], n, confidence), p):
                missed += likely[counts.pop(0)]
            while counts and not covers(method(counts[-1], n, confidence), p):
                missed += likely[counts.pop()]
            open_ = {k: likely[k] for k in counts}
        assert (missed <= 1 - confidence) is keeps


@pytest.mark.parametrize("method", [confidence_sequence, clopper_pearson])
def test_bounds_grow_with_the_number_of_successes(method: Callable[[int, int, float], Bounds]) -> None:
    for n in (1, 2, 17, 100, 399):
        intervals = [method(k, n, 0.9) for k in range(n + 1)]
        assert [i.lower for i in intervals] == sorted(i.lower for i in intervals)
        assert [i.upper for i in intervals] == sorted(i.upper for i in intervals)


RATIO = Ratio(0.7, 0.05, 0.05)
decided = cache(RATIO.decision)
"""The decision after some successes in a number of traces, which does not depend on `p`."""


@cache
def intervals_at(k: int, n: int) -> tuple[Bounds, Bounds]:
    """Both intervals after a decision, with a confidence of 0.95."""
    return confidence_sequence(k, n, 0.95), clopper_pearson(k, n, 0.95)


@pytest.mark.parametrize("p", [0.62, 0.65, 0.68, 0.7, 0.73, 0.75, 0.8])
def test_intervals_and_errors_of_the_sequential_test(p: float) -> None:
    """Computed exactly, over all runs until the test decides: the interval has the stated confidence, and so has the
    decision outside the indifference region."""
    error = 0.05
    open_, covered, above, covered_once = {0: 1.0}, 0.0, 0.0, 0.0
    n = 0
    while sum(open_.values()) > 1e-6:
        n += 1
        after: dict[int, float] = {}
        for k, weight in open_.items():
            after[k] = after.get(k, 0.0) + weight * (1 - p)
            after[k + 1] = after.get(k + 1, 0.0) + weight * p
        open_ = {}
        for k, weight in after.items():
            decision = decided(k, n)
            if decision is None:
                open_[k] = weight
                continue
            above += weight if decision else 0.0
            at_any_time, once = intervals_at(k, n)
            covered += weight if covers(at_any_time, p) else 0.0
            covered_once += weight if covers(once, p) else 0.0
    assert covered >= 1 - error
    if p == 0.7:
        assert covered_once < 1 - error
    if p >= 0.75:
        assert 1 - above <= error + 1e-5
    if p <= 0.65:
        assert above <= error


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
    # At most 5 percent are expected. More than 9 percent would occur once in ten thousand times.
    assert wrong <= 0.09 * tests


def test_intervals_of_means_are_valid_at_all_times() -> None:
    """In almost none of many runs, an interval misses the mean after the first values."""
    source, missed, runs = random.Random(3), 0, 300
    for _ in range(runs):
        mean, wrong = Mean(), False
        for number in range(1, 1500):
            mean = mean.add(source.expovariate(1.0))
            if number >= 100 and number % 20 == 0:
                lower, upper = mean.anytime_bounds(0.9)
                wrong = wrong or not lower <= 1.0 <= upper
        missed += wrong
    assert missed <= 0.1 * runs


REWARDS: dict[str, tuple[float, Callable[[np.random.Generator, int], np.ndarray]]] = {
    "1000 with probability 0.001": (1.0, lambda source, n: 1000.0 * (source.random(n) < 0.001)),
    "10,000 with probability 0.0005, otherwise 1": (
        5.9995,
        lambda source, n: np.where(source.random(n) < 5e-4, 1e4, 1.0),
    ),
    "one of two values": (3.0, lambda source, n: np.where(source.random(n) < 0.5, 1.0, 5.0)),
    "exponential": (1.0, lambda source, n: source.exponential(1.0, n)),
    "lognormal": (math.exp(2.0), lambda source, n: source.lognormal(0.0, 2.0, n)),
    "Pareto with infinite variance": (2.5, lambda source, n: source.pareto(5 / 3, n) + 1),
    "a loss with probability 0.002": (8.0, lambda source, n: np.where(source.random(n) < 0.002, -990.0, 10.0)),
}
"""Rare, skewed and heavy-tailed rewards: their expected values, and random values."""


def measured(values: np.ndarray) -> Mean:
    mean = float(values.mean())
    return Mean(len(values), mean, float(((values - mean) ** 2).sum()), float(values.min()), float(values.max()))


@pytest.mark.parametrize("epsilon", [0.1, 0.02])
@pytest.mark.parametrize("name", REWARDS)
def test_coverage_of_rewards_when_stopping_as_soon_as_possible(name: str, epsilon: float) -> None:
    """With 150 seeds, the intervals contain the expected value at least as often as stated, whenever the rule of the
    adaptive method ends the traces, or a limit of 60,000."""
    (expected, sample), confidence, covered = REWARDS[name], 0.95, 0
    share = 1 - (1 - confidence) * stopping_error_share(confidence)
    for seed in range(150):
        source, mean = np.random.default_rng(seed), Mean()
        for _, size in batches(0, 60_000):
            mean = mean.joined(measured(sample(source, size)))
            bounds = mean.bernstein_bounds(share)
            if mean.number >= MIN_REWARD_TRACES and bounds.half_width <= epsilon * abs(mean.mean):
                break
        covered += bounds.lower <= expected <= bounds.upper
    assert covered >= confidence * 150


def test_equal_rewards_have_no_interval() -> None:
    for number in (2, 100, 100_000):
        mean = Mean(number, 7.0, 0.0, 7.0, 7.0)
        for bounds in (mean.bounds(0.95), mean.bernstein_bounds(0.95), mean.anytime_bounds(0.95)):
            assert bounds == (-math.inf, math.inf)


@given(st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=50))
def test_moments(values: list[float]) -> None:
    mean = Mean()
    for value in values:
        mean = mean.add(value)
    average = math.fsum(values) / len(values)
    assert mean.mean == pytest.approx(average, abs=1e-6)
    assert mean.squares == pytest.approx(math.fsum((v - average) ** 2 for v in values), abs=1e-3)
    assert (mean.least, mean.greatest) == (min(values), max(values))

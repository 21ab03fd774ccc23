# SPDX-License-Identifier: Apache-2.0
"""Intervals, numbers of traces and sequential tests.

The quantiles are computed here from the incomplete beta function: importing a statistics package would take longer
than verifying most models.
"""

from __future__ import annotations

import math
from typing import NamedTuple

_TINY = 1e-300
_CLOSE = 1e-15
_MOST_TERMS = 100_000


class Bounds(NamedTuple):
    """A closed interval."""

    lower: float
    upper: float

    @property
    def half_width(self) -> float:
        return (self.upper - self.lower) / 2


def incomplete_beta(x: float, a: float, b: float) -> float:
    """The regularised incomplete beta function I_x(a, b) for a, b > 0 and 0 ≤ x ≤ 1.

    By its continued fraction (DLMF 8.17.22), which converges fast below the mean; above it, by symmetry.
    """
    if x <= 0.0:
        return 0.0
    if x >= 1.0:
        return 1.0
    if x > (a + 1) / (a + b + 2):
        return 1.0 - incomplete_beta(1 - x, b, a)
    log_front = math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)
    # Lentz's algorithm, as modified by Thompson and Barnett.
    c, d = 1.0, 1 - (a + b) * x / (a + 1)
    d = 1 / (d if abs(d) > _TINY else _TINY)
    result = d
    for m in range(1, _MOST_TERMS):
        even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        change = 1.0
        for term in (even, odd):
            d = 1 + term * d
            d = 1 / (d if abs(d) > _TINY else _TINY)
            c = 1 + term / c
            c = c if abs(c) > _TINY else _TINY
            change = c * d
            result *= change
        if abs(change - 1) < _CLOSE:
            break
    return math.exp(log_front) * result / a


def beta_quantile(probability: float, a: float, b: float) -> float:
    """The x with I_x(a, b) = probability."""
    low, high = 0.0, 1.0
    for _ in range(200):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        if incomplete_beta(middle, a, b) < probability:
            low = middle
        else:
            high = middle
        if high - low < 1e-13:
            break
    return (low + high) / 2


def student_quantile(probability: float, freedom: float) -> float:
    """The quantile of Student's t distribution, for a probability above 1/2."""
    x = beta_quantile(2 * (1 - probability), freedom / 2, 0.5)
    return math.sqrt(freedom * (1 - x) / x) if x > 0 else math.inf


def clopper_pearson(successes: int, traces: int, confidence: float, undecided: int = 0) -> Bounds:
    """The exact interval for a probability. Undecided traces may have been successes or not, so they widen it."""
    if traces == 0:
        return Bounds(0.0, 1.0)
    tail = (1 - confidence) / 2
    most = successes + undecided
    lower = 0.0 if successes == 0 else beta_quantile(tail, successes, traces - successes + 1)
    upper = 1.0 if most == traces else beta_quantile(1 - tail, most + 1, traces - most)
    return Bounds(lower, upper)


def okamoto(confidence: float, epsilon: float) -> int:
    """How many traces make the estimate of a probability miss by more than `epsilon` with a probability of at most
    1 - `confidence` (Okamoto 1958, by Hoeffding's bound)."""
    return math.ceil(math.log(2 / (1 - confidence)) / (2 * epsilon**2))


class Mean(NamedTuple):
    """The moments of the rewards seen so far."""

    number: int = 0
    mean: float = 0.0
    squares: float = 0.0

    def add(self, value: float) -> Mean:
        """With one more value (Welford 1962)."""
        number = self.number + 1
        step = value - self.mean
        mean = self.mean + step / number
        return Mean(number, mean, self.squares + step * (value - mean))

    def bounds(self, confidence: float) -> Bounds:
        """The interval for the expected value, by Student's t."""
        if self.number < 2:
            return Bounds(-math.inf, math.inf)
        deviation = math.sqrt(self.squares / (self.number - 1) / self.number)
        if deviation == 0:
            return Bounds(self.mean, self.mean)
        half = student_quantile((1 + confidence) / 2, self.number - 1) * deviation
        return Bounds(self.mean - half, self.mean + half)


class Ratio(NamedTuple):
    """Wald's sequential test of "the probability is at least `threshold` + `epsilon`" against "at most `threshold` -
    `epsilon`", both errors at most `error`."""

    threshold: float
    epsilon: float
    error: float

    def decision(self, successes: int, traces: int) -> bool | None:
        """Whether the probability is above the threshold; None while that is open."""
        high = min(self.threshold + self.epsilon, 1 - 1e-12)
        low = max(self.threshold - self.epsilon, 1e-12)
        failures = traces - successes
        ratio = successes * math.log(low / high) + failures * math.log((1 - low) / (1 - high))
        limit = math.log((1 - self.error) / self.error)
        if ratio <= -limit:
            return True
        return False if ratio >= limit else None

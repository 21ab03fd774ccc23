# SPDX-License-Identifier: Apache-2.0
"""Intervals, numbers of traces and sequential tests.

The quantiles are computed here from the incomplete beta function: importing a statistics package would take longer
than verifying most models.
"""

from __future__ import annotations

import math
from typing import NamedTuple

_MIN_DENOMINATOR = 1e-300
_MIN_RELATIVE_CHANGE = 1e-15
_MAX_TERMS = 100_000
_NARROWEST_AT_TRACES = 1000
_MAX_RELATIVE_ERROR = 1e-13
"""That of a quantile: Student's quantiles divide by small values."""


class Bounds(NamedTuple):
    """A closed interval."""

    lower: float
    upper: float

    @property
    def half_width(self) -> float:
        return (self.upper - self.lower) / 2


def incomplete_beta(x: float, a: float, b: float) -> float:
    """The regularised incomplete beta function I_x(a, b) for a, b > 0 and 0 ≤ x ≤ 1.

    It is computed by its continued fraction (DLMF 8.17.22), which converges fast below the mean; above the mean, the
    symmetry of the function is used.
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
    d = 1 / (d if abs(d) > _MIN_DENOMINATOR else _MIN_DENOMINATOR)
    result = d
    for m in range(1, _MAX_TERMS):
        even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        change = 1.0
        for term in (even, odd):
            d = 1 + term * d
            d = 1 / (d if abs(d) > _MIN_DENOMINATOR else _MIN_DENOMINATOR)
            c = 1 + term / c
            c = c if abs(c) > _MIN_DENOMINATOR else _MIN_DENOMINATOR
            change = c * d
            result *= change
        if abs(change - 1) < _MIN_RELATIVE_CHANGE:
            break
    return math.exp(log_front) * result / a


def beta_quantile(probability: float, a: float, b: float) -> float:
    """The x with I_x(a, b) = probability, by Newton's method within an interval that is halved where a step leaves it
    or does not halve it."""
    log_scale = math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b)
    low, high, x, last = 0.0, 1.0, a / (a + b), 1.0
    while high - low > _MAX_RELATIVE_ERROR * high:
        excess = incomplete_beta(x, a, b) - probability
        low, high = (x, high) if excess < 0 else (low, x)
        density = math.exp(log_scale + (a - 1) * math.log(x) + (b - 1) * math.log1p(-x))
        step = excess / density if density > 0 else math.inf
        if not low < x - step < high or abs(step) > last / 2:
            step = x - (low + high) / 2
            if not low < x - step < high:  # there is no number between them
                break
        x, last = x - step, abs(step)
        if last < _MAX_RELATIVE_ERROR * x:
            break
    return x


def student_quantile(probability: float, freedom: float) -> float:
    """The quantile of Student's t distribution, for a probability above 1/2."""
    x = beta_quantile(2 * (1 - probability), freedom / 2, 0.5)
    return math.sqrt(freedom * (1 - x) / x) if x > 0 else math.inf


def clopper_pearson(successes: int, traces: int, confidence: float, undecided: int = 0) -> Bounds:
    """The exact interval for a probability. Undecided traces may be successes or failures, so they widen it."""
    if traces == 0:
        return Bounds(0.0, 1.0)
    tail = (1 - confidence) / 2
    most = successes + undecided
    lower = 0.0 if successes == 0 else beta_quantile(tail, successes, traces - successes + 1)
    upper = 1.0 if most == traces else beta_quantile(1 - tail, most + 1, traces - most)
    return Bounds(lower, upper)


def confidence_sequence(successes: int, traces: int, confidence: float, undecided: int = 0) -> Bounds:
    """The interval for a probability that may be inspected after each trace: with the probability `confidence` all
    intervals of one run contain the true value, so it is valid whenever and for whatever reason the run stops.

    The beta-binomial mixture (Robbins 1970; Howard, Ramdas, McAuliffe and Sekhon 2021, "Time-uniform, nonparametric,
    nonasymptotic confidence sequences"): the likelihood of the observations averaged over Jeffreys' prior Beta(1/2,
    1/2), divided by their likelihood under a probability p, is a martingale that begins with 1 if p is the true
    probability. By Ville's inequality it ever reaches 1 / error with a probability of at most `error`. The interval
    contains the p for which it has not reached 1 / error.

    Args:
        successes, traces: the number of successes, and the number of independent traces.
        confidence: between 0 and 1.
        undecided: the number of those traces that are undecided; they widen the interval.
    """
    if traces == 0:
        return Bounds(0.0, 1.0)
    limit = -math.log1p(-confidence)
    most = successes + undecided
    lower = _crossing(successes, traces, limit)
    upper = 1.0 - _crossing(traces - most, traces, limit)
    return Bounds(lower, upper)


def _crossing(successes: int, traces: int, limit: float) -> float:
    """The greatest probability below the estimate at which the logarithm of the martingale reaches `limit`; 0 if there
    is none. The function decreases up to the estimate."""
    if successes == 0:
        return 0.0
    failures = traces - successes
    a, b, c = successes + 0.5, failures + 0.5, traces + 1.0
    mixture = math.lgamma(a) + math.lgamma(b) - math.lgamma(c) - math.log(math.pi)
    low, high = 0.0, successes / traces
    while high - low > 1e-13 * high:
        middle = (low + high) / 2
        if middle in (low, high):
            break
        value = mixture - successes * math.log(middle) - (failures * math.log1p(-middle) if failures else 0.0)
        if value >= limit:
            low = middle
        else:
            high = middle
    return low


def okamoto(confidence: float, epsilon: float) -> int:
    """The number of traces for which the estimate of a probability is wrong by more than `epsilon` with a probability
    of at most 1 - `confidence` (Okamoto 1958, by Hoeffding's bound)."""
    return math.ceil(math.log(2 / (1 - confidence)) / (2 * epsilon**2))


class Mean(NamedTuple):
    """The number and the mean of the rewards so far, the sum of the squares of their distances from the mean
    (`squares`), and the least and the greatest of them."""

    number: int = 0
    mean: float = 0.0
    squares: float = 0.0
    least: float = math.inf
    greatest: float = -math.inf

    @property
    def is_constant(self) -> bool:
        """Whether there are values and all are equal."""
        return self.least == self.greatest

    def add(self, value: float) -> Mean:
        """A copy to which one more value is added (Welford 1962)."""
        number = self.number + 1
        step = value - self.mean
        mean = self.mean + step / number
        squares = self.squares + step * (value - mean)
        return Mean(number, mean, squares, min(self.least, value), max(self.greatest, value))

    def joined(self, other: Mean) -> Mean:
        """The mean of the rewards of both (Chan, Golub and LeVeque 1983)."""
        if self.number == 0 or other.number == 0:
            return other if self.number == 0 else self
        number = self.number + other.number
        step = other.mean - self.mean
        share = other.number / number
        squares = self.squares + other.squares + step * step * self.number * share
        least, greatest = min(self.least, other.least), max(self.greatest, other.greatest)
        return Mean(number, self.mean + step * share, squares, least, greatest)

    def bounds(self, confidence: float) -> Bounds:
        """The interval for the expected value, by Student's t. Equal values have no variance to infer an interval
        from, so it is the whole line: a rare other value may not have been seen."""
        if self.number < 2 or self.is_constant:
            return Bounds(-math.inf, math.inf)
        deviation = math.sqrt(self.squares / (self.number - 1) / self.number)
        half = student_quantile((1 + confidence) / 2, self.number - 1) * deviation
        return Bounds(self.mean - half, self.mean + half)

    def bernstein_bounds(self, confidence: float) -> Bounds:
        """The interval for the expected value by the empirical Bernstein bound (Maurer and Pontil 2009, "Empirical
        Bernstein bounds and sample variance penalization", theorem 4), for values between the least and the greatest
        one so far.

        The bound holds for each number of values if all possible values are in this range. If a value outside of it is
        possible, the interval has no guarantee, but the second term keeps it wide while single values determine the
        mean, where that by Student's t is too narrow.
        """
        if self.number < 2 or self.is_constant:
            return Bounds(-math.inf, math.inf)
        log = math.log(4 / (1 - confidence))
        variance = self.squares / (self.number - 1)
        half = math.sqrt(2 * variance * log / self.number)
        half += 7 * (self.greatest - self.least) * log / (3 * (self.number - 1))
        return Bounds(self.mean - half, self.mean + half)

    def anytime_bounds(self, confidence: float) -> Bounds:
        """The interval for the expected value that may be inspected after each trace; it is valid for many traces, like
        the interval by Student's t, and not narrower than `bernstein_bounds`.

        The asymptotic confidence sequence by a mixture of normal distributions (Waudby-Smith, Arbour, Sinha, Kennedy
        and Ramdas 2024, "Time-uniform central limit theory and asymptotic confidence sequences"), narrowest after
        about `_NARROWEST_AT_TRACES` traces.
        """
        if self.number < 2 or self.is_constant:
            return Bounds(-math.inf, math.inf)
        deviation = math.sqrt(self.squares / self.number)
        error = -2 * math.log1p(-confidence)
        rho = (error + math.log1p(error)) / _NARROWEST_AT_TRACES
        spread = self.number * rho + 1
        half = deviation * math.sqrt(spread / (self.number**2 * rho) * (math.log(spread) + error))
        once = self.bernstein_bounds(confidence)
        return Bounds(min(self.mean - half, once.lower), max(self.mean + half, once.upper))


class Ratio(NamedTuple):
    """Wald's sequential test of "the probability is at least `threshold` + `epsilon`" against "it is at most
    `threshold` - `epsilon`".

    Each error has a probability of at most `error`: the ratio of likelihoods is a martingale under either hypothesis,
    and reaches 1 / `error` with at most that probability (Ville's inequality). For probabilities in between, there is
    no guarantee.
    """

    threshold: float
    epsilon: float
    error: float

    def decision(self, successes: int, traces: int) -> bool | None:
        """Whether the probability is above the threshold; `None` while it is undecided."""
        high = min(self.threshold + self.epsilon, 1 - 1e-12)
        low = max(self.threshold - self.epsilon, 1e-12)
        failures = traces - successes
        ratio = successes * math.log(low / high) + failures * math.log((1 - low) / (1 - high))
        limit = -math.log(self.error)
        if ratio <= -limit:
            return True
        return False if ratio >= limit else None

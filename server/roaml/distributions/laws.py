# SPDX-License-Identifier: Apache-2.0
"""The distributions that models can draw from (docs/spec/distributions.md#distributions)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import TypeAlias

from roaml.record import Record

_SUM_TOLERANCE = Fraction(1, 1000)
"""How much the probabilities of `categorical` may differ from 1 in total, as those of targets."""


class LawError(ValueError):
    """A distribution has invalid arguments; the message states the reason."""


class UniformLaw(Record, frozen=True):
    """Numbers from `low` to `high`, all with the same density."""

    low: Fraction
    high: Fraction

    def below(self, x: float) -> float:
        """The probability of a number of at most `x`."""
        return min(max((x - float(self.low)) / float(self.high - self.low), 0.0), 1.0)

    def above(self, x: float) -> float:
        """The probability of a number above `x`."""
        return min(max((float(self.high) - x) / float(self.high - self.low), 0.0), 1.0)

    @property
    def middle(self) -> Fraction:
        """A number inside of the support."""
        return (self.low + self.high) / 2


class NormalLaw(Record, frozen=True):
    """The normal distribution."""

    mean: Fraction
    deviation: Fraction

    def below(self, x: float) -> float:
        """The probability of a number of at most `x`."""
        return math.erfc((float(self.mean) - x) / (float(self.deviation) * math.sqrt(2))) / 2

    def above(self, x: float) -> float:
        """The probability of a number above `x`."""
        return math.erfc((x - float(self.mean)) / (float(self.deviation) * math.sqrt(2))) / 2

    @property
    def middle(self) -> Fraction:
        """A number inside of the support."""
        return self.mean


class ExponentialLaw(Record, frozen=True):
    """The exponential distribution with a mean, which is the inverse of its rate."""

    mean: Fraction

    def below(self, x: float) -> float:
        """The probability of a number of at most `x`."""
        return -math.expm1(-max(x, 0.0) / float(self.mean))

    def above(self, x: float) -> float:
        """The probability of a number above `x`."""
        return math.exp(-max(x, 0.0) / float(self.mean))

    @property
    def middle(self) -> Fraction:
        """A number inside of the support."""
        return self.mean


class ListedLaw(Record, frozen=True):
    """Finitely many values with their probabilities."""

    values: tuple[Fraction, ...]
    probabilities: tuple[float, ...]


class CountedLaw(Record, frozen=True, eq=False):
    """Integers from `first` on, without an end.

    Attributes:
        mass: the probability of an integer.
        above: the probability of a greater integer.
    """

    first: int
    mass: Callable[[int], float]
    above: Callable[[int], float]


Continuous: TypeAlias = UniformLaw | NormalLaw | ExponentialLaw
Law: TypeAlias = Continuous | ListedLaw | CountedLaw


class LawFunction(Record, frozen=True, eq=False):
    """A distribution as a function.

    Attributes:
        parameters: the names of its parameters, without `step`.
        has_units: whether numbers of the distribution are in the unit of its arguments, so that it can be one of times.
        is_continuous: whether its values must be rounded.
        documentation: a sentence about it.
        make: arguments -> the distribution; raises `LawError`.
        repeats: whether the parameters are repeated any number of times.
    """

    name: str
    parameters: tuple[str, ...]
    has_units: bool
    is_continuous: bool
    documentation: str
    make: Callable[[Sequence[Fraction]], Law]
    repeats: bool = False

    @property
    def value_parameters(self) -> tuple[str, ...]:
        """The parameters as the distribution of a value."""
        return (*self.parameters, "step") if self.is_continuous else self.parameters

    @property
    def signature(self) -> str:
        """The function with its parameters, as the distribution of a value."""
        return f"{self.name}({', '.join(self.value_parameters)}{', …' if self.repeats else ''})"

    def law(self, arguments: Sequence[Fraction]) -> Law:
        """The distribution with these arguments, without `step`.

        Raises:
            LawError: the arguments are not valid.
        """
        number = len(self.parameters)
        fits = len(arguments) % number == 0 and len(arguments) > 0 if self.repeats else len(arguments) == number
        if not fits:
            raise LawError(f"`{self.name}` has the arguments {', '.join(f'`{name}`' for name in self.parameters)}")
        return self.make(arguments)


def _uniform(arguments: Sequence[Fraction]) -> Law:
    low, high = arguments
    if low >= high:
        raise LawError("the first argument of `uniform` must be less than the second one")
    return UniformLaw(low, high)


def _uniform_int(arguments: Sequence[Fraction]) -> Law:
    low, high = arguments
    if low.denominator != 1 or high.denominator != 1 or low > high:
        raise LawError("`uniform_int` needs two integers, of which the first is not greater than the second")
    count = int(high - low) + 1
    return ListedLaw(_integers(int(low), count), (1 / count,) * count) if count <= MAX_VALUES else _too_many(count)


def _normal(arguments: Sequence[Fraction]) -> Law:
    mean, deviation = arguments
    if deviation <= 0:
        raise LawError("the standard deviation of `normal` must be above 0")
    return NormalLaw(mean, deviation)


def _exponential(arguments: Sequence[Fraction]) -> Law:
    (mean,) = arguments
    if mean <= 0:
        raise LawError("the mean of `exponential` must be above 0")
    return ExponentialLaw(mean)


def _bernoulli(arguments: Sequence[Fraction]) -> Law:
    probability = _probability("bernoulli", arguments[0])
    return ListedLaw((Fraction(0), Fraction(1)), (float(1 - probability), float(probability)))


def _categorical(arguments: Sequence[Fraction]) -> Law:
    values, shares = tuple(arguments[::2]), [_probability("categorical", share) for share in arguments[1::2]]
    total = sum(shares, Fraction(0))
    if abs(total - 1) > _SUM_TOLERANCE:
        raise LawError(f"the probabilities of `categorical` add up to {float(total):g} instead of 1")
    if len(set(values)) < len(values):
        raise LawError("`categorical` lists a value twice; add up its probabilities")
    return ListedLaw(values, tuple(float(share / total) for share in shares))


def _binomial(arguments: Sequence[Fraction]) -> Law:
    trials, probability = arguments[0], float(_probability("binomial", arguments[1]))
    if trials.denominator != 1 or trials < 0:
        raise LawError("the number of trials of `binomial` must be an integer of at least 0")
    count = int(trials)
    if count >= MAX_VALUES:
        _too_many(count + 1)
    return ListedLaw(_integers(0, count + 1), tuple(_binomial_mass(count, probability, k) for k in range(count + 1)))


def _binomial_mass(count: int, probability: float, successes: int) -> float:
    if probability in (0.0, 1.0):
        return float(successes == count * probability)
    ways = math.lgamma(count + 1) - math.lgamma(successes + 1) - math.lgamma(count - successes + 1)
    return math.exp(ways + successes * math.log(probability) + (count - successes) * math.log1p(-probability))


def _geometric(arguments: Sequence[Fraction]) -> Law:
    probability = float(_probability("geometric", arguments[0]))
    if probability == 0:
        raise LawError("the probability of `geometric` must be above 0")

    def above(trials: int) -> float:
        return float(trials < 1) if probability == 1 else math.exp(max(trials, 0) * math.log1p(-probability))

    return CountedLaw(1, lambda trials: above(trials - 1) * probability, above)


def _poisson(arguments: Sequence[Fraction]) -> Law:
    mean = float(arguments[0])
    if mean <= 0:
        raise LawError("the mean of `poisson` must be above 0")

    def mass(number: int) -> float:
        return math.exp(number * math.log(mean) - mean - math.lgamma(number + 1))

    def above(number: int) -> float:
        # Beyond the mean, the terms decrease; they are added until they do not change the sum.
        total, k = 0.0, number + 1
        while (term := mass(k)) > total * 1e-17 or k < mean:
            total += term
            k += 1
        return min(total, 1.0)

    return CountedLaw(0, mass, above)


def _probability(name: str, value: Fraction) -> Fraction:
    if not 0 <= value <= 1:
        raise LawError(f"`{name}` needs a probability from 0 to 1, not {float(value):g}")
    return value


def _integers(first: int, count: int) -> tuple[Fraction, ...]:
    return tuple(Fraction(number) for number in range(first, first + count))


CATEGORICAL = "categorical"
"""The name of the distribution of listed values."""
HISTOGRAM = "histogram"
"""The name of the distribution that is read from a file (`roaml.distributions.data`)."""
MAX_VALUES = 2000
"""The maximum number of values of a distribution."""


def _too_many(count: int) -> Law:
    raise LawError(f"it has {count:,} values; at most {MAX_VALUES:,} are possible")


def _histogram(_: Sequence[Fraction]) -> Law:
    raise LawError("`histogram` needs the name of a file in quotes")


def _functions() -> Iterator[LawFunction]:
    yield LawFunction("bernoulli", ("p",), False, False, "1 with the probability p, otherwise 0.", _bernoulli)
    yield LawFunction(
        "binomial",
        ("n", "p"),
        False,
        False,
        "The number of successes in n trials that succeed with probability p.",
        _binomial,
    )
    yield LawFunction(
        CATEGORICAL,
        ("value", "p"),
        True,
        False,
        "Each value with the probability that follows it.",
        _categorical,
        repeats=True,
    )
    yield LawFunction(
        "exponential", ("mean",), True, True, "An exponential distribution; its rate is 1 / mean.", _exponential
    )
    yield LawFunction(
        "geometric",
        ("p",),
        False,
        False,
        "The number of trials up to the first success, at least 1; each trial succeeds with probability p.",
        _geometric,
    )
    yield LawFunction(
        "normal",
        ("mean", "deviation"),
        True,
        True,
        "A normal distribution with a mean and a standard deviation.",
        _normal,
    )
    yield LawFunction(
        HISTOGRAM,
        ("file", "step"),
        False,
        False,
        "The values in a CSV file, in quotes: a column of values, and optionally one with their numbers. `step` is "
        "optional; values are rounded to multiples of it.",
        _histogram,
    )
    yield LawFunction("poisson", ("mean",), False, False, "A Poisson distribution: an integer of at least 0.", _poisson)
    yield LawFunction("uniform", ("low", "high"), True, True, "Any number from low to high.", _uniform)
    yield LawFunction(
        "uniform_int",
        ("low", "high"),
        False,
        False,
        "One of the integers from low to high, all with the same probability.",
        _uniform_int,
    )


LAWS = {function.name: function for function in _functions()}
"""Name -> function, sorted by name."""

# SPDX-License-Identifier: Apache-2.0
"""Discretises distributions (docs/spec/distributions.md#discretisation)."""

from __future__ import annotations

import enum
import itertools
import math
from collections.abc import Callable, Mapping
from decimal import Decimal
from fractions import Fraction

from roaml.distributions.laws import MAX_VALUES, Continuous, CountedLaw, Law, LawError, ListedLaw
from roaml.record import Record

MAX_CUT = 1e-6
"""The maximum probability of the numbers that are replaced by the outermost values."""


class Rounding(enum.Enum):
    """How a number becomes a multiple of the step."""

    NEAREST = "nearest"
    UP = "up"


class Outcomes(Record, frozen=True):
    """A distribution with finitely many values.

    Attributes:
        values: the values, in increasing order unless the user listed them.
        probabilities: their probabilities, all above 0; they add up to 1.
        shift: how far a drawn number and the value that replaces it are apart at most, unless the number is cut.
        cut: an upper bound of the probability of the numbers that the outermost values replace.
    """

    values: tuple[Fraction, ...]
    probabilities: tuple[float, ...]
    shift: Fraction = Fraction(0)
    cut: float = 0.0

    @property
    def mean(self) -> float:
        return math.fsum(float(v) * p for v, p in zip(self.values, self.probabilities, strict=True))


def outcomes(law: Law, step: Fraction | None = None, rounding: Rounding = Rounding.NEAREST) -> Outcomes:
    """The values of a distribution with their probabilities.

    Args:
        step: the step of the values of a continuous distribution, above 0. Other distributions keep their values
            without a step, and are rounded to multiples of a step otherwise.

    Raises:
        LawError: there are too many values, or a continuous distribution has no step.
    """
    if isinstance(law, ListedLaw):
        return _listed(law, step, rounding)
    if isinstance(law, CountedLaw):
        return _counted(law)
    if step is None or step <= 0:
        raise LawError("the step of a distribution must be above 0")
    return _grid(law, step, rounding)


def hazards(drawn: Outcomes) -> tuple[float, ...]:
    """For k = 0, 1, … up to the greatest value: the probability that a number is k if it is at least k.

    Args:
        drawn: a distribution of integers of at least 0, in increasing order.
    """
    shares = dict(zip(drawn.values, drawn.probabilities, strict=True))
    last = int(drawn.values[-1])
    found: list[float] = []
    at_least = 0.0
    for number in range(last, -1, -1):
        share = shares.get(Fraction(number), 0.0)
        at_least += share
        found.append(share / at_least)
    return tuple(reversed(found))


def decimal_text(number: float) -> str:
    """A probability without an exponent."""
    return format(Decimal(repr(number)), "f")


def _listed(law: ListedLaw, step: Fraction | None, rounding: Rounding) -> Outcomes:
    shares: dict[Fraction, float] = {}
    for value, share in zip(law.values, law.probabilities, strict=True):
        if share > 0:
            rounded = value if step is None else _rounded(value / step, rounding) * step
            shares[rounded] = shares.get(rounded, 0.0) + share
    if len(shares) > MAX_VALUES:
        raise LawError(f"it has {len(shares):,} values; at most {MAX_VALUES:,} are possible")
    shift = Fraction(0) if step is None else _shift(step, rounding)
    return _outcomes(shares, shift, 0.0)


def _counted(law: CountedLaw) -> Outcomes:
    shares: dict[Fraction, float] = {}
    for number in itertools.count(law.first):
        if len(shares) == MAX_VALUES:
            raise LawError(f"it has more than {MAX_VALUES:,} values whose probability matters")
        rest = law.above(number)
        if rest <= MAX_CUT:
            shares[Fraction(number)] = law.mass(number) + rest
            return _outcomes(shares, Fraction(0), rest)
        shares[Fraction(number)] = law.mass(number)
    raise AssertionError


def _grid(law: Continuous, step: Fraction, rounding: Rounding) -> Outcomes:
    """The multiples of `step`. Each has the probability of the numbers that are rounded to it."""
    offset = Fraction(1, 2) if rounding is Rounding.NEAREST else Fraction(0)

    def edge(number: int) -> float:
        """The greatest number that is rounded to `number` times the step."""
        return float((number + offset) * step)

    middle = _rounded(law.middle / step, rounding)
    first = _last(middle, -1, lambda number: law.below(edge(number - 1)))
    last = _last(middle, 1, lambda number: law.above(edge(number)))
    if last - first >= MAX_VALUES:
        raise LawError(
            f"it has {last - first + 1:,} values at multiples of the step; at most {MAX_VALUES:,} are possible"
        )
    shares: dict[Fraction, float] = {}
    for number in range(first, last + 1):
        low, high = edge(number - 1), edge(number)
        # The smaller one of two differences has the smaller rounding error.
        share = law.above(low) - law.above(high) if number > middle else law.below(high) - law.below(low)
        share += law.below(low) if number == first else 0.0
        share += law.above(high) if number == last else 0.0
        if share > 0:
            shares[number * step] = share
    cut = law.below(edge(first - 1)) + law.above(edge(last))
    return _outcomes(shares, _shift(step, rounding), cut)


def _last(middle: int, direction: int, beyond: Callable[[int], float]) -> int:
    """The number nearest to `middle` in a direction, 1 or -1, beyond which there is at most half of `MAX_CUT`."""
    distance = 1
    while beyond(middle + direction * distance) > MAX_CUT / 2:
        distance *= 2
    near, far = 0, distance
    while near < far:
        half = (near + far) // 2
        if beyond(middle + direction * half) > MAX_CUT / 2:
            near = half + 1
        else:
            far = half
    return middle + direction * near


def _rounded(number: Fraction, rounding: Rounding) -> int:
    return math.ceil(number - Fraction(1, 2)) if rounding is Rounding.NEAREST else math.ceil(number)


def _shift(step: Fraction, rounding: Rounding) -> Fraction:
    return step / 2 if rounding is Rounding.NEAREST else step


def _outcomes(shares: Mapping[Fraction, float], shift: Fraction, cut: float) -> Outcomes:
    total = math.fsum(shares.values())
    return Outcomes(tuple(shares), tuple(share / total for share in shares.values()), shift, cut)

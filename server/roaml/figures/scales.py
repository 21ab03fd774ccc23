# SPDX-License-Identifier: Apache-2.0
"""Scales of the axes of plots: from numbers to the unit interval, and the numbers that label an axis."""

from __future__ import annotations

import enum
import math
from collections.abc import Iterable, Sequence

from roaml.record import Record

MAX_TICKS = 7
"""The maximum number of labelled places of a linear axis."""
_NICE = (1.0, 2.0, 2.5, 5.0, 10.0)
"""Multiples of a power of ten that are used as the distance of ticks."""


class ScaleKind(enum.Enum):
    """How numbers are placed on an axis."""

    LINEAR = "linear"
    LOGARITHMIC = "logarithmic"


class Scale(Record, frozen=True):
    """The numbers from `low` to `high`, both included, with the places that are labelled.

    Attributes:
        low, high: the ends; `low` is less than `high`. Both are positive if the scale is logarithmic.
        ticks: the labelled numbers, ascending, all between the ends.
    """

    kind: ScaleKind
    low: float
    high: float
    ticks: tuple[float, ...]

    def place(self, number: float) -> float:
        """The place of a number: 0 for `low`, 1 for `high`."""
        if self.kind is ScaleKind.LOGARITHMIC:
            return math.log(number / self.low) / math.log(self.high / self.low)
        return (number - self.low) / (self.high - self.low)

    def shows(self, number: float) -> bool:
        """Whether a number has a place on the axis."""
        return math.isfinite(number) and self.low <= number <= self.high


def scale_of(
    numbers: Iterable[float],
    kind: ScaleKind = ScaleKind.LINEAR,
    low: float | None = None,
    high: float | None = None,
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> Scale:
    """A scale that contains all finite numbers.

    Args:
        numbers: the numbers that are drawn. Those that are not finite are left out, and those that are not positive if
            the scale is logarithmic.
        low, high: the ends, if they are fixed.
        limits: the smallest and the greatest number that the ends may be, such as 0 and 1 for probabilities.
    """
    known = [number for number in numbers if math.isfinite(number)]
    known += [end for end in (low, high) if end is not None]
    if kind is ScaleKind.LOGARITHMIC:
        return _logarithmic([number for number in known if number > 0] or [1.0], low, high)
    return _linear(known or [0.0, 1.0], low, high, limits)


def _linear(numbers: Sequence[float], low: float | None, high: float | None, limits: tuple[float, float]) -> Scale:
    least, greatest = min(numbers), max(numbers)
    if least == greatest:
        margin = abs(least) / 10 or 0.5
        least, greatest = max(limits[0], least - margin), min(limits[1], greatest + margin)
    step = _step(greatest - least)
    begin = max(limits[0], math.floor(least / step + 1e-9) * step) if low is None else low
    end = min(limits[1], math.ceil(greatest / step - 1e-9) * step) if high is None else high
    first, last = math.ceil(begin / step - 1e-9), math.floor(end / step + 1e-9)
    return Scale(ScaleKind.LINEAR, begin, end, tuple(_rounded(index * step, step) for index in range(first, last + 1)))


def _step(width: float) -> float:
    """The distance of ticks for an axis of this width."""
    unit = 10.0 ** math.floor(math.log10(width / (MAX_TICKS - 1)))
    return next(unit * nice for nice in _NICE if unit * nice * (MAX_TICKS - 1) >= width * (1 - 1e-9))


def _rounded(number: float, step: float) -> float:
    """A multiple of `step` without the error of the multiplication."""
    return round(number, max(0, 2 - math.floor(math.log10(step)))) + 0.0


def _logarithmic(numbers: Sequence[float], low: float | None, high: float | None) -> Scale:
    first = math.floor(math.log10(min(numbers)) + 1e-9)
    last = max(math.ceil(math.log10(max(numbers)) - 1e-9), first + 1)
    begin, end = 10.0**first if low is None else low, 10.0**last if high is None else high
    factors = (1, 2, 5) if last - first <= 2 else (1,)
    stride = 1 + (last - first) // (MAX_TICKS + 1)
    ticks = [factor * 10.0**power for power in range(first, last + 1, stride) for factor in factors]
    return Scale(
        ScaleKind.LOGARITHMIC, begin, end, tuple(t for t in ticks if begin <= t * (1 + 1e-9) <= end * (1 + 2e-9))
    )


def number_label(number: float) -> str:
    """A number as the label of a tick."""
    text = f"{number:.10g}"
    return text.replace("-", "−") if not text.startswith("-0") or number else "0"

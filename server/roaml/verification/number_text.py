# SPDX-License-Identifier: Apache-2.0
"""Values of properties as text. A value is shown as 1 only if it is 1, because 1 means that a property certainly
holds."""

from __future__ import annotations

import math

from roaml.smc.statistics import Bounds

ALMOST_ONE = "almost 1"
"""The words for a probability that is less than 1 by no more than the rounding of floating-point numbers."""
_ROUNDING = 1e-12
"""The greatest difference from 1 that says nothing about the model."""


def number(value: float, digits: int = 6, *, is_probability: bool = True) -> str:
    """A value with `digits` significant digits. A probability that is not 1, but would be rounded to 1, is written as a
    difference, such as `1 - 2.3e-08`, or in words if the difference is that of rounding.

    Args:
        is_probability: false for rewards and differences, for which 1 is a number like any other.
    """
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    text = f"{value:.{digits}g}"
    if text != "1" or value == 1 or not is_probability:
        return text
    if abs(1 - value) <= _ROUNDING:
        return ALMOST_ONE if value < 1 else text
    return f"1 {'-' if value < 1 else '+'} {abs(1 - value):.2g}"


def without_noise(bounds: Bounds) -> Bounds:
    """The bounds of an exact reward, 1 instead of what differs from 1 only by rounding: the words for such a number are
    those of probabilities."""
    return Bounds(*(1.0 if abs(1 - end) <= _ROUNDING else end for end in bounds))


def with_interval(value: float, bounds: Bounds, *, is_probability: bool = True) -> str:
    """An estimate with its interval. If that has only a lower end, a number within it would mean nothing, so only the
    end is shown."""
    lower, upper = bounds
    if math.isinf(value):
        return "infinite"
    if upper == math.inf:
        least = number(lower, is_probability=is_probability)
        return number(value, is_probability=is_probability) if lower == -math.inf else f"at least {least}"
    ends = ", ".join(number(end, is_probability=is_probability) for end in bounds)
    return f"{number(value, is_probability=is_probability)} in [{ends}]"


def distinct(value: float, other: float) -> str:
    """A value with as many digits as are necessary to see on which side of another number it is."""
    for digits in range(6, 17):
        text = f"{value:.{digits}g}"
        if text != f"{other:.{digits}g}":
            return number(value, digits)
    return number(value)


def exact_number(lower: float, upper: float, digits: int = 7, *, is_probability: bool = True) -> str:
    """A value that is known to be between two bounds that are close to each other. 0 and 1 are preferred to other
    numbers between the bounds."""
    value = next((end for end in (0.0, 1.0) if lower <= end <= upper), (lower + upper) / 2)
    return number(value, digits, is_probability=is_probability)


def json_number(value: float) -> float | str | None:
    """The number as a value for JSON, which has only finite numbers: `infinity` or `-infinity` as text, `None` for
    NaN."""
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else "infinity" if value > 0 else "-infinity"

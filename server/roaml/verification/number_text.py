# SPDX-License-Identifier: Apache-2.0
"""Values of properties as text. A value is shown as 1 only if it is 1, because 1 means that a property certainly
holds."""

from __future__ import annotations

import math

_ROUNDING = 1e-12
"""The difference from 1 that sums of numbers with 16 digits may have by rounding."""


def number(value: float, digits: int = 6) -> str:
    """A value with `digits` significant digits. A value that is not 1, but would be rounded to 1, is written as a
    difference, such as `1 - 2.3e-08`, or as `almost 1` if the difference may be a rounding error."""
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    if 0 < abs(1 - value) < _ROUNDING:
        return "almost 1"
    text = f"{value:.{digits}g}"
    return f"1 {'-' if value < 1 else '+'} {abs(1 - value):.2g}" if text == "1" and value != 1 else text


def distinct(value: float, other: float) -> str:
    """A value with as many digits as are necessary to see on which side of another number it is."""
    for digits in range(6, 17):
        text = f"{value:.{digits}g}"
        if text != f"{other:.{digits}g}":
            return number(value, digits)
    return number(value)


def exact_number(lower: float, upper: float, digits: int = 7) -> str:
    """A value that is known to be between two bounds that are close to each other. 0 and 1 are preferred to other
    numbers between the bounds."""
    return number(next((end for end in (0.0, 1.0) if lower <= end <= upper), (lower + upper) / 2), digits)


def json_number(value: float) -> float | str | None:
    """The number as a value for JSON, which has only finite numbers: `infinity` or `-infinity` as text, `None` for
    NaN."""
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else "infinity" if value > 0 else "-infinity"

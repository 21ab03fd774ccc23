# SPDX-License-Identifier: Apache-2.0
"""Numbers as users write them, as exact fractions, and remainders of numbers."""

from __future__ import annotations

from fractions import Fraction
from typing import TypeVar

Number = TypeVar("Number", int, float, Fraction)

SMALLEST, GREATEST = 1e-30, 1e30
"""The smallest and greatest absolute value of a number other than 0. Without these limits, the fraction of `1e-9999999`
would have ten million digits."""


def exact_number(text: str) -> Fraction | None:
    """The value of `text`, a decimal number such as ` 0.5` or `2e3`; `None` if it is not a number, or if its absolute
    value is outside the limits `SMALLEST` and `GREATEST`."""
    try:
        size = abs(float(text))
        if "/" in text or not (SMALLEST <= size <= GREATEST or (size == 0 and _is_zero(text))):
            return None
        return Fraction(text.strip())
    except ValueError:
        return None


def _is_zero(text: str) -> bool:
    """Whether a number is exactly 0. A float is also 0 if the number is too small for it."""
    return not any(digit in "123456789" for digit in text.lower().partition("e")[0])


def exact_fraction(text: str) -> Fraction | None:
    """The value of `text`, a decimal number or a fraction of two, such as `1/3`; `None` if it is neither; see
    `exact_number`."""
    numerator, slash, denominator = text.partition("/")
    above, below = exact_number(numerator), exact_number(denominator) if slash else Fraction(1)
    return above / below if above is not None and below else None


def remainder(left: Number, right: Number) -> Number:
    """The Euclidean remainder of `left / right`: 0 <= result < |right|, for all signs.

    JANI does not define the sign of the result. Storm and PRISM return the same result for positive divisors. In
    ECMAScript, C and IEEE 754, the result has the sign of `left`.

    Raises:
        ZeroDivisionError: `right` is 0.
    """
    return left % abs(right)

# SPDX-License-Identifier: Apache-2.0
"""Texts for people about sets of values."""

from __future__ import annotations

import math

from roaml.expr.format import format_string
from roaml.model.values.domain import Constant, Origin, ValueSet

MAX_NAMED = 4
"""The maximum number of values that a text lists."""


MAX_TYPE_BOUND = 2**16
"""The maximum size of a bound that is described although only the type of the value gives it."""


def described(values: ValueSet, most: int = MAX_NAMED) -> str:
    """The values as a phrase after a verb, such as ``0``, ``1, 2 or 3`` or `between 0 and 5`; "" if nothing is known
    about them. At most `most` values are listed."""
    if values.only is not None and len(values.only) <= most:
        texts = [_text(value) for value in sorted(values.only, key=lambda v: (isinstance(v, str), v))]
        return texts[0] if len(texts) == 1 else " or ".join((", ".join(texts[:-1]), texts[-1])) if texts else ""
    if values.only is not None:
        numbers = [value for value in values.only if not isinstance(value, str)]
        return f"between {_text(min(numbers))} and {_text(max(numbers))}" if len(numbers) == len(values.only) else ""
    low, high = _says_something(values.low, values.low_from), _says_something(values.high, values.high_from)
    if low and high:
        return f"between {_text(values.low)} and {_text(values.high)}"
    if low:
        return f"at least {_text(values.low)}"
    return f"at most {_text(values.high)}" if high else ""


def _says_something(bound: float, origin: Origin) -> bool:
    """Whether a bound is worth mentioning: one that only a wide type gives is not."""
    return math.isfinite(bound) and (origin is not Origin.ASSUMED or abs(bound) <= MAX_TYPE_BOUND)


def is_informative(values: ValueSet) -> bool:
    """Whether a set says more than the type of the values."""
    if values.only is not None:
        return values.only != frozenset((True, False)) or not all(isinstance(v, bool) for v in values.only)
    return min(values.low_from, values.high_from) < Origin.ASSUMED and bool(described(values))


def _text(value: Constant) -> str:
    if isinstance(value, bool):
        return "`true`" if value else "`false`"
    if isinstance(value, str):
        return f"`{format_string(value)}`"
    return f"{value:,.6g}".replace(",", "") if isinstance(value, float) and not value.is_integer() else str(int(value))

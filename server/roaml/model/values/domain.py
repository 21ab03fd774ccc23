# SPDX-License-Identifier: Apache-2.0
"""Sets of values of one variable, field or expression: the abstract domain of the analysis.

- `ValueSet` contains at least all values that occur. A set of at most `MAX_LISTED` constants is listed; a larger set of
  numbers is an interval.
- Each bound of an interval has an origin. Only a bound that values reach is a reason for a warning.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from enum import IntEnum
from typing import TypeAlias

from roaml.record import Record

Constant: TypeAlias = bool | int | float | str

MAX_LISTED = 10
"""The maximum number of constants that are listed."""


class Origin(IntEnum):
    """Why an interval has a bound, the most certain reason first."""

    REACHED = 0
    """The bound is a value that was computed, or a condition of the model allows it."""
    WIDENED = 1
    """A loop changes the value on each pass, and no bound was found within a few passes."""
    ASSUMED = 2
    """Nothing is known about the value, or only its type."""


class ValueSet(Record, frozen=True):
    """A set of values.

    Attributes:
        only: all values, if they are listed; otherwise `None`.
        low, high: the bounds of numbers that are not listed, included. Strings that are not listed have no bounds.
        low_from, high_from: the origins of the bounds.
    """

    only: frozenset[Constant] | None = None
    low: float = -math.inf
    high: float = math.inf
    low_from: Origin = Origin.ASSUMED
    high_from: Origin = Origin.ASSUMED

    @property
    def value(self) -> Constant | None:
        """The only value; `None` if there are several."""
        return next(iter(self.only)) if self.only is not None and len(self.only) == 1 else None

    def includes(self, value: Constant) -> bool:
        if self.only is not None:
            return value in self.only
        return isinstance(value, str) or self.low <= value <= self.high


ANYTHING = ValueSet()
TRUE, FALSE = ValueSet(frozenset((True,))), ValueSet(frozenset((False,)))
BOTH = ValueSet(frozenset((True, False)))
NONE: ValueSet = ValueSet(frozenset())


def exactly(value: Constant) -> ValueSet:
    return ValueSet(frozenset((value,)))


def listed(constants: Iterable[Constant]) -> ValueSet:
    """The set of `constants`; an interval if there are more than `MAX_LISTED` numbers."""
    only = frozenset(constants)
    if len(only) <= MAX_LISTED:
        return ValueSet(only)
    if any(isinstance(value, str) for value in only):
        return ANYTHING
    numbers = [value for value in only if not isinstance(value, str)]
    return ValueSet(None, min(numbers), max(numbers), Origin.REACHED, Origin.REACHED)


def truth(values: Iterable[bool]) -> ValueSet:
    return listed(values)


def between(low: float, high: float, low_from: Origin = Origin.REACHED, high_from: Origin = Origin.REACHED) -> ValueSet:
    """The numbers from `low` to `high`, both included."""
    if low == high and low_from is Origin.REACHED and high_from is Origin.REACHED:
        return exactly(low)
    return ValueSet(None, low, high, low_from, high_from)


def is_numeric(values: ValueSet) -> bool:
    """Whether listed values are numbers; values that are not listed may be numbers."""
    return values.only is None or not any(isinstance(value, str) for value in values.only)


def interval(values: ValueSet) -> ValueSet:
    """The smallest interval that contains `values`; `ANYTHING` for strings."""
    if values.only is None:
        return values
    if not values.only or not is_numeric(values):
        return ANYTHING
    numbers = [value for value in values.only if not isinstance(value, str)]
    return ValueSet(None, min(numbers), max(numbers), Origin.REACHED, Origin.REACHED)


def join(first: ValueSet, second: ValueSet) -> ValueSet:
    """The values that are in one of both sets."""
    if first == second:
        return first
    if first.only is not None and second.only is not None:
        return listed(first.only | second.only)
    if first.only == frozenset():
        return second
    if second.only == frozenset():
        return first
    first, second = interval(first), interval(second)
    low, low_from = min((first.low, first.low_from), (second.low, second.low_from))
    high, high_from = max((first.high, -first.high_from), (second.high, -second.high_from))
    return ValueSet(None, low, high, low_from, Origin(-high_from))


def joined(sets: Iterable[ValueSet]) -> ValueSet:
    result = NONE
    for values in sets:
        result = join(result, values)
    return result


def widen(before: ValueSet, after: ValueSet, thresholds: Sequence[float]) -> ValueSet:
    """A set that contains `after` and has no bound between two `thresholds` that `before` does not have, so that a
    sequence of such sets ends. `thresholds` is sorted."""
    if after == before or after.only is not None:
        return after
    before = interval(before)
    low, high, low_from, high_from = after.low, after.high, after.low_from, after.high_from
    if low < before.low:
        low = max((t for t in thresholds if t <= low), default=-math.inf)
        low_from = max(Origin.WIDENED, low_from)
    if high > before.high:
        high = min((t for t in thresholds if t >= high), default=math.inf)
        high_from = max(Origin.WIDENED, high_from)
    return ValueSet(None, low, high, low_from, high_from)


# ------------------------------------------------------------------ conditions


def below(values: ValueSet, limit: ValueSet, is_whole: bool, strict: bool) -> ValueSet:
    """The values that are less than some value of `limit`; also equal ones unless `strict`."""
    top = interval(limit)
    if values.only is not None:
        return ValueSet(
            frozenset(v for v in values.only if isinstance(v, str) or (v < top.high if strict else v <= top.high))
        )
    high = top.high
    if strict and is_whole and math.isfinite(high):
        high = math.ceil(high) - 1
    if high > values.high or (high == values.high and not _is_vaguer(values.high_from, top.high_from)):
        return values
    if values.low > high or (values.low == high and strict and not is_whole):
        return NONE
    return between(values.low, high, values.low_from, top.high_from)


def above(values: ValueSet, limit: ValueSet, is_whole: bool, strict: bool) -> ValueSet:
    """The values that are greater than some value of `limit`; also equal ones unless `strict`."""
    bottom = interval(limit)
    if values.only is not None:
        return ValueSet(
            frozenset(v for v in values.only if isinstance(v, str) or (v > bottom.low if strict else v >= bottom.low))
        )
    low = bottom.low
    if strict and is_whole and math.isfinite(low):
        low = math.floor(low) + 1
    if low < values.low or (low == values.low and not _is_vaguer(values.low_from, bottom.low_from)):
        return values
    if low > values.high or (low == values.high and strict and not is_whole):
        return NONE
    return between(low, values.high, bottom.low_from, values.high_from)


def _is_vaguer(bound: Origin, limit: Origin) -> bool:
    """Whether a condition with an equal limit says more about a bound: that it is reached, or, if a loop has no bound,
    that the condition ends the loop at a number of which nothing is known."""
    return limit < bound or (bound is Origin.WIDENED and limit is Origin.ASSUMED)


def meet(first: ValueSet, second: ValueSet) -> ValueSet:
    """The values that are in both sets."""
    if first.only is not None:
        return ValueSet(frozenset(value for value in first.only if second.includes(value)))
    if second.only is not None:
        return ValueSet(frozenset(value for value in second.only if first.includes(value)))
    low, low_from = max((first.low, -first.low_from), (second.low, -second.low_from))
    high, high_from = min((first.high, first.high_from), (second.high, second.high_from))
    return NONE if low > high else between(low, high, Origin(-low_from), high_from)


def without(values: ValueSet, other: ValueSet, is_whole: bool) -> ValueSet:
    """The values that are not the only value of `other`; all values if `other` has several."""
    value = other.value
    if value is None:
        return values
    if values.only is not None:
        return ValueSet(values.only - {value})
    if is_whole and not isinstance(value, str):
        if value == values.low:
            return between(values.low + 1, values.high, values.low_from, values.high_from)
        if value == values.high:
            return between(values.low, values.high - 1, values.low_from, values.high_from)
    return values

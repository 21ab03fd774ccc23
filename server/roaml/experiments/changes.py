# SPDX-License-Identifier: Apache-2.0
"""How the values of properties differ between two models, and whether the difference is significant
(docs/comparison.md#values).

The value of each side is in an interval. If the intervals of both sides are right, the difference is between the ends
`new.low - old.high` and `new.high - old.low`; this needs no assumption on how the traces of both models depend on each
other. A change is significant if 0 is not between these ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from roaml.exhaustive import Vocabulary
from roaml.experiments.enough import Met, meets
from roaml.experiments.points import ExperimentPoint, PointKind
from roaml.record import Record
from roaml.smc.statistics import Bounds
from roaml.verification.expectations import Expectation

ROUNDING = 1e-12
"""Exact values with at most this relative difference are equal: they are sums of floating-point numbers."""


class ValueVerdict(Vocabulary):
    """What happened to the value of a property."""

    SAME = "same"
    CHANGED = "changed"
    OPEN = "no significant change"
    ADDED = "added"
    REMOVED = "removed"
    LOST = "no value now"
    GAINED = "no value before"
    UNKNOWN = "no value"


class ValueChange(Record, frozen=True):
    """A property in two models.

    Attributes:
        old, new: the values; `None` if the model does not have the property.
        is_redefined: whether both models have the property, with different definitions.
        expected_before, expected_now: what is expected of the property in each model.
    """

    name: str
    old: ExperimentPoint | None
    new: ExperimentPoint | None
    is_redefined: bool = False
    expected_before: tuple[Expectation, ...] = ()
    expected_now: tuple[Expectation, ...] = ()

    @property
    def verdict(self) -> ValueVerdict:
        if self.old is None or self.new is None:
            return ValueVerdict.ADDED if self.old is None else ValueVerdict.REMOVED
        if not self.old.has_value or not self.new.has_value:
            if self.old.has_value:
                return ValueVerdict.LOST
            return ValueVerdict.GAINED if self.new.has_value else ValueVerdict.UNKNOWN
        if self.old.value == self.new.value and self.is_exact:
            return ValueVerdict.SAME
        low, high = self.difference
        if self.is_exact:
            near = ROUNDING * max(abs(self.old.value), abs(self.new.value))
            return ValueVerdict.SAME if low <= near and high >= -near else ValueVerdict.CHANGED
        return ValueVerdict.OPEN if low <= 0 <= high else ValueVerdict.CHANGED

    @property
    def is_exact(self) -> bool:
        """Whether both values are exact."""
        return all(point is not None and point.kind is PointKind.EXACT for point in (self.old, self.new))

    @property
    def change(self) -> float:
        """The new value minus the old one; not a number if one of them does not exist, or both are infinite."""
        return math.nan if self.old is None or self.new is None else self.new.value - self.old.value

    @property
    def difference(self) -> Bounds:
        """The interval of the difference; everything if one of the values does not exist."""
        if self.old is None or self.new is None or math.isnan(self.change):
            return Bounds(-math.inf, math.inf)
        return Bounds(self.new.low - self.old.high, self.new.high - self.old.low)

    def met_before(self) -> tuple[Met, ...]:
        return () if self.old is None else tuple(meets(self.old, e.threshold) for e in self.expected_before)

    def met_now(self) -> tuple[Met, ...]:
        return () if self.new is None else tuple(meets(self.new, e.threshold) for e in self.expected_now)

    @property
    def is_newly_missed(self) -> bool:
        """Whether the new value misses an expectation, and the old one missed none."""
        return Met.NO in self.met_now() and Met.NO not in self.met_before()

    @property
    def lacks_expected(self) -> bool:
        """Whether something is expected of the property, and the new version has no value, so that nobody knows whether
        it is met."""
        return bool(self.expected_now) and self.new is not None and not self.new.has_value

    @property
    def differs(self) -> bool:
        """Whether the value differs significantly, or one of the models has no value, or not the property."""
        return self.verdict not in (ValueVerdict.SAME, ValueVerdict.OPEN)


def value_changes(
    old: Sequence[ExperimentPoint],
    new: Sequence[ExperimentPoint],
    redefined: frozenset[str],
    expected_before: Sequence[Expectation],
    expected_now: Sequence[Expectation],
) -> tuple[ValueChange, ...]:
    """The properties of both models, in the order of the new one, then those that were removed."""
    before, after = ({point.name: point for point in points} for points in (old, new))
    return tuple(
        ValueChange(
            name,
            before.get(name),
            after.get(name),
            name in redefined,
            tuple(e for e in expected_before if e.name == name),
            tuple(e for e in expected_now if e.name == name),
        )
        for name in [*after, *(name for name in before if name not in after)]
    )

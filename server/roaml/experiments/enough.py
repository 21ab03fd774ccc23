# SPDX-License-Identifier: Apache-2.0
"""Which value of a parameter is enough: the values of a grid for which a property meets an expectation.

- Without assumptions, all values of the grid are computed, so the answer about these values is complete. Whether the
  property rises or falls with the parameter is then known for the values of the grid, and not between them.
- If it is assumed that the property is monotone, the border is found by bisection, with few points.
- Estimates have intervals whose confidence is valid for all points together (Bonferroni). A value whose interval
  contains the expected number is open.
"""

from __future__ import annotations

import enum
import itertools
from collections.abc import Callable, Sequence

from roaml.experiments.grid import ExperimentOptions
from roaml.experiments.points import ExperimentPoint, PointKind
from roaml.experiments.sweeps import Setting, Sweep
from roaml.jani.operators import BinaryOperator
from roaml.record import Record, replace
from roaml.smc.goal import Threshold

_SLACK = 1e-9
"""The difference up to which an exact value is equal to the expected number; exact values have bounds."""


class Met(enum.Enum):
    """Whether a point meets an expectation."""

    YES = "yes"
    NO = "no"
    OPEN = "open"


class Trend(enum.Enum):
    """How the exact values of a property change over the values of a parameter, in ascending order."""

    RISING = "the property never falls from one value to the next"
    FALLING = "the property never rises from one value to the next"
    MIXED = "the property rises and falls"
    UNKNOWN = "the values are estimates, or some are missing, so they do not show whether the property rises or falls"


class Enough(Record, frozen=True):
    """The values of one parameter that meet an expectation, for one setting of the others.

    Attributes:
        others: the other parameters.
        verdicts: the values in ascending order, with whether they meet the expectation. With the assumption, values
            that were not computed have the verdict that follows from it.
        is_assumed: whether the property was assumed to be monotone.
        trend: how the property changes over the values.
    """

    parameter: str
    others: Setting
    verdicts: tuple[tuple[str, Met], ...]
    is_assumed: bool
    trend: Trend

    @property
    def first(self) -> str | None:
        """The smallest value such that it and all greater values meet the expectation; `None` if there is none."""
        known = [value for value, met in self.verdicts]
        count = 0
        for _, met in reversed(self.verdicts):
            if met is not Met.YES:
                break
            count += 1
        return known[len(known) - count] if count else None

    @property
    def last(self) -> str | None:
        """The greatest value such that it and all smaller values meet the expectation; `None` if there is none."""
        last = None
        for value, met in self.verdicts:
            if met is not Met.YES:
                break
            last = value
        return last

    @property
    def open(self) -> tuple[str, ...]:
        """The values for which it is not known whether they meet the expectation."""
        return tuple(value for value, met in self.verdicts if met is Met.OPEN)

    def text(self, expectation: str) -> str:
        """The answer as a sentence without a full stop, then what was assumed or shown."""
        values = [value for value, _ in self.verdicts]
        where = f"{', '.join(f'{n} = {v}' for n, v in self.others)}: " if self.others else ""
        met = sum(verdict is Met.YES for _, verdict in self.verdicts)
        name = self.parameter
        if met == len(values):
            answer = f"{expectation} is met for all values of {name} from {values[0]} to {values[-1]}"
        elif met and self.open:
            fitting = ", ".join(value for value, verdict in self.verdicts if verdict is Met.YES)
            answer = f"{expectation} is met for {name} = {fitting}"
        elif met == 0:
            answer = f"{expectation} is met for no value of {name} from {values[0]} to {values[-1]}"
        elif self.first is not None and not self._meets_before(self.first):
            answer = f"{expectation} is met from {name} = {self.first} on, and for no smaller value"
        elif self.last is not None and not self._meets_after(self.last):
            answer = f"{expectation} is met up to {name} = {self.last}, and for no greater value"
        else:
            fitting = ", ".join(value for value, verdict in self.verdicts if verdict is Met.YES)
            answer = f"{expectation} is met for {name} = {fitting}"
        if self.open:
            answer += f"; open for {', '.join(self.open)}: use a smaller epsilon, or explore all states"
        basis = (
            "assumed: the property only rises or only falls with the parameter"
            if self.is_assumed
            else f"all {len(values)} values were computed; {self.trend.value}; nothing is known between them"
        )
        return f"{where}{answer} ({basis})"

    def _meets_before(self, value: str) -> bool:
        """Whether a value before another one may meet the expectation for sure."""
        names = [name for name, _ in self.verdicts]
        return any(met is Met.YES for _, met in self.verdicts[: names.index(value)])

    def _meets_after(self, value: str) -> bool:
        names = [name for name, _ in self.verdicts]
        return any(met is Met.YES for _, met in self.verdicts[names.index(value) + 1 :])


def together(options: ExperimentOptions, points: int) -> ExperimentOptions:
    """Options with which the intervals of all points are right together, with the confidence of `options`."""
    sampling = options.sampling
    error = (1 - sampling.confidence) / max(1, points)
    return replace(options, sampling=replace(sampling, confidence=1 - error))


def meets(point: ExperimentPoint, expected: Threshold) -> Met:
    """Whether a point meets an expectation: for an exact value, by the value; otherwise, by the whole interval."""
    if not point.has_value:
        return Met.OPEN
    if point.kind is PointKind.EXACT:
        return Met.YES if _holds(point.value, expected, _SLACK) else Met.NO
    verdicts = {_holds(end, expected, 0.0) for end in (point.low, point.high)}
    if expected.relation is BinaryOperator.EQUAL or len(verdicts) == 2:
        return Met.OPEN
    return Met.YES if verdicts.pop() else Met.NO


def _holds(value: float, expected: Threshold, slack: float) -> bool:
    return expected.met(value) or (
        expected.relation in (BinaryOperator.GREATER_EQUAL, BinaryOperator.LESS_EQUAL, BinaryOperator.EQUAL)
        and abs(value - expected.number) <= slack
    )


def enough_of(
    sweep: Sweep, others: Setting, point: Callable[[str], ExperimentPoint], expected: Threshold, *, is_assumed: bool
) -> Enough:
    """The values of a parameter that meet an expectation.

    Args:
        sweep: the parameter with its values, which must be numbers.
        others: the other parameters.
        point: the point for a value of the parameter.
        is_assumed: whether the property is assumed to be monotone: then only a few points are computed.
    """
    assert sweep.numbers is not None
    values = [value for _, value in sorted(zip(sweep.numbers, sweep.values, strict=True))]
    if is_assumed and len(values) > 2:
        verdicts = _bisected([*values], lambda value: meets(point(value), expected))
        return Enough(sweep.name, others, tuple(zip(values, verdicts, strict=True)), True, Trend.UNKNOWN)
    points = [point(value) for value in values]
    verdicts = [meets(each, expected) for each in points]
    return Enough(sweep.name, others, tuple(zip(values, verdicts, strict=True)), False, _trend(points))


def _bisected(values: Sequence[str], verdict: Callable[[str], Met]) -> list[Met]:
    """The verdicts of a monotone property. Open verdicts lie around the border."""
    known = {0: verdict(values[0]), len(values) - 1: verdict(values[-1])}

    def search(low: int, high: int) -> None:
        if high - low < 2 or known[low] is known[high]:
            return
        middle = (low + high) // 2
        known[middle] = verdict(values[middle])
        search(low, middle)
        search(middle, high)

    search(0, len(values) - 1)
    verdicts = []
    for index in range(len(values)):
        before = max(place for place in known if place <= index)
        verdicts.append(known[before])  # the next known verdict is the same, or they are neighbours
    return verdicts


def _trend(points: Sequence[ExperimentPoint]) -> Trend:
    if any(point.kind is not PointKind.EXACT for point in points):
        return Trend.UNKNOWN
    pairs = list(itertools.pairwise(points))
    if all(b.value >= a.value - _SLACK for a, b in pairs):
        return Trend.RISING
    return Trend.FALLING if all(b.value <= a.value + _SLACK for a, b in pairs) else Trend.MIXED

# SPDX-License-Identifier: Apache-2.0
"""Computes the value that a property asks for from all states of the model: its minimum and maximum over all
schedulers, and its value under uniform choices."""

from __future__ import annotations

import math
from math import fsum
from typing import Any

from roaml.explicit import codes, solver
from roaml.explicit.space import Space
from roaml.record import Record
from roaml.smc.goal import NOT, InitialFold
from roaml.smc.program import AT_END, FALSE, TRUE, UNKNOWN
from roaml.smc.statistics import Bounds

MAXIMUM, MINIMUM, MEAN = 0, 1, 2
NOTHING, AS_JUDGED, NEGATED = 0, 1, 2
_OPEN_SHARE = 1e-6
"""The maximum probability of traces that the end of the model's time leaves undecided and that are neglected."""

_TOO_MUCH_WORK = "the computation of its values takes too many operations"


class NoValueError(Exception):
    """Raised if the value that a property asks for does not exist or takes too long to compute. The message states the
    reason."""


class OpenDeadlineError(NoValueError):
    """Raised if the time ends before a deadline of the property in some traces."""


class GoalValues(Record, frozen=True):
    """The values that a property asks for, enclosed by bounds.

    Attributes:
        minimum, maximum: the bounds of the extreme values over all schedulers.
        uniform: the bounds of the value under uniform choices; `None` if the states do not determine it, or if it
            takes too much work.
        is_precise: whether the bounds of all three values are as close as intended.

    With several initial states, these are the minimum, the maximum or the mean of their values, as the property asks
    (`goal.InitialFold`).
    """

    minimum: Bounds
    maximum: Bounds
    uniform: Bounds | None
    is_precise: bool


def values_of(space: Space, modules: Any = None, work: int | None = None) -> GoalValues:
    """The values that the property of `space` asks for.

    Args:
        modules: the module of the solver, for tests.
        work: the maximum number of additions for each value; `None` for the limit of the solver.

    Raises:
        NoValueError: a value does not exist, or its computation needs more work.
    """
    return _Question(space, modules or solver, work).values()


class _Question:
    def __init__(self, space: Space, module: Any, work: int | None) -> None:
        self.space = space
        self.work = work
        self.module = module
        self.goal = space.compiled_property.goal
        self.question = space.compiled_property.question
        self.is_precise = True

    def values(self) -> GoalValues:
        if sum(bound == AT_END for bound in self.goal.lower) > 1:
            raise NoValueError("a property with several `F G` can only be estimated from traces")
        if any(bound == AT_END for bound in self.goal.lower):
            _, share = self.solver(MAXIMUM).probability(UNKNOWN, codes.OPEN, NOTHING)
            if share > _OPEN_SHARE:
                raise OpenDeadlineError(
                    f"in traces with a probability of up to {share:.6g}, the time ends (`max_time`) before a deadline "
                    "of the property"
                )
        minimum, maximum = self.bounds(MINIMUM), self.bounds(MAXIMUM)
        return GoalValues(minimum, maximum, self.uniform(), self.is_precise)

    def uniform(self) -> Bounds | None:
        """The bounds of the value under uniform choices; `None` if the states do not determine it, or if its
        computation needs more work than a limit on it allows."""
        if self.space.is_reduced:
            return None
        try:
            return self.bounds(MEAN)
        except NoValueError:
            if self.work is None:
                raise
            return None

    def solver(self, mode: int) -> Any:
        solver_ = self.module.Solver(self.space.search, mode)
        if self.work is not None:
            solver_.most_work = self.work
        return solver_

    def bounds(self, mode: int) -> Bounds:
        """The bounds of the value that the property asks for over all initial states."""
        return _folded(self.of_each_root(mode), _FOLDS.get(self.question.fold, mode))

    def of_each_root(self, mode: int) -> list[Bounds]:
        """The bounds of the values of the initial states, in their order."""
        goal = self.goal
        is_until = len(goal.left) == 1 and goal.lower[0] != AT_END
        if self.question.is_reward and goal.upper[0] >= 0:
            steps = goal.upper[0]
            if self.work is not None and steps * self.space.search.code_end > self.work:
                raise NoValueError(_TOO_MUCH_WORK)
            return self.closed(self.solver(mode), "accumulated", steps)
        if self.question.is_reward:
            return self.closed(self.solver(mode), "expected")
        if self.question.is_stuck:
            return self.closed(self.solver(mode), "probability", UNKNOWN, codes.GETS_STUCK, NOTHING)
        if is_until:
            # The value of the until itself: `¬F ¬a` has its minimum where `F ¬a` has its maximum.
            is_negated = goal.formula.count(NOT) % 2 == 1
            target = FALSE if is_negated else TRUE
            if is_negated and mode != MEAN:
                mode = MAXIMUM if mode == MINIMUM else MINIMUM
            if goal.is_bounded and (goal.lower[0] > 0 or goal.upper[0] >= 0):
                steps = max(goal.lower[0], goal.upper[0])
                if self.work is not None and steps * self.space.search.code_end > self.work:
                    raise NoValueError(_TOO_MUCH_WORK)
                bounds = self.closed(self.solver(mode), "bounded", target, goal.lower[0], goal.upper[0])
            else:
                bounds = self.closed(self.solver(mode), "probability", target, 0, NOTHING)
            return _complements(bounds) if is_negated else bounds
        if mode == MINIMUM:
            bounds = self.closed(self.solver(MAXIMUM), "probability", FALSE, 0, NEGATED)
            return _complements(bounds)
        return self.closed(self.solver(mode), "probability", TRUE, 0, AS_JUDGED)

    def closed(self, solver_: Any, method: str, *arguments: int) -> list[Bounds]:
        """The bounds that a method of the solver computes for the initial states."""
        low, high = getattr(solver_, method)(*arguments)
        if solver_.is_unclear:
            raise NoValueError("rewards are negative in a part of the model that can be repeated for ever")
        if solver_.has_ended_early:
            if self.work is not None:
                raise NoValueError(_TOO_MUCH_WORK)
            self.is_precise = False
        values = [(low, high)]
        if self.question.initial_states > 1:
            high_of = solver_.low if method == "accumulated" else solver_.high
            values = [(solver_.low[root], high_of[root]) for root in self.space.roots]
        if method == "probability":
            certain = solver_.certain(list(self.space.roots) if len(values) > 1 else [0])
            values = [_with_certainty(*bounds, is_one) for bounds, is_one in zip(values, certain, strict=True)]
        # Equal bounds can be in the wrong order after rounding.
        return [Bounds(min(low, high), max(low, high)) for low, high in values]


_FOLDS = {InitialFold.MINIMUM: MINIMUM, InitialFold.MAXIMUM: MAXIMUM, InitialFold.MEAN: MEAN}


_BELOW_ONE = math.nextafter(1.0, 0.0)
"""The greatest floating-point number that is less than 1."""


def _with_certainty(low: float, high: float, is_one: bool) -> tuple[float, float]:
    """The bounds of a probability of which is known whether it is 1 (`Solver.certain`)."""
    return (1.0, 1.0) if is_one else (min(low, _BELOW_ONE), min(high, _BELOW_ONE))


def _complements(values: list[Bounds]) -> list[Bounds]:
    """The bounds of the complements of probabilities. If a probability is positive, its complement is less than 1."""
    return [Bounds(_complement(bounds.upper), _complement(bounds.lower)) for bounds in values]


def _complement(value: float) -> float:
    return min(1 - value, _BELOW_ONE) if value > 0 else 1.0


def _folded(values: list[Bounds], mode: int) -> Bounds:
    """The minimum, maximum or mean of values."""
    if len(values) == 1:
        return values[0]
    lower, upper = [bounds.lower for bounds in values], [bounds.upper for bounds in values]
    if mode == MEAN:
        return Bounds(fsum(lower) / len(values), fsum(upper) / len(values))
    return Bounds(min(lower), min(upper)) if mode == MINIMUM else Bounds(max(lower), max(upper))

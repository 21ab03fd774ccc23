# SPDX-License-Identifier: Apache-2.0
"""Bounds on rewards as conditions on variables.

Each bound of a property gets a variable, which contains the reward that has been accumulated so far. `F`, `U` and the
other operators then compare this variable (docs/spec/properties.md#reward-bounds). The kernel increases the variable in
each step; only the goal of its property does so, so the variable is constant for all other properties.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from roaml.jani.expressions import Binary, Expression, Name, Real
from roaml.jani.model import Model, Variable
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import BinaryPath, Interval, PathBounds, Property, RewardBound, UnaryPath, walk
from roaml.jani.types import REAL
from roaml.record import replace


def sum_names(property_: Property) -> dict[RewardBound, str]:
    """The bounds on rewards in a property, and the names of the variables of their sums."""
    bounds = dict.fromkeys(
        bound
        for formula in walk(property_.expression)
        if isinstance(formula, (UnaryPath, BinaryPath))
        for bound in formula.reward_bounds or ()
    )
    return {bound: f"reward {number} of {property_.name}" for number, bound in enumerate(bounds, 1)}


def with_sums(model: Model, properties: Iterable[Property]) -> Model:
    """A model with the variables for the bounds on rewards in some properties; the same model if there are none."""
    names = dict.fromkeys(name for property_ in properties for name in sum_names(property_).values())
    if not names:
        return model
    variables = tuple(Variable(name, REAL, Real(0.0)) for name in names)
    return replace(model, variables=(*model.variables, *variables))


class SumConditions(NamedTuple):
    """The conditions on sums that the bounds of a path operator require.

    Attributes:
        within: that no sum exceeds its upper bound. Sums never decrease, so this is false for ever once it is false.
        reached: that all sums are within their bounds.
    """

    within: tuple[Expression, ...]
    reached: tuple[Expression, ...]


def conditions_of(
    path: PathBounds, names: Mapping[RewardBound, str], number: Callable[[Interval, Expression], float]
) -> SumConditions:
    """The conditions that the bounds on rewards of a path operator require.

    Args:
        number: the value of an end of an interval.
    """
    within: list[Expression] = []
    lower: list[Expression] = []
    for bound in path.reward_bounds or ():
        interval = bound.bounds
        total = Name(names[bound])
        if interval.upper is not None:
            operator = BinaryOperator.LESS if interval.upper_exclusive else BinaryOperator.LESS_EQUAL
            within.append(Binary(operator, total, Real(float(number(interval, interval.upper)))))
        if interval.lower is not None:
            operator = BinaryOperator.GREATER if interval.lower_exclusive else BinaryOperator.GREATER_EQUAL
            lower.append(Binary(operator, total, Real(float(number(interval, interval.lower)))))
    return SumConditions(tuple(within), (*within, *lower))


def limit_of(interval: Interval, number: Callable[[Interval, Expression], float]) -> float:
    """The number from which on greater sums satisfy the same bounds."""
    limits = [0.0]
    if interval.lower is not None:
        limits.append(number(interval, interval.lower) + (1 if interval.lower_exclusive else 0))
    if interval.upper is not None:
        limits.append(number(interval, interval.upper) + (0 if interval.upper_exclusive else 1))
    return float(max(limits))

# SPDX-License-Identifier: Apache-2.0
"""Exact values of properties of models with few states, computed without a request of the user. All limits are numbers
of states, bytes and operations, and not times, so the speed of the machine does not determine whether a property is
answered exactly. At these limits, exploring the states of most systems takes less than a tenth of the time of the
default number of traces.
"""

from __future__ import annotations

from roaml.explicit.space import StateLimits
from roaml.smc.choices import Choices, Extreme, ExtremeMethod
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty, InitialFold
from roaml.smc.model import ModelChecker
from roaml.verification.exhaustive import UndecidedError, exact_values
from roaml.verification.results import Exact

MAX_SMALL_STATES = 20_000
LIMITS = StateLimits(states=MAX_SMALL_STATES, bytes=4 << 30, combinations=4_096, transitions=200_000, work=30_000_000)
EXAMPLE_TRACES = 200
"""The number of traces that are generated as examples if the value is exact."""


def values_if_small(checker: ModelChecker, property_: CompiledProperty) -> Exact | None:
    """The exact values of a property; `None` if the model is too large, if an undefined operation is executed, or if
    only traces can answer the property."""
    if property_.question.is_conditional:
        return None
    try:
        exact = exact_values(checker, property_, LIMITS)
    except (FaultError, UndecidedError):
        return None
    return exact if exact.is_precise else None


def choices_of(exact: Exact, agreement: str = "") -> Choices:
    """The facts about schedulers other than the uniform one that follow from exact values.

    Args:
        agreement: the reason why all schedulers have the same value, if it is known without the exact values.
    """
    asks_for_extreme_state = exact.initial_states > 1 and exact.fold is not InitialFold.MEAN
    states = "1 state" if exact.states == 1 else f"{exact.states:,} states"
    return Choices(
        agreement or (f"all {states} were explored" if exact.agrees and not asks_for_extreme_state else ""),
        Extreme(exact.least, exact.minimum, ExtremeMethod.EXPLORATION),
        Extreme(exact.greatest, exact.maximum, ExtremeMethod.EXPLORATION),
    )

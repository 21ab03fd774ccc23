# SPDX-License-Identifier: Apache-2.0
"""Exact values of properties of models with few states, computed without a request of the user. All limits are numbers
of states, bytes and operations, and not times, so the speed of the machine does not determine whether a property is
answered exactly. If there are more than a few states, they are explored without the choices that change neither the
minimum nor the maximum; if that shows that all states exceed the limits, these are not explored
(docs/spec/reductions.md#when).
"""

from __future__ import annotations

from typing import Any

from roaml.explicit.independence import can_be_reduced
from roaml.explicit.space import LimitError, StateLimits, explore, search_tables
from roaml.explicit.tables import Tables
from roaml.record import replace
from roaml.smc.choices import Choices, Extreme, ExtremeMethod
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty, InitialFold
from roaml.smc.model import ModelChecker
from roaml.verification.exhaustive import UndecidedError, alone, values_from
from roaml.verification.results import Exact

MAX_SMALL_STATES = 20_000
MAX_STATES_AT_FIRST = 2_000
"""The maximum number of states that are explored before choices are left out."""
LIMITS = StateLimits(states=MAX_SMALL_STATES, bytes=4 << 30, combinations=4_096, transitions=200_000, work=100_000_000)
MAX_REDUCED_TRANSITIONS = 100_000
"""The maximum number of transitions of the search that leaves choices out. Each of them takes longer."""
EXAMPLE_TRACES = 200
"""The number of traces that are generated as examples if the value is exact."""


def values_if_small(checker: ModelChecker, property_: CompiledProperty, *, leaves_out: bool = True) -> Exact | None:
    """The exact values of a property; `None` if the model is too large, if an undefined operation is executed, or if
    only traces can answer the property.

    Args:
        leaves_out: whether choices may be left out if there are too many states.
    """
    if property_.question.is_conditional:
        return None
    checker, property_ = alone(checker, property_)
    tables = search_tables(checker, property_, LIMITS)
    try:
        if leaves_out and can_be_reduced(checker.program, property_.goal):
            exact = _partly(checker, property_, tables)
        else:
            exact = values_from(explore(checker, property_, LIMITS, tables=tables), LIMITS)
    except (FaultError, UndecidedError, LimitError):
        return None
    return exact if exact.is_precise else None


def _partly(checker: ModelChecker, property_: CompiledProperty, tables: Tables) -> Exact:
    """The values from all states if there are few, otherwise from those that are left after reductions. If these show
    that there are not few states, the search through all states is omitted.

    Raises:
        UndecidedError, FaultError, LimitError: see `values_from` and `explore`.
    """

    def wholly(states: int) -> Exact:
        return values_from(explore(checker, property_, replace(LIMITS, states=states), tables=tables), LIMITS)

    try:
        return wholly(min(MAX_STATES_AT_FIRST, LIMITS.states))
    except LimitError:
        pass
    most = min(LIMITS.transitions or MAX_REDUCED_TRANSITIONS, MAX_REDUCED_TRANSITIONS)
    limits = replace(LIMITS, transitions=most)
    try:
        space = explore(checker, property_, limits, is_reduced=True, tables=tables)
    except LimitError as error:
        if error.states >= LIMITS.states or _has_many_states(error.search):
            raise
        return wholly(LIMITS.states)
    if not _has_many_states(space.search):
        try:
            return wholly(LIMITS.states)
        except LimitError:
            pass
    return values_from(space, limits)


def _has_many_states(search: Any) -> bool:
    """Whether a search with reductions shows that a model is not small. Its states and those that it passes are reached
    without reductions, too. Twice as many are required, because a state that is not remembered is passed repeatedly.
    States of cycles are not counted."""
    return bool(search.count + search.passed - search.circled > 2 * LIMITS.states)


def choices_of(exact: Exact, agreement: str = "") -> Choices:
    """The facts about schedulers other than the uniform one that follow from exact values.

    Args:
        agreement: the reason why all schedulers have the same value, if it is known without the exact values.
    """
    asks_for_extreme_state = exact.initial_states > 1 and exact.fold is not InitialFold.MEAN
    states = "1 state" if exact.states == 1 else f"{exact.states:,} states"
    explored = "the only state was explored" if exact.states == 1 else f"all {states} were explored"
    if exact.is_reduced:
        explored = f"all states were explored, {states} after reductions"
    return Choices(
        agreement or (explored if exact.agrees and not asks_for_extreme_state else ""),
        Extreme(exact.least, exact.minimum, ExtremeMethod.EXPLORATION),
        Extreme(exact.greatest, exact.maximum, ExtremeMethod.EXPLORATION),
    )

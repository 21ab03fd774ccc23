# SPDX-License-Identifier: Apache-2.0
"""Exact values of properties that are computed without a request of the user, within limits. All limits are numbers of
states, transitions, bytes and operations, and not times, so the speed of the machine does not determine whether a
property is answered exactly. First all states are explored; if there are too many, they are explored without the
choices that change neither the minimum nor the maximum (docs/spec/reductions.md#when).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from roaml.explicit.independence import can_be_reduced
from roaml.explicit.space import (
    MAX_TRANSITIONS_LIMIT,
    ExplorationWatch,
    LimitError,
    Space,
    StateLimits,
    explore,
    search_tables,
)
from roaml.record import Record, replace
from roaml.smc.choices import Choices, Extreme, ExtremeMethod
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty, InitialFold
from roaml.smc.model import ModelChecker
from roaml.verification.conditional import of_condition, parts_of, quotient
from roaml.verification.exhaustive import UndecidedError, alone, values_from
from roaml.verification.results import Exact

MAX_SMALL_STATES = 20_000
LIMITS = StateLimits(states=MAX_SMALL_STATES, bytes=4 << 30, combinations=4_096, transitions=200_000, work=100_000_000)
"""The limits of a first search, and the least that each of several properties gets."""
SHARED_LIMITS = StateLimits(
    states=2_000_000, bytes=1 << 30, combinations=4_096, transitions=8_000_000, work=100_000_000
)
"""The limits of all properties of one verification together. A search that reaches them takes about 10 s."""
UNIFORM_LIMITS = replace(SHARED_LIMITS, transitions=2_000_000)
"""The same if only uniform choices are considered, and the model has other ones: traces answer the question, too, and a
search that leaves out choices answers it only if all schedulers have the same value."""
REDUCED_SHARE = 2
"""A search that leaves out choices may have this fraction of the transitions, each of which takes about three times as
long."""
_COST_OF_ALL, _COST_OF_REDUCED, _COST_OF_BOTH = 3, 10, 8
"""The duration of a transition in both kinds of search. If both reach their limits, their cost is the limit."""
SETUP_COST = 10
"""The transitions that take as long as the preparation of one instruction of the model for a search."""
_REDUCED_PER_TRANSITION = 8
"""The numbers of a program from which a part is taken in the time of a transition."""
_STEPS_PER_TRANSITION = 50
"""The number of steps of traces that take five times as long as one transition of a search."""
_LEAST_BESIDE = 5_000
"""The transitions of the shortest search beside traces, without its preparation."""
EXAMPLE_TRACES = 200
"""The number of traces that are generated as examples if the value is exact."""
MAX_EXAMPLE_STEPS = 50_000
"""The maximum number of steps of these traces. The steps of slowly converging models would take longer than the
value."""


class Attempt(Record, frozen=True):
    """The result of a search within limits.

    Attributes:
        exact: the values; `None` if there are none.
        transitions: the part of the limit on transitions that was used.
        reason: why there are no values, for users; "" if only traces can answer the property.
        space: the states from which the values were computed.
        is_cut: whether there are no values because there are too many transitions.
        explored: the greatest number of states at which a search stopped; 0 if none stopped.
        limit: the name of the limit at which this search stopped (`LimitError.limit`).
    """

    exact: Exact | None
    transitions: int = 0
    reason: str = ""
    space: Space | None = None
    is_cut: bool = False
    explored: int = 0
    limit: str = ""


NOTHING_LEFT = Attempt(
    None,
    reason=f"the searches for other properties have reached the limit --{MAX_TRANSITIONS_LIMIT}",
    limit=MAX_TRANSITIONS_LIMIT,
)
"""The result for a property for which the budget of all properties has nothing left."""


def attempt(
    checker: ModelChecker,
    property_: CompiledProperty,
    limits: StateLimits,
    watch: ExplorationWatch | None = None,
    *,
    leaves_out: bool = True,
    only_uniform: bool = False,
    is_repeated: bool = False,
) -> Attempt:
    """The exact values of a property, if the model is not too large, no undefined operation is executed, and not only
    traces can answer the property.

    Args:
        watch: see `roaml.explicit.space.explore`.
        leaves_out: whether choices may be left out if there are too many states.
        only_uniform: whether the value under uniform choices is sufficient for a property with a condition.
        is_repeated: whether a search with narrower limits was cut before, so that a short one is not tried again.
    """
    if property_.question.is_conditional:
        return _conditional(checker, property_, limits, watch, only_uniform=only_uniform)
    whole = checker
    checker, property_ = alone(whole, property_)
    cost, reason, is_cut, explored, limit = setup_cost(whole, checker), "", False, 0, ""
    tables = search_tables(checker, property_, limits)
    reduces = leaves_out and can_be_reduced(checker.program, property_.goal)
    for most, is_reduced in _searches(limits, reduces=reduces, is_repeated=is_repeated):
        search: Any = None
        space, exact = None, None
        try:
            space = explore(checker, property_, most, watch, is_reduced=is_reduced, tables=tables)
            search = space.search
            exact, reason = values_from(space, most), ""
        except LimitError as error:
            search, is_cut = error.search, error.limit == MAX_TRANSITIONS_LIMIT
            if error.states > explored:
                reason, explored, limit = str(error), error.states, error.limit
        except UndecidedError as error:
            reason, is_cut, explored, limit = error.reason, False, 0, ""  # there were not too many states
        except FaultError:
            return Attempt(None, cost)
        if search is not None:
            weight = _COST_OF_REDUCED if is_reduced else _COST_OF_ALL
            cost += weight * (search.transitions + search.passed) // _COST_OF_BOTH
        if exact is not None:
            return Attempt(exact if exact.is_precise else None, cost, space=space)
    return Attempt(None, cost, reason, is_cut=is_cut, explored=explored, limit=limit)


def _searches(limits: StateLimits, *, reduces: bool, is_repeated: bool) -> Iterator[tuple[StateLimits, bool]]:
    """The limits of the searches that follow each other, and whether each leaves out choices. The search that leaves
    out choices comes before the one through all states within wide limits, which takes much longer and answers less
    often."""
    most = limits.transitions
    least = LIMITS.transitions
    is_wide = least is not None and (most is None or most > least)
    if reduces and is_wide:
        if not is_repeated:
            yield replace(limits, states=min(LIMITS.states, limits.states), transitions=least), False
    else:
        yield limits, False
    if reduces:
        yield replace(limits, transitions=None if most is None else most // REDUCED_SHARE), True
        if is_wide:
            yield limits, False


def _conditional(
    checker: ModelChecker,
    property_: CompiledProperty,
    limits: StateLimits,
    watch: ExplorationWatch | None,
    *,
    only_uniform: bool,
) -> Attempt:
    """The exact value under a condition."""
    plain = replace(property_, question=replace(property_.question, is_conditional=False))
    parts = parts_of(checker, property_)
    if parts is not None:
        joint, given = (
            attempt(part, part.compiled_properties[0], limits, watch, leaves_out=not only_uniform) for part in parts
        )
        cost = joint.transitions + given.transitions
        exact = None if joint.exact is None or given.exact is None else quotient(joint.exact, given.exact)
    elif property_.question.is_reward:
        whole = attempt(checker, plain, limits, watch, leaves_out=False)
        cost = whole.transitions
        exact = None if whole.exact is None else of_condition(whole.exact, property_.question, whole.space)
    else:
        return Attempt(None)
    if exact is not None and not (only_uniform or exact.agrees):
        exact = None
    return Attempt(exact, cost)


def setup_cost(checker: ModelChecker, reduced: ModelChecker | None = None) -> int:
    """The duration of the preparation of a search, in transitions.

    Args:
        reduced: the model checker for the parts on which the property depends (`alone`); if it is not known yet, the
            duration is that for all parts.
    """
    if reduced is None or reduced is checker:
        return SETUP_COST * len(checker.program.code)
    return SETUP_COST * len(reduced.program.code) + len(checker.program.code) // _REDUCED_PER_TRANSITION


def limits_beside(steps: int, setup: int, states: int) -> StateLimits | None:
    """The limits of a search that compares schedulers beside traces that were requested: it may take a fifth of the
    time of these traces, and explores few states in any case. `None` if it should not be started, because its
    preparation takes too long.

    Args:
        steps: the number of steps of the traces.
        setup: the duration of the preparation, in transitions (`setup_cost`).
        states: the maximum number of states of any search (`Budget.states`).
    """
    most = LIMITS.transitions or 0
    left = min(steps // _STEPS_PER_TRANSITION - setup, most)
    if left <= 0 and setup > most:
        return None
    return replace(LIMITS, states=min(LIMITS.states, states), transitions=max(left, _LEAST_BESIDE))


class Budget:
    """What is left of limits that several properties share. Each gets an equal share of what those before it have left,
    but at least `LIMITS`. If nothing is left, a model whose preparation alone takes longer than that is not searched
    again. Properties whose share did not suffice can be searched again with what all have left (`rest`)."""

    def __init__(self, limits: StateLimits = SHARED_LIMITS) -> None:
        self._limits = limits
        self._left = limits.transitions or 0
        self._asked = 0
        self._waiting = 0

    @property
    def states(self) -> int:
        """The maximum number of states of each search."""
        return self._limits.states

    def share(self, properties: int, setup: int = 0) -> StateLimits | None:
        """The limits of the next property of this number; `None` if it should not be searched.

        Args:
            setup: the duration of the preparation of the search, in transitions.
        """
        others = max(1, properties - self._asked)
        self._asked += 1
        self._waiting = others - 1
        least = min(LIMITS.transitions or 0, self._limits.transitions or 0)
        if self._left == 0 and setup > least:
            return None
        return replace(self._limits, transitions=max(self._left // others, least))

    def rest(self, properties: int, before: StateLimits, setup: int = 0) -> StateLimits | None:
        """The limits of another search for one of some properties whose first search was cut; `None` if it would not be
        longer than the first one.

        Args:
            properties: the number of these properties. Those that were not searched yet keep their share.
            before: the limits of the first search.
            setup: the duration of the preparation of the search, in transitions.
        """
        most = self._left // (properties + self._waiting) - setup
        return replace(before, transitions=most) if most > (before.transitions or 0) else None

    def spend(self, transitions: int) -> None:
        self._left = max(0, self._left - transitions)


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

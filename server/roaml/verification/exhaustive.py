# SPDX-License-Identifier: Apache-2.0
"""Answers from all states of a model: `verify --exhaustive`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roaml.explicit.independence import can_be_reduced
from roaml.explicit.path import shortest
from roaml.explicit.space import (
    ExplorationWatch,
    LimitError,
    SearchInterruptedError,
    Space,
    StateLimits,
    explore,
    search_tables,
)
from roaml.explicit.values import GoalValues, NoValueError, OpenDeadlineError, values_of
from roaml.record import replace
from roaml.smc.fault import FaultError
from roaml.smc.goal import NOT, CompiledProperty, Question
from roaml.smc.model import ModelChecker
from roaml.smc.program import AT_END, FALSE, TRUE
from roaml.smc.statistics import Bounds
from roaml.verification.conditional import of_condition, parts_of, quotient
from roaml.verification.expectations import Expectation, Verdict, holds_exactly, side_of_certainty
from roaml.verification.headline import LONGER_TIME
from roaml.verification.number_text import distinct
from roaml.verification.results import Exact, Proof, ShortestTrace, is_close
from roaml.verification.schedulers import extreme_of, is_minimised

if TYPE_CHECKING:
    from roaml.explicit.path import EndlessTrace
    from roaml.explicit.search import StateSearch
    from roaml.verification.growth import GrowingVariable

MAX_STATES_AT_FIRST = 20_000
"""If there are more states, a second search leaves out choices that change neither the minimum nor the maximum."""
MAX_STATES_FOR_UNIFORM = 1_000_000
"""The maximum number of states that are explored without leaving anything out, because the minimum and the maximum
differ and do not determine the value under uniform choices."""
_ESTIMATE = "estimate the value from traces with uniform choices instead"
"""The remedy if a limit ends the exploration, or if only traces can answer the property."""


class UndecidedError(Exception):
    """The states of the model do not answer a property. The message contains the reason and what to do.

    Attributes:
        reason: why there is no value, as a phrase for users.
        remedy: what to do, as a phrase for users.
        growing: the variables because of which there are so many states that a limit was reached.
    """

    def __init__(self, reason: str, remedy: str, growing: tuple[GrowingVariable, ...] = ()) -> None:
        super().__init__(reason, remedy, growing)  # all of them, because other processes raise it, too
        self.reason = reason
        self.remedy = remedy
        self.growing = growing

    def __str__(self) -> str:
        return f"{self.reason}; {self.remedy}"


class ExplorationInterruptedError(KeyboardInterrupt):
    """The exploration was interrupted after `states` states; `growing` as for `UndecidedError`."""

    def __init__(self, states: int, growing: tuple[GrowingVariable, ...]) -> None:
        super().__init__()
        self.states = states
        self.growing = growing


def exact_values(
    checker: ModelChecker,
    property_: CompiledProperty,
    limits: StateLimits,
    watch: ExplorationWatch | None = None,
    *,
    only_uniform: bool = False,
) -> Exact:
    """The exact values of a property, from all states.

    Args:
        watch: see `roaml.explicit.space.explore`.
        only_uniform: whether the value under uniform choices is sufficient for a property with a condition.

    Raises:
        UndecidedError: a limit was reached, or the property has no value that can be computed.
        FaultError: an undefined operation is executed in a reachable state.
        ExplorationInterruptedError: Ctrl-C was pressed.

    Unless `limits.reduces` is false, choices are left out if there are many states
    (docs/spec/reductions.md#when).
    """
    if property_.question.is_conditional:
        return _conditional(checker, property_, limits, watch, only_uniform=only_uniform)
    checker, property_ = alone(checker, property_)
    try:
        if limits.reduces and can_be_reduced(checker.program, property_.goal):
            return _partly(checker, property_, limits, watch)
        return values_from(explore(checker, property_, limits, watch), limits)
    except LimitError as error:
        variables = () if error.search is None else _growing(checker, error.search)
        raise UndecidedError(str(error), _remedy(error), variables) from None
    except SearchInterruptedError as interrupt:
        variables = _growing(checker, interrupt.search)
        raise ExplorationInterruptedError(interrupt.search.count, variables) from None


def _remedy(error: LimitError) -> str:
    """What to do if a limit has ended the exploration."""
    return f"{'raise this limit, or ' if error.limit else ''}{_ESTIMATE}"


def _growing(checker: ModelChecker, search: StateSearch) -> tuple[GrowingVariable, ...]:
    from roaml.verification.growth import growing_variables  # noqa: PLC0415 - most searches end before their limits

    return growing_variables(checker, search)


def _conditional(
    checker: ModelChecker,
    property_: CompiledProperty,
    limits: StateLimits,
    watch: ExplorationWatch | None,
    *,
    only_uniform: bool,
) -> Exact:
    """The exact value under a condition."""
    parts, exact = parts_of(checker, property_), None
    limits = replace(limits, reduces=limits.reduces and not only_uniform and parts is not None)
    if parts is not None:
        exact = quotient(*(exact_values(part, part.compiled_properties[0], limits, watch) for part in parts))
    elif property_.question.is_reward:
        own, plain = alone(checker, replace(property_, question=replace(property_.question, is_conditional=False)))
        try:
            space = explore(own, plain, limits, watch)
        except LimitError as error:
            raise UndecidedError(str(error), _remedy(error)) from None
        exact = of_condition(values_from(space, limits), property_.question, space)
    else:
        raise UndecidedError("a probability given assumptions cannot be computed from all states", _ESTIMATE)
    if exact is None or not (only_uniform or exact.agrees):
        raise UndecidedError(
            "a value under a condition is computed from all states only if all schedulers have the same", _ESTIMATE
        )
    return exact


def alone(checker: ModelChecker, property_: CompiledProperty) -> tuple[ModelChecker, CompiledProperty]:
    """A property with the parts of the model on which it depends."""
    reduced = checker.reduced(property_)
    return (checker, property_) if reduced is checker else (reduced, reduced.compiled_properties[0])


def _partly(
    checker: ModelChecker, property_: CompiledProperty, limits: StateLimits, watch: ExplorationWatch | None
) -> Exact:
    """The exact values, from as few states as possible."""
    tables = search_tables(checker, property_, limits)

    def wholly(states: int) -> Exact | None:
        """The values from all states; `None` if there are more than this number, and the limits allow more."""
        try:
            most = replace(limits, states=min(states, limits.states))
            return values_from(explore(checker, property_, most, watch, tables=tables), limits)
        except LimitError as error:
            if error.states < states or limits.states <= states:
                raise
            return None

    exact = wholly(MAX_STATES_AT_FIRST)
    if exact is not None:
        return exact
    exact = values_from(explore(checker, property_, limits, watch, is_reduced=True, tables=tables), limits)
    if exact.uniform is None and exact.states <= MAX_STATES_FOR_UNIFORM:
        try:
            return wholly(MAX_STATES_FOR_UNIFORM) or exact
        except LimitError:
            return exact
    return exact


def values_from(space: Space, limits: StateLimits) -> Exact:
    """The exact values from the states of a space.

    Raises:
        UndecidedError, FaultError: see `exact_values`.
    """
    if space.problem is not None:
        fault = space.checker.fault(space.problem)
        raise FaultError(f"{fault.message} (in a reachable state)", fault.origin, code=fault.code)
    try:
        values = values_of(space, work=limits.work)
    except OpenDeadlineError as error:
        raise UndecidedError(str(error), LONGER_TIME) from None
    except NoValueError as error:
        raise UndecidedError(str(error), _ESTIMATE) from None
    uniform = values.uniform
    if uniform is None and is_close(values.minimum, values.maximum):
        uniform = Bounds(values.minimum.lower, values.maximum.upper)
    paths = [path for verdict in (FALSE, TRUE) if (path := shortest(space, verdict)) is not None]
    return Exact(
        values.minimum,
        values.maximum,
        uniform,
        space.states,
        values.is_precise,
        _proof(space, values),
        space.can_get_stuck,
        space.checker.initial_states,
        space.compiled_property.question.fold,
        tuple(ShortestTrace(space.checker, space.compiled_property, path, space.is_reduced) for path in paths),
        space.is_reduced,
        space.compiled_property.question.is_reward,
        None if len(paths) == 2 or is_close(values.minimum, values.maximum) else _endless(space),
    )


def _endless(space: Space) -> EndlessTrace | None:
    from roaml.explicit.endless import endless  # noqa: PLC0415 - few verifications need it

    return endless(space)


def _proof(space: Space, values: GoalValues) -> Proof | None:
    """What the exploration of all states proves in addition to a probability of 0 or 1 (see `Exact.proof`)."""
    goal = space.compiled_property.goal
    if space.compiled_property.question.is_reward or len(goal.left) != 1 or goal.lower[0] == AT_END:
        return None
    is_negated = goal.formula.count(NOT) % 2 == 1
    if values.maximum.upper == 0.0 and not is_negated:
        return Proof.NONE
    return Proof.ALL if values.minimum.lower == 1.0 and is_negated else None


def check_exactly(
    expectation: Expectation,
    exact: Exact,
    question: Question,
    *,
    only_uniform: bool = False,
    over_intervals: bool = False,
) -> Verdict:
    """Whether the value that a property asks for, its minimum or its maximum, satisfies an expectation.

    Args:
        only_uniform: whether the value under uniform choices is checked instead.
        over_intervals: whether the value is the worst one of those that intervals of parameters allow
            (`Exact.worst_for`).
    """
    threshold = expectation.threshold
    bounds, value = exact.asked_value(question, only_uniform=only_uniform)
    side = _side_of_example(expectation, exact, question, only_uniform=only_uniform)
    because, by = "", ""
    is_reward = question.is_reward
    if holds_exactly(threshold, bounds, value, is_reward=is_reward, side=side):
        met = True
        if not (exact.agrees or only_uniform or over_intervals):
            by = _deciding_bound(expectation, exact, question)
    elif side:
        met, because = False, f"the value is {_EXCLUDED[side]}, as an example trace shows"
    else:
        which = "worst value" if over_intervals else "value"
        if not exact.agrees:
            which = f"{extreme_of(question)} over all schedulers"
        small = 0 if is_reward else side_of_certainty(threshold, bounds)
        number = _EXCLUDED[small] if small else distinct(value, threshold.number)
        met, because = False, "" if only_uniform else f"the {which} is {number}"
    ends = {holds_exactly(threshold, Bounds(end, end), end, is_reward=is_reward) for end in bounds}
    return Verdict(expectation, met, exact.is_precise or side != 0 or len(ends) == 1, because=because, by=by)


_EXCLUDED = {-1: "less than 1", 1: "greater than 0"}
"""A probability that is known not to be 1 or 0."""


def _deciding_bound(expectation: Expectation, exact: Exact, question: Question) -> str:
    """The extreme that meets an expectation, as a phrase for users; also the other one if it does not."""
    threshold, asked = expectation.threshold, extreme_of(question)
    value, other = (exact.least, exact.greatest) if is_minimised(question) else (exact.greatest, exact.least)
    by = f"by the {asked} over all schedulers, which is {distinct(value, threshold.number)}"
    if threshold.met(other):
        return by
    opposite = "maximum" if asked == "minimum" else "minimum"
    return (
        f"{by}, because the property asks for it; not met by the {opposite}, which is "
        f"{distinct(other, threshold.number)}, so ask for the {opposite} if all schedulers must meet it"
    )


def _side_of_example(expectation: Expectation, exact: Exact, question: Question, *, only_uniform: bool) -> int:
    """-1 if a trace shows that a probability is not 1, with which it is compared, and 1 if a trace shows that it is not
    0, however close it is; 0 otherwise."""
    number = expectation.threshold.number
    if question.is_reward:
        return 0
    if number == 1 and exact.fails and (only_uniform or is_minimised(question)):
        return -1
    return int(number == 0 and exact.shortest(TRUE) is not None and (only_uniform or not is_minimised(question)))

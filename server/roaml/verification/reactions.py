# SPDX-License-Identifier: Apache-2.0
"""The minimum and the maximum of a property if machines react at once, for properties on which schedulers disagree
(docs/spec/semantics.md#reaction-time)."""

from __future__ import annotations

from collections.abc import Callable

from roaml.durations import AT_ONCE, short_moment
from roaml.explicit.independence import can_be_reduced
from roaml.explicit.space import LimitError, StateLimits, explore
from roaml.jani.model import Clock
from roaml.record import replace
from roaml.smc.choices import Choices, Extreme, ExtremeMethod
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, TRUE
from roaml.verification.exhaustive import UndecidedError, alone, values_from
from roaml.verification.results import Computed, Estimated, Exact, Outcome, UnderAssumption
from roaml.verification.small import Budget, setup_cost
from roaml.verification.target import VerificationTarget

ASSUMPTION = "if machines react at once"
LIMITS = StateLimits(states=300_000, bytes=1 << 30, transitions=3_000_000, work=300_000_000)
"""The limits of the searches of all properties of one verification together, which nobody has requested."""


def at_once(
    target: VerificationTarget,
    property_: CompiledProperty,
    outcome: Outcome,
    checker_of: Callable[[VerificationTarget], ModelChecker],
    budget: Budget,
) -> UnderAssumption | None:
    """The values of a property if machines react at once; `None` if the result does not leave them open, if the model
    assumes a reaction time, or if they cannot be computed within the budget, which has the limits `LIMITS`.

    Args:
        outcome: the result without the assumption.
        checker_of: compiles the properties for a target.
    """
    metadata, question = target.model.metadata, property_.question
    if metadata is None or metadata.clock is None or not metadata.reaction_time.is_any or not _is_open(outcome):
        return None
    if question.is_reward or question.is_stuck or question.is_conditional:
        return None
    from roaml.jani.reaction import reacting  # noqa: PLC0415 - only models with a clock have a reaction time

    try:
        checker = checker_of(replace(target, model=reacting(target.model, AT_ONCE)))
        subject = next((p for p in checker.compiled_properties if p.question.name == question.name), None)
        exact = None if subject is None else _values(checker, subject, budget)
    except (FaultError, UndecidedError, LimitError):
        return None
    if exact is None or not exact.is_precise:
        return None
    return UnderAssumption(ASSUMPTION, Computed(question, exact), _remark(outcome, exact, metadata.clock))


def with_reactions(choices: Choices, exact: Exact) -> Choices:
    """What is known about schedulers, with the values if machines react at once. The schedulers under which they do are
    among all schedulers, so these values bound the minimum from above and the maximum from below."""
    least, greatest = choices.minimum, choices.maximum
    if least is None or exact.minimum.upper < least.bounds.upper:
        least = Extreme(exact.least, exact.minimum, ExtremeMethod.REACTIONS)
    if greatest is None or exact.maximum.lower > greatest.bounds.lower:
        greatest = Extreme(exact.greatest, exact.maximum, ExtremeMethod.REACTIONS)
    return replace(choices, minimum=least, maximum=greatest)


def _is_open(outcome: Outcome) -> bool:
    """Whether schedulers have different values, or it is not known whether they have."""
    match outcome:
        case Computed(exact=exact):
            return not exact.agrees
        case Estimated(choices=choices, is_interrupted=False):
            return choices is not None and not choices.agreement
        case _:
            return False


def _values(checker: ModelChecker, property_: CompiledProperty, budget: Budget) -> Exact | None:
    limits = budget.share(len(checker.compiled_properties), setup_cost(checker))
    if limits is None:
        return None
    alone_checker, subject = alone(checker, property_)
    setup = setup_cost(checker, alone_checker)
    is_reduced = can_be_reduced(alone_checker.program, subject.goal)
    transitions = limits.transitions or 0
    try:
        space = explore(alone_checker, subject, limits, is_reduced=is_reduced)
        transitions = space.search.transitions + space.search.passed
        return values_from(space, limits)
    finally:
        budget.spend(setup + transitions)


def _remark(outcome: Outcome, exact: Exact, clock: Clock) -> str:
    """The longest delay in an example trace that the assumption may exclude; "" if there is none."""
    if not isinstance(outcome, Computed):
        return ""
    verdict = FALSE if outcome.exact.least < exact.least else TRUE
    trace = outcome.exact.shortest(verdict)
    if trace is None:
        return ""
    from roaml.verification.delays import longest_delay  # noqa: PLC0415 - few verifications need it

    delay = longest_delay(trace, clock)
    if delay is None:
        return ""
    seconds = clock.step / 1e9
    end = "the end" if delay.until is None else short_moment(delay.until * seconds)
    what = "does not hold" if verdict == FALSE else "holds"
    when = f"from {short_moment(delay.since * seconds)} until {end}"
    return f"the property {what}, for example, if {delay.actor} is delayed {when}"

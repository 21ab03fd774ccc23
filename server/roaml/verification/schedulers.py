# SPDX-License-Identifier: Apache-2.0
"""The effect of schedulers on answers and verdicts. `Pmin` and `Pmax` refer to all schedulers, but traces use one.

- A lower bound on a minimum, or an upper bound on a maximum, must hold under every scheduler. One scheduler can refute
  it. If it is only known to hold for uniform choices, it is met under uniform choices.
- An upper bound on a minimum, or a lower bound on a maximum, is met if it holds under one scheduler, such as the
  uniform one.
"""

from __future__ import annotations

from roaml.comparison import UniformPolicy
from roaml.jani.operators import BinaryOperator
from roaml.record import replace
from roaml.smc.choices import Choices, Extreme, ExtremeMethod
from roaml.smc.goal import Question, Threshold
from roaml.smc.run import Answer
from roaml.verification.expectations import Verdict, holds_exactly
from roaml.verification.number_text import number, with_interval


def under_all_schedulers(verdict: Verdict, answer: Answer, choices: Choices | None) -> Verdict:
    """The verdict on an expectation of an answer under uniform choices, corrected by what is known about other
    schedulers.

    Args:
        choices: `None` if the question is about uniform choices.
    """
    if choices is None:
        return verdict
    threshold, average = verdict.expectation.threshold, answer.question.average
    verdict = replace(verdict, average=average)
    is_minimum = is_minimised(answer.question)
    extreme = choices.minimum if is_minimum else choices.maximum
    if choices.agreement:
        if extreme is None or not extreme.is_exact:
            return verdict
        # The exact value decides, not the interval of the estimate.
        met = holds_exactly(threshold, extreme.bounds, extreme.value, is_reward=answer.question.is_reward)
        return replace(verdict, is_met=met, is_certain=True, is_open=False, unanimous=None)
    if not verdict.is_met:
        verdict = replace(verdict, under=average)
    under, because = _missed_by(answer.question, extreme)
    missed = replace(verdict, is_met=False, is_certain=True, is_open=False, under=under, because=because)
    if extreme is not None and extreme.is_exact:
        met = holds_exactly(threshold, extreme.bounds, extreme.value, is_reward=answer.question.is_reward)
        return replace(verdict, is_met=True, is_certain=True, is_open=False, under="") if met else missed
    if answer.question.has_opposite_extremes:
        return replace(verdict, is_uniform=verdict.is_met)
    if threshold.relation is BinaryOperator.EQUAL:
        width = answer.options.epsilon
        bounds = None if extreme is None else extreme.bounds
        if bounds is not None and (
            threshold.number > bounds.upper + width if is_minimum else threshold.number < bounds.lower - width
        ):
            return missed
        return replace(verdict, is_uniform=verdict.is_met)
    if threshold.is_lower is is_minimum:
        if extreme is not None and not threshold.met(extreme.bounds.upper if is_minimum else extreme.bounds.lower):
            return missed
        return replace(
            verdict, is_uniform=verdict.is_met, uniform_only=_doubtful_by(threshold, answer.question, extreme)
        )
    if extreme is not None and threshold.met(extreme.bounds.upper if is_minimum else extreme.bounds.lower):
        return replace(verdict, is_met=True, is_certain=True, is_open=False, under="")
    return verdict


def under_sampled_schedulers(verdict: Verdict, question: Question, scheduler: str, tried: int) -> Verdict:
    """The verdict on an expectation of an answer under the most extreme one of sampled schedulers. That scheduler alone
    shows that an expectation is missed, that a minimum is at most a number, or that a maximum is at least a number.

    Args:
        scheduler: its description.
        tried: the number of sampled schedulers.
    """
    if not verdict.is_met:
        return replace(verdict, under=f"under {scheduler}")
    threshold = verdict.expectation.threshold
    is_shown = threshold.relation is not BinaryOperator.EQUAL and threshold.is_lower is not is_minimised(question)
    return verdict if is_shown else replace(verdict, sampled=tried)


def judged(verdict: Verdict, policy: UniformPolicy) -> Verdict:
    """A verdict that `under_all_schedulers` has returned, with the worth of one that is met under uniform choices
    only."""
    if not verdict.is_uniform:
        return verdict
    return replace(verdict, policy=policy, is_met=policy is not UniformPolicy.FAIL)


def _doubtful_by(threshold: Threshold, question: Question, extreme: Extreme | None) -> str:
    """A phrase that states that the estimate of a sampled scheduler misses an expectation although its interval does
    not; "" if it does not."""
    if extreme is None or extreme.method is not ExtremeMethod.SAMPLING or threshold.met(extreme.value):
        return ""
    return f"not shown for the {extreme_of(question)}, of which an estimate is {number(extreme.value)}"


def _missed_by(question: Question, extreme: Extreme | None) -> tuple[str, str]:
    """What violates an expectation: the scheduler, as a phrase (`Verdict.under`), or the extreme, as a clause
    (`Verdict.because`); uniform choices if no other is known."""
    if extreme is None or extreme.method is ExtremeMethod.UNIFORM:
        return question.average, ""
    subject = f"the {extreme_of(question)} over all schedulers is"
    if extreme.is_exact:
        return "", f"{subject} {number(extreme.value, is_probability=not question.is_reward)}"
    if extreme.method is ExtremeMethod.REACTIONS:
        bound = "at most" if is_minimised(question) else "at least"
        return "", f"{subject} {bound} {number(extreme.value)}, the value if machines react at once"
    return f"under {extreme.scheduler}", interval_text(extreme)


def is_minimised(question: Question) -> bool:
    """Whether a property asks for the minimum."""
    return question.is_minimised


def may_differ(choices: Choices | None) -> bool:
    """Whether it is unknown if the value depends on the scheduler."""
    return choices is not None and not choices.agreement and not choices.differ


def is_extreme_known(question: Question, choices: Choices) -> bool:
    """Whether the minimum or maximum that a property asks for is known exactly, or is the value of all schedulers."""
    extreme = choices.minimum if is_minimised(question) else choices.maximum
    return choices.agreement != "" or (extreme is not None and extreme.is_exact)


def extreme_of(question: Question) -> str:
    """The extreme that a property asks for: `minimum` or `maximum`."""
    return "minimum" if is_minimised(question) else "maximum"


def interval_text(extreme: Extreme) -> str:
    """The value of an extreme, with its bounds."""
    return with_interval(extreme.value, extreme.bounds)

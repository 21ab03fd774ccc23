# SPDX-License-Identifier: Apache-2.0
"""`NAME >= 0.95`: the expected value of a property, and whether it holds.

- The estimate decides the exit status, not its interval: no number of traces could ever show that a probability is 1.
  If the interval contains both values that satisfy the expectation and others, the words are `undecided`, unless no
  trace contradicts an expected 0 or 1 (`Verdict.is_undecided`).
- An exact value is compared with its bounds (`holds_exactly`).
- `==` means at most epsilon away from an estimate.
- Undecided traces can have any result: an expectation is met if it is met whatever they have, and open if it is met
  only with some of these results.
- A decision of a sequential test about the same number takes precedence.
"""

from __future__ import annotations

import math

from roaml.comparison import Comparison, UniformPolicy, as_written, read_comparison
from roaml.jani.operators import BinaryOperator
from roaml.record import Record
from roaml.regex import regex
from roaml.smc.goal import UNIFORMLY, Question, Threshold
from roaml.smc.run import Answer
from roaml.smc.statistics import Bounds

_RELATIONS = {
    ">=": BinaryOperator.GREATER_EQUAL,
    "<=": BinaryOperator.LESS_EQUAL,
    ">": BinaryOperator.GREATER,
    "<": BinaryOperator.LESS,
    "==": BinaryOperator.EQUAL,
}
_FORM = regex(r"\s*(.+?)\s*((?:>=|<=|==|≥|≤|>|<|=)\s*\S+)\s*")
ROUNDING = 1e-12
"""The maximum difference of values that is attributed to rounding; relative for values above 1."""
_NARROW = 1e-6
"""The maximum distance of the bounds of an exact value that equals a number between them; relative above 1."""
NO_EXPECTATION = "no expectation set"
"""The text for a result with which no expectation is compared."""


class Expectation(Record, frozen=True):
    """A comparison of the value of a property with a number. `is_own` states whether the comparison is part of the
    property itself."""

    name: str
    threshold: Threshold
    is_own: bool = False

    @property
    def text(self) -> str:
        return f"{self.threshold.relation.symbol} {as_written(self.threshold.number)}"


class Verdict(Record, frozen=True):
    """Whether an expectation is met.

    Attributes:
        is_met: whether the expectation counts as met.
        is_certain: whether the verdict is the same for the whole interval.
        is_open: whether the expectation is not met, but could be, depending on the traces that are undecided.
        is_uniform: whether the expectation is met under uniform choices and not known to be met under all schedulers.
            `policy` then decides `is_met`.
        uniform_only: what is known about the minimum or maximum if `is_uniform`, as a phrase for users; "" for nothing.
        under: a phrase that follows `NOT MET` or `undecided`, such as `under uniform choices` or `so far`; "" if there
            is none.
        because: a clause that follows `NOT MET`, such as `the value is 0.3`; "" if there is none.
        by: a phrase that follows `met` and names the bound that decided, if the minimum and the maximum differ; "" if
            there is none.
        policy: what an expectation is worth that is met under uniform choices only.
        average: of what traces estimate the value (`Question.average`).
        sampled: the number of sampled schedulers that meet the expectation, if it is about all schedulers and no more
            is known; 0 otherwise.
        unanimous: the number of traces and the other bound of the interval, if no trace contradicts an expected 0 or 1.
    """

    expectation: Expectation
    is_met: bool
    is_certain: bool
    is_open: bool = False
    is_uniform: bool = False
    under: str = ""
    because: str = ""
    by: str = ""
    unanimous: tuple[int, float] | None = None
    uniform_only: str = ""
    sampled: int = 0
    policy: UniformPolicy = UniformPolicy.WARN
    average: str = UNIFORMLY

    @property
    def is_undecided(self) -> bool:
        """Whether the expectation depends on traces that are undecided, or on which value of the interval is the true
        one. If it is met all the same, the estimate meets it."""
        is_refused = self.is_uniform and not self.is_met
        return self.is_open or not (self.is_certain or self.unanimous_text or is_refused)

    @property
    def text(self) -> str:
        """A phrase for users that states whether the expectation is met."""
        if self.is_undecided and not self.is_open:
            return "; ".join(filter(None, (f"undecided {self.under}".rstrip(), self.uniform_only)))
        if self.is_uniform:
            what = f"met {self.average}" if self.is_met else f"NOT MET: known only {self.average}"
            return "; ".join(filter(None, (what, self.uniform_only)))
        if self.is_met and self.sampled:
            which = "only sampled scheduler" if self.sampled == 1 else f"{self.sampled:,} sampled schedulers"
            return f"met by the {which}; another one may miss it"
        if self.is_met:
            return f"met {self.by}".rstrip()
        if self.is_open:
            return f"undecided {self.under}".rstrip() + ", because it depends on the undecided traces"
        missed = f"NOT MET {self.under}".rstrip()
        return f"{missed}: {self.because}" if self.because else missed

    @property
    def unanimous_text(self) -> str:
        """A phrase that states that no trace contradicts an expected 0 or 1; "" if one does, and for other
        expectations."""
        if self.unanimous is None or not self.is_met_in_traces:
            return ""
        return f"no trace of {self.unanimous[0]:,} contradicts it"

    @property
    def is_met_in_traces(self) -> bool:
        """Whether the expectation is met under all schedulers, or under uniform choices."""
        return self.is_met or self.is_uniform

    @property
    def is_warned_about(self) -> bool:
        """Whether a warning reports that the expectation is met under uniform choices only, or by the estimate only."""
        return (self.is_uniform and self.policy is UniformPolicy.WARN) or (self.is_undecided and self.is_met)

    def explained(self, epsilon: float) -> str:
        """The text, with the reason why the interval leaves the verdict open (`doubt`)."""
        doubt = self.doubt(epsilon)
        return f"{self.text}{': ' if self.is_undecided else '; '}{doubt}" if doubt else self.text

    def doubt(self, epsilon: float) -> str:
        """The reason why the interval leaves the verdict open; "" if it does not.

        Args:
            epsilon: the difference that `==` allows.
        """
        if self.is_certain or self.is_open:
            return ""
        if self.unanimous_text:
            assert self.unanimous is not None
            where = "down" if self.expectation.threshold.is_lower else "up"
            bound = f"{_rounded(self.unanimous[1]):g}"
            return f"{self.unanimous_text}, which proves nothing: the interval reaches {where} to {bound}"
        number = as_written(self.expectation.threshold.number)
        met, missed = {
            BinaryOperator.GREATER_EQUAL: (f"of at least {number}", f"below {number}"),
            BinaryOperator.GREATER: (f"above {number}", f"of at most {number}"),
            BinaryOperator.LESS_EQUAL: (f"of at most {number}", f"above {number}"),
            BinaryOperator.LESS: (f"below {number}", f"of at least {number}"),
            BinaryOperator.EQUAL: (f"within {epsilon:g} of {number}", f"more than {epsilon:g} away from {number}"),
        }[self.expectation.threshold.relation]
        if not self.is_undecided:
            return f"the interval includes values {missed}"
        if not self.is_met:
            return f"the interval includes values {met} and values {missed}"
        by = f"the estimate {self.average}" if self.is_uniform else "the estimate"
        return f"{by} meets it, but the interval includes values {missed}"


def parse(text: str) -> Expectation:
    """The expectation that a text such as `NAME >= 0.95` states.

    Raises:
        ValueError: the text does not have this form; the message contains the reason.
    """
    match = _FORM.fullmatch(text)
    comparison = read_comparison(match[2]) if match else None
    if match is None or comparison is None:
        raise ValueError(f"an expectation must have a form like `NAME >= 0.95`, not `{text}`")
    return expectation_of(match[1], comparison)


def expectation_of(name: str, comparison: Comparison) -> Expectation:
    return Expectation(name, Threshold(_RELATIONS[comparison.relation], comparison.number))


class RangeError(ValueError):
    """A probability is compared with a number that is not between 0 and 1; the message names both."""


def check_range(expectation: Expectation, question: Question) -> None:
    """Check that a probability is compared with a number from 0 to 1.

    Raises:
        RangeError: it is compared with another number.
    """
    if not is_possible(expectation, question):
        number = as_written(expectation.threshold.number)
        raise RangeError(
            f"`{expectation.name}` is a probability and can only be compared with a number from 0 to 1, not {number}"
        )


def is_possible(expectation: Expectation, question: Question) -> bool:
    """Whether the value of a property can be compared with the number of an expectation: for a probability, only with 0
    to 1."""
    return question.is_reward or 0 <= expectation.threshold.number <= 1


def check_expectation(expectation: Expectation, answer: Answer) -> Verdict:
    """Whether an answer satisfies an expectation."""
    threshold, tally = expectation.threshold, answer.tally
    if tally.traces == 0:
        return Verdict(expectation, False, False)
    if tally.accepted is not None and answer.question.threshold == threshold:
        return Verdict(expectation, tally.accepted, True)
    lower, upper = answer.bounds
    if answer.question.is_reward and _is_open(threshold, answer.bounds):
        return Verdict(expectation, False, False)
    least = greatest = answer.value
    if tally.undecided and not answer.question.is_reward:
        least, greatest = tally.successes / tally.traces, (tally.successes + tally.undecided) / tally.traces
    if threshold.relation is BinaryOperator.EQUAL:
        width = answer.options.epsilon + 1e-12
        low, high = threshold.number - width, threshold.number + width
        near = low <= least and greatest <= high
        is_open = not near and least <= high and low <= greatest and least < greatest
        is_certain = low <= lower and upper <= high if near else upper < low or high < lower
        return Verdict(expectation, near, is_certain, is_open)
    value, other = (least, greatest) if threshold.is_lower else (greatest, least)
    met = threshold.met(value)
    unanimous = None
    if met and not answer.question.is_reward and value == threshold.number and value in (0, 1):
        unanimous = tally.traces, lower if threshold.is_lower else upper
    is_certain, is_open = threshold.met(lower) is threshold.met(upper), not met and threshold.met(other)
    return Verdict(expectation, met, is_certain, is_open, unanimous=unanimous)


def holds_exactly(threshold: Threshold, bounds: Bounds, value: float, *, is_reward: bool, side: int = 0) -> bool:
    """Whether an exact value satisfies a comparison. Of `<` and `≥`, and of `>` and `≤`, one is satisfied; `==` is only
    if the bounds contain the number, except for rounding.

    Args:
        bounds: those of the value; if they are wide, it decides itself, and `==` is not satisfied.
        is_reward: whether the value is an expected reward. The bounds of a probability decide whether it is 0 or 1.
        side: -1 if the value is known to be less than the number, 1 if it is known to be greater.
    """
    if not is_reward:
        side = side or side_of_certainty(threshold, bounds)
    return bool(threshold.relation.function(side or _side(threshold, bounds, value), 0))


def side_of_certainty(threshold: Threshold, bounds: Bounds) -> int:
    """-1 if a probability is less than 1, with which it is compared, 1 if it is greater than 0, with which it is
    compared, however small the difference is, and 0 otherwise."""
    return (bounds.lower > threshold.number == 0) - (bounds.upper < threshold.number == 1)


def _side(threshold: Threshold, bounds: Bounds, value: float) -> float:
    """A negative number if a value is less than the number of a threshold, a positive one if it is greater, and 0 if
    both are equal as far as the bounds show; NaN if nothing is known."""
    number, slack = threshold.number, ROUNDING * max(1.0, abs(threshold.number))
    if bounds.upper < number - slack:
        return -1
    if bounds.lower > number + slack:
        return 1
    if bounds.lower == bounds.upper:
        return 0
    if math.isfinite(bounds.lower) and bounds.upper - bounds.lower <= _NARROW * max(1.0, abs(bounds.lower)):
        return 0
    return math.nan if value == number and threshold.relation is BinaryOperator.EQUAL else value - number


def _is_open(threshold: Threshold, bounds: Bounds) -> bool:
    """Whether the interval of a reward has no bound where the threshold needs one, for example since all rewards were
    equal. Then the estimate says nothing about rare rewards."""
    needs_lower = threshold.relation is BinaryOperator.EQUAL or threshold.is_lower
    needs_upper = threshold.relation is BinaryOperator.EQUAL or not threshold.is_lower
    return (needs_lower and bounds.lower == -math.inf) or (needs_upper and bounds.upper == math.inf)


def _rounded(bound: float) -> float:
    """A bound of the interval with three digits after the point, rounded away from the expected 0 or 1."""
    return math.floor(bound * 1000) / 1000 if bound > 0.5 else math.ceil(bound * 1000) / 1000

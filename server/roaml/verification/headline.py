# SPDX-License-Identifier: Apache-2.0
"""The words for a result: what is known about the value that the property asks for. Reports, lenses, hints and the list
of tests all use these words.

- A property that asks for a minimum or maximum over all schedulers is never answered by the value under uniform
  choices. The sampled traces of one scheduler bound the minimum from above and the maximum from below; if not even that
  excludes a value, the words only state that it is undecided.
- If traces are undecided, the words name bounds, the number of undecided traces and the remedy, and no value between
  the bounds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from roaml.exhaustive import assert_never
from roaml.record import Record
from roaml.smc.choices import Choices, Extreme, ExtremeMethod
from roaml.smc.end import End
from roaml.smc.goal import UNIFORMLY, InitialFold, Question
from roaml.smc.lss import Side
from roaml.smc.run import Answer
from roaml.verification.number_text import ALMOST_ONE, number, with_interval
from roaml.verification.results import Computed, CutShort, Estimated, Refused, Result, Sampled, SampledResult, Undecided
from roaml.verification.schedulers import extreme_of, is_minimised

NO_TRACES = "no result yet"
UNDECIDED = "undecided"
"""The word for a value, an extreme or an expectation about which nothing was found out."""
_EXTREME_STATES = {
    InitialFold.MINIMUM: "minimum over the initial states",
    InitialFold.MAXIMUM: "maximum over the initial states",
}
"""The values for which a property asks that names an extreme over the initial states itself."""
LONGER_TIME = "raise max_time, which does not help where what starts the deadline keeps happening"
"""The remedy for traces that the time ends before a deadline, as far as there is one."""
_SIGNS = {"at most": "≤", "at least": "≥", "less than": "<", "greater than": ">"}
NOT_CLOSER = "no closer bounds"
_MAX_DIGITS = 13
"""The maximum number of digits of a bound; what needs more of them to differ from 1 or 0 is rounding."""


class Headline(Record, frozen=True):
    """The words for a result.

    Attributes:
        claim: what is known for all schedulers, such as `minimum between 0 and 0.17 (0.95 confidence), no closer
            bounds`; "" if the property asks only for uniform choices, or all schedulers agree.
        estimate: the estimate from traces with uniform choices; "" if there is none.
        short: a short form of both, for editors; "" if there is no result.
        average: of what the estimate is one (`Question.average`).
    """

    claim: str = ""
    estimate: str = ""
    short: str = ""
    average: str = UNIFORMLY

    @property
    def text(self) -> str:
        """Both as one phrase."""
        return f"{self.claim}; {self.average}: {self.estimate}" if self.claim else self.estimate


def headline(result: Result) -> Headline:
    match result.outcome:
        case Computed() as computed:
            return Headline(short=f"{_asked_extreme(computed)}{exact_text(computed)}, exact")
        case Estimated(answer=answer, choices=choices):
            return of_answer(answer, choices)
        case Undecided():
            return Headline(short=UNDECIDED)
        case Sampled(extremes=extremes):
            return of_sampled(extremes)
        case Refused() | CutShort():
            return Headline()
        case never:
            return assert_never(never)


def of_sampled(extremes: Sequence[SampledResult]) -> Headline:
    """The words for the extreme estimates among sampled schedulers, with the one for which the property asks first."""
    ordered = sorted(
        extremes, key=lambda extreme: (extreme.side is Side.LEAST) is not extreme.answer.question.is_minimised
    )
    long = [found_text(extreme) for extreme in ordered]
    short = [f"{extreme.side.extreme} found {_short(extreme.answer)}" for extreme in ordered]
    return Headline("", "; ".join(long), "; ".join(short))


def found_text(extreme: SampledResult) -> str:
    """The estimate for the best one of sampled schedulers. It is not the extreme over all schedulers, so it is only
    called about as large."""
    estimate = estimate_text(extreme.answer)
    about = "" if extreme.answer.tally.undecided else "about "
    return f"{extreme.side.extreme} with the best scheduler found: {about}{estimate}"


def _asked_extreme(computed: Computed) -> str:
    """The asked extreme, such as `minimum `; "" if all schedulers agree, or uniform choices are asked."""
    if computed.exact.agrees:
        return ""
    return "" if computed.is_uniform else f"{extreme_of(computed.question)} "


def exact_text(computed: Computed) -> str:
    """An exact value with four significant digits; `almost 1` for a smaller probability that would be shown as 1."""
    bounds, value = computed.asked_value()
    text = _rounded(value, 4)
    is_below_one = bounds.upper < 1 or (is_minimised(computed.question) and computed.exact.fails)
    return ALMOST_ONE if text == "1" and is_below_one and not computed.question.is_reward else text


def of_answer(answer: Answer, choices: Choices | None = None) -> Headline:
    """The words for an estimate.

    Args:
        choices: what is known about other schedulers; `None` if only uniform choices are considered.
    """
    estimate, short = estimate_text(answer), _short(answer)
    claim = claim_for_all(answer.question, choices, answer.options.confidence) if answer.tally.traces else ""
    if not claim and answer.question.is_conditional and answer.tally.traces:
        # The minimum and the maximum under a condition are not computed.
        if answer.question.is_deterministic:
            return Headline("", estimate, short)
        return Headline("", f"{UNIFORMLY}: {estimate}", f"uniform {short}")
    if not claim or (_is_open(answer) and claim.endswith(UNDECIDED)):
        # Nothing is known: once is enough.
        return Headline("", estimate, short)
    known = _asked_extreme_of(answer.question, choices)
    if not answer.question.asks_for_extreme_state and (bound := bound_text(answer.question, known)):
        words, _, value = bound.rpartition(" ")
        return Headline(claim, estimate, f"{extreme_of(answer.question)} {_SIGNS[words]} {value}; uniform {short}")
    average = answer.question.average
    word = "uniform" if average == UNIFORMLY else "average"
    return Headline(claim, estimate, f"{claim}; {word} {short}", average)


def claim_for_all(question: Question, choices: Choices | None, confidence: float) -> str:
    """What is known about the minimum or maximum that a property asks for, if it may differ from the value under
    uniform choices; otherwise "".

    Args:
        confidence: that of bounds from traces.
    """
    if question.asks_for_extreme_state:
        known = _asked_extreme_of(question, choices)
        extreme = _EXTREME_STATES.get(question.fold, f"{extreme_of(question)} over the initial states")
        return (
            f"{extreme} {_value(question, known.value)}, exact"
            if known is not None and known.is_exact
            else f"{extreme} {UNDECIDED}"
        )
    if choices is None or choices.agreement:
        return ""
    known = _asked_extreme_of(question, choices)
    if known is not None and known.is_exact:
        return f"{extreme_of(question)} {_value(question, known.value)}, exact"
    bound = bound_text(question, known)
    if not bound:
        return f"{extreme_of(question)} {UNDECIDED}"
    if known is None or known.method is ExtremeMethod.REACTIONS:
        return f"{extreme_of(question)} {bound}, {NOT_CLOSER}"
    # A range cannot be taken for a second estimate.
    words, _, value = bound.rpartition(" ")
    between = f"between 0 and {value}" if words == "at most" else f"between {value} and 1"
    return f"{extreme_of(question)} {between} ({confidence:g} confidence), {NOT_CLOSER}"


def _asked_extreme_of(question: Question, choices: Choices | None) -> Extreme | None:
    """What is known about the minimum or maximum that a property asks for."""
    if choices is None:
        return None
    return choices.minimum if is_minimised(question) else choices.maximum


def bound_text(question: Question, known: Extreme | None) -> str:
    """What the bounds of the value under one scheduler show about the minimum or maximum that a property asks for, such
    as `at most 0.17`; "" for nothing."""
    if known is None or question.has_opposite_extremes or question.is_reward:
        return ""
    is_exact = known.method is ExtremeMethod.REACTIONS
    bound, limit = (known.bounds.upper, 1.0) if is_minimised(question) else (known.bounds.lower, 0.0)
    if bound == limit:
        return ""
    words, rounding = ("at most", math.ceil) if is_minimised(question) else ("at least", math.floor)
    for digits in range(6, _MAX_DIGITS) if is_exact else (3,):
        rounded = _outwards(bound, rounding, digits)
        if rounded != limit:
            return f"{words} {rounded:.{digits}g}"
    return ("less than 1" if is_minimised(question) else "greater than 0") if is_exact else ""


def _value(question: Question, value: float) -> str:
    return number(value, is_probability=not question.is_reward)


def too_wide(answer: Answer) -> str:
    """That the interval of an estimate is wider than requested, and which limit ended the estimate."""
    why = ", because max-traces ended the estimate" if answer.is_ended_by_limit else ""
    return f"the interval is wider than requested (epsilon){why}"


def estimate_text(answer: Answer) -> str:
    """An estimate with its interval and the numbers of traces; without a value if there are undecided traces."""
    tally, lower, is_reward = answer.tally, answer.bounds.lower, answer.question.is_reward
    if tally.traces == 0:
        return NO_TRACES
    good, bad = answer.question.outcomes
    if not tally.undecided or is_reward:
        is_open = bool(tally.undecided) and lower == -math.inf
        value = UNDECIDED if is_open else with_interval(answer.value, answer.bounds, is_probability=not is_reward)
        counts = f"{tally.traces:,} traces: {tally.successes:,} {good}, {answer.failures:,} {bad}"
        if tally.undecided:
            counts += f", {undecided_reason(answer)}"
        return f"{value} from {counts}"
    if _is_open(answer):
        return f"{UNDECIDED}: {undecided_reason(answer)}"
    results = [f"{tally.successes:,} of {tally.traces:,} traces {good}"]
    results += [f"{answer.failures:,} {bad}"] if answer.failures else []
    results.append(undecided_reason(answer))
    bounds = _between(answer)
    confidence = "" if bounds == UNDECIDED else f" ({answer.options.confidence:g} confidence)"
    return f"{bounds}{confidence}: {', '.join(results)}"


def _is_open(answer: Answer) -> bool:
    """Whether there are traces, and none of them decides a probability."""
    return 0 < answer.tally.traces == answer.tally.undecided and not answer.question.is_reward


def _between(answer: Answer) -> str:
    """The bounds of an estimate with undecided traces."""
    lower, upper = _outwards(answer.bounds.lower, math.floor), _outwards(answer.bounds.upper, math.ceil)
    match lower > 0, upper < 1:
        case True, True:
            return f"between {lower:g} and {upper:g}"
        case True, False:
            return f"at least {lower:g}"
        case False, True:
            return f"at most {upper:g}"
        case _:
            return UNDECIDED


def undecided_reason(answer: Answer) -> str:
    """The number of undecided traces, why they are undecided, and the remedy."""
    cut = answer.tally.ended(End.CUT)
    open_ = answer.tally.undecided - cut
    parts = []
    if cut:
        steps = f"{answer.options.max_steps:,} steps"
        remedy = answer.growth or "raise max-steps, or explore all states"
        parts.append(f"{_these(cut, answer)} cut after {steps}: {remedy}")
    if open_:
        these = _these(open_, answer)
        parts.append(f"{these} too short, because the time ended before a deadline: {LONGER_TIME}")
    return "; ".join(parts)


def _these(count: int, answer: Answer) -> str:
    """Some or all traces of an estimate, as a subject with its verb."""
    if count == answer.tally.traces:
        return "the only trace was" if count == 1 else f"all {count:,} traces were"
    return f"{count:,} {'was' if count == 1 else 'were'}"


def _short(answer: Answer) -> str:
    if answer.tally.traces == 0:
        return ""
    if answer.is_unknown:
        return UNDECIDED
    if answer.tally.undecided and not answer.question.is_reward:
        return _between(answer).replace("at least ", "≥ ").replace("at most ", "≤ ")
    lower, upper = answer.bounds
    if math.isfinite(answer.value) and upper == math.inf:
        if lower > -math.inf:
            return f"≥ {_rounded(lower)}"
        return UNDECIDED if answer.tally.undecided else _rounded(answer.value)
    if math.isinf(answer.value):
        return _rounded(answer.value)
    return f"{_rounded(answer.value)} [{_rounded(lower)}, {_rounded(upper)}]"


def _outwards(value: float, rounding: Callable[[float], int], digits: int = 3) -> float:
    """A bound with some digits after the point, rounded so that the statement remains true."""
    scale = float(10**digits)
    return rounding(round(value * scale, 9)) / scale


def _rounded(value: float, digits: int = 3) -> str:
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    return f"{value:.{digits}g}"

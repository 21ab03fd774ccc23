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
from roaml.smc.goal import InitialFold, Question
from roaml.smc.lss import Side
from roaml.smc.run import Answer
from roaml.verification.number_text import number
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


class Headline(Record, frozen=True):
    """The words for a result.

    Attributes:
        claim: what is known for all schedulers, such as `minimum between 0 and 0.17 (0.95 confidence), no closer
            bounds`; "" if the property asks only for uniform choices, or all schedulers agree.
        estimate: the estimate from traces with uniform choices; "" if there is none.
        short: a short form of both, for editors; "" if there is no result.
    """

    claim: str = ""
    estimate: str = ""
    short: str = ""

    @property
    def text(self) -> str:
        """Both as one phrase."""
        return f"{self.claim}; under uniform choices: {self.estimate}" if self.claim else self.estimate


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
    long = [f"{extreme.side.extreme} probability found {estimate_text(extreme.answer)}" for extreme in ordered]
    short = [f"{extreme.side.extreme} found {_short(extreme.answer)}" for extreme in ordered]
    return Headline("", "; ".join(long), "; ".join(short))


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
    return "almost 1" if text == "1" and is_below_one and not computed.question.is_reward else text


def of_answer(answer: Answer, choices: Choices | None = None) -> Headline:
    """The words for an estimate.

    Args:
        choices: what is known about other schedulers; `None` if only uniform choices are considered.
    """
    estimate, short = estimate_text(answer), _short(answer)
    claim = claim_for_all(answer.question, choices, answer.options.confidence) if answer.tally.traces else ""
    if not claim and answer.question.is_conditional and answer.tally.traces:
        # The minimum and the maximum under a condition are not computed.
        return Headline("", f"under uniform choices: {estimate}", f"uniform {short}")
    if not claim or (_is_open(answer) and claim.endswith(UNDECIDED)):
        # Nothing is known: once is enough.
        return Headline("", estimate, short)
    known = _asked_extreme_of(answer.question, choices)
    if not answer.question.asks_for_extreme_state and (bound := bound_text(answer.question, known)):
        words, _, value = bound.rpartition(" ")
        return Headline(claim, estimate, f"{extreme_of(answer.question)} {_SIGNS[words]} {value}; uniform {short}")
    return Headline(claim, estimate, f"{claim}; uniform {short}")


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
            f"{extreme} {number(known.value)}, exact"
            if known is not None and known.is_exact
            else f"{extreme} {UNDECIDED}"
        )
    if choices is None or choices.agreement:
        return ""
    known = _asked_extreme_of(question, choices)
    if known is not None and known.is_exact:
        return f"{extreme_of(question)} {number(known.value)}, exact"
    bound = bound_text(question, known)
    if not bound:
        return f"{extreme_of(question)} {UNDECIDED}"
    # A range cannot be taken for a second estimate.
    words, _, value = bound.rpartition(" ")
    if words in ("at most", "at least"):
        bound = f"between 0 and {value}" if words == "at most" else f"between {value} and 1"
    sure = "" if known is None or known.method is ExtremeMethod.REACTIONS else f" ({confidence:g} confidence)"
    return f"{extreme_of(question)} {bound}{sure}, {NOT_CLOSER}"


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
    digits = 6 if known.method is ExtremeMethod.REACTIONS else 3
    if is_minimised(question):
        upper = _outwards(known.bounds.upper, math.ceil, digits)
        if upper < 1:
            return f"at most {upper:g}"
        return "less than 1" if known.method is ExtremeMethod.REACTIONS and known.bounds.upper < 1 else ""
    lower = _outwards(known.bounds.lower, math.floor, digits)
    if lower > 0:
        return f"at least {lower:g}"
    return "greater than 0" if known.method is ExtremeMethod.REACTIONS and known.bounds.lower > 0 else ""


def estimate_text(answer: Answer) -> str:
    """An estimate with its interval and the numbers of traces; without a value if there are undecided traces."""
    tally, (lower, upper) = answer.tally, answer.bounds
    if tally.traces == 0:
        return NO_TRACES
    good, bad = ("stuck", "not stuck") if answer.question.is_stuck else ("passed", "failed")
    if not tally.undecided or answer.question.is_reward:
        value = UNDECIDED if answer.is_unknown else "infinite" if math.isinf(answer.value) else number(answer.value)
        counts = f"{tally.traces:,} traces: {tally.successes:,} {good}, {answer.failures:,} {bad}"
        if tally.undecided:
            counts += f", {tally.undecided:,} undecided"
        return f"{value} in [{number(lower)}, {number(upper)}] from {counts}"
    if _is_open(answer):
        return f"{UNDECIDED}: {_undecided(answer)}"
    results = [f"{tally.successes:,} of {tally.traces:,} traces {good}"]
    results += [f"{answer.failures:,} {bad}"] if answer.failures else []
    results.append(_undecided(answer))
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


def _undecided(answer: Answer) -> str:
    """The number of undecided traces, why they are undecided, and the remedy."""
    cut = answer.tally.ended(End.CUT)
    open_ = answer.tally.undecided - cut
    parts = []
    if cut:
        steps = f"{answer.options.max_steps:,} steps"
        parts.append(f"{_these(cut, answer)} cut after {steps}: raise max-steps, or explore all states")
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
    return f"{_rounded(answer.value)} [{_rounded(lower)}, {_rounded(upper)}]"


def _outwards(value: float, rounding: Callable[[float], int], digits: int = 3) -> float:
    """A bound with some digits after the point, rounded so that the statement remains true."""
    scale = float(10**digits)
    return rounding(round(value * scale, 9)) / scale


def _rounded(value: float, digits: int = 3) -> str:
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    return f"{value:.{digits}g}"

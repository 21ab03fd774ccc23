# SPDX-License-Identifier: Apache-2.0
"""Expectations that a user may want to set from a result."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from roaml.comparison import read_comparison
from roaml.verification.expectations import expectation_of
from roaml.verification.results import Result
from roaml.verification.verifier import with_expectations


def suggestions(result: Result) -> tuple[str, ...]:
    """The expectations that a result meets, such as `>= 0.97`: the strictest first, lower bounds before upper ones.

    If no trace contradicts a probability of 1 or 0, the expectation with this number is the first. The numbers of all
    others are at the ends of the interval, rounded outwards, so that their verdict is certain.
    """
    return tuple(text for text in _candidates(result) if _is_met(result, text))


def _candidates(result: Result) -> Iterator[str]:
    answer, choices = result.answer, result.choices
    if answer is None or answer.tally.traces == 0:
        return
    exact = result.asked_value()
    if exact is not None:
        fails = result.exact is not None and result.exact.fails
        yield from _around(exact[1], answer.question.is_reward, fails=fails)
        return
    lower, upper = answer.bounds
    for extreme in (choices.minimum, choices.maximum) if choices is not None else ():
        if extreme is not None:
            lower, upper = min(lower, extreme.bounds.lower), max(upper, extreme.bounds.upper)
    if answer.question.is_reward:
        if math.isfinite(lower):
            yield f">= {_rounded(lower, math.floor)}"
        if math.isfinite(upper):
            yield f"<= {_rounded(upper, math.ceil)}"
        return
    if answer.tally.successes == answer.tally.traces:
        yield ">= 1"
    if answer.tally.successes + answer.tally.undecided == 0:
        yield "<= 0"
    lower, upper = max(lower, 0), min(upper, 1)
    if _rounded(lower, math.floor) != "0":
        yield f">= {_rounded(lower, math.floor)}"
    if _rounded(upper, math.ceil) != "1":
        yield f"<= {_rounded(upper, math.ceil)}"


def _around(value: float, is_reward: bool, *, fails: bool) -> Iterator[str]:
    """Bounds on an exact value, without those that every probability satisfies.

    Args:
        fails: whether a trace fails, so that a probability is less than 1 even if it is rounded to 1.
    """
    if math.isfinite(value):
        if is_reward or value > 0:
            rounded = _rounded(value, math.floor)
            yield ">= 0.99" if rounded == "1" and fails and not is_reward else f">= {rounded}"
        if is_reward or value < 1:
            yield f"<= {_rounded(value, math.ceil)}"


def _rounded(number: float, rounding: Callable[[float], int]) -> str:
    """A number with two digits after the point, or two significant ones if it is close to 0."""
    digits = 2 if abs(number) >= 0.01 or number == 0 else 1 - math.floor(math.log10(abs(number)))
    return f"{rounding(round(number * 10**digits, 9)) / 10**digits:.{digits}f}".rstrip("0").rstrip(".")


def _is_met(result: Result, text: str) -> bool:
    comparison = read_comparison(text)
    assert comparison is not None
    checked = with_expectations(result, [expectation_of(result.name, comparison)])
    return bool(checked.verdicts) and checked.verdicts[-1].is_met

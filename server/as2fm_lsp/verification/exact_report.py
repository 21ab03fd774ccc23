# SPDX-License-Identifier: Apache-2.0
"""Results from all states, for users and programs."""

from __future__ import annotations

import math
from typing import Any

from roaml.smc.goal import UNIFORMLY, InitialFold, Question
from roaml.smc.program import FALSE, TRUE
from roaml.smc.statistics import Bounds
from roaml.verification.number_text import ALMOST_ONE, exact_number, json_number
from roaml.verification.results import EXACT_WIDTH, Computed, Exact, Proof, are_apart

EXACT = "exact"
"""The method and the kind of interval of an exact value in JSON."""
_PROOFS = {Proof.ALL: "all", Proof.NONE: "none", None: ""}
"""The words in JSON for what an exploration of all states has proved: that the condition of a property holds in all
states, or in none; empty if neither is proved."""

_DIGITS, _MAX_DIGITS = 7, 16
"""The number of significant digits of a value, and the greatest number if the minimum and the maximum would otherwise
look the same."""

_OVER_INITIAL_STATES = {
    InitialFold.CHOICE: "the scheduler chooses one of {:,} initial states",
    InitialFold.MINIMUM: "minimum over {:,} initial states",
    InitialFold.MAXIMUM: "maximum over {:,} initial states",
    InitialFold.MEAN: "mean over {:,} initial states",
}
_ONLY_INITIAL_STATES = "minimum and maximum over {:,} initial states, which are the only choice"
"""The same if the model has no other nondeterminism."""


def lines(
    name: str,
    exact: Exact,
    seconds: float,
    question: Question | None = None,
    *,
    only_uniform: bool = False,
    uniform_estimate: str = "",
    is_whole: bool = False,
) -> list[str]:
    """The lines of the report for users: the values; if it is whole, also proofs and the lengths of shortest traces.

    Args:
        question: what the property asks for; `None` if that is unknown.
        only_uniform: whether only the value under uniform choices is of interest.
        uniform_estimate: the estimate of the value under uniform choices, if it is not known exactly.
    """
    states = "1 state" if exact.states == 1 else f"{exact.states:,} states"
    end = f"{states}{' after reductions' if exact.is_reduced else ''}, {seconds:.1f} s"
    quality = "exact" if exact.is_precise else "not exact, because the bounds no longer converge"
    average = UNIFORMLY if question is None else question.average
    shown: list[str] = []
    if one_value := _one_value(exact):
        shown.append(f"{name}: {one_value} for all schedulers, {quality}, {end}")
    elif only_uniform and exact.uniform is not None:
        if _is_enclosed(exact):
            value, quality = f"between {' and '.join(_distinct(exact))}", f"the {quality} minimum and maximum"
        else:
            value = _below_one(exact, exact.uniform) or f"= {_number(exact, exact.uniform)}"
        shown.append(f"{name}: {value} {average}, {quality}, {end}")
    else:
        both = _extremes(exact, question)
        if _is_enclosed(exact):
            both += f", between them {average}"
        elif exact.uniform is not None:
            both += f", {_below_one(exact, exact.uniform) or _number(exact, exact.uniform)} {average}"
        shown.append(f"{name}: {both}, {quality}, {end}")
        if exact.uniform is None and uniform_estimate:
            shown.append(f"  {average}: {uniform_estimate}")
        elif exact.uniform is None:
            shown.append("  not computed: the value under uniform choices; use --no-reductions")
    if exact.initial_states > 1:
        is_only_choice = question is not None and question.is_deterministic and exact.fold is InitialFold.CHOICE
        text = _ONLY_INITIAL_STATES if is_only_choice else _OVER_INITIAL_STATES[exact.fold]
        shown.append(f"  {text.format(exact.initial_states)}")
    return [*shown, *_details(exact, states, question)] if is_whole else shown


def _details(exact: Exact, states: str, question: Question | None) -> list[str]:
    """A proof, and the lengths of the shortest traces."""
    shown = []
    fails, holds = exact.shortest(FALSE), exact.shortest(TRUE)
    if exact.proof is Proof.ALL:
        shown.append(f"  proof: its condition holds in all {'states' if exact.is_reduced else states}")
    elif exact.proof is Proof.NONE:
        shown.append(f"  proof: its condition holds in {'no state' if exact.is_reduced else f'none of the {states}'}")
    is_reward = question is not None and question.is_reward
    shortest = [
        f"{what} after {trace.steps:,} {'step' if trace.steps == 1 else 'steps'}"
        for what, trace in (("it fails", fails), ("its condition is reached" if is_reward else "it holds", holds))
        if trace is not None
    ]
    if shortest:
        shown.append(f"  {'example traces' if exact.is_reduced else 'shortest traces'}: {', '.join(shortest)}")
    return shown


def short(exact: Exact, question: Question) -> str:
    """The values, in one line for users.

    Args:
        question: what the property asks for.
    """
    states = "1 state" if exact.states == 1 else f"{exact.states:,} states"
    end = f"{states}{' after reductions' if exact.is_reduced else ''}"
    if one_value := _one_value(exact):
        return f"{one_value} for all schedulers, exact, {end}"
    return f"{_extremes(exact, question)}, exact, {end}"


def _extremes(exact: Exact, question: Question | None) -> str:
    """The minimum and the maximum, with the one for which the property asks first; the minimum if that is unknown."""
    least, greatest = _distinct(exact)
    minimum = f"minimum {_least_below_one(exact) or least}"
    maximum = f"maximum {_below_one(exact, exact.maximum) or greatest}"
    is_minimum_first = question is None or question.is_minimised
    return f"{minimum}, {maximum}" if is_minimum_first else f"{maximum}, {minimum}"


def _distinct(exact: Exact) -> tuple[str, str]:
    """The minimum and the maximum, with as many digits as are necessary to see that they differ."""
    for digits in range(_DIGITS, _MAX_DIGITS):
        least, greatest = _number(exact, exact.minimum, digits), _number(exact, exact.maximum, digits)
        if least != greatest or not are_apart(exact.minimum, exact.maximum):
            return least, greatest
    return _number(exact, exact.minimum, _MAX_DIGITS), _number(exact, exact.maximum, _MAX_DIGITS)


def _is_enclosed(exact: Exact) -> bool:
    """Whether the value under uniform choices was not computed, and is only known to be between the minimum and the
    maximum, which differ."""
    is_between = exact.uniform == Bounds(exact.minimum.lower, exact.maximum.upper)
    return is_between and not exact.agrees


def row(exact: Exact) -> dict[str, Any]:
    """The result as a value for JSON."""
    return {
        "least": json_number(exact.least),
        "greatest": json_number(exact.greatest),
        "uniform": json_number(exact.average),
        "bounds": {
            name: None if bounds is None else [json_number(bounds.lower), json_number(bounds.upper)]
            for name, bounds in (("least", exact.minimum), ("greatest", exact.maximum), ("uniform", exact.uniform))
        },
        "precise": exact.is_precise,
        "proof": _PROOFS[exact.proof],
        "states": exact.states,
        "initial_states": {"number": exact.initial_states, "combined": exact.fold.value},
        "reduced": exact.is_reduced,
        "shortest": {
            name: None if (trace := exact.shortest(verdict)) is None or exact.is_reduced else trace.steps
            for name, verdict in (("failed", FALSE), ("passed", TRUE))
        },
    }


ESTIMATE = (
    "expected_value",
    "probability",
    "lower",
    "upper",
    "complete",
    "interval",
    "confidence",
    "epsilon",
    "method",
)
"""The members for JSON that describe an estimate."""


def estimate_row(computed: Computed) -> dict[str, Any]:
    """The members for JSON that replace the estimate of the traces (`ESTIMATE`)."""
    bounds, value = computed.asked_value()
    return {
        "expected_value" if computed.question.is_reward else "probability": json_number(value),
        "lower": json_number(bounds.lower),
        "upper": json_number(bounds.upper),
        "complete": True,
        "interval": EXACT,
        "confidence": 1,
        "epsilon": EXACT_WIDTH,
        "method": EXACT,
    }


def _one_value(exact: Exact) -> str:
    """The words for the value of all schedulers, also if all are close to 1; "" if they have different values."""
    almost = _least_below_one(exact)
    if exact.agrees:
        return almost or f"= {_number(exact, exact.minimum)}"
    return f"1 or {almost}" if almost and exact.maximum.lower >= 1.0 else ""


def _least_below_one(exact: Exact) -> str:
    """As `_below_one`, for the minimum. A trace that fails excludes 1 even if the bounds are equal to 1."""
    if not exact.is_reward and exact.fails and exact.minimum.lower == 1:
        return f"{ALMOST_ONE} (fails, but too rarely to compute how often)"
    return _below_one(exact, exact.minimum)


def _below_one(exact: Exact, bounds: Bounds) -> str:
    """The words for a probability that is less than 1 and would be shown as 1; "" for all other values."""
    is_shown_as_one = f"{bounds.upper:.7g}" == "1" == f"{(bounds.lower + bounds.upper) / 2:.7g}"
    if exact.is_reward or bounds.upper >= 1.0 or not is_shown_as_one:
        return ""
    return f"{ALMOST_ONE} (fails with a probability of at most {_upwards(1 - bounds.lower)})"


def _upwards(value: float) -> str:
    """A small positive number with one digit, rounded up unless the difference is negligible."""
    exponent = math.floor(math.log10(value))
    return f"{math.ceil(value / 10**exponent - 1e-6) * 10**exponent:.1g}"


def _number(exact: Exact, bounds: Bounds, digits: int = _DIGITS) -> str:
    """A value, or the interval of its bounds if that is wider than `EXACT_WIDTH`, relative to the value if it is
    greater than 1."""
    if math.isinf(bounds.lower) and bounds.lower == bounds.upper:
        return "∞" if bounds.lower > 0 else "-∞"
    if bounds.upper - bounds.lower > EXACT_WIDTH * max(1.0, abs(bounds.lower)):
        return f"[{bounds.lower:.7g}, {'∞' if math.isinf(bounds.upper) else f'{bounds.upper:.7g}'}]"
    return exact_number(bounds.lower, bounds.upper, digits, is_probability=not exact.is_reward)

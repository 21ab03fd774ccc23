# SPDX-License-Identifier: Apache-2.0
"""`Pmin` and `Pmax` ask about all schedulers, traces are made with one: what that means for an answer and for what was
expected of it, in words and for programs.

- That a minimum is at least a number, or a maximum at most, must hold under every scheduler. One that misses it refutes
  it; if only uniform choices are known to meet it, it is met under uniform choices.
- That a minimum is at most a number, or a maximum at least, holds if one scheduler shows it, be it the uniform one.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from as2fm_lsp.verification.expectations import Verdict
from roaml.jani.operators import BinaryOperator
from roaml.smc.choices import EXPLORATION, SAMPLING, Choices, Extreme
from roaml.smc.goal import Question
from roaml.smc.run import Answer

_SLACK = 1e-6


def under_all_schedulers(verdict: Verdict, answer: Answer, choices: Choices | None) -> Verdict:
    """A verdict on what is expected of an answer under uniform choices, with what is known of other schedulers.

    Args:
        choices: None if uniform choices are what is wanted.
    """
    if choices is None or choices.agreement:
        return verdict
    threshold = verdict.expectation.threshold
    is_minimum = asks_for_minimum(answer.question)
    extreme = choices.minimum if is_minimum else choices.maximum
    if extreme is not None and extreme.is_exact:
        if threshold.relation is BinaryOperator.EQUAL:
            near = abs(extreme.value - threshold.number) <= answer.options.epsilon + 1e-12
            return replace(verdict, is_met=near, is_certain=True)
        is_strict = threshold.relation in (BinaryOperator.LESS, BinaryOperator.GREATER)
        slack = 0.0 if is_strict else _SLACK
        met = threshold.met(extreme.value + slack) or threshold.met(extreme.value - slack)
        return replace(verdict, is_met=met, is_certain=True)
    if threshold.relation is BinaryOperator.EQUAL:
        width = answer.options.epsilon
        bounds = None if extreme is None else extreme.bounds
        if bounds is not None and not bounds.lower - width <= threshold.number <= bounds.upper + width:
            return replace(verdict, is_met=False, is_certain=True)
        return replace(verdict, is_uniform=verdict.is_met)
    if threshold.is_lower is is_minimum:
        if extreme is not None and not threshold.met(extreme.bounds.upper if is_minimum else extreme.bounds.lower):
            return replace(verdict, is_met=False, is_certain=True)
        return replace(verdict, is_uniform=verdict.is_met)
    if extreme is not None and threshold.met(extreme.bounds.upper if is_minimum else extreme.bounds.lower):
        return replace(verdict, is_met=True, is_certain=True)
    return verdict


def asks_for_minimum(question: Question) -> bool:
    """Whether a property asks for the least value."""
    return question.operator.endswith("min")


def remark(question: Question, choices: Choices | None) -> str:
    """One line for people; empty if uniform choices are what is wanted."""
    if choices is None:
        return ""
    if choices.agreement:
        return f"all schedulers agree: {choices.agreement}"
    extreme = "minimum" if asks_for_minimum(question) else "maximum"
    head = f"warning: this is the value under uniform choices, and `{question.operator}` asks for the {extreme}"
    least, greatest = choices.minimum, choices.maximum
    if least is not None and greatest is not None and choices.differ:
        return f"{head}; schedulers reach from {_reached(least)} to {_reached(greatest)}"
    if choices.tried:
        return f"{head}, which may differ; {choices.tried:,} sampled schedulers show no difference"
    why = "schedulers are not sampled for expected rewards" if question.is_reward else "no schedulers were sampled"
    return f"{head}, which may differ; {why}"


def warning(question: Question, choices: Choices | None) -> str:
    """The same if it is a warning, for programs; else empty."""
    text = remark(question, choices)
    return text.removeprefix("warning: ") if text.startswith("warning: ") else ""


def rows(choices: Choices | None) -> dict[str, Any]:
    """For JSON: `schedulers`, whether all agree (null if that is not known) and why, `minimum` and `maximum`."""
    if choices is None:
        return {"schedulers": {"wanted": "uniform"}}
    agree = True if choices.agreement else False if choices.differ else None
    found: dict[str, Any] = {"schedulers": {"wanted": "all", "agree": agree, "why": choices.agreement}}
    if choices.tried:
        found["schedulers"]["tried"] = choices.tried
    for name, extreme in (("minimum", choices.minimum), ("maximum", choices.maximum)):
        found[name] = None if extreme is None else _row(extreme)
    return found


def _row(extreme: Extreme) -> dict[str, Any]:
    row: dict[str, Any] = {
        "value": _finite(extreme.value),
        "lower": _finite(extreme.bounds.lower),
        "upper": _finite(extreme.bounds.upper),
        "found": extreme.found,
    }
    if extreme.scheduler:
        row["scheduler"] = extreme.scheduler
    if extreme.traces:
        row["traces"] = extreme.traces
    return row


def _reached(extreme: Extreme) -> str:
    if extreme.found == EXPLORATION:
        return f"{extreme.value:.6g} (exactly, from all states)"
    who = f"by {extreme.scheduler}" if extreme.found == SAMPLING else "by uniform choices"
    return f"{extreme.value:.6g} in [{extreme.bounds.lower:.6g}, {extreme.bounds.upper:.6g}] ({who})"


def _finite(value: float) -> float | str | None:
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else "infinity" if value > 0 else "-infinity"

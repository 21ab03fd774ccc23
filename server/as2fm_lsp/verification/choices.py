# SPDX-License-Identifier: Apache-2.0
"""`Pmin` and `Pmax` ask about all schedulers, traces are made with one: what that means for an answer and for what was
expected of it, in words and for programs.

- That a minimum is at least a number, or a maximum at most, must hold under every scheduler. One that misses it refutes
  it; if only uniform choices are known to meet it, it is met under uniform choices.
- That a minimum is at most a number, or a maximum at least, holds if one scheduler shows it, be it the uniform one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from as2fm_lsp.verification.expectations import Verdict
from roaml.jani.operators import BinaryOperator
from roaml.smc.choices import EXPLORATION, SAMPLING, UNIFORM, Choices, Extreme
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
    if not verdict.is_met:
        verdict = replace(verdict, under="under uniform choices")
    threshold = verdict.expectation.threshold
    is_minimum = asks_for_minimum(answer.question)
    extreme = choices.minimum if is_minimum else choices.maximum
    missed = replace(verdict, is_met=False, is_certain=True, under=_missed_by(answer.question, extreme))
    if extreme is not None and extreme.is_exact:
        if threshold.relation is BinaryOperator.EQUAL:
            met = abs(extreme.value - threshold.number) <= answer.options.epsilon + 1e-12
        else:
            is_strict = threshold.relation in (BinaryOperator.LESS, BinaryOperator.GREATER)
            slack = 0.0 if is_strict else _SLACK
            met = threshold.met(extreme.value + slack) or threshold.met(extreme.value - slack)
        return replace(verdict, is_met=True, is_certain=True, under="") if met else missed
    if threshold.relation is BinaryOperator.EQUAL:
        width = answer.options.epsilon
        bounds = None if extreme is None else extreme.bounds
        if bounds is not None and not bounds.lower - width <= threshold.number <= bounds.upper + width:
            return missed
        return replace(verdict, is_uniform=verdict.is_met)
    if threshold.is_lower is is_minimum:
        if extreme is not None and not threshold.met(extreme.bounds.upper if is_minimum else extreme.bounds.lower):
            return missed
        return replace(verdict, is_uniform=verdict.is_met)
    if extreme is not None and threshold.met(extreme.bounds.upper if is_minimum else extreme.bounds.lower):
        return replace(verdict, is_met=True, is_certain=True, under="")
    return verdict


def _missed_by(question: Question, extreme: Extreme | None) -> str:
    """Where an extreme is found that does not meet what is expected."""
    if extreme is None or extreme.found == UNIFORM:
        return "under uniform choices"
    if extreme.is_exact:
        return f"by the {_asked(question)} over all schedulers, which is {extreme.value:.6g}"
    return f"under {extreme.scheduler}: {_interval(extreme)}"


def asks_for_minimum(question: Question) -> bool:
    """Whether a property asks for the least value."""
    return question.operator.endswith("min")


def may_differ(choices: Choices | None) -> bool:
    """Whether it is open if other schedulers than the uniform one give another value."""
    return choices is not None and not choices.agreement and not choices.differ


def remark(question: Question, choices: Choices | None) -> str:
    """One line for people; empty if uniform choices are what is wanted."""
    if choices is None:
        return ""
    if choices.agreement:
        return f"all schedulers agree: {choices.agreement}"
    head = "warning: this is the value under uniform choices"
    head += f", and `{question.operator}` asks for the {_asked(question)}"
    least, greatest = choices.minimum, choices.maximum
    if least is not None and greatest is not None and choices.differ:
        return f"{head}; schedulers reach from {_reached(least)} to {_reached(greatest)}"
    return f"{head}, which may differ; {_looked(question, choices)}"


def warning(question: Question, choices: Choices | None) -> str:
    """The same if it is a warning, for programs; else empty."""
    text = remark(question, choices)
    return text.removeprefix("warning: ") if text.startswith("warning: ") else ""


def note(asked: Sequence[tuple[Question, Choices]]) -> list[str]:
    """Said once of all properties whose minimum or maximum may differ from their values, and what one can do about it.

    Args:
        asked: these properties, with what is known of them.
    """
    if not asked:
        return []
    names: dict[tuple[str, str], list[str]] = {}
    tried: dict[tuple[str, str], int] = {}
    for question, choices in asked:
        key = (question.operator, "" if choices.tried else _looked(question, choices))
        names.setdefault(key, []).append(question.name)
        tried[key] = max(tried.get(key, 0), choices.tried)
    lines = ["note: these are values under uniform choices; the minimum or maximum over all schedulers may differ"]
    for (operator, why), of in names.items():
        extreme = "minimum" if operator.endswith("min") else "maximum"
        looked = why or f"up to {tried[operator, why]:,} sampled schedulers show no difference, which proves nothing"
        lines.append(f"  {', '.join(of)} (`{operator}` asks for the {extreme}): {looked}")
    lines.append(
        "  help: use --scheduler uniform if you want uniform choices, --scheduler lss to sample more schedulers, "
        "or --exact to compute the minimum and the maximum if there are few states"
    )
    return lines


def _looked(question: Question, choices: Choices) -> str:
    """How a difference was looked for, and was not found."""
    if choices.tried:
        return f"{choices.tried:,} sampled schedulers show no difference"
    return "schedulers are not sampled for expected rewards" if question.is_reward else "no schedulers were sampled"


def _asked(question: Question) -> str:
    return "minimum" if asks_for_minimum(question) else "maximum"


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
    who = extreme.scheduler if extreme.found == SAMPLING else "uniform choices"
    return f"{_interval(extreme)} (by {who})"


def _interval(extreme: Extreme) -> str:
    return f"{extreme.value:.6g} in [{extreme.bounds.lower:.6g}, {extreme.bounds.upper:.6g}]"


def _finite(value: float) -> float | str | None:
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else "infinity" if value > 0 else "-infinity"

# SPDX-License-Identifier: Apache-2.0
"""Results for schedulers other than the uniform one, for users and programs."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

from roaml.smc.choices import Choices, Extreme, ExtremeMethod
from roaml.smc.goal import UNIFORMLY, InitialFold, Question
from roaml.verification.headline import bound_text
from roaml.verification.number_text import json_number, number
from roaml.verification.schedulers import extreme_of, is_minimised

UNIFORM_CHOICES = "uniform choices: each step that is possible is equally probable"
A_SCHEDULER = (
    "a scheduler: a rule that chooses which of the possible steps is next, such as which of two messages arrives first"
)
"""What the words of results mean for readers who do not know model checking."""
OTHERS = "another one may have a lower minimum or a higher maximum"
"""What the values of sampled schedulers do not show."""
MAX_NAMED = 4
"""The maximum number of properties that a note names."""


def remark(question: Question, choices: Choices | None) -> str:
    """A line for users about schedulers other than the uniform one: that all schedulers have the same value, or a
    warning with what is known about the extreme that the property asks for if schedulers are known to have different
    values, or a warning that they may have.

    Args:
        choices: `None` if the property asks only for uniform choices; the line is then empty.
    """
    if question.asks_for_extreme_state:
        return _initial_states_remark(question, choices)
    if choices is None:
        return ""
    if choices.agreement:
        value = choices.minimum
        if value is not None and value.is_exact:
            return f"the exact value is {number(value.value)} for all schedulers: {choices.agreement}"
        return f"all schedulers agree: {choices.agreement}"
    asked = f"the property asks for the {extreme_of(question)} over all schedulers"
    known = choices.minimum if is_minimised(question) else choices.maximum
    if known is not None and choices.differ:
        return f"warning: {asked}, which {_known(question, known)}"
    head = "warning: this is the value under uniform choices"
    return f"{head}, and {asked}, which may differ; {_looked(question, choices)}"


def below_headline(question: Question, choices: Choices | None) -> str:
    """The text of `remark`, without what the headline above it states (`roaml.verification.headline.claim_for_all`):
    an exact extreme, or its bound. Of a bound, what shows it remains."""
    known = None if choices is None else choices.minimum if is_minimised(question) else choices.maximum
    if known is None or choices is None or choices.agreement or not choices.differ or question.asks_for_extreme_state:
        return remark(question, choices)
    if known.is_exact:
        return ""
    if not bound_text(question, known):
        return remark(question, choices)
    is_sampled = known.method is ExtremeMethod.SAMPLING
    basis = f"from {known.scheduler}" if is_sampled else "the value if machines react at once"
    return f"warning: the order of steps matters; the bound of the {extreme_of(question)} is {basis}"


def _known(question: Question, extreme: Extreme) -> str:
    """What is known about the extreme that a property asks for, as a phrase with a verb. The value under uniform
    choices is in the line before it."""
    if extreme.is_exact:
        return f"is {number(extreme.value)} (exact, from all states)"
    if extreme.method is ExtremeMethod.REACTIONS and (bound := bound_text(question, extreme)):
        return f"is {bound}, the value if machines react at once"
    if extreme.method is ExtremeMethod.SAMPLING and (bound := bound_text(question, extreme)):
        return f"is {bound} (by {extreme.scheduler})"
    return f"may be {'smaller' if is_minimised(question) else 'greater'}: other schedulers have other values"


def _initial_states_remark(question: Question, choices: Choices | None) -> str:
    """A warning that traces have the mean of the values of several initial states, and not the extreme one."""
    extreme, schedulers = extreme_of(question), "" if question.is_deterministic else " and all schedulers"
    asked = {
        InitialFold.CHOICE: f"{extreme} over the initial states{schedulers}",
        InitialFold.MINIMUM: "minimum over the initial states",
        InitialFold.MAXIMUM: "maximum over the initial states",
    }[question.fold]
    known = None if choices is None else choices.minimum if is_minimised(question) else choices.maximum
    count = f"{question.initial_states:,}"
    chosen = "" if question.is_deterministic else f" {UNIFORMLY}"
    head = f"warning: this is the mean over {count} initial states{chosen}, and the property asks for"
    if known is not None and known.is_exact:
        return f"{head} the {asked}, which is {number(known.value)} (exact, from all states)"
    return f"{head} the {asked}, which may differ"


def meanings(text: str) -> str:
    """What the words for schedulers in a text mean, in one line; "" if it has none of them."""
    parts = [UNIFORM_CHOICES] if "uniform choices" in text else []
    parts += [A_SCHEDULER] if "minimum" in text or "maximum" in text else []
    return "; ".join(parts)


def warning(question: Question, choices: Choices | None) -> str:
    """The text of `remark` for programs if it is a warning; otherwise empty."""
    text = remark(question, choices)
    return text.removeprefix("warning: ") if text.startswith("warning: ") else ""


def note(
    entries: Sequence[tuple[Question, Choices]], *, opened: Collection[str] = (), knows_reactions: bool = False
) -> list[str]:
    """A note about properties whose minimum or maximum may differ from their values, in one line for each reason, and
    what to do. Properties whose schedulers are known to have different values have a warning instead of a line.

    Args:
        entries: the properties whose minimum or maximum is not known, with what is known about other schedulers;
            without entries, there are no lines.
        opened: the names of those for which all states give no value either, because the time ends before a deadline.
        knows_reactions: whether values for another reaction time are shown.
    """
    if not entries:
        return []
    lines = []
    if unclear := [question.name for question, choices in entries if question.name in opened and not choices.differ]:
        why = "the time ends before a deadline in some traces, and --exhaustive does not decide these either"
        lines.append(f"note: the minimum or maximum of {_listed(unclear)} over all schedulers is undecided ({why})")
    entries = [(question, choices) for question, choices in entries if question.name not in opened]
    return lines + (_note_of_others(entries, knows_reactions=knows_reactions) if entries else [])


def _note_of_others(entries: Sequence[tuple[Question, Choices]], *, knows_reactions: bool) -> list[str]:
    """The lines of `note` about properties for which all states may give a value."""
    names: dict[tuple[str, str, str], list[str]] = {}
    tried: dict[tuple[str, str, str], int] = {}
    most: dict[tuple[str, str, str], Choices] = {}
    for question, choices in entries:
        if choices.differ:
            continue
        kind = choices.limit if choices.explored else choices.reason
        key = (question.operator, "" if choices.tried else _looked(question, choices), kind)
        names.setdefault(key, []).append(question.name)
        tried[key] = max(tried.get(key, 0), choices.tried)
        most[key] = max(most.get(key, choices), choices, key=lambda other: other.explored)
    lines = []
    for key, of in names.items():
        operator, why, _ = key
        extreme = "minimum" if operator.endswith("min") else "maximum"
        looked = why or f"{_no_difference(tried[key], 'up to ')}, which proves nothing"
        if ended := _ended(most[key]):
            looked = f"{ended}; {looked}"
        lines.append(f"note: the {extreme} of {_listed(of)} over all schedulers is undecided ({looked})")
    ways = ["--exhaustive to compute it from all states", "--scheduler uniform if uniform choices are meant"]
    if limits := [limit for limit in dict.fromkeys(choices.limit for _, choices in entries) if limit]:
        ways.insert(0, f"a higher {' and '.join(f'--{limit}' for limit in limits)} to search for longer")
    if knows_reactions:
        ways.insert(0, 'a reaction time if machines always react within it (--reaction-time instant, or "20 ms")')
    advice = f"use {', '.join(ways[:-1])}, or {ways[-1]}"
    return [*lines, f"  help: {advice}"] if lines else [f"help: for what is undecided, {advice}"]


def _ended(choices: Choices) -> str:
    """Why the search through all schedulers gave no values, with the limit that ended it, as a phrase for users; "" if
    there was none."""
    if choices.explored and choices.limit:
        return f"too many states: the search stopped at {choices.explored:,} states, at the limit --{choices.limit}"
    if choices.explored:
        return f"the search {choices.reason}"
    return f"no values from all states: {choices.reason}" if choices.reason else ""


def _listed(names: Sequence[str]) -> str:
    """Names of properties; of many, the first ones and the number of the others."""
    shown = ", ".join(names) if len(names) <= MAX_NAMED else ", ".join(names[: MAX_NAMED - 1])
    return shown if len(names) <= MAX_NAMED else f"{shown} and {len(names) - MAX_NAMED + 1:,} more"


def _no_difference(tried: int, at_most: str = "") -> str:
    if tried == 1:
        return "the only sampled scheduler shows no difference"
    return f"{at_most}{tried:,} sampled schedulers show no difference"


def _looked(question: Question, choices: Choices) -> str:
    """A phrase that states how a difference was searched for without success."""
    if choices.tried:
        return _no_difference(choices.tried)
    return "schedulers are not sampled for expected rewards" if question.is_reward else "no schedulers were sampled"


def rows(choices: Choices | None) -> dict[str, Any]:
    """The members of a result in JSON. `schedulers` states whether the property asks for all schedulers or for uniform
    choices only. For all schedulers, it also states whether they have the same value (`agree`; null if unknown), why,
    and how many were sampled; `minimum` and `maximum` are their extreme values, null if unknown."""
    if choices is None:
        return {"schedulers": {"wanted": "uniform"}}
    agree = True if choices.agreement else False if choices.differ else None
    row: dict[str, Any] = {"schedulers": {"wanted": "all", "agree": agree, "why": choices.agreement}}
    if choices.tried:
        row["schedulers"]["tried"] = choices.tried
    for name, extreme in (("minimum", choices.minimum), ("maximum", choices.maximum)):
        row[name] = None if extreme is None else _row(extreme)
    return row


def _row(extreme: Extreme) -> dict[str, Any]:
    row: dict[str, Any] = {
        "value": json_number(extreme.value),
        "lower": json_number(extreme.bounds.lower),
        "upper": json_number(extreme.bounds.upper),
        "found": extreme.method.value,
    }
    if extreme.scheduler:
        row["scheduler"] = extreme.scheduler
    if extreme.traces:
        row["traces"] = extreme.traces
    return row

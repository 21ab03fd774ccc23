# SPDX-License-Identifier: Apache-2.0
"""Reports on how far traces have exercised a property: how many satisfy its assumptions, enter its scope, contain its
trigger, or are left open when the time ends (docs/verification.md#vacuity)."""

from __future__ import annotations

from typing import Any

from roaml.smc.end import End
from roaml.smc.goal import Question
from roaml.smc.run import Answer
from roaml.smc.tally import Tally

_UNTESTED = "these are among the passed traces, but do not test it"
_NEVER_TESTED = "nothing has tested the property, so this value does not show that the system is right (vacuous):"
_REMEDY = "check whether it can happen at all"
_MORE_TIME = ", or allow more time (max_time)"
"""A remedy where the end of time has ended traces."""
NONE_ACCEPTED = "no trace satisfies the assumptions of the property, so there is no value"


def remarks(answer: Answer, *, are_examples: bool = False) -> list[str]:
    """The remarks of a result for users, one line each.

    Args:
        are_examples: whether the traces are examples for an exact value, so that no other line states their number.
    """
    tally = answer.tally
    lines = []
    if answer.question.is_conditional and tally.traces:
        share = _share(tally.traces, tally.simulated)
        if answer.question.is_reward:
            lines.append(f"the value is that of the traces that reach the condition: {share}")
        else:
            lines.append(f"the value is that of the traces that satisfy the assumption: {share}")
    if is_untested(answer):
        lines.append(f"warning: {warning(answer)}")
    elif tally.undecided < tally.traces:
        if tally.closed:
            lines.append(f"{_not_opened(answer.question)} in {_share(tally.closed, tally.traces)}: {_UNTESTED}")
        if tally.idle:
            lines.append(f"{_not_triggered(answer.question)} in {_share(tally.idle, tally.traces)}: {_UNTESTED}")
    late = tally.late or _ended_with_time(answer)
    if late:
        of = f" (of {tally.traces:,} random examples)" if are_examples else ""
        share = "all" if late == answer.failures else f"{late:,} of"
        lines.append(
            f"{share} {answer.failures:,} failed traces{of} fail because the time ends (max_time) before what "
            "the property requires has happened; a longer time may satisfy them"
        )
    opened = open_at_end(tally)
    if opened:
        lines.append(
            f"{_share(opened, tally.traces)} are open: the time ends (max_time) before a deadline of the property; "
            "they widen the interval"
        )
    return lines


def is_untested(answer: Answer) -> bool:
    """Whether the property holds vacuously in all traces. If all are undecided, it holds in none."""
    tally = answer.tally
    return tally.undecided < tally.traces == tally.closed + tally.idle


def _ended_with_time(answer: Answer) -> int:
    """The number of traces if all of them have failed and have lasted until the end of time; otherwise 0. If some have
    passed, failed ones may never pass, however long the time is."""
    question, tally = answer.question, answer.tally
    ended = tally.ends.get(End.TIME)
    if ended is None or question.is_reward or question.is_stuck or not tally.traces == ended.count == answer.failures:
        return 0
    return answer.failures


def open_at_end(tally: Tally) -> int:
    """The number of traces that are undecided because the time ended before a deadline of the property."""
    return tally.undecided - tally.ended(End.CUT)


def warning(answer: Answer) -> str:
    """The reason why the value does not show how the system behaves: no trace satisfies the assumptions of the
    property, or all traces satisfy it vacuously; "" otherwise."""
    tally = answer.tally
    if answer.question.is_conditional and tally.traces == 0 and tally.rejected:
        return f"{NONE_ACCEPTED}: {tally.rejected:,} traces violate them"
    if not is_untested(answer):
        return ""
    more_time = _MORE_TIME if End.TIME in tally.ends else ""
    missing = (_not_triggered if tally.idle else _not_opened)(answer.question)
    return f"{_NEVER_TESTED} {missing} in any trace; {_REMEDY}{more_time}"


def _not_triggered(question: Question) -> str:
    """That the event did not happen after which the property requires something."""
    trigger = f"{question.trigger}, " if question.trigger else ""
    return f"{trigger}what must happen before the property requires anything{',' if trigger else ''} did not happen"


def _not_opened(question: Question) -> str:
    """That the event did not happen that begins or ends the scope of the property."""
    scope = f"{question.scope}, " if question.scope else ""
    return f"{scope}the event that begins or ends the scope of the property{',' if scope else ''} did not happen"


def row(answer: Answer) -> dict[str, Any]:
    """The facts of `remarks` as a value for JSON."""
    tally, question = answer.tally, answer.question
    values: dict[str, Any] = {"open_at_end_of_time": open_at_end(tally)}
    if question.is_conditional:
        values["assumptions"] = {"satisfied": tally.traces, "violated": tally.rejected}
    if question.can_be_vacuous:
        values["vacuous"] = {"scope_not_judged": tally.closed, "not_triggered": tally.idle}
    if question.can_be_late:
        values["failed_at_end_of_time"] = tally.late
    return values


def _share(part: int, whole: int) -> str:
    """A number of traces as a share of all, such as `3 of 200 traces (1.5 %)`."""
    return f"all {whole:,} traces" if part == whole else f"{part:,} of {whole:,} traces ({100 * part / whole:.3g} %)"

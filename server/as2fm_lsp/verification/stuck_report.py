# SPDX-License-Identifier: Apache-2.0
"""Reports on whether a system gets stuck, for users and programs."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from roaml.durations import short_moment
from roaml.jani.node import Origin
from roaml.smc.end import End
from roaml.verification.headline import UNDECIDED
from roaml.verification.stuck import Stuck, StuckLevel, StuckResult

if TYPE_CHECKING:
    from roaml.views.story import PlaceOf

PROBABILITY = "probability of getting stuck"
NOT_STUCK = "does not get stuck"
"""The name of the test in a JUnit report."""


def as_text(result: StuckResult, place_of: PlaceOf, shown: str = "", *, is_whole: bool = True) -> str:
    """The result as text for users.

    Args:
        shown: where in the output who waits for whom is shown, such as `in the trace below`; "" to show them here.
        is_whole: whether the probability is also shown if no trace got stuck.
    """
    answer, stuck = result.answer, result.stuck
    lines = []
    if answer is not None and answer.tally.traces and (is_whole or answer.tally.ended(End.STUCK) or answer.is_unknown):
        lower, upper = answer.bounds
        cut = answer.tally.ended(End.CUT)
        traces = f"{answer.tally.traces:,} traces"
        steps = f"{answer.options.max_steps:,} steps (max-steps)"
        if cut == answer.tally.traces:
            lines.append(f"{PROBABILITY}: {UNDECIDED}: all {traces} were cut after {steps}")
        else:
            to = f"; {cut:,} of them were cut after {steps}" if cut else " to their end"
            value = UNDECIDED if answer.is_unknown else f"{answer.value:.6g}"
            lines.append(f"{PROBABILITY}: {value} in [{lower:.6g}, {upper:.6g}] from {traces}{to}")
    if result.fault:
        why = "a trace that went on after the properties were decided went wrong"
        lines.append(f"{PROBABILITY}: {UNDECIDED}, because {why}: {result.fault}")
    if stuck is not None:
        still = "" if stuck.time is None else " and time does not advance"
        if shown:
            lines.append(f"{result.level}: the system gets stuck{still}; who waits for whom is shown {shown}")
        else:
            lines.append(f"{result.level}: the system gets stuck{still}: {_where(stuck)}")
            lines += (f"  {line}" for line in waiting_lines(stuck, place_of))
    return "".join(f"{line}\n" for line in lines)


def stuck_lines(stuck: Stuck, place_of: PlaceOf, level: StuckLevel = StuckLevel.WARNING, shown: str = "") -> list[str]:
    """A warning or error for users that traces get stuck, below the value that this makes doubtful; `shown` as in
    `as_text`."""
    if shown:
        return [f"{level}: {stuck.warning}; who waits for whom is shown {shown}"]
    lines = [f"{level}: {stuck.warning}; for example {_where(stuck)}:"]
    return [*lines, *(f"  {line}" for line in waiting_lines(stuck, place_of))]


def waiting_lines(stuck: Stuck, place_of: PlaceOf) -> list[str]:
    """The waiting automata, one line each, and a line on how to fix the system, if that is known."""
    lines = []
    for wait in stuck.waits:
        place = "" if wait.origin is None else f" ({place_of(wait.origin)})"
        lines.append(f"{wait.who} {wait.what}{place}")
    from roaml.views.waiting import help_line  # noqa: PLC0415 - most systems do not get stuck

    line = help_line(stuck.waits)
    return [*lines, line] if line else lines


def _where(stuck: Stuck) -> str:
    at = "" if stuck.time is None else f" at {short_moment(stuck.time)}"
    return f"trace {stuck.seen.trace} after {stuck.seen.steps:,} steps{at}"


def as_row(result: StuckResult, place: Callable[[Origin], dict[str, Any]]) -> dict[str, Any]:
    """The result as a value for JSON; `place` returns the members for an origin."""
    row: dict[str, Any] = {"level": result.level.value}
    if result.answer is not None:
        tally, (lower, upper) = result.answer.tally, result.answer.bounds
        row.update(traces=tally.traces, stuck=tally.ended(End.STUCK), cut=tally.ended(End.CUT))
        row.update(lower=lower, upper=upper)
    if result.fault:
        row["fault"] = result.fault
    row["example"] = None if result.stuck is None else example_row(result.stuck, place)
    return row


def example_row(stuck: Stuck, place: Callable[[Origin], dict[str, Any]]) -> dict[str, Any]:
    """A stuck trace as a value for JSON."""
    return {
        "trace": stuck.seen.trace,
        "steps": stuck.seen.steps,
        "time": stuck.time,
        "waits": [
            {"who": wait.who, "what": wait.what, **({} if wait.origin is None else place(wait.origin))}
            for wait in stuck.waits
        ],
        "advice": stuck.advice,
        "rule": stuck.rule,
    }

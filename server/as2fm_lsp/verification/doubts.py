# SPDX-License-Identifier: Apache-2.0
"""Reasons why a value says little about the system, although it is correct: the property is decided before the first
step, or no time passes any more, or the system can get stuck."""

from __future__ import annotations

from roaml.scxml.names import FIELD_PREFIX, flag_of
from roaml.smc.end import End
from roaml.smc.goal import Question
from roaml.smc.tally import Tally
from roaml.verification.results import Computed, Result, Traces

CAN_GET_STUCK = (
    "the system can get stuck before the property is decided, and then F is false and G is true; `verify` without "
    "--exhaustive shows where"
)


def doubts(result: Result) -> list[str]:
    """The reasons, as phrases for users."""
    reasons = []
    question = _question_decided_at_once(result)
    if question is not None:
        reasons.append(f"the initial state decides the property, before any step{_default_values(question)}")
    if result.answer is not None and result.traces is not None:
        reasons += _stopped_time(result.answer.tally, result.traces)
    return reasons


def _stopped_time(tally: Tally, traces: Traces) -> list[str]:
    """That time stops in some traces, with the machines that take steps for ever in the shortest one."""
    if End.ROUND not in tally.ends or traces.target.clock is None:
        return []
    from roaml.durations import moment  # noqa: PLC0415 - time seldom stops
    from roaml.verification.repetition import repetition  # noqa: PLC0415

    rounds, shortest = tally.ends[End.ROUND].count, tally.ends[End.ROUND].shortest
    repeated = repetition(traces, shortest.trace, shortest.steps)
    if repeated.is_after_end:
        return []
    who = " and ".join(repeated.names) if repeated.names else "machines"
    verb = "takes" if len(repeated.names) == 1 else "take"
    where = "" if repeated.time is None else f", in trace {shortest.trace} at {moment(repeated.time)}"
    return [
        f"time stops in {rounds:,} of {tally.traces:,} traces{where}: {who} {verb} steps for ever, so no timer "
        "ticks any more; let a timer or an event of another machine end them"
    ]


def can_get_stuck(result: Result) -> bool:
    """Whether an exploration of all states has shown that the system can get stuck. Traces show more: the automata that
    wait (`stuck_report`)."""
    match result.outcome:
        case Computed(question=question, exact=exact, sample=None):
            return exact.can_get_stuck and not question.is_stuck
        case _:
            return False


def _question_decided_at_once(result: Result) -> Question | None:
    """The question of a result if no trace has a step before it is decided."""
    if result.answer is not None:
        ends, question = result.answer.tally.ends, result.answer.question
        is_at_once = set(ends) == {End.DECIDED} and ends[End.DECIDED].shortest.steps == 0
        return question if is_at_once and question.initial_states == 1 else None
    match result.outcome:
        case Computed(question=question, exact=exact) if exact.initial_states == 1 == exact.states:
            return question if any(trace.steps == 0 for trace in exact.traces) else None
        case _:
            return None


def _default_values(question: Question) -> str:
    """What to do if the property reads fields of messages without checking whether there is one."""
    events = {name.partition(f"__{FIELD_PREFIX}")[0] for name in question.variables if f"__{FIELD_PREFIX}" in name}
    flag = next((flag_of(event) for event in sorted(events) if flag_of(event) not in question.variables), None)
    if flag is None:
        return ""
    return f"; fields have default values until the first message, so the property may have to require `{flag}` as well"

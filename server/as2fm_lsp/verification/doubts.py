# SPDX-License-Identifier: Apache-2.0
"""Reasons why a value says little about the system, although it is correct: the property is decided before the first
step, or no time passes any more, or the system can get stuck."""

from __future__ import annotations

from roaml.scxml.names import FIELD_PREFIX, flag_of
from roaml.smc.end import End
from roaml.smc.goal import Question
from roaml.verification.results import Computed, Result, StoppedTime

CAN_GET_STUCK = (
    "the system can get stuck before the property is decided; what has not happened by then counts as never happening; "
    "`verify` without --exhaustive shows where"
)


def doubts(result: Result) -> list[str]:
    """The reasons, as phrases for users."""
    reasons = []
    question = _question_decided_at_once(result)
    if question is not None:
        reasons.append(f"the initial state decides the property, before any step{_default_values(question)}")
    stopped = _stopped(result)
    if stopped is not None:
        reasons.append(_stopped_time(stopped))
    return reasons


def _stopped(result: Result) -> StoppedTime | None:
    """The traces of a result in which time stops; `None` if there are none."""
    if result.answer is not None and result.traces is not None and End.ROUND in result.answer.tally.ends:
        from roaml.verification.repetition import stopped_time  # noqa: PLC0415 - time seldom stops

        return stopped_time(result.answer.tally, result.traces)
    return result.outcome.stopped if isinstance(result.outcome, Computed) else None


def _stopped_time(stopped: StoppedTime) -> str:
    """A phrase for users, with the machines that take steps for ever in the shortest trace."""
    from roaml.durations import moment  # noqa: PLC0415 - time seldom stops

    who = " and ".join(stopped.names) if stopped.names else "machines"
    verb = "takes" if len(stopped.names) == 1 else "take"
    where = "" if stopped.time is None else f", in trace {stopped.trace} at {moment(stopped.time)}"
    traces = f"{stopped.count:,} of {stopped.traces:,} traces"
    if stopped.count < stopped.traces:
        # The percentage keeps this number apart from the value of the property in the line before.
        traces = f"{stopped.count:,} of {stopped.traces:,} random traces ({100 * stopped.count / stopped.traces:.3g} %)"
    return (
        f"time stops in {traces}{where}: {who} {verb} steps for ever that "
        "need no time, so no timer ticks after that, and what has not happened by then never happens; let one of these "
        "steps wait for a timer, or for an event of another machine"
    )


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

# SPDX-License-Identifier: Apache-2.0
"""The shortest trace that shows why a property fails, as a story whose lines have positions."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from roaml.jani.operators import BinaryOperator
from roaml.record import Record
from roaml.smc.goal import Threshold
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.record import VERDICTS, Recording, TraceVerdict
from roaml.smc.tally import StoredTrace
from roaml.text import Location
from roaml.verification.results import Result, Traces
from roaml.verification.target import VerificationTarget

if TYPE_CHECKING:
    from roaml.views.story import StoryLine


MAX_SEARCHED_TRACES = 1_000
"""The maximum number of random traces that `random_trace` generates."""


class Counterexample(Record, frozen=True):
    """The explanation of a trace.

    Attributes:
        heading: why the trace has its verdict, and a summary of the trace.
        summary: the verdict of the trace, its length, and how many of its turns matter, in one short sentence.
        verdict: the verdict of the trace on the property.
        trace: the number of the trace.
        lines: one line for each turn of an automaton.
    """

    heading: str
    summary: str
    verdict: TraceVerdict
    trace: int
    lines: tuple[StoryLine, ...]


def unwanted_verdict(result: Result) -> int:
    """The verdict of the traces that contradict an expectation."""
    if result.includes_stuck:
        return TRUE
    thresholds = [verdict.expectation.threshold for verdict in result.verdicts]
    return TRUE if thresholds and not any(_requires_more(result, threshold) for threshold in thresholds) else FALSE


def _requires_more(result: Result, threshold: Threshold) -> bool:
    """Whether traces that fail contradict a threshold: a lower one, or an equation with a number above the value."""
    if threshold.relation is not BinaryOperator.EQUAL or not 0 < threshold.number < 1:
        return threshold.is_lower or (threshold.relation is BinaryOperator.EQUAL and threshold.number > 0)
    if result.exact is not None:
        return result.exact.is_below(threshold)
    return result.answer is not None and result.answer.value < threshold.number


def unwanted_trace(result: Result) -> StoredTrace | None:
    """The shortest trace that contradicts an expectation; an undecided one if there is none; `None` if there is
    neither.

    If any trace got stuck, the shortest stuck trace is returned, because it explains why the result of the property is
    doubtful.
    """
    if result.answer is None:
        return None
    if result.stuck is not None:
        return result.stuck.seen
    shortest = result.answer.tally.shortest
    return shortest.get(unwanted_verdict(result)) or shortest.get(UNKNOWN)


def witness_trace(result: Result) -> StoredTrace | None:
    """The shortest trace that supports a property: one that is as expected or, if nothing is expected, one in which the
    property holds. `None` if there is none."""
    if result.answer is None:
        return None
    return result.answer.tally.shortest.get(FALSE if unwanted_verdict(result) == TRUE else TRUE)


def random_trace(traces: Traces, verdict: int) -> int | None:
    """The number of the first random trace with a verdict; `None` if there is none among `MAX_SEARCHED_TRACES`."""
    recorder = traces.recorder()
    for number in range(MAX_SEARCHED_TRACES):
        recording = Recording(number)
        recorder.rush(recording)
        if recording.verdict == verdict:
            return number
    return None


def counterexample(result: Result, place_of: Callable[[Location], str] | None = None) -> Counterexample | None:
    """Simulate the shortest trace that contradicts an expectation again; `None` if there is none.

    Args:
        place_of: formats a position; the default is `path:line`.
    """
    return _counterexample(result, unwanted_trace(result), place_of)


def witness(result: Result, place_of: Callable[[Location], str] | None = None) -> Counterexample | None:
    """Simulate the trace of `witness_trace` again; `None` if there is none. See `counterexample`."""
    return _counterexample(result, witness_trace(result), place_of)


def _counterexample(
    result: Result, seen: StoredTrace | None, place_of: Callable[[Location], str] | None
) -> Counterexample | None:
    traces = result.traces
    if seen is None or traces is None:
        return None
    story = traces.story(seen.trace)
    verdict = VERDICTS[story.recording.verdict]
    from roaml.verification.nearest import nearest  # noqa: PLC0415
    from roaml.views.cause import cause  # noqa: PLC0415 - most verifications do not need a story
    from roaml.views.story import heading, lines, summary  # noqa: PLC0415

    place = place_of or _path_and_line(traces.target)
    near = nearest(result, story, traces.target.clock)
    why = cause(story, place, None if near is None else (near.parting, near.story))
    words = f"{why}. {heading(story)}" if why else heading(story)
    return Counterexample(words, summary(story), verdict, seen.trace, tuple(lines(story, place)))


def _path_and_line(target: VerificationTarget) -> Callable[[Location], str]:
    def place_of(origin: Location) -> str:
        place = target.place(origin)
        return f"{place.path}:{place.line}" if place else ""

    return place_of

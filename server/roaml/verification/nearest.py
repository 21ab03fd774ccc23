# SPDX-License-Identifier: Apache-2.0
"""The trace with the opposite verdict that parts latest from a trace that is explained, and where they part."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.record import Record
from roaml.smc.program import FALSE, TRUE
from roaml.smc.story import Story
from roaml.verification.results import Result
from roaml.views.parting import Parting, first_difference, read_trace

MAX_COMPARED_TRACES = 100
"""The maximum number of traces that are compared."""
MAX_COMPARED_STEPS = 200_000
"""The maximum number of steps of these traces together."""


class Nearest(Record, frozen=True):
    """A trace with the opposite verdict, and its first difference.

    Attributes:
        story: the other trace.
        compared: the number of traces from which it was chosen.
    """

    story: Story
    parting: Parting
    compared: int


def nearest(result: Result, story: Story, clock: tuple[str, str] | None) -> Nearest | None:
    """Of the first random traces with the opposite verdict, and of the shortest one if all states were explored, the
    one that has the most turns in common with a trace of the property. `None` if there is no other trace, if the trace
    does nothing that the others do not do as well, if it has no verdict, or if it gets stuck.

    Args:
        clock: see `roaml.smc.story.build_story`.
    """
    opposite = {TRUE: FALSE, FALSE: TRUE}.get(story.recording.verdict)
    if opposite is None or story.standstill is not None:  # the waiting automata explain a standstill
        return None
    here = read_trace(story)
    best: tuple[Story, Parting] | None = None
    compared = 0
    for other in _others(result, opposite, clock):
        compared += 1
        difference = first_difference(here, read_trace(other))
        if difference is not None and (best is None or _rank(difference) > _rank(best[1])):
            best = other, difference
    return None if best is None else Nearest(*best, compared)


def _rank(difference: Parting) -> tuple[bool, int]:
    return difference.there is not None, difference.common


def _others(result: Result, verdict: int, clock: tuple[str, str] | None) -> Iterator[Story]:
    steps = 0
    if result.answer is not None and result.traces is not None:
        for seen in result.answer.tally.examples[verdict][:MAX_COMPARED_TRACES]:
            steps += seen.steps
            if steps > MAX_COMPARED_STEPS:
                break
            yield result.traces.story(seen.trace, has_options=False)
    shortest = None if result.exact is None else result.exact.shortest(verdict)
    if shortest is not None:
        yield shortest.story(clock)

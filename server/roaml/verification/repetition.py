# SPDX-License-Identifier: Apache-2.0
"""Traces in which time stops: what they repeat for ever, the machines that take these steps, and the time at which they
do."""

from __future__ import annotations

from itertools import islice, tee

from roaml.record import Record
from roaml.smc.end import End
from roaml.smc.record import TraceStep
from roaml.smc.rounds import FIRST_CHECK
from roaml.smc.story import clock_times
from roaml.smc.tally import Tally
from roaml.verification.results import StoppedTime, Traces

MAX_REPLAYED_STEPS = 200_000
"""Longer traces are not simulated again."""


class EndlessSteps(Record, frozen=True):
    """The end of a trace that repeats states.

    Attributes:
        names: the machines and trees that take its last steps, in backquotes; empty if they are not known.
        time: the time at which they do, in s; `None` if it is not known.
        is_after_end: whether the time of the model is over, so that the steps hold no clock.
    """

    names: tuple[str, ...] = ()
    time: float | None = None
    is_after_end: bool = False


def stopped_time(tally: Tally, traces: Traces) -> StoppedTime | None:
    """The traces of a tally in which time stops; `None` if there are none."""
    if End.ROUND not in tally.ends or traces.target.clock is None:
        return None
    rounds, shortest = tally.ends[End.ROUND].count, tally.ends[End.ROUND].shortest
    repeated = repetition(traces, shortest.trace, shortest.steps)
    if repeated.is_after_end:
        return None
    return StoppedTime(rounds, tally.traces, shortest.trace, repeated.names, repeated.time)


def repetition(traces: Traces, trace: int, steps: int) -> EndlessSteps:
    """What a trace repeats.

    Args:
        trace, steps: its number, and the number of steps after which the repetition was found.
    """
    metadata = traces.target.model.metadata
    if metadata is None or metadata.clock is None or steps > MAX_REPLAYED_STEPS:
        return EndlessSteps()
    clock = metadata.clock.automaton
    automata = [element.automaton for element in traces.checker.model.system.elements]
    last: list[TraceStep] = []
    time, place = 0.0, ""
    walked, timed = tee(islice(traces.steps(trace), steps))
    for step, now in zip(walked, clock_times(timed, traces.target.clock), strict=True):
        for part in step.parts:
            if automata[part.instance] == clock:
                place = part.destination.location
        if now is not None and now != time:
            time = now
            last.clear()
        last.append(step)
    element = traces.checker.legend.layout.instances[automata.index(clock)].automaton
    is_over = place != "" and all(edge.source != place for edge in element.edges)
    # A trace with fewer steps has ended before it repeated any. Of longer ones, the first steps of an instant may still
    # lead to the repeated ones.
    repeated = last[len(last) // 2 :] if steps >= FIRST_CHECK else []
    actors = traces.checker.actors
    names = dict.fromkeys(actors[part.instance] for step in repeated for part in step.parts)
    return EndlessSteps(tuple(name for name in names if name.startswith("`")), time, is_over)

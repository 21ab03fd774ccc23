# SPDX-License-Identifier: Apache-2.0
"""A trace as a story: what led to its end, and nothing else.

Folded to what the property depends on: the steps that change what it reads, and what these steps have needed, back to
the start: the last change of each variable that they read, and what woke the automaton that takes them.
"""

from __future__ import annotations

from dataclasses import dataclass

from roaml.smc.record import Part, Recorder, Recording, TraceStep, Variable


@dataclass(frozen=True, slots=True)
class Story:
    """The steps of a trace that matter.

    Attributes:
        length: the number of all steps.
        folded: so many steps that matter are left out after the first ones.
        clock: for each step of the story the time in seconds, None where the model has no clock.
    """

    property: str
    recording: Recording
    steps: tuple[TraceStep, ...]
    clock: tuple[float | None, ...]
    length: int
    variables: tuple[str, ...]
    folded: int = 0


FIRST, LAST = 20, 40
"""Steps of a story that are told; what stands between them is folded."""


def tell(recorder: Recorder, trace: int, clock: tuple[str, str] | None = None) -> Story:
    """The story of a trace.

    Args:
        clock: the variables that hold the seconds and nanoseconds of the model's time.
    """
    recording = Recording(trace)
    steps: list[TraceStep] = []
    times: list[float | None] = []
    seconds = nanoseconds = 0.0
    for step in recorder.walk(recording):
        for change in step.changes:
            if clock is not None and change.variable.instance < 0 and isinstance(change.after, (int, float)):
                if change.variable.name == clock[0]:
                    seconds = change.after
                elif change.variable.name == clock[1]:
                    nanoseconds = change.after
        steps.append(step)
        times.append(None if clock is None else seconds + nanoseconds / 1e9)
    variables = recorder.asked.question.variables
    relevant = _relevant(recorder, steps, variables)
    kept = relevant if len(relevant) <= FIRST + LAST else relevant[:FIRST] + relevant[-LAST:]
    return Story(
        recorder.asked.question.name,
        recording,
        tuple(steps[i] for i in kept),
        tuple(times[i] for i in kept),
        len(steps),
        variables,
        len(relevant) - len(kept),
    )


def _relevant(recorder: Recorder, steps: list[TraceStep], variables: tuple[str, ...]) -> list[int]:
    last_change: dict[Variable, list[int]] = {}
    last_step: dict[int, list[int]] = {}
    for i, step in enumerate(steps):
        for change in step.changes:
            last_change.setdefault(change.variable, []).append(i)
        for part in step.parts:
            last_step.setdefault(part.instance, []).append(i)
    kept: set[int] = set()
    waiting = [i for name in variables for i in last_change.get(Variable(-1, name), ())]
    if steps:
        waiting.append(len(steps) - 1)
    while waiting:
        i = waiting.pop()
        if i in kept:
            continue
        kept.add(i)
        for part in steps[i].parts:
            waiting += (k for v in recorder.reads(part) if (k := _before(last_change.get(v, ()), i)) is not None)
            cause = _cause(steps, last_step[part.instance], part, i)
            if cause is not None:
                waiting.append(cause)
    return sorted(kept)


def _cause(steps: list[TraceStep], own: list[int], part: Part, i: int) -> int | None:
    """The latest earlier step in which the automaton did something together with another one."""
    before = [k for k in own if k < i]
    for k in reversed(before):
        if len(steps[k].parts) > 1:
            return k
    return None


def _before(places: list[int] | tuple[int, ...], i: int) -> int | None:
    found = None
    for k in places:
        if k >= i:
            break
        found = k
    return found

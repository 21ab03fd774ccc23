# SPDX-License-Identifier: Apache-2.0
"""Explains a trace by the steps that led to its end.

The relevant steps are the last one, or the one that finished the tree if the trace ended because of it, those that
change a variable of the property, and those on which these steps depend, back to the start: the last change of each
variable that a step reads, and the step that triggered the automaton that takes it. In a model without a clock, which
is no translated system, they also depend on the step with which the automaton entered its location; and if such a trace
ends before the property is decided, the last step of each automaton that could change a variable of the property is
relevant.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from roaml.jani.model import Automaton
from roaml.jani.semantics import Value
from roaml.record import Record, field
from roaml.smc.end import End
from roaml.smc.record import VERDICTS, Plain, RecordedVariable, Recorder, Recording, TraceStep, TraceVerdict
from roaml.smc.standstill import Standstill

MAX_STEPS_WITH_OPTIONS = 5_000
"""The maximum number of steps of a trace in which the choices of the scheduler are known for all steps. In longer ones,
they are known for the relevant steps."""


class Story(Record, frozen=True):
    """A whole trace, and its relevant steps.

    Attributes:
        property: the name of the property.
        clock: for each step the time in s; `None` if the model has no clock.
        relevant: the indices of the relevant steps, in their order.
        ends: the indices of the steps that ended the trace: the last one, or those that finished the trees.
        variables: the variables that the property reads.
        automata: the automaton of each instance.
        start: the variables of the model before the first step.
        standstill: the final state, if the trace is stuck.
        is_whole: whether all steps are shown, not only the relevant ones.
        constants: the values of the constants of the model.
        comment: a description of what the property requires, if the model contains one.
        is_reward: whether the property asks for a reward, so that a trace reaches its condition or does not.
        options: among how many steps the scheduler chose (`roaml.smc.record.Recorder.options`); empty if that is not
            known.
    """

    property: str
    recording: Recording
    steps: tuple[TraceStep, ...]
    clock: tuple[float | None, ...]
    relevant: tuple[int, ...]
    ends: tuple[int, ...]
    variables: tuple[str, ...]
    automata: tuple[Automaton, ...]
    start: Mapping[str, Plain]
    standstill: Standstill | None = None
    is_whole: bool = False
    comment: str = ""
    constants: Mapping[str, Value] = field(default_factory=dict)
    options: Mapping[int, Mapping[int, int]] = field(default_factory=dict)
    is_reward: bool = False


def outcome(story: Story) -> str:
    """The verdict of a trace, as a verb phrase in the past."""
    verdict = VERDICTS[story.recording.verdict]
    if verdict is TraceVerdict.FAULT:
        return "went wrong"
    if story.is_reward and verdict is not TraceVerdict.UNDECIDED:
        return f"{'reached' if verdict is TraceVerdict.PASSED else 'did not reach'} its condition"
    return str(verdict)


def build_story(
    recorder: Recorder, trace: int, clock: tuple[str, str] | None = None, *, has_options: bool = True
) -> Story:
    """The trace with the number `trace`, and its relevant steps.

    Args:
        clock: the variables for the seconds and nanoseconds of the model's time.
        has_options: whether the story contains the choices of the scheduler, for which the trace is simulated again.
    """
    recording = Recording(trace)
    shared = recorder.shared
    start = dict(zip((storage.name for storage in shared), recorder.initial(shared, trace), strict=True))
    steps = list(recorder.walk(recording))
    variables = recorder.compiled_property.question.variables
    finished = recorder.causes_of(End.FINISHED) if recording.end is End.FINISHED else []
    ends = last_steps(steps, finished) or [len(steps) - 1] * bool(steps)
    automata = tuple(instance.automaton for instance in recorder.legend.layout.instances)
    if clock is None and recording.end is not End.DECIDED:
        writers = [number for number, automaton in enumerate(automata) if _writes(automaton, variables)]
        ends = last_steps(steps, writers) or ends
    relevant = _relevant(recorder, steps, variables, ends, follows_locations=clock is None)
    standstill = recorder.standstill() if recording.end is End.STUCK else None
    considered = range(len(steps)) if len(steps) <= MAX_STEPS_WITH_OPTIONS else relevant
    options = recorder.options(trace, considered) if has_options else {}
    return Story(
        recorder.compiled_property.question.name,
        recording,
        tuple(steps),
        tuple(clock_times(steps, clock)),
        tuple(relevant),
        tuple(ends),
        variables,
        automata,
        start,
        standstill,
        comment=recorder.compiled_property.property.comment or "",
        constants=recorder.constants,
        options=options,
        is_reward=recorder.compiled_property.question.is_reward,
    )


def clock_times(steps: Iterable[TraceStep], clock: tuple[str, str] | None) -> Iterator[float | None]:
    """The time after each step, in s; `None` if the model has no clock.

    Args:
        clock: the variables that contain the seconds and nanoseconds.
    """
    seconds = nanoseconds = 0.0
    for step in steps:
        for change in step.changes:
            if clock is not None and change.variable.instance < 0 and isinstance(change.after, (int, float)):
                if change.variable.name == clock[0]:
                    seconds = change.after
                elif change.variable.name == clock[1]:
                    nanoseconds = change.after
        yield None if clock is None else seconds + nanoseconds / 1e9


def last_steps(steps: Sequence[TraceStep], instances: Collection[int]) -> list[int]:
    """The indices of the last steps of some instances; an instance without a step has none."""
    last = {part.instance: i for i, step in enumerate(steps) for part in step.parts}
    return sorted({last[instance] for instance in instances if instance in last})


def _writes(automaton: Automaton, variables: Collection[str]) -> bool:
    """Whether an automaton has an assignment to one of these variables of the model."""
    own = {variable.name for variable in automaton.variables}
    return any(
        assignment.variable in variables and assignment.variable not in own
        for edge in automaton.edges
        for destination in edge.destinations
        for assignment in destination.assignments
    )


def _relevant(
    recorder: Recorder,
    steps: list[TraceStep],
    variables: tuple[str, ...],
    ends: list[int],
    *,
    follows_locations: bool,
) -> list[int]:
    changes: dict[RecordedVariable, list[int]] = {}
    joint_steps: dict[int, list[int]] = {}
    moves: dict[int, list[int]] = {}
    for i, step in enumerate(steps):
        for change in step.changes:
            changes.setdefault(change.variable, []).append(i)
        for part in step.parts if follows_locations else ():
            if part.source != part.destination.location:
                moves.setdefault(part.instance, []).append(i)
        if len(step.parts) > 1:
            for part in step.parts:
                joint_steps.setdefault(part.instance, []).append(i)
    kept: set[int] = set()
    waiting = [i for name in variables for i in changes.get(RecordedVariable(-1, name), ())]
    waiting += ends
    while waiting:
        i = waiting.pop()
        if i in kept:
            continue
        kept.add(i)
        for part in steps[i].parts:
            causes = [_before(changes.get(variable, ()), i) for variable in recorder.reads(part)]
            # The automaton was triggered by the latest step that it took together with another one.
            causes.append(_before(joint_steps.get(part.instance, ()), i))
            causes.append(_before(moves.get(part.instance, ()), i))
            waiting += (cause for cause in causes if cause is not None)
    return sorted(kept)


def _before(numbers: Sequence[int], i: int) -> int | None:
    """The greatest of some sorted numbers that is less than `i`."""
    position = bisect_left(numbers, i)
    return numbers[position - 1] if position > 0 else None

# SPDX-License-Identifier: Apache-2.0
"""Whether a system gets stuck: asked with every verification, by traces that run on whatever their properties say.

A trace is stuck where its automata wait for one another, so that the time of the model stands still for ever. What such
a trace says about a property is chance. So it is told beside every number, with an example: who waits for whom.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from roaml.smc.end import End
from roaml.smc.fault import FaultError
from roaml.smc.goal import Asked
from roaml.smc.model import Checker
from roaml.smc.pool import Alone, Pulse
from roaml.smc.record import Recorder, Recording
from roaml.smc.run import FIXED, Answer, Options, Seen, Tally
from roaml.verification.target import Target
from roaml.views.waiting import Wait, advice, rule, waits

WARNING, ERROR = "warning", "error"
LEVELS = (WARNING, ERROR)
"""How a trace that gets stuck is reported."""
MAX_TRACES = 100
"""The number of traces that are made to see whether a system gets stuck."""
MAX_STEPS_PER_TRACE = 100_000
MAX_STEPS = 1_000_000
"""After this number of steps no more traces are made; they take a tenth of a second."""
BATCH_SIZE = 10
"""The number of traces after which the steps are counted."""


@dataclass(frozen=True, slots=True)
class Stuck:
    """Traces of one question that got stuck.

    Attributes:
        count: how many.
        traces: of so many.
        seen: the shortest one.
        time: of the model at its end, in s; None without a clock.
        waits: who waits for whom there.
    """

    count: int
    traces: int
    seen: Seen
    time: float | None
    waits: tuple[Wait, ...]

    @property
    def advice(self) -> str:
        """What to do about it; "" where that is not known."""
        return advice(self.waits)

    @property
    def rule(self) -> str:
        """The rule that finds the reason in the model; "" if there is none."""
        return rule(self.waits)

    @property
    def warning(self) -> str:
        """What it means for the value of the property whose traces these are."""
        of = f"all {self.traces:,} traces" if self.count == self.traces else f"{self.count:,} of {self.traces:,} traces"
        return f"{of} got stuck and say nothing about the property, so its value is doubtful"

    @property
    def chain(self) -> Chain:
        """Who waits for whom, whenever it is."""
        return chain_of(self.waits)


Chain: TypeAlias = tuple[tuple[str, str, str], ...]


def chain_of(waiting: Sequence[Wait]) -> Chain:
    """Who waits for whom, whenever it is: automata, where they are, and for whom they wait."""
    return tuple((wait.automaton, wait.location, wait.whom) for wait in waiting)


@dataclass(frozen=True, slots=True)
class Look:
    """What is known of getting stuck.

    Attributes:
        answer: that of the traces which were made for it; None if none were.
        stuck: the shortest example, from these traces or from those of a property.
        level: whether it is a warning or an error.
        fault: what went wrong in one of these traces; then there is no answer.
    """

    answer: Answer | None
    stuck: Stuck | None
    level: str = WARNING
    fault: str = ""

    @property
    def is_met(self) -> bool:
        return self.stuck is None or self.level != ERROR


def look(target: Target, checker: Checker, options: Options, level: str, pulse: Pulse | None = None) -> Look:
    """Make traces to see whether they get stuck."""
    try:
        answer = _answer(checker, options, pulse)
    except FaultError as fault:
        return Look(None, None, level, f"{fault.message} (in trace {fault.trace} of seed {options.seed})")
    return Look(answer, stuck_in(target, checker, checker.stuck, answer), level)


def _answer(checker: Checker, options: Options, pulse: Pulse | None) -> Answer:
    asked, tally = checker.stuck, Tally()
    alone = Alone(checker.compiled(asked))
    for traces in range(BATCH_SIZE, MAX_TRACES + BATCH_SIZE, BATCH_SIZE):
        limits = replace(
            options, method=FIXED, max_traces=traces, max_steps=min(options.max_steps, MAX_STEPS_PER_TRACE)
        )
        tally.is_finished = False
        answer = checker.answer(asked, limits, alone, tally, pulse=pulse)
        if tally.steps >= MAX_STEPS:
            break
    return answer


def can_be_stuck(checker: Checker) -> bool:
    """Whether it is known what it means: that the model is a translated system."""
    return any(checker.program.location_mark)


def stuck_in(target: Target, checker: Checker, asked: Asked, answer: Answer, scheduler: int = 0) -> Stuck | None:
    """The traces of an answer that got stuck; None if none did."""
    ended = answer.tally.ends.get(End.STUCK)
    if ended is None:
        return None
    recorder = Recorder(checker, asked, answer.options.seed, answer.options.max_steps, scheduler)
    recorder.rush(Recording(ended.shortest.trace))
    time = time_of(target, recorder)
    return Stuck(ended.count, answer.tally.traces, ended.shortest, time, waits(recorder.standstill(), time))


def time_of(target: Target, recorder: Recorder) -> float | None:
    """The time of the model in the state that is reached, in s; None without a clock."""
    if target.clock is None:
        return None
    by_name = {storage.name: storage for storage in recorder.shared}
    seconds, nanoseconds = recorder.values([by_name[name] for name in target.clock])
    assert not isinstance(seconds, list)
    assert not isinstance(nanoseconds, list)
    return seconds + nanoseconds / 1e9


def shortest(examples: Iterable[Stuck | None]) -> Stuck | None:
    """The one with the shortest trace; it is shown as the example."""
    return min((stuck for stuck in examples if stuck is not None), key=lambda stuck: stuck.seen.steps, default=None)

# SPDX-License-Identifier: Apache-2.0
"""Whether a system gets stuck. Every verification checks this with traces that do not stop when a property is decided.

A trace is stuck if its automata wait for one another, so that the time of the model never advances again. The verdict
of a stuck trace on a property has no meaning. So stuck traces are reported with every result, with an example: the
chain of waiting automata.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, TypeAlias

from roaml.exhaustive import Vocabulary
from roaml.record import Record, replace
from roaml.smc.end import End
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Alone, Pulse
from roaml.smc.run import Answer, EstimationMethod, Options
from roaml.smc.tally import StoredTrace, Tally
from roaml.verification.target import VerificationTarget

if TYPE_CHECKING:
    from roaml.smc.record import Recorder
    from roaml.views.waiting import Wait

MAX_TRACES = 100
"""The number of traces that are generated to check whether a system gets stuck."""
MAX_STEPS_PER_TRACE = 100_000
MAX_STEPS = 1_000_000
"""The number of steps after which no further traces are generated; this many steps take a tenth of a second."""
BATCH_SIZE = 10
"""The number of traces in a batch. The number of steps is checked after each batch."""


class StuckLevel(Vocabulary):
    """The severity with which a stuck trace is reported."""

    WARNING = "warning"
    ERROR = "error"


class Stuck(Record, frozen=True):
    """The traces of one answer that got stuck.

    Attributes:
        count: the number of stuck traces.
        traces: the number of all traces.
        seen: the shortest stuck trace.
        time: the time of the model at the end of `seen`, in s; `None` if the model has no clock.
        waits: the waiting automata at the end of `seen`.
    """

    count: int
    traces: int
    seen: StoredTrace
    time: float | None
    waits: tuple[Wait, ...]

    @property
    def advice(self) -> str:
        """How the system can be fixed; "" if unknown."""
        from roaml.views.waiting import advice  # noqa: PLC0415 - most systems do not get stuck

        return advice(self.waits)

    @property
    def rule(self) -> str:
        """The rule that reports the cause in the model; "" if there is none."""
        from roaml.views.waiting import rule  # noqa: PLC0415 - most systems do not get stuck

        return rule(self.waits)

    @property
    def warning(self) -> str:
        """A sentence on the consequence of these traces for the value of the property."""
        of = f"all {self.traces:,} traces" if self.count == self.traces else f"{self.count:,} of {self.traces:,} traces"
        return (
            f"{of} got stuck, because machines wait for each other for ever; they say nothing about the property, so "
            "its value is doubtful"
        )

    @property
    def chain(self) -> Chain:
        """The chain of waiting automata; see `chain_of`."""
        return chain_of(self.waits)


Chain: TypeAlias = tuple[tuple[str, str, str], ...]


def chain_of(waiting: Sequence[Wait]) -> Chain:
    """The chain of waiting automata: for each its name, its location, and the automaton that it waits for, "" if none.
    Traces that get stuck in the same way at different times have equal chains."""
    return tuple((wait.automaton, wait.location, wait.whom) for wait in waiting)


class StuckResult(Record, frozen=True):
    """The result of the check for stuck traces.

    Attributes:
        answer: the answer of the traces that were generated for the check; `None` if there were none, or `fault` is
            set.
        stuck: the stuck traces with the shortest example, from the check or from a property; `None` if none got stuck.
        level: whether stuck traces are a warning or an error.
        fault: the message about an undefined operation in a trace of the check; "" if there was none.
    """

    answer: Answer | None
    stuck: Stuck | None
    level: StuckLevel = StuckLevel.WARNING
    fault: str = ""

    @property
    def is_met(self) -> bool:
        return self.stuck is None or self.level is not StuckLevel.ERROR


def check_stuck(
    target: VerificationTarget, checker: ModelChecker, options: Options, level: StuckLevel, pulse: Pulse | None = None
) -> StuckResult:
    """Generate traces to check whether they get stuck."""
    try:
        answer = _answer(checker, options, pulse)
    except FaultError as fault:
        return StuckResult(None, None, level, f"{fault.message} (in trace {fault.trace} of seed {options.seed})")
    return StuckResult(answer, stuck_in(target, checker, checker.stuck, answer), level)


def _answer(checker: ModelChecker, options: Options, pulse: Pulse | None) -> Answer:
    property_, tally = checker.stuck, Tally()
    alone = Alone(checker.compiled(property_))
    for traces in range(BATCH_SIZE, MAX_TRACES + BATCH_SIZE, BATCH_SIZE):
        limits = replace(
            options,
            method=EstimationMethod.FIXED,
            max_traces=traces,
            max_steps=min(options.max_steps, MAX_STEPS_PER_TRACE),
        )
        tally.is_finished = False
        answer = checker.answer(property_, limits, alone, tally, pulse=pulse)
        if tally.steps >= MAX_STEPS:
            break
    return answer


def can_be_stuck(checker: ModelChecker) -> bool:
    """Whether it is known which traces are stuck; true for translated systems."""
    return any(checker.program.location_mark)


def stuck_in(
    target: VerificationTarget,
    checker: ModelChecker,
    property_: CompiledProperty,
    answer: Answer,
    scheduler: int = 0,
) -> Stuck | None:
    """The traces of an answer that got stuck; `None` if none did."""
    ended = answer.tally.ends.get(End.STUCK)
    if ended is None:
        return None
    from roaml.smc.record import Recorder, Recording  # noqa: PLC0415 - few models get stuck
    from roaml.views.waiting import waits  # noqa: PLC0415 - most systems do not get stuck

    recorder = Recorder(checker, property_, answer.options.seed, answer.options.max_steps, scheduler)
    recorder.rush(Recording(ended.shortest.trace))
    time = time_of(target, recorder)
    return Stuck(ended.count, answer.tally.traces, ended.shortest, time, waits(recorder.standstill(), time))


def time_of(target: VerificationTarget, recorder: Recorder) -> float | None:
    """The time of the model in the current state, in s; `None` if the model has no clock."""
    if target.clock is None:
        return None
    by_name = {storage.name: storage for storage in recorder.shared}
    seconds, nanoseconds = recorder.values([by_name[name] for name in target.clock])
    assert not isinstance(seconds, list)
    assert not isinstance(nanoseconds, list)
    return seconds + nanoseconds / 1e9


def shortest(examples: Iterable[Stuck | None]) -> Stuck | None:
    """The stuck traces with the shortest example; `None` if there are none."""
    return min((stuck for stuck in examples if stuck is not None), key=lambda stuck: stuck.seen.steps, default=None)

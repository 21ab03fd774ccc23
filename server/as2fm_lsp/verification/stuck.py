# SPDX-License-Identifier: Apache-2.0
"""Whether a system gets stuck: asked with every verification, by traces that run on whatever their properties say.

A trace is stuck where its automata wait for one another, so that the time of the model stands still for ever. What such
a trace says about a property is chance. So it is told beside every number, with an example: who waits for whom.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from as2fm_lsp.verification.subject import Subject
from roaml.jani.node import Origin
from roaml.smc.end import End
from roaml.smc.fault import FaultError
from roaml.smc.goal import Asked
from roaml.smc.model import Checker
from roaml.smc.pool import Alone, Pulse
from roaml.smc.record import Recorder, Recording
from roaml.smc.run import FIXED, Answer, Options, Seen, Tally
from roaml.views.waiting import Wait, advice, help_line, rule, waits

WARNING, ERROR = "warning", "error"
LEVELS = (WARNING, ERROR)
"""What it is that a trace gets stuck."""
PROBABILITY = "probability of getting stuck"
NOT_STUCK = "does not get stuck"
"""The name of the test in a JUnit report."""
TRACES = 100
"""So many traces are made to see it."""
STEPS = 100_000
"""None of them is longer."""
EFFORT = 1_000_000
"""No more are made after so many steps: a tenth of a second."""
FEW = 10
"""So many are made at once."""


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


def look(subject: Subject, checker: Checker, options: Options, level: str, pulse: Pulse | None = None) -> Look:
    """Make traces to see whether they get stuck."""
    try:
        answer = _answer(checker, options, pulse)
    except FaultError as fault:
        return Look(None, None, level, f"{fault.message} (in trace {fault.trace} of seed {options.seed})")
    return Look(answer, stuck_in(subject, checker, checker.stuck, answer), level)


def _answer(checker: Checker, options: Options, pulse: Pulse | None) -> Answer:
    asked, tally = checker.stuck, Tally()
    alone = Alone(checker.compiled(asked))
    for traces in range(FEW, TRACES + FEW, FEW):
        limits = replace(options, method=FIXED, max_traces=traces, max_steps=min(options.max_steps, STEPS))
        tally.is_finished = False
        answer = checker.answer(asked, limits, alone, tally, pulse=pulse)
        if tally.steps >= EFFORT:
            break
    return answer


def can_be_stuck(checker: Checker) -> bool:
    """Whether it is known what it means: that the model is a translated system."""
    return any(checker.program.location_mark)


def stuck_in(subject: Subject, checker: Checker, asked: Asked, answer: Answer, scheduler: int = 0) -> Stuck | None:
    """The traces of an answer that got stuck; None if none did."""
    ended = answer.tally.ends.get(End.STUCK)
    if ended is None:
        return None
    recorder = Recorder(checker, asked, answer.options.seed, answer.options.max_steps, scheduler)
    recorder.rush(Recording(ended.shortest.trace))
    time = time_of(subject, recorder)
    return Stuck(ended.count, answer.tally.traces, ended.shortest, time, waits(recorder.standstill(), time))


def time_of(subject: Subject, recorder: Recorder) -> float | None:
    """The time of the model in the state that is reached, in s; None without a clock."""
    if subject.clock is None:
        return None
    by_name = {storage.name: storage for storage in recorder.shared}
    seconds, nanoseconds = recorder.values([by_name[name] for name in subject.clock])
    assert not isinstance(seconds, list)
    assert not isinstance(nanoseconds, list)
    return seconds + nanoseconds / 1e9


def shortest(found: Sequence[Stuck | None]) -> Stuck | None:
    """The one that is told as the example."""
    return min((each for each in found if each is not None), key=lambda each: each.seen.steps, default=None)


PlaceOf = Callable[[Origin], str]
"""File and line of an origin, as people read it."""


def as_text(look: Look, place_of: PlaceOf, shown: str = "") -> str:
    """For people.

    Args:
        shown: where it has been shown who waits for whom; it is shown here if that is "".
    """
    answer, stuck = look.answer, look.stuck
    lines = []
    if answer is not None and answer.tally.traces:
        lower, upper = answer.bounds
        cut = answer.tally.ended(End.CUT)
        to = f"; {cut:,} of them were cut after {answer.options.max_steps:,} steps" if cut else " to their end"
        value = f"{answer.value:.6g} in [{lower:.6g}, {upper:.6g}]"
        lines.append(f"{PROBABILITY}: {value} from {answer.tally.traces:,} traces{to}")
    if look.fault:
        lines.append(f"{PROBABILITY}: not known, since a trace that ran on went wrong: {look.fault}")
    if stuck is not None:
        still = "" if stuck.time is None else ", time stands still"
        if shown:
            lines.append(f"{look.level}: the system gets stuck{still}; who waits for whom is shown {shown}")
        else:
            lines.append(f"{look.level}: the system gets stuck{still}: {_where(stuck)}")
            lines += (f"  {line}" for line in waiting_lines(stuck, place_of))
    return "".join(f"{line}\n" for line in lines)


def told(stuck: Stuck, place_of: PlaceOf, level: str = WARNING, shown: str = "") -> list[str]:
    """For people, beneath the value that it makes doubtful; `shown` as in `as_text`."""
    if shown:
        return [f"{level}: {stuck.warning}; who waits for whom is shown {shown}"]
    lines = [f"{level}: {stuck.warning}; for example {_where(stuck)}:"]
    return [*lines, *(f"  {line}" for line in waiting_lines(stuck, place_of))]


def waiting_lines(stuck: Stuck, place_of: PlaceOf) -> list[str]:
    """Who waits for whom, and what to do about it."""
    lines = []
    for wait in stuck.waits:
        place = "" if wait.origin is None else f" ({place_of(wait.origin)})"
        lines.append(f"{wait.who} {wait.what}{place}")
    line = help_line(stuck.waits)
    return [*lines, line] if line else lines


def _where(stuck: Stuck) -> str:
    at = "" if stuck.time is None else f" at {stuck.time:g} s"
    return f"trace {stuck.seen.trace} after {stuck.seen.steps:,} steps{at}"


def as_row(look: Look, place: Callable[[Origin], dict[str, Any]]) -> dict[str, Any]:
    """For JSON; `place` gives an origin's members."""
    found: dict[str, Any] = {"level": look.level}
    if look.answer is not None:
        tally, (lower, upper) = look.answer.tally, look.answer.bounds
        found.update(traces=tally.traces, stuck=tally.ended(End.STUCK), cut=tally.ended(End.CUT))
        found.update(lower=lower, upper=upper)
    if look.fault:
        found["fault"] = look.fault
    found["example"] = None if look.stuck is None else example_row(look.stuck, place)
    return found


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

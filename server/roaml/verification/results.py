# SPDX-License-Identifier: Apache-2.0
"""The result of one property."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from roaml.smc.choices import Choices
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.record import Recorder, Recording, TraceStep
from roaml.smc.run import Answer, Options
from roaml.smc.story import Story, tell
from roaml.verification.expectations import Verdict
from roaml.verification.refusal import Refusal
from roaml.verification.stuck import Stuck
from roaml.verification.target import VerificationTarget


@dataclass(frozen=True, slots=True)
class Exact:
    """The exact minimum and maximum over all schedulers, and the number of states."""

    least: float
    greatest: float
    states: int


@dataclass(frozen=True, slots=True)
class SampledResult:
    """What one scheduler achieves, which was sampled for the least or the greatest probability.

    Attributes:
        side: `LEAST` or `GREATEST` of `roaml.smc.lss`.
        scheduler: its number; `words` describes it.
        stuck: its traces that got stuck, if any did.
    """

    side: str
    answer: Answer
    scheduler: int
    words: str
    stuck: Stuck | None = None


@dataclass(frozen=True, slots=True)
class Traces:
    """The traces under uniform choices for a property. Each can be simulated again."""

    target: VerificationTarget
    checker: ModelChecker
    asked: CompiledProperty
    options: Options

    def recorder(self) -> Recorder:
        """Simulates single traces; one recorder is used by one thread at a time."""
        return Recorder(self.checker, self.asked, self.options.seed, self.options.max_steps)

    def steps(self, trace: int) -> Iterator[TraceStep]:
        """The steps of a trace.

        Args:
            trace: its number, from 0; any trace can be walked, not only those that were made.
        """
        return self.recorder().walk(Recording(trace))

    def story(self, trace: int) -> Story:
        """A whole trace, with the steps that are relevant for the property."""
        return tell(self.recorder(), trace, self.target.clock)


@dataclass(frozen=True, slots=True)
class Result:
    """What came of one property.

    Attributes:
        answer: by traces with uniform choices; None if only other schedulers or exact values were asked for.
        verdicts: one for each expectation.
        seconds: how long it took.
        is_interrupted: whether the work was ended before the answer was complete.
        sampled: by traces with sampled schedulers.
        tried: how many schedulers these were chosen from.
        stuck: its traces that got stuck, if any did.
        choices: what is known of other schedulers than the uniform one; None if only uniform choices are asked about.
        refusal: why there is no answer; `fault` is its cause.
        traces: those of `answer`, to walk them again.
    """

    name: str
    answer: Answer | None
    verdicts: tuple[Verdict, ...]
    seconds: float
    is_interrupted: bool = False
    sampled: tuple[SampledResult, ...] = ()
    tried: int = 0
    stuck: Stuck | None = None
    exact: Exact | None = None
    choices: Choices | None = None
    refusal: Refusal | None = None
    fault: FaultError | None = field(default=None, repr=False, compare=False)
    traces: Traces | None = field(default=None, repr=False, compare=False)

    @property
    def comment(self) -> str:
        """What the property requires, if the model says it."""
        return (self.traces.asked.property.comment or "") if self.traces is not None else ""

    @property
    def asks_stuck(self) -> bool:
        """Whether the question is about stuck traces."""
        return any(answer.question.is_stuck for answer in self._answers())

    @property
    def epsilon(self) -> float:
        """The difference that `==` allows."""
        return next((answer.options.epsilon for answer in self._answers()), 0.0)

    @property
    def has_no_expectation(self) -> bool:
        """Whether there is an answer that is compared with nothing, so that it is neither good nor bad."""
        return self.refusal is None and not self.verdicts

    @property
    def is_met(self) -> bool:
        """Whether there is an answer, and every expectation holds."""
        return self.refusal is None and all(verdict.is_met for verdict in self.verdicts)

    def _answers(self) -> Iterator[Answer]:
        answers = [self.answer, *(sampled.answer for sampled in self.sampled)]
        return (answer for answer in answers if answer is not None)

# SPDX-License-Identifier: Apache-2.0
"""The result of one property."""

from __future__ import annotations

import math
from collections.abc import Iterator
from enum import Enum

from roaml.explicit.path import Path, PathRecorder
from roaml.record import PartlyCompared, Record
from roaml.smc.choices import Choices
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty, InitialFold, Question
from roaml.smc.lss import Side
from roaml.smc.model import ModelChecker
from roaml.smc.record import SELECTED, SHORTEST, Recorder, Recording, TraceStep
from roaml.smc.run import Answer, Options
from roaml.smc.statistics import Bounds
from roaml.smc.story import Story, build_story
from roaml.verification.expectations import Verdict
from roaml.verification.growth import GrowingVariable
from roaml.verification.refusal import Refusal
from roaml.verification.schedulers import is_minimised
from roaml.verification.stuck import Stuck
from roaml.verification.target import VerificationTarget


class ShortestTrace(Record, frozen=True):
    """The shortest of all traces with a given verdict; if choices were left out, any trace with this verdict.

    Attributes:
        is_reduced: whether choices were left out.
    """

    checker: ModelChecker
    compiled_property: CompiledProperty
    path: Path
    is_reduced: bool

    @property
    def verdict(self) -> int:
        return self.path.verdict

    @property
    def steps(self) -> int:
        """The number of steps."""
        return len(self.path.steps)

    def story(self, clock: tuple[str, str] | None) -> Story:
        """The whole trace, with the steps that are relevant for the property.

        Args:
            clock: see `roaml.smc.story.build_story`.
        """
        recorder = PathRecorder(self.checker, self.compiled_property, self.path)
        names = {storage.name for storage in recorder.shared}
        number = SELECTED if self.is_reduced else SHORTEST
        return build_story(recorder, number, clock if clock is not None and names.issuperset(clock) else None)


EXACT_WIDTH = 1e-6
"""The maximum distance between the bounds of two values that are regarded as equal; relative for values above 1."""


class Proof(Enum):
    """What the exploration of all states proves about the condition of a property."""

    ALL = "the condition holds in all states"
    NONE = "the condition holds in no state"


class Exact(PartlyCompared, frozen=True):
    """The exact values of a property, computed from all states.

    Attributes:
        minimum, maximum: the extreme values over all schedulers, enclosed by bounds.
        uniform: the value with uniform choices, enclosed by bounds; `None` if it was not computed, because choices
            were left out and the minimum and the maximum differ.
        states: the number of states that were explored.
        is_precise: whether the bounds are as close as intended: at most 0.0001 percent.
        proof: for a property about one condition that is always or never reached: whether the condition holds in all
            states or in none; `None` otherwise.
        can_get_stuck: whether a trace can get stuck before the property is decided.
        initial_states: the number of initial states.
        fold: how the values of several initial states are combined.
        traces: the shortest traces in which the property fails or holds, if there are any.
        is_reduced: whether choices that change neither the minimum nor the maximum were left out. Then there are more
            than `states` states, and `traces` are not necessarily the shortest ones.
    """

    UNCOMPARED = frozenset({"traces"})

    minimum: Bounds
    maximum: Bounds
    uniform: Bounds | None
    states: int
    is_precise: bool = True
    proof: Proof | None = None
    can_get_stuck: bool = False
    initial_states: int = 1
    fold: InitialFold = InitialFold.CHOICE
    traces: tuple[ShortestTrace, ...] = ()
    is_reduced: bool = False

    @property
    def least(self) -> float:
        return _value(self.minimum)

    @property
    def greatest(self) -> float:
        return _value(self.maximum)

    @property
    def average(self) -> float:
        """The value with uniform choices; NaN if it was not computed."""
        return math.nan if self.uniform is None else _value(self.uniform)

    @property
    def agrees(self) -> bool:
        """Whether all schedulers have the same value."""
        return is_same(self.minimum, self.maximum) and self.uniform is not None and is_same(self.minimum, self.uniform)

    def asked_value(self, question: Question, *, only_uniform: bool) -> tuple[Bounds, float]:
        """The bounds and the value of the minimum or maximum that a property asks for; with `only_uniform`, those for
        uniform choices."""
        if only_uniform:
            return Bounds(-math.inf, math.inf) if self.uniform is None else self.uniform, self.average
        return (self.minimum, self.least) if is_minimised(question) else (self.maximum, self.greatest)

    def shortest(self, verdict: int) -> ShortestTrace | None:
        """The shortest trace with a verdict; `None` if there is none."""
        return next((trace for trace in self.traces if trace.verdict == verdict), None)


def is_same(a: Bounds, b: Bounds) -> bool:
    """Whether two values are equal, as far as their bounds show."""
    if a == b:
        return True
    lower, upper = min(a.lower, b.lower), max(a.upper, b.upper)
    return upper - lower <= EXACT_WIDTH * max(1.0, abs(lower))


def _value(bounds: Bounds) -> float:
    """A number for the value that bounds enclose: 0 or 1 if one of them is within the bounds, otherwise their middle;
    NaN if only one bound is infinite."""
    if bounds.lower == bounds.upper:
        return bounds.lower
    if math.isinf(bounds.upper) or math.isinf(bounds.lower):
        return math.nan
    return next((end for end in (0.0, 1.0) if bounds.lower <= end <= bounds.upper), (bounds.lower + bounds.upper) / 2)


class SampledResult(Record, frozen=True):
    """The probability under the scheduler that was selected for the minimum or the maximum among sampled schedulers.

    Attributes:
        side: whether it is the minimum or the maximum.
        scheduler: the number of the scheduler; `words` describes it.
        stuck: the traces under this scheduler that got stuck; `None` if there are none.
    """

    side: Side
    answer: Answer
    scheduler: int
    words: str
    stuck: Stuck | None = None


class Traces(Record, frozen=True):
    """The traces under uniform choices for a property. Each can be simulated again."""

    target: VerificationTarget
    checker: ModelChecker
    compiled_property: CompiledProperty
    options: Options

    def recorder(self) -> Recorder:
        """A recorder that simulates single traces. It must not be used by several threads at a time."""
        return Recorder(self.checker, self.compiled_property, self.options.seed, self.options.max_steps)

    def steps(self, trace: int) -> Iterator[TraceStep]:
        """The steps of a trace.

        Args:
            trace: its number, from 0; any trace can be simulated, not only those of the answer.
        """
        return self.recorder().walk(Recording(trace))

    def story(self, trace: int) -> Story:
        """A whole trace, with the steps that are relevant for the property."""
        return build_story(self.recorder(), trace, self.target.clock)


class Result(PartlyCompared, frozen=True):
    """The result of one property.

    Attributes:
        answer: the answer of traces with uniform choices; `None` if only other schedulers or exact values were
            requested. If the result also has exact values, the traces of the answer are examples, unless the value
            under uniform choices is not one of them.
        verdicts: one for each expectation.
        seconds: the duration of the verification, in s.
        is_interrupted: whether the work was ended before the answer was complete.
        sampled: the results of traces with sampled schedulers.
        tried: the number of sampled schedulers from which those of `sampled` were selected.
        stuck: the traces that got stuck; `None` if there are none.
        exact: the values from all states; `None` if they were not computed.
        choices: what is known about schedulers other than the uniform one; `None` if only uniform choices are
            considered.
        refusal: the reason why there is no answer; `None` if there is one.
        undecided: the reason why the exploration of all states could not decide the property; "" if it could.
        growing: the variables because of which the exploration has reached a limit or was interrupted.
        explored: the number of states after which the exploration was interrupted; 0 if it was not.
        fault: the error that is the cause of `refusal`.
        traces: the traces of `answer`, which can be simulated again.
        comment: a description of what the property requires; "" if the model contains none.
    """

    UNCOMPARED = frozenset({"fault", "traces"})

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
    undecided: str = ""
    growing: tuple[GrowingVariable, ...] = ()
    explored: int = 0
    fault: FaultError | None = None
    traces: Traces | None = None
    comment: str = ""

    @property
    def includes_stuck(self) -> bool:
        """Whether the result is about the property `stuck`, which asks whether traces get stuck."""
        traces = () if self.exact is None else self.exact.traces
        questions = [answer.question for answer in self._answers()] + [t.compiled_property.question for t in traces]
        return any(question.is_stuck for question in questions)

    @property
    def is_uniform(self) -> bool:
        """Whether the result is only about uniform choices."""
        return self.answer is not None and self.choices is None and not self.includes_stuck

    def asked_value(self) -> tuple[Bounds, float] | None:
        """The exact value that the property asks for, with its bounds (`Exact.asked_value`); `None` if there are no
        exact values beside the answer of traces."""
        if self.exact is None or self.answer is None:
            return None
        return self.exact.asked_value(self.answer.question, only_uniform=self.is_uniform)

    @property
    def has_uniform_estimate(self) -> bool:
        """Whether the value under uniform choices is an estimate from traces, while the minimum and the maximum are
        exact."""
        return self.exact is not None and self.exact.uniform is None and self.answer is not None

    @property
    def epsilon(self) -> float:
        """The difference that an expectation with `==` allows; 0 if the result is not an estimate from traces."""
        return next((answer.options.epsilon for answer in self._answers()), 0.0)

    @property
    def has_no_expectation(self) -> bool:
        """Whether there is an answer, but no expectation."""
        return self.refusal is None and not self.undecided and not self.verdicts

    @property
    def is_met(self) -> bool:
        """Whether there is an answer, and every expectation holds."""
        return self.refusal is None and not self.undecided and all(verdict.is_met for verdict in self.verdicts)

    def _answers(self) -> Iterator[Answer]:
        answers = [self.answer, *(sampled.answer for sampled in self.sampled)]
        return (answer for answer in answers if answer is not None)

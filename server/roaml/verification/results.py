# SPDX-License-Identifier: Apache-2.0
"""The result of one property: a closed union of its kinds, with what all of them have in common."""

from __future__ import annotations

import math
from collections.abc import Iterator
from enum import Enum
from typing import TYPE_CHECKING, TypeAlias

from roaml.exhaustive import assert_never
from roaml.jani.operators import BinaryOperator
from roaml.record import PartlyCompared, Record, replace
from roaml.smc.choices import Choices
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty, InitialFold, Question, Threshold
from roaml.smc.lss import Side
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE
from roaml.smc.run import Answer, Options
from roaml.smc.statistics import Bounds
from roaml.verification.expectations import ROUNDING, Verdict
from roaml.verification.schedulers import is_minimised
from roaml.verification.stuck import Stuck, shortest
from roaml.verification.target import VerificationTarget

if TYPE_CHECKING:
    from roaml.explicit.path import EndlessTrace, Path
    from roaml.smc.record import Recorder, TraceStep
    from roaml.smc.story import Story
    from roaml.verification.growth import GrowingVariable
    from roaml.verification.refusal import Refusal


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
        from roaml.explicit.path_recorder import PathRecorder  # noqa: PLC0415 - most results are shown without traces
        from roaml.smc.record import SELECTED, SHORTEST  # noqa: PLC0415
        from roaml.smc.story import build_story  # noqa: PLC0415

        recorder = PathRecorder(self.checker, self.compiled_property, self.path)
        names = {storage.name for storage in recorder.shared}
        number = SELECTED if self.is_reduced else SHORTEST
        return build_story(recorder, number, clock if clock is not None and names.issuperset(clock) else None)


EXACT_WIDTH = 1e-6
"""The maximum distance between the bounds of an exact value; relative for values above 1."""


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
        is_reward: whether the values are expected rewards, not probabilities.
        endless: an endless trace with the verdict that no trace has after finitely many steps, if the values differ and
            such a trace was found.
    """

    UNCOMPARED = frozenset({"traces", "endless"})

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
    is_reward: bool = False
    endless: EndlessTrace | None = None

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
        """Whether all schedulers have the same value, as far as the bounds show. Those of a probability decide whether
        it is 0 or 1 (`roaml.explicit.solver.Solver.certain`)."""
        is_sometimes_one = self.minimum.upper < 1.0 <= self.maximum.lower
        is_sometimes_zero = self.minimum.upper <= 0.0 < self.maximum.lower
        is_apart = not self.is_reward and (is_sometimes_one or is_sometimes_zero)
        return is_same(self.minimum, self.maximum) and not is_apart

    def asked_value(self, question: Question, *, only_uniform: bool) -> tuple[Bounds, float]:
        """The bounds and the value of the minimum or maximum that a property asks for; with `only_uniform`, those for
        uniform choices."""
        if only_uniform:
            return Bounds(-math.inf, math.inf) if self.uniform is None else self.uniform, self.average
        return (self.minimum, self.least) if is_minimised(question) else (self.maximum, self.greatest)

    def worst_for(self, threshold: Threshold) -> Exact:
        """The value that is worst for a threshold, as that of all schedulers: the minimum for a lower threshold, the
        maximum for an upper one, and for an equation the one that is farther from its number."""
        is_lower = threshold.is_lower
        if threshold.relation is BinaryOperator.EQUAL:
            is_lower = self.is_below(threshold)
        worst = self.minimum if is_lower else self.maximum
        return replace(self, minimum=worst, maximum=worst, uniform=worst)

    def is_below(self, threshold: Threshold) -> bool:
        """Whether the value that is farther from the number of a threshold is the minimum."""
        return abs(self.least - threshold.number) > abs(self.greatest - threshold.number)

    @property
    def fails(self) -> bool:
        """Whether a trace fails. Then a minimum is less than 1, even if no number shows the difference."""
        return self.shortest(FALSE) is not None

    def shortest(self, verdict: int) -> ShortestTrace | None:
        """The shortest trace with a verdict; `None` if there is none."""
        return next((trace for trace in self.traces if trace.verdict == verdict), None)


def is_same(a: Bounds, b: Bounds) -> bool:
    """Whether two values are equal, as far as their bounds show: these are close and overlap, except for rounding."""
    return is_close(a, b) and not are_apart(a, b)


def are_apart(a: Bounds, b: Bounds) -> bool:
    """Whether the bounds of two values show that these differ."""
    gap = max(a.lower, b.lower) - min(a.upper, b.upper)
    return gap > ROUNDING * max(1.0, abs(a.lower))


def is_close(a: Bounds, b: Bounds) -> bool:
    """Whether two values differ by at most `EXACT_WIDTH`."""
    if a == b:
        return True
    lower, upper = min(a.lower, b.lower), max(a.upper, b.upper)
    if math.isinf(lower) or math.isinf(upper):
        return False
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
        from roaml.smc.record import Recorder  # noqa: PLC0415

        return Recorder(self.checker, self.compiled_property, self.options.seed, self.options.max_steps)

    def steps(self, trace: int) -> Iterator[TraceStep]:
        """The steps of a trace.

        Args:
            trace: its number, from 0; any trace can be simulated, not only those of the answer.
        """
        from roaml.smc.record import Recording  # noqa: PLC0415

        return self.recorder().walk(Recording(trace))

    def story(self, trace: int, *, has_options: bool = True) -> Story:
        """A whole trace, with the steps that are relevant for the property.

        Args:
            has_options: see `roaml.smc.story.build_story`.
        """
        from roaml.smc.story import build_story  # noqa: PLC0415

        return build_story(self.recorder(), trace, self.target.clock, has_options=has_options)


class StoppedTime(Record, frozen=True):
    """Traces in which time stops, because machines take steps for ever that take no time.

    Attributes:
        count: the number of these traces, among `traces`.
        trace: the number of the shortest one.
        names: the machines and trees that take the steps, in backquotes; empty if they are not known.
        time: the time at which they do, in s; `None` if it is not known.
    """

    count: int
    traces: int
    trace: int
    names: tuple[str, ...] = ()
    time: float | None = None


class Refused(PartlyCompared, frozen=True):
    """The property cannot be answered.

    Attributes:
        reason: why not, for users.
        fault: the error that is the cause.
    """

    UNCOMPARED = frozenset({"fault"})

    reason: Refusal
    fault: FaultError


class Undecided(Record, frozen=True):
    """The exploration of all states could not decide the property.

    Attributes:
        reason: a phrase for users.
        growing: the variables because of which a limit was reached.
    """

    reason: str
    growing: tuple[GrowingVariable, ...] = ()


class CutShort(Record, frozen=True):
    """The work was interrupted before there was a value.

    Attributes:
        states: the number of states that were explored.
        growing: the variables because of which there were so many states.
    """

    states: int = 0
    growing: tuple[GrowingVariable, ...] = ()


class Estimated(PartlyCompared, frozen=True):
    """An estimate from traces with uniform choices.

    Attributes:
        answer: the estimate.
        choices: what is known about schedulers other than the uniform one; `None` if only uniform choices are
            considered.
        stuck: the traces that got stuck; `None` if there are none.
        traces: the traces of `answer`, which can be simulated again; `None` for an intermediate result.
        is_interrupted: whether the work was ended before the answer was complete.
    """

    UNCOMPARED = frozenset({"traces"})

    answer: Answer
    choices: Choices | None = None
    stuck: Stuck | None = None
    traces: Traces | None = None
    is_interrupted: bool = False


class Computed(Record, frozen=True):
    """Exact values from all states.

    Attributes:
        question: what the property asks for.
        exact: the values.
        sample: traces with uniform choices. They are examples or, if the value under uniform choices was not computed,
            its estimate. `None` if no traces were generated.
        reason: why the values differ although no trace shows that after finitely many steps, as a clause for users; ""
            if that is unknown.
        stopped: random traces in which time stops, if there is no `sample` that shows them; `None` if there are none.
    """

    question: Question
    exact: Exact
    sample: Estimated | None = None
    reason: str = ""
    stopped: StoppedTime | None = None

    @property
    def is_uniform(self) -> bool:
        """Whether only the value under uniform choices is asked for."""
        return self.sample is not None and self.sample.choices is None and not self.question.is_stuck

    @property
    def has_uniform_estimate(self) -> bool:
        """Whether the value under uniform choices is an estimate from traces, while the minimum and the maximum are
        exact."""
        return self.exact.uniform is None and self.sample is not None

    def asked_value(self) -> tuple[Bounds, float]:
        """The bounds and the value that the property asks for (`Exact.asked_value`)."""
        return self.exact.asked_value(self.question, only_uniform=self.is_uniform)


class Sampled(Record, frozen=True):
    """The results of traces with sampled schedulers.

    Attributes:
        extremes: the minimum and the maximum that were found.
        tried: the number of schedulers from which they were selected.
        is_interrupted: whether the search was ended early.
    """

    extremes: tuple[SampledResult, ...]
    tried: int
    is_interrupted: bool = False


Outcome: TypeAlias = Refused | Undecided | CutShort | Estimated | Computed | Sampled
"""All kinds of results. Code that treats them differently matches them exhaustively (`roaml.exhaustive`)."""


class UnderAssumption(Record, frozen=True):
    """The result of the same property under an assumption.

    Attributes:
        assumption: a clause for users, such as `if machines react at once`.
        outcome: the result under this assumption.
        remark: what the assumption excludes, as a clause for users; "" if that is unknown.
    """

    assumption: str
    outcome: Computed | Estimated | Undecided
    remark: str = ""


class RewardQuantile(Record, frozen=True):
    """The least number such that the reward of at least a share of the traces is not greater.

    Attributes:
        share: the share, greater than 0 and less than 1.
        value: the estimate; infinite if too few traces reach the condition.
        low, high: the interval.
        traces: the number of traces from which it was estimated.
        cut: the number of these that were cut after `max_steps` steps, so that their rewards are not known.
        remark: why there are fewer traces than usual, as a phrase; "" if there are not.
    """

    share: float
    value: float
    low: float
    high: float
    traces: int
    cut: int = 0
    max_steps: int = 0
    remark: str = ""


class Result(Record, frozen=True):
    """The result of one property.

    Attributes:
        outcome: the value, or the reason why there is none.
        verdicts: one for each expectation.
        seconds: the duration of the verification, in s.
        comment: a description of what the property requires; "" if the model contains none.
        conditional: the results under assumptions that the property does not make.
        quantiles: those of a reward that were asked for, from further traces with uniform choices.
    """

    name: str
    outcome: Outcome
    verdicts: tuple[Verdict, ...] = ()
    seconds: float = 0.0
    comment: str = ""
    conditional: tuple[UnderAssumption, ...] = ()
    quantiles: tuple[RewardQuantile, ...] = ()

    @property
    def estimated(self) -> Estimated | None:
        """The traces with uniform choices, also those beside exact values; `None` if there are none."""
        match self.outcome:
            case Estimated() as estimated:
                return estimated
            case Computed(sample=sample):
                return sample
            case _:
                return None

    @property
    def answer(self) -> Answer | None:
        """The answer of `estimated`."""
        return None if self.estimated is None else self.estimated.answer

    @property
    def choices(self) -> Choices | None:
        """What is known about schedulers other than the uniform one; `None` if only uniform choices are considered."""
        return None if self.estimated is None else self.estimated.choices

    @property
    def traces(self) -> Traces | None:
        """The traces of `estimated`, which can be simulated again."""
        return None if self.estimated is None else self.estimated.traces

    @property
    def exact(self) -> Exact | None:
        """The values from all states; `None` if they were not computed."""
        return self.outcome.exact if isinstance(self.outcome, Computed) else None

    @property
    def stuck(self) -> Stuck | None:
        """The traces that got stuck; `None` if there are none."""
        if isinstance(self.outcome, Sampled):
            return shortest(sampled.stuck for sampled in self.outcome.extremes)
        return None if self.estimated is None else self.estimated.stuck

    @property
    def is_interrupted(self) -> bool:
        """Whether the work was ended before the result was complete."""
        match self.outcome:
            case CutShort():
                return True
            case Estimated(is_interrupted=is_interrupted) | Sampled(is_interrupted=is_interrupted):
                return is_interrupted
            case Refused() | Undecided() | Computed():
                return False
        return assert_never(self.outcome)

    @property
    def question(self) -> Question | None:
        """What the property asks for; `None` if there is no value."""
        match self.outcome:
            case Computed(question=question):
                return question
            case Estimated(answer=answer):
                return answer.question
            case Sampled(extremes=extremes):
                return extremes[0].answer.question if extremes else None
            case Refused() | Undecided() | CutShort():
                return None
        return assert_never(self.outcome)

    @property
    def includes_stuck(self) -> bool:
        """Whether the result is about the property `stuck`, which asks whether traces get stuck."""
        return self.question is not None and self.question.is_stuck

    def asked_value(self) -> tuple[Bounds, float] | None:
        """The exact value that the property asks for, with its bounds; `None` if there is none."""
        return self.outcome.asked_value() if isinstance(self.outcome, Computed) else None

    @property
    def epsilon(self) -> float:
        """The difference that an expectation with `==` allows; 0 if the result is not an estimate from traces."""
        match self.outcome:
            case Sampled(extremes=extremes) if extremes:
                return extremes[0].answer.options.epsilon
            case _:
                return 0.0 if self.answer is None else self.answer.options.epsilon

    @property
    def has_answer(self) -> bool:
        """Whether there is a value, or could be one if the work had not been interrupted."""
        return not isinstance(self.outcome, (Refused, Undecided))

    @property
    def has_no_expectation(self) -> bool:
        """Whether there is an answer, but no expectation."""
        return self.has_answer and not self.verdicts

    @property
    def is_met(self) -> bool:
        """Whether there is an answer, and every expectation holds."""
        return self.has_answer and all(verdict.is_met for verdict in self.verdicts)

    @property
    def is_undecided(self) -> bool:
        """Whether no expectation is missed, and some are undecided."""
        is_any = any(verdict.is_undecided for verdict in self.verdicts)
        return is_any and all(verdict.is_met or verdict.is_undecided for verdict in self.verdicts)

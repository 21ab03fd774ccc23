# SPDX-License-Identifier: Apache-2.0
"""Compares the result under uniform choices with other schedulers: whether all schedulers have the same value and, if
that is unknown, which range the values of sampled schedulers have.

1. A model without nondeterminism has only one scheduler.
2. If there are few states, `roaml.verification.small` computes the minimum and the maximum from all states.
3. Otherwise schedulers are sampled (`lss.probe`), with a fraction of the effort for the result.

The method depends only on the model, the question, the options and the traces of the result.
"""

from __future__ import annotations

from collections.abc import Sequence

from roaml.exhaustive import Vocabulary
from roaml.jani.model import Model, ModelType
from roaml.record import Record
from roaml.smc.batch import Payload
from roaml.smc.lss import candidates, described, probe
from roaml.smc.pool import Pool, Pulse
from roaml.smc.program import Program
from roaml.smc.run import Answer
from roaml.smc.statistics import Bounds

NO_NONDETERMINISM = "the model has no nondeterminism"
"""The reason why all schedulers of a model of type `dtmc` have the same value."""
_RESULT_STEPS_PER_PROBE_STEP = 5
"""The number of steps that were simulated for the result, for each step that is simulated for sampled schedulers."""
_MIN_STEPS, _MAX_STEPS = 50_000, 400_000
"""The limits of the number of steps that are simulated for sampled schedulers."""
_MAX_CHEAP_REGISTERS = 200
"""The number of registers and automata with which the maximum number of steps is half of `_MAX_STEPS`. This maximum
decreases as the number of registers grows, because a step then takes longer."""


class ExtremeMethod(Vocabulary):
    """The method by which an extreme was found."""

    EXPLORATION = "all states"
    SAMPLING = "sampled schedulers"
    UNIFORM = "uniform choices"
    REACTIONS = "machines that react at once"


class Extreme(Record, frozen=True):
    """The minimum or the maximum probability, as far as it is known.

    Attributes:
        value: the estimate, or the exact value.
        bounds: an interval that contains the probability under some scheduler; this is certain if all states were
            explored, also with the assumption that machines react at once, and otherwise has the confidence of the
            method.
        method: the method by which the extreme was found.
        scheduler: a description of the sampled scheduler that achieves the value; empty for the other methods.
        traces: the number of traces on which the estimate is based; 0 for an exact value.
    """

    value: float
    bounds: Bounds
    method: ExtremeMethod
    scheduler: str = ""
    traces: int = 0

    @property
    def is_exact(self) -> bool:
        return self.method is ExtremeMethod.EXPLORATION


class Choices(Record, frozen=True):
    """What is known about schedulers other than the uniform one.

    Attributes:
        agreement: the reason why all schedulers have the same value; empty if that is unknown.
        minimum, maximum: the extreme values of schedulers; `None` if unknown.
        tried: the number of schedulers that were sampled.
        explored: the number of states at which a search through all of them stopped; 0 if there was none.
        limit: the name of the limit at which it stopped, or because of which there was none, such as `max-states`; ""
            if it cannot be raised.
        reason: why no search gave values, as a phrase for users; "" if there was none and no limit prevented it.
    """

    agreement: str = ""
    minimum: Extreme | None = None
    maximum: Extreme | None = None
    tried: int = 0
    explored: int = 0
    limit: str = ""
    reason: str = ""

    @property
    def differ(self) -> bool:
        """Whether the minimum and the maximum are known to differ."""
        if self.agreement or self.minimum is None or self.maximum is None:
            return False
        return self.minimum.bounds.upper < self.maximum.bounds.lower


def check_choices(
    model: Model,
    program: Program,
    payload: Payload,
    answer: Answer,
    actors: Sequence[str],
    pool: Pool,
    pulse: Pulse | None = None,
) -> Choices:
    """Determine whether schedulers other than the uniform one may have other values, and estimate the extreme values.

    Args:
        answer: the answer under uniform choices.
        actors: a noun phrase for each element of the system.

    Raises:
        TraceFaultError: a trace under some scheduler failed.
    """
    question, tally = answer.question, answer.tally
    if model.type is ModelType.DTMC and not question.asks_for_extreme_state:
        return Choices(NO_NONDETERMINISM, *_of_answer(answer))
    if model.type is ModelType.DTMC or question.has_opposite_extremes:
        return Choices()
    if question.is_reward or not tally.traces:
        return Choices()
    size = program.int_count + program.real_count + program.instances
    most = _MAX_STEPS * _MAX_CHEAP_REGISTERS // (_MAX_CHEAP_REGISTERS + size)
    budget = max(_MIN_STEPS, min(most, tally.steps // _RESULT_STEPS_PER_PROBE_STEP))
    length = tally.steps / tally.traces
    some = candidates(len(actors), per_automaton=1, memoryless=16, memory=16)
    extremes = probe(payload, question, answer.options, pool, some, budget, length, pulse)
    own_least, own_greatest = _of_answer(answer)
    if extremes is None:
        return Choices("", own_least, own_greatest)
    sampled = [
        Extreme(extreme.value, extreme.bounds, ExtremeMethod.SAMPLING, described(by, actors), extreme.tally.traces)
        for extreme, by in ((extremes.least, extremes.least_by), (extremes.greatest, extremes.greatest_by))
    ]
    least = sampled[0] if sampled[0].bounds.upper < own_least.bounds.lower else own_least
    greatest = sampled[1] if sampled[1].bounds.lower > own_greatest.bounds.upper else own_greatest
    return Choices("", least, greatest, extremes.tried)


def _of_answer(answer: Answer) -> tuple[Extreme, Extreme]:
    own = Extreme(answer.value, answer.bounds, ExtremeMethod.UNIFORM, traces=answer.tally.traces)
    return own, own

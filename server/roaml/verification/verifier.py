# SPDX-License-Identifier: Apache-2.0
"""Decides the properties of a target, and compares the results with expectations."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from roaml.comparison import UniformPolicy
from roaml.explicit.space import ExplorationProgress, ExplorationWatch, StateLimits
from roaml.jani.properties import Property
from roaml.jani.selection import PropertyError, select
from roaml.record import Record, field, replace
from roaml.smc.choices import NO_NONDETERMINISM, Choices
from roaml.smc.end import End
from roaml.smc.fault import FaultError
from roaml.smc.goal import STUCK_PROPERTY, CompiledProperty, with_threshold
from roaml.smc.lss import Search, Side, described, sampling_options
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Alone, Pool, Pulse
from roaml.smc.run import Answer, EstimationMethod, Options, Watch, summary
from roaml.smc.tally import Tally
from roaml.suggest import alternatives, close_names
from roaml.verification import stuck
from roaml.verification.exhaustive import UndecidedError, alone, check_exactly, exact_values
from roaml.verification.expectations import Expectation, Verdict, check_expectation, check_range, is_possible
from roaml.verification.explorations import Explorations, subject_of
from roaml.verification.reactions import LIMITS as REACTION_LIMITS
from roaml.verification.reactions import at_once, with_reactions
from roaml.verification.refusal import refusal
from roaml.verification.results import (
    Computed,
    Estimated,
    Exact,
    Outcome,
    Refused,
    Result,
    Sampled,
    SampledResult,
    StoppedTime,
    Traces,
    Undecided,
)
from roaml.verification.schedulers import (
    is_minimised,
    judged,
    under_all_schedulers,
    under_sampled_schedulers,
)
from roaml.verification.small import (
    EXAMPLE_TRACES,
    MAX_EXAMPLE_STEPS,
    NOTHING_LEFT,
    SHARED_LIMITS,
    UNIFORM_LIMITS,
    Attempt,
    Budget,
    attempt,
    choices_of,
    limits_beside,
    setup_cost,
)
from roaml.verification.stuck import StuckLevel, StuckResult
from roaml.verification.target import VerificationTarget
from roaml.views.actors import actors
from roaml.views.ends import marks, observer_outputs

if TYPE_CHECKING:
    from roaml.smc.record import Recorder
    from roaml.verification.searches import Searches

PULSE_INTERVAL_S = 0.1
"""The interval between two calls of a pulse during an exploration, in s."""


class NoThresholdError(ValueError):
    """A sequential test is requested for a property that is not a probability compared with a number."""


def checker_of(target: VerificationTarget, properties: Iterable[str] | None = None) -> ModelChecker:
    """A model, compiled for some of its properties.

    Args:
        properties: the names of the properties; `None` for all. The name `stuck` asks whether traces get stuck
            (`roaml.smc.end.End.STUCK`); every translated system has this property.

    Raises:
        PropertyError: the model has no property with one of the names.
        FaultError: the model is of an unsupported kind; see `roaml.smc.fault`. The errors of unsupported
            properties are in `ModelChecker.refused` instead.
    """
    ends = marks(target.model)
    if properties is None:
        return _checker(target, target.properties)
    names = list(dict.fromkeys(properties))
    includes_stuck = bool(ends) and STUCK_PROPERTY in names and all(p.name != STUCK_PROPERTY for p in target.properties)
    if includes_stuck:
        names.remove(STUCK_PROPERTY)
    chosen = select(target.properties, names, "model", (STUCK_PROPERTY,) if ends else ())
    return _checker(target, chosen, includes_stuck=includes_stuck)


def _checker(target: VerificationTarget, chosen: tuple[Property, ...], *, includes_stuck: bool = False) -> ModelChecker:
    model, names = target.model, {property_.name for property_ in chosen}
    return ModelChecker(
        model,
        chosen,
        marks(model),
        includes_stuck=includes_stuck,
        outputs=observer_outputs(model),
        assumptions={name: assumed for name, assumed in target.assumptions.items() if name in names},
        actors=actors(model),
    )


def verifier_of(
    target: VerificationTarget,
    properties: Sequence[str] | None = None,
    options: Options | None = None,
    expectations: Iterable[Expectation] = (),
    *,
    only_uniform: bool = False,
    exact_if_small: bool = False,
    example_traces: int | None = None,
    limits: StateLimits | None = None,
    uniform: UniformPolicy = UniformPolicy.WARN,
) -> Verifier:
    """A target prepared for verification.

    Args:
        properties: the names of the properties to verify; `None` for all. Properties with expectations are added.
        only_uniform: whether only uniform choices are considered, not the minimum or maximum over all schedulers.
        exact_if_small, example_traces: see `Verifier`.
        limits: those of all searches for exact values together; `None` for `small.SHARED_LIMITS`, or for
            `small.UNIFORM_LIMITS` if only uniform choices are considered and the model has nondeterminism.
        uniform: what an expectation is worth that is met under uniform choices only.

    Raises:
        PropertyError: a property, or the property of an expectation, does not exist.
        RangeError: the expectation of a probability has a number that is not between 0 and 1.
        FaultError: the model cannot be run.
    """
    expectations = tuple(expectations)
    expected = [expectation.name for expectation in expectations]
    known = [property_.name for property_ in target.properties]
    names = None if properties is None else [*properties, *expected]
    if names is None and STUCK_PROPERTY in expected:
        names = [*known, STUCK_PROPERTY]
    for name in expected:
        if name not in (*known, STUCK_PROPERTY):
            hint = (
                alternatives(close_names(name, known), known, "property", math.inf) or "; the target has no properties"
            )
            raise PropertyError(f"there is no property `{name}`, for which a result is expected{hint}")
    checker = checker_of(target, names)
    for property_ in checker.compiled_properties:
        for expectation in (*expectations, *target.expectations):
            if expectation.name == property_.question.name:
                check_range(expectation, property_.question)
    if limits is None:
        limits = UNIFORM_LIMITS if only_uniform and not checker.is_deterministic else SHARED_LIMITS
    return Verifier(
        target,
        checker,
        options or Options(),
        expectations,
        only_uniform,
        exact_if_small,
        example_traces,
        uniform=uniform,
        budget=Budget(limits),
    )


def expectations_of(property_: CompiledProperty, given: Iterable[Expectation]) -> tuple[Expectation, ...]:
    """The expectations of a property: its own comparison with a number, if it has one, and those in `given` about
    it."""
    name, threshold = property_.question.name, property_.question.threshold
    about_it = tuple(dict.fromkeys(expectation for expectation in given if expectation.name == name))
    if threshold is None or any(expectation.threshold == threshold for expectation in about_it):
        return about_it
    return (Expectation(name, threshold, is_own=True), *about_it)


def with_expectations(
    result: Result, given: Iterable[Expectation], uniform: UniformPolicy = UniformPolicy.WARN
) -> Result:
    """The result of traces with uniform choices, or exact values, compared with other expectations, without new traces.

    Args:
        given: the expectations, also of other properties. Impossible ones (see `check_range`) are ignored.
        uniform: what an expectation is worth that is met under uniform choices only.
    """
    estimated = result.estimated
    if estimated is None or estimated.traces is None:
        return result
    question = estimated.answer.question
    expectations = [e for e in expectations_of(estimated.traces.compiled_property, given) if is_possible(e, question)]
    return replace(result, verdicts=_verdicts(estimated.traces.target, expectations, estimated, result.exact, uniform))


def _comment(property_: CompiledProperty) -> str:
    return property_.property.comment or ""


def _verdicts(
    target: VerificationTarget,
    expectations: Iterable[Expectation],
    estimated: Estimated,
    exact: Exact | None,
    uniform: UniformPolicy,
) -> tuple[Verdict, ...]:
    answer, choices = estimated.answer, estimated.choices
    if exact is not None:
        only_uniform = choices is None and not answer.question.is_stuck and not target.has_intervals
        return tuple(
            check_exactly(
                expectation,
                _compared(target, expectation, exact),
                answer.question,
                only_uniform=only_uniform,
                over_intervals=target.has_intervals,
            )
            for expectation in expectations
        )
    return tuple(
        judged(under_all_schedulers(check_expectation(expectation, answer), answer, choices), uniform)
        for expectation in expectations
    )


def _compared(target: VerificationTarget, expectation: Expectation, exact: Exact) -> Exact:
    """The values with which an expectation is compared: over intervals of parameters, only the worst one."""
    return exact.worst_for(expectation.threshold) if target.has_intervals else exact


class Verifier(Record, frozen=True):
    """A target with compiled properties, and their expectations; see `verifier_of`.

    Attributes:
        only_uniform: whether only uniform choices are considered, not the minimum or maximum over all schedulers.
        exact_if_small: whether the result of a property contains exact values if the model has few states (`small`),
            and if schedulers may disagree, those for machines that react at once (`reactions`).
        example_traces: the number of traces that are generated for a result with exact values; `None` for the number
            that an estimate needs.
        uniform: what an expectation is worth that is met under uniform choices only.
        explorations: the exact values that several properties share.
        budget: the limits of all searches for exact values that are not requested.
        reaction_budget: those of all searches under the assumption that machines react at once.
        failed: what a search was about -> if it gave no values, the number of states at which it stopped, the limit and
            the reason (`Choices`).
    """

    target: VerificationTarget
    checker: ModelChecker
    options: Options = field(default_factory=Options)
    expectations: tuple[Expectation, ...] = ()
    only_uniform: bool = False
    exact_if_small: bool = False
    example_traces: int | None = None
    uniform: UniformPolicy = UniformPolicy.WARN
    explorations: Explorations = field(default_factory=Explorations)
    budget: Budget = field(default_factory=Budget)
    reaction_budget: Budget = field(default_factory=lambda: Budget(REACTION_LIMITS))
    failed: dict[object, tuple[int, str, str]] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the properties, in their order."""
        return self.checker.names

    def question(self, name: str) -> CompiledProperty:
        """The compiled property with a name. For a sequential test, its value is compared with the number of its first
        expectation.

        Raises:
            FaultError: the property cannot be decided.
        """
        if name in self.checker.refused:
            raise self.checker.refused[name]
        property_ = next(property_ for property_ in self.checker.compiled_properties if property_.question.name == name)
        if self.options.method is EstimationMethod.SPRT and property_.question.threshold is None:
            for expectation in (*self.expectations, *self.target.expectations):
                if expectation.name == name:
                    return replace(property_, question=with_threshold(property_.question, expectation.threshold))
        return property_

    def expected(self, property_: CompiledProperty) -> tuple[Expectation, ...]:
        """The expectations of a property: those of the property itself, of the verifier, and of the target."""
        return expectations_of(property_, (*self.expectations, *self.target.expectations))

    def verify(self, name: str, pool: Pool) -> Result:
        """The result of a property; a refusal if it cannot be decided.

        Raises:
            NoThresholdError: see `answer`.
            WorkersLostError: processes end repeatedly.
        """
        try:
            return self.answer(self.question(name), pool)
        except FaultError as fault:
            return self.refused(name, fault)

    def verify_all(self, pool: Pool) -> Iterator[Result]:
        """The results of all properties, in their order. Properties that can share traces are verified together.

        Raises:
            NoThresholdError, WorkersLostError: see `verify`.
        """
        properties = self.sharing()
        results = {}
        if properties:
            shared = self.answer_together(properties, pool, [Tally() for _ in properties], lambda *_: None)
            results = {result.name: result for result in shared}
        for name in self.names:
            yield results.get(name) or self.verify(name, pool)

    def sharing(self) -> list[CompiledProperty]:
        """The properties that can share traces; empty if there are fewer than two."""
        properties = [self.question(name) for name in self.names if name not in self.checker.refused]
        sharing = [property_ for property_ in properties if self.can_share(property_)]
        return sharing if len(sharing) > 1 else []

    def answer(
        self,
        property_: CompiledProperty,
        pool: Pool,
        tally: Tally | None = None,
        watch: Watch | None = None,
        pulse: Pulse | None = None,
    ) -> Result:
        """The result of a property, from traces with uniform choices; with exact values if they are requested, the
        model is small, and no trace can get stuck.

        Args:
            tally: the state to continue from; it is updated after each batch. After an interruption, `interrupted`
                creates a result from it.
            watch: called after each batch.
            pulse: called several times per second.

        Raises:
            FaultError: a trace executed an undefined operation.
            NoThresholdError: see `check_method`.
            WorkersLostError: processes end repeatedly.
        """
        self.check_method(property_)
        began = time.monotonic()
        small = self._small(property_, pulse)
        options = self._trace_options(self._shown(small))
        answer = self.checker.answer(property_, options, pool, tally, watch, pulse)
        return self._finished(property_, answer, small, pool, pulse, began)

    def can_share(self, property_: CompiledProperty) -> bool:
        """Whether the traces of other properties can answer a property: it must be about a probability, and not about
        deadlocks."""
        return not property_.question.is_reward and property_.goal.is_bounded < 2

    def answer_together(
        self,
        properties: Sequence[CompiledProperty],
        pool: Pool,
        tallies: Sequence[Tally],
        watch: Callable[[CompiledProperty, Tally], None],
        pulse: Pulse | None = None,
    ) -> list[Result]:
        """The results of properties that can share traces (`can_share`). Each has the answer that `answer` gives.

        Args:
            tallies: the states to continue from; they are updated after each batch.
            watch: called for each property after each of its batches.

        Raises:
            NoThresholdError, WorkersLostError: see `answer`.
        """
        for property_ in properties:
            self.check_method(property_)
        began = time.monotonic()
        seconds: dict[str, float] = {}

        def watch_time(property_: CompiledProperty, tally: Tally) -> None:
            seconds[property_.question.name] = time.monotonic() - began
            watch(property_, tally)

        small = self._all_small(properties, pulse)
        groups: dict[Options, list[int]] = {}
        for i, exact in enumerate(small):
            groups.setdefault(self._trace_options(self._shown(exact)), []).append(i)
        answers: dict[int, Answer | FaultError] = {}
        for options, group in groups.items():
            together = self.checker.answer_together(
                [properties[i] for i in group], options, pool, [tallies[i] for i in group], watch_time, pulse
            )
            answers.update(zip(group, together, strict=True))
        results = []
        for i, property_ in enumerate(properties):
            name, since = property_.question.name, time.monotonic()
            answer = answers[i]
            if isinstance(answer, FaultError):
                results.append(self.refused(name, answer))
                continue
            try:
                since -= seconds.get(name, 0.0)
                results.append(self._finished(property_, answer, small[i], pool, pulse, since))
            except FaultError as fault:
                results.append(self.refused(name, fault))
        return results

    def _small(
        self, property_: CompiledProperty, pulse: Pulse | None, cut: dict[Hashable, StateLimits] | None = None
    ) -> Exact | None:
        """The exact values of a property, for its result; `None` if they are not requested, or if the model is too
        large.

        Args:
            cut: the limits of the search are added if they did not suffice; with the key of the property (`_subject`).
        """
        if not self.exact_if_small:
            return None

        def computed() -> Exact | None:
            subjects = {self._subject(other) for other in self.checker.compiled_properties}
            limits = self.budget.share(len(subjects), setup_cost(self.checker))
            if limits is None:
                self._note_failed(property_, NOTHING_LEFT)
                return None
            attempted = self._attempted(property_, limits, pulse)
            if attempted.is_cut and cut is not None:
                cut[self._subject(property_)] = limits
            return attempted.exact

        return self.explorations.exact(self.checker, property_, "shared limits", computed)

    def _all_small(self, properties: Sequence[CompiledProperty], pulse: Pulse | None) -> list[Exact | None]:
        """The exact values of several properties, as `_small`. Those whose share of the limits did not suffice are
        searched again with what the others have left."""
        cut: dict[Hashable, StateLimits] = {}
        small = [self._small(property_, pulse, cut) for property_ in properties]
        subjects = set(cut)
        for i, property_ in enumerate(properties):
            if self._subject(property_) in subjects:
                small[i] = self._small_again(property_, cut, pulse)
        return small

    def _small_again(
        self, property_: CompiledProperty, cut: dict[Hashable, StateLimits], pulse: Pulse | None
    ) -> Exact | None:
        """The exact values of a property whose first search was cut; `None` if not enough is left of the limits."""

        def computed() -> Exact | None:
            before = cut.pop(self._subject(property_))
            limits = self.budget.rest(len(cut) + 1, before, setup_cost(self.checker))
            return None if limits is None else self._attempted(property_, limits, pulse, is_repeated=True).exact

        return self.explorations.exact(self.checker, property_, "rest of the limits", computed)

    def _subject(self, property_: CompiledProperty) -> Hashable:
        """What one search is about: several properties may have the same."""
        return subject_of(self.checker, property_) or property_.question.name

    def _beside(self, property_: CompiledProperty, answer: Answer) -> Exact | None:
        """The exact values of a property, to compare schedulers beside traces that were requested; `None` if the model
        is so large that the search would take longer than the traces."""
        limits = limits_beside(answer.tally.steps, setup_cost(self.checker), self.budget.states)
        if self.checker.is_deterministic or limits is None:
            return None
        return self.explorations.exact(
            self.checker, property_, limits, lambda: attempt(self.checker, property_, limits, leaves_out=False).exact
        )

    def _attempted(
        self, property_: CompiledProperty, limits: StateLimits, pulse: Pulse | None, *, is_repeated: bool = False
    ) -> Attempt:
        """A search for the exact values of a property, which is a part of the budget."""
        pulsed = time.monotonic()

        def watch(_: ExplorationProgress) -> None:
            nonlocal pulsed
            if pulse is not None and time.monotonic() - pulsed > PULSE_INTERVAL_S:
                pulsed = time.monotonic()
                pulse(0, 0)

        attempted = attempt(self.checker, property_, limits, watch, is_repeated=is_repeated)
        self.budget.spend(attempted.transitions)
        if attempted.exact is None:
            self._note_failed(property_, attempted)
        return attempted

    def _note_failed(self, property_: CompiledProperty, search: Attempt) -> None:
        self.failed[self._subject(property_)] = search.explored, search.limit, search.reason

    def _shown(self, small: Exact | None) -> Exact | None:
        """The exact values that the result contains. If traces can get stuck, the result contains them only as the
        values of other schedulers, because the value is doubtful and traces are needed as examples. If only the value
        under uniform choices is of interest, the result contains no exact values without it."""
        if not self.exact_if_small or small is None or small.can_get_stuck:
            return None
        return None if self.only_uniform and small.uniform is None else small

    def _trace_options(self, exact: Exact | None) -> Options:
        if exact is None or exact.uniform is None or self.example_traces is None:
            return self.options
        steps = min(self.options.max_steps, MAX_EXAMPLE_STEPS)
        return replace(self.options, method=EstimationMethod.FIXED, max_traces=self.example_traces, max_steps=steps)

    def _finished(
        self,
        property_: CompiledProperty,
        answer: Answer,
        small: Exact | None,
        pool: Pool,
        pulse: Pulse | None,
        began: float,
    ) -> Result:
        """The result that contains an answer.

        Args:
            small: the exact values, if they were requested and the model is small.
            began: the time at which the work began.
        """
        choices = None
        if self._considers_choices(property_):
            compared = small if self.exact_if_small else self._beside(property_, answer)
            if compared is None:
                choices = self.checker.choices(property_, answer, pool, pulse)
                explored, limit, reason = self.failed.get(self._subject(property_), (0, "", ""))
                choices = replace(choices, explored=explored, limit=limit, reason=reason)
            else:
                choices = choices_of(compared, NO_NONDETERMINISM if self.checker.is_deterministic else "")
        result = self._with_verdicts(property_, answer, choices, time.monotonic() - began, self._shown(small))
        # Traces that are requested are not extended by a search, which may take longer than they do.
        return self._with_reactions(property_, result, began) if self.exact_if_small else result

    def _reason(self, property_: CompiledProperty, exact: Exact) -> str:
        """Why the exact values of a property differ; see `Computed.reason`."""
        if exact.endless is None:
            return ""
        from roaml.verification.delays import endless_delay  # noqa: PLC0415 - few verifications need it

        metadata = self.target.model.metadata
        clock = None if metadata is None else metadata.clock
        return endless_delay(*alone(self.checker, property_), exact.endless, clock)

    def _considers_choices(self, property_: CompiledProperty) -> bool:
        """Whether the question is about all schedulers, not only about uniform choices."""
        return not (self.only_uniform or property_.question.is_stuck or property_.question.is_conditional)

    def check_method(self, property_: CompiledProperty) -> None:
        """Check that a property can be decided by a sequential test, if that is the requested method.

        Raises:
            NoThresholdError: the property is a reward, or is not compared with a number.
        """
        question = property_.question
        if self.options.method is not EstimationMethod.SPRT:
            return
        if question.is_reward:
            raise NoThresholdError(
                f"a sequential test needs a probability, but `{question.name}` is a reward; use another method"
            )
        if question.threshold is None:
            raise NoThresholdError(
                f"a sequential test compares a probability with a number, but `{question.name}` has no expectation; "
                "set one, or use another method"
            )

    def interrupted(
        self, property_: CompiledProperty, tally: Tally, seconds: float, *, is_partial: bool = True
    ) -> Result:
        """The result of a property so far, after an interruption.

        Args:
            is_partial: whether there are fewer traces than requested; other schedulers were not examined in any case.
        """
        answer = summary(property_.question, self.options, tally)
        choices = None if self.only_uniform else Choices()
        return self._with_verdicts(property_, answer, choices, seconds, is_interrupted=is_partial)

    def refused(self, name: str, fault: FaultError) -> Result:
        """The result of a property that cannot be answered."""
        return Result(name, Refused(refusal(fault, self.target, self.options.seed), fault))

    def sampled(
        self, property_: CompiledProperty, search: Search, seconds: float, *, is_interrupted: bool = False
    ) -> Result:
        """The minimum and maximum probability under sampled schedulers, as far as the search has progressed."""
        sampled = []
        for side, (scheduler, tally) in search.selected.items():
            if tally.traces:
                answer = summary(property_.question, sampling_options(self.options), tally)
                words = described(scheduler, self.checker.actors)
                got_stuck = stuck.stuck_in(self.target, self.checker, property_, answer, scheduler)
                sampled.append(SampledResult(side, answer, scheduler, words, got_stuck))
        required_side = Side.LEAST if is_minimised(property_.question) else Side.GREATEST
        own = next((result for result in sampled if result.side is required_side), None)
        verdicts = [
            Verdict(expectation, False, False, under="so far")
            if own is None
            else check_expectation(expectation, own.answer)
            for expectation in self.expected(property_)
        ]
        if own is not None:
            verdicts = [
                under_sampled_schedulers(verdict, property_.question, own.words, search.tried) for verdict in verdicts
            ]
        outcome = Sampled(tuple(sampled), search.tried, is_interrupted)
        return Result(property_.question.name, outcome, tuple(verdicts), seconds, _comment(property_))

    def searches(self, limits: StateLimits, jobs: int = 1) -> Searches:
        """The searches for all properties, at most `jobs` of them at the same time."""
        properties: dict[Hashable, CompiledProperty] = {}
        for property_ in self.checker.compiled_properties:
            if not property_.question.is_conditional:
                properties.setdefault(self._subject(property_), property_)
        from roaml.verification.searches import Searches  # noqa: PLC0415 - few verifications are exhaustive

        return Searches(self.checker, properties.values(), limits, jobs)

    def exhaustive(
        self,
        property_: CompiledProperty,
        limits: StateLimits,
        watch: ExplorationWatch | None = None,
        searches: Searches | None = None,
    ) -> Result:
        """The exact values of a property, from all states; undecided if there are none (see `exact_values`).

        Args:
            watch: called several times during the search.
            searches: those of this verifier with the same limits, if the following properties may be explored at the
                same time.

        Raises:
            FaultError: the model executes an undefined operation in some state.
        """
        began = time.monotonic()
        expectations = self.expected(property_)

        def seconds() -> float:
            elsewhere = 0.0 if searches is None else searches.seconds.get(property_.question.name, 0.0)
            return max(time.monotonic() - began, elsewhere)

        def computed() -> Exact:
            if searches is not None:
                return searches.exact_values(property_, watch)
            return exact_values(self.checker, property_, limits, watch)

        try:
            exact = self.explorations.exact(self.checker, property_, limits, computed)
            assert exact is not None
        except UndecidedError as error:
            open_ = tuple(Verdict(expectation, False, False, under="so far") for expectation in expectations)
            undecided = Undecided(str(error), error.growing)
            return Result(property_.question.name, undecided, open_, seconds(), _comment(property_))
        verdicts = tuple(
            check_exactly(
                expectation,
                _compared(self.target, expectation, exact),
                property_.question,
                over_intervals=self.target.has_intervals,
            )
            for expectation in expectations
        )
        reason, stopped = self._reason(property_, exact), self._stopped_time(property_)
        outcome = Computed(property_.question, exact, reason=reason, stopped=stopped)
        result = Result(property_.question.name, outcome, verdicts, seconds(), _comment(property_))
        return self._with_reactions(property_, result, time.monotonic() - seconds())

    def _stopped_time(self, property_: CompiledProperty) -> StoppedTime | None:
        """The random traces in which time stops, of as many as are generated beside exact values without a request;
        `None` if there are none."""
        if self.target.clock is None:
            return None
        options = replace(
            self.options,
            method=EstimationMethod.FIXED,
            max_traces=EXAMPLE_TRACES,
            max_steps=min(self.options.max_steps, MAX_EXAMPLE_STEPS),
        )
        try:
            answer = self.checker.answer(property_, options, Alone(self.checker.compiled(property_)))
        except FaultError:  # in a state that the search did not need
            return None
        if End.ROUND not in answer.tally.ends:
            return None
        from roaml.verification.repetition import stopped_time  # noqa: PLC0415 - time seldom stops

        return stopped_time(answer.tally, Traces(self.target, self.checker, property_, options))

    def _with_reactions(self, property_: CompiledProperty, result: Result, began: float) -> Result:
        """The result, with the values if machines react at once if schedulers disagree."""
        if not self._considers_choices(property_):
            return result
        under = at_once(
            self.target,
            property_,
            result.outcome,
            lambda target: self.explorations.checker(lambda: checker_of(target, self.names)),
            self.reaction_budget,
        )
        if under is None:
            return result
        match result.outcome, under.outcome:
            case Estimated(choices=Choices() as known) as estimated, Computed(exact=exact):
                estimated = replace(estimated, choices=with_reactions(known, exact))
                verdicts = _verdicts(self.target, self.expected(property_), estimated, None, self.uniform)
                result = replace(result, outcome=estimated, verdicts=verdicts)
        return replace(result, conditional=(*result.conditional, under), seconds=time.monotonic() - began)

    def check_stuck(self, level: StuckLevel = StuckLevel.WARNING, pulse: Pulse | None = None) -> StuckResult:
        """Generate traces to check whether the system gets stuck. `stuck.can_be_stuck` must be true for the model."""
        return stuck.check_stuck(self.target, self.checker, self.options, level, pulse)

    def _with_verdicts(
        self,
        property_: CompiledProperty,
        answer: Answer,
        choices: Choices | None,
        seconds: float,
        exact: Exact | None = None,
        *,
        is_interrupted: bool = False,
    ) -> Result:
        got_stuck = stuck.stuck_in(self.target, self.checker, property_, answer)
        traces = Traces(self.target, self.checker, property_, self.options)
        if not is_interrupted and (cut := answer.tally.ends.get(End.CUT)) is not None:
            from roaml.verification.growth import growth_in_trace  # noqa: PLC0415 - few traces are cut

            options = answer.options

            def recorder_of(steps: int) -> Recorder:
                return replace(traces, options=replace(options, max_steps=steps)).recorder()

            growth = growth_in_trace(self.checker, recorder_of, options.max_steps, cut.shortest.trace)
            answer = replace(answer, growth=growth)
        estimated = Estimated(answer, choices, got_stuck, traces, is_interrupted)
        verdicts = _verdicts(self.target, self.expected(property_), estimated, exact, self.uniform)
        outcome: Outcome = estimated
        if exact is not None:
            reason = "" if choices is None else self._reason(property_, exact)
            outcome = Computed(property_.question, exact, estimated, reason)
        return Result(property_.question.name, outcome, verdicts, seconds, _comment(property_))

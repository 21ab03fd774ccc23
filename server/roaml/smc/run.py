# SPDX-License-Identifier: Apache-2.0
"""Answers a question by sampling: determines how many traces are generated, and computes the estimate and its interval
from them.

- Whether more traces are needed is decided after whole batches, in the order of their numbers. The size of a batch
  depends only on the numbers of traces before it and after it. So the answer is a function of model, property, seed
  and options.
- The state that is needed to continue after an interruption is a `Tally`: a few numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence

from roaml.exhaustive import Vocabulary
from roaml.record import Record
from roaml.smc.batch import Counting, Payload, Rows, Task, TraceProblem
from roaml.smc.goal import Question
from roaml.smc.pool import Pulse, Runner
from roaml.smc.program import TRUE, UNKNOWN
from roaml.smc.statistics import Bounds, Ratio, clopper_pearson, confidence_sequence, okamoto
from roaml.smc.tally import REJECTED, Tally


class EstimationMethod(Vocabulary):
    """What determines the number of traces: the width of the interval, Okamoto's bound, a sequential test, or the
    user."""

    ADAPTIVE = "adaptive"
    OKAMOTO = "okamoto"
    SPRT = "sprt"
    FIXED = "fixed"


FIRST_BATCH_TRACES = 100
MAX_BATCH_TRACES = 5000
BATCH_GROWTH = 0.1
"""The size of a batch as a fraction of the number of traces before it; at least `FIRST_BATCH_TRACES`, at most
`MAX_BATCH_TRACES`."""
BATCH_OF_REST = 0.1
"""The maximum size of a batch as a fraction of the remaining traces, so that all workers end at about the same time; at
least `FIRST_BATCH_TRACES`."""


def stopping_error_share(confidence: float) -> float:
    """Stopping as soon as the interval is narrow enough increases the error; so the interval is computed for this
    fraction of the allowed error. A test computes that the total error does not exceed the allowed error. The smaller
    the allowed error, the greater is the share that stopping adds."""
    return 0.75 if confidence <= 0.95 else 0.55


MIN_EPSILON = 1e-9
"""The minimum half-width of an interval. A narrower interval needs more traces than can be simulated."""
MAX_REWARD_TRACES = 10_000_000
"""The number of traces after which the adaptive method ends even if the interval is wider than requested."""
MIN_REWARD_TRACES = 10_000
"""The number of traces before which the adaptive method does not end for a reward: the range of the rewards is not
known, so a rare reward may change the mean. One with a probability of 0.001 occurs in these traces almost surely."""
MAX_EQUAL_TRACES = 100_000
"""The number of traces after which the adaptive method ends if all rewards were equal. There is no interval then."""
MAX_REJECTED = 100_000
"""The number of traces after which the work ends if the assumptions have rejected all of them."""


class Options(Record, frozen=True):
    """The options for answering a question.

    Attributes:
        confidence: the probability with which the interval contains the true value.
        epsilon: half the width of the interval; for rewards relative to the value.
        max_traces: the maximum number of traces; with the method "fixed", the exact number.
        max_steps: the maximum number of steps of a trace; traces that are not decided by then are undecided.

    Raises:
        ValueError: a number is not valid; the message states which.
    """

    confidence: float = 0.95
    epsilon: float = 0.01
    max_traces: int | None = None
    max_steps: int = 1_000_000
    seed: int = 0
    method: EstimationMethod = EstimationMethod.ADAPTIVE

    def __post_init__(self) -> None:
        if not 0 < self.confidence < 1:
            raise ValueError("the confidence must be a number between 0 and 1, both excluded")
        if not MIN_EPSILON <= self.epsilon < 1:
            raise ValueError(f"epsilon must be a number of at least {MIN_EPSILON:g} and less than 1")
        if not isinstance(self.method, EstimationMethod):
            raise ValueError(
                f"there is no method `{self.method}`; the methods are {', '.join(map(str, EstimationMethod))}"
            )
        if self.method is EstimationMethod.FIXED and self.max_traces is None:
            raise ValueError("the method `fixed` needs a number of traces; set the maximum (max_traces)")


class Answer(Record, frozen=True):
    """The answer to a question that follows from traces.

    Attributes:
        value: the estimate: of a probability, the middle of the range that undecided traces leave; of a reward,
            infinity if some trace never reaches its target. Not a number if there are no traces.
        bounds: the interval for the true value.
        is_complete: whether the interval is as narrow as requested, or the test has decided.
        is_anytime: whether the interval is valid at any stopping time; otherwise it is valid for the stopping rule of
            the method.
        growth: what grows through cut traces, and what to do, as a phrase for users; "" if nothing is known to grow.
    """

    question: Question
    options: Options
    tally: Tally
    value: float
    bounds: Bounds
    is_complete: bool
    is_anytime: bool = False
    growth: str = ""

    @property
    def interval(self) -> str:
        """The name of the interval in statistics. The intervals for rewards are valid if no reward is outside of the
        range of those that were seen."""
        if self.question.is_reward:
            return "asymptotic confidence sequence" if self.is_anytime else "empirical Bernstein"
        return "confidence sequence" if self.is_anytime else "Clopper-Pearson"

    @property
    def is_too_wide(self) -> bool:
        """Whether the interval is wider than requested. If the user has requested a number of traces, no width was
        requested."""
        return not self.is_complete and self.options.method is not EstimationMethod.FIXED

    @property
    def is_ended_by_limit(self) -> bool:
        """Whether the maximum number of traces has ended the estimate, so that only more traces make it better."""
        return self.options.max_traces is not None and self.tally.simulated >= self.options.max_traces

    @property
    def is_unknown(self) -> bool:
        """Whether there are traces and all of them are undecided, so that `value` says nothing about the model."""
        return 0 < self.tally.traces == self.tally.undecided

    @property
    def failures(self) -> int:
        return self.tally.traces - self.tally.successes - self.tally.undecided


Watch = Callable[[Tally], None]


class TraceFaultError(Exception):
    """A trace executed an undefined operation. `ModelChecker.fault` converts `problem` to an error for users."""

    def __init__(self, problem: TraceProblem) -> None:
        super().__init__(problem)
        self.problem = problem


def answer(
    payload: Payload,
    question: Question,
    options: Options,
    pool: Runner,
    tally: Tally | None = None,
    watch: Watch | None = None,
    pulse: Pulse | None = None,
    first: int = 0,
    scheduler: int = 0,
) -> Answer:
    """Run traces until the question is answered.

    Args:
        payload: the goals of the question and of its assumptions, if it has any.
        tally: the state to continue from. It is updated after each batch, so that it contains the result so far if the
            work is interrupted.
        watch: called after each batch.
        first: the number of the first trace.

    Raises:
        TraceFaultError: a trace failed.
    """
    inquiry = Inquiry(question, Tally() if tally is None else tally, columns_of([question])[0])

    def watch_one(_: Inquiry) -> None:
        if watch is not None:
            watch(inquiry.tally)

    if not inquiry.tally.is_finished:
        problem = _run(payload, [inquiry], options, pool, watch_one, pulse, first, scheduler)
        if problem is not None:
            raise TraceFaultError(problem)
    return summary(question, options, inquiry.tally)


class Inquiry(Record):
    """A question that shares traces with others.

    Attributes:
        tally: the state to continue from, updated after each batch.
        columns: the numbers of the question, and of its assumptions if it has any, in the goal of the shared traces.
        problem: the trace that failed for the question, which then has no answer.
    """

    question: Question
    tally: Tally
    columns: tuple[int, ...]
    problem: TraceProblem | None = None


def columns_of(questions: Iterable[Question]) -> list[tuple[int, ...]]:
    """The numbers that each question and its assumptions have in a goal that joins the goals of all, in their order.
    The assumption of a reward is its own goal."""
    columns: list[tuple[int, ...]] = []
    count = 0
    for question in questions:
        if question.is_conditional and question.is_reward:
            columns.append((count, count))
            count += 1
            continue
        size = 2 if question.is_conditional else 1
        columns.append(tuple(range(count, count + size)))
        count += size
    return columns


def answer_together(
    payload: Payload,
    inquiries: Sequence[Inquiry],
    options: Options,
    pool: Runner,
    watch: Callable[[Inquiry], None],
    pulse: Pulse | None = None,
) -> None:
    """Answer several questions with the same traces. Each answer is exactly that of `answer`, because each question
    has its own stopping rule, and the verdict of a trace on a question does not depend on the other questions.

    Args:
        payload: the goals of the questions of all inquiries.
        inquiries: their tallies contain the results; a trace that fails is stored in `problem`.
        watch: called for each question after each of its batches.
    """
    groups: dict[object, list[Inquiry]] = {}
    for inquiry in inquiries:
        if not inquiry.tally.is_finished:
            # Questions share traces only if the same numbers of traces have been generated for them before.
            key = (inquiry.tally.simulated, _limit(inquiry.question, options))
            groups.setdefault(key, []).append(inquiry)
    for group in groups.values():
        if _run(payload, group, options, pool, watch, pulse) is None:
            continue
        # The trace that failed need not concern all questions: with separate traces, some may have stopped before it.
        for inquiry in group:
            if not inquiry.tally.is_finished:
                inquiry.problem = _run(payload, [inquiry], options, pool, watch, pulse)


def _run(
    payload: Payload,
    inquiries: Sequence[Inquiry],
    options: Options,
    pool: Runner,
    watch: Callable[[Inquiry], None],
    pulse: Pulse | None,
    first: int = 0,
    scheduler: int = 0,
) -> TraceProblem | None:
    """Run traces until the questions are answered. The same number of traces was generated for all of them before.

    Returns:
        The trace that failed; `None` if there is none. If there are several questions, the results of its batch are
        discarded.
    """
    open_ = list(inquiries)
    done = inquiries[0].tally.simulated
    limit = _limit(inquiries[0].question, options)

    def tasks() -> Iterator[Task]:
        for start, size in batches(done, limit):
            columns = tuple(column for inquiry in open_ for column in inquiry.columns)
            counted = tuple(_counting(inquiry, columns, options) for inquiry in open_)
            yield Task(payload, options.seed, first + start, size, options.max_steps, scheduler, columns, counted)

    for task, outcome in pool.outcomes(tasks(), pulse):
        if outcome.problem is not None and len(inquiries) > 1:
            return outcome.problem
        counted = dict(zip((task.questions[c.columns[0]] for c in task.counted), outcome.counted, strict=True))
        for inquiry in tuple(open_):
            tally, question = inquiry.tally, inquiry.question
            results = counted[inquiry.columns[0]]
            if isinstance(results, Tally):
                tally.add(results)
            else:
                _test(inquiry, results, task.first, options)
            if outcome.problem is not None:
                return outcome.problem
            tally.is_finished = _is_enough(tally, question, options)
            watch(inquiry)
            if tally.is_finished:
                open_.remove(inquiry)
        if not open_:
            break
    for inquiry in open_:
        inquiry.tally.is_finished = True
    return None


def summary(question: Question, options: Options, tally: Tally) -> Answer:
    """The answer that follows from a tally, complete or not."""
    is_anytime = not tally.is_finished or _stops_freely(tally, options)
    bounds = bounds_of(tally, question, options, is_anytime)
    if question.is_reward:
        failures = tally.traces - tally.successes - tally.undecided
        value = math.inf if failures else tally.mean.mean
        complete = _is_narrow(tally, question, options, bounds)
    else:
        value = (tally.successes + tally.undecided / 2) / tally.traces if tally.traces else math.nan
        complete = tally.accepted is not None or _is_narrow(tally, question, options, bounds)
    return Answer(question, options, tally, value, bounds, complete, is_anytime)


def bounds_of(tally: Tally, question: Question, options: Options, is_anytime: bool = True) -> Bounds:
    """The interval of a tally.

    Args:
        is_anytime: whether the interval must be valid at any stopping time; otherwise it is valid only for the stopping
            rule of the method.
    """
    error = 1 - options.confidence
    confidence = (
        1 - error * stopping_error_share(options.confidence)
        if options.method is EstimationMethod.ADAPTIVE and not is_anytime
        else options.confidence
    )
    if question.is_reward:
        lower, upper = tally.mean.anytime_bounds(confidence) if is_anytime else tally.mean.bernstein_bounds(confidence)
        if tally.traces - tally.successes:
            upper = math.inf
            lower = math.inf if tally.traces - tally.successes - tally.undecided else lower
        return Bounds(lower, upper)
    interval = confidence_sequence if is_anytime else clopper_pearson
    return interval(tally.successes, tally.traces, confidence, tally.undecided)


def _stops_freely(tally: Tally, options: Options) -> bool:
    """Whether the number of traces depends on the results in a way for which only an anytime-valid interval is correct.
    This is the case after a sequential test, or if the options were changed after results were known."""
    return options.method is EstimationMethod.SPRT or tally.is_revised


def trace_count(options: Options) -> int | None:
    """The number of traces that a method determines in advance; `None` for the adaptive method and the sequential
    test."""
    if options.method is EstimationMethod.OKAMOTO:
        return okamoto(options.confidence, options.epsilon)
    return options.max_traces if options.method is EstimationMethod.FIXED else None


def _limit(question: Question, options: Options) -> int | None:
    """The maximum number of traces; `None` if there is no limit. Okamoto's number is not a limit for a question with
    assumptions, because it is not known in advance how many traces they accept."""
    required = None if question.is_conditional and options.method is EstimationMethod.OKAMOTO else trace_count(options)
    limits = [limit for limit in (options.max_traces, required) if limit is not None]
    return min(limits) if limits else None


def batches(done: int, limit: int | None) -> Iterator[tuple[int, int]]:
    """The first trace and the size of each batch after `done` traces."""
    while limit is None or done < limit:
        size = max(FIRST_BATCH_TRACES, min(MAX_BATCH_TRACES, int(done * BATCH_GROWTH)))
        if limit is not None:
            size = min(size, max(FIRST_BATCH_TRACES, int((limit - done) * BATCH_OF_REST)), limit - done)
        yield done, size
        done += size


def _counting(inquiry: Inquiry, columns: Sequence[int], options: Options) -> Counting:
    question = inquiry.question
    return Counting(
        tuple(columns.index(column) for column in inquiry.columns),
        inquiry.tally.room(),
        question.is_reward,
        question.can_be_late,
        ratio_of(question, options) is not None,
    )


def _test(inquiry: Inquiry, rows: Rows, first: int, options: Options) -> None:
    """Add traces up to the one after which the sequential test decides. `first` is the number of the first one."""
    tally, question = inquiry.tally, inquiry.question
    ratio, threshold = ratio_of(question, options), question.threshold
    assert ratio is not None
    assert threshold is not None
    traces = tally.traces
    good = tally.successes + (0 if threshold.is_lower else tally.undecided)
    size = 0
    for verdict in rows.verdicts:
        size += 1
        if verdict == REJECTED:
            continue
        traces += 1
        good += verdict == TRUE or (verdict == UNKNOWN and not threshold.is_lower)
        above = ratio.decision(good, traces)
        if above is not None:
            tally.accepted = above is threshold.is_lower
            break
    tally.add(rows.tally(_counting(inquiry, inquiry.columns, options), first, size))


def ratio_of(question: Question, options: Options) -> Ratio | None:
    """The sequential test; `None` if the options require another method, or the question has no threshold or is about
    rewards."""
    if options.method is not EstimationMethod.SPRT or question.threshold is None or question.is_reward:
        return None
    return Ratio(question.threshold.number, options.epsilon, 1 - options.confidence)


def _is_enough(tally: Tally, question: Question, options: Options) -> bool:
    if question.is_conditional:
        if tally.traces == 0 and tally.simulated >= MAX_REJECTED:
            return True
        if options.method is EstimationMethod.OKAMOTO:
            return tally.traces >= okamoto(options.confidence, options.epsilon)
    if options.method in (EstimationMethod.OKAMOTO, EstimationMethod.FIXED):
        return False
    if options.method is EstimationMethod.SPRT and ratio_of(question, options) is not None:
        return tally.accepted is not None
    if question.is_reward and tally.traces - tally.successes - tally.undecided:
        return True
    if tally.simulated >= MAX_REWARD_TRACES:
        return True
    if question.is_reward and tally.traces < MIN_REWARD_TRACES:
        return _is_hopeless(tally, options)
    if question.is_reward and tally.mean.is_constant and tally.traces >= MAX_EQUAL_TRACES:
        return True
    return _is_narrow(tally, question, options) or _is_hopeless(tally, options)


def _is_narrow(tally: Tally, question: Question, options: Options, bounds: Bounds | None = None) -> bool:
    if bounds is None:
        bounds = bounds_of(tally, question, options, _stops_freely(tally, options))
    if question.is_reward:
        if math.isinf(tally.mean.mean) or tally.traces == 0:
            return False
        if math.isinf(bounds.lower):
            return bounds.lower > 0
        return bounds.half_width <= options.epsilon * max(abs(tally.mean.mean), 1e-9)
    return bounds.half_width <= options.epsilon + 1e-12


def _is_hopeless(tally: Tally, options: Options) -> bool:
    """Whether there are too many undecided traces for any number of traces to make the interval narrow enough."""
    if tally.undecided == 0:
        return False
    share = clopper_pearson(tally.undecided, tally.traces, options.confidence)
    return share.lower > 2 * options.epsilon

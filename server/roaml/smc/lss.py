# SPDX-License-Identifier: Apache-2.0
"""The minimum and the maximum probability over schedulers, by sampling schedulers (Legay, Sedwards and Traonouez 2014).
A scheduler is a number, and its choice in a state is a hash of this number and the state.

Schedulers of four kinds are tried:

- memoryless schedulers;
- schedulers with memory of the last step;
- for each automaton, schedulers that take its edges only if nothing else is possible;
- for each automaton, schedulers that take its edges whenever possible.

Smart sampling (D'Argenio, Legay, Sedwards and Traonouez 2015): many schedulers are tried with few traces, then the
better half with more traces, until one is left. Its probability is then estimated with traces that were not used to
select it. So the interval is one for the probability under this scheduler; the true minimum or maximum may be more
extreme.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from roaml.exhaustive import Vocabulary
from roaml.record import Record, field, replace
from roaml.smc.batch import Payload, Task
from roaml.smc.goal import Question
from roaml.smc.pool import Pool, Pulse
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.run import Answer, EstimationMethod, Options, TraceFaultError, answer
from roaml.smc.tally import Tally

INITIAL_SCHEDULERS = 256
"""The initial number of memoryless schedulers."""
FIRST_ROUND_TRACES = 16
"""The number of traces for each scheduler in the first round; it doubles in each further round."""
LEAST_SCHEDULERS = 4
"""The number of schedulers that are tried even if traces are very long."""
MIN_ROUNDS_IF_CERTAIN = 3
"""The number of rounds after which the search ends if all traces of a scheduler have failed (minimum) or succeeded
(maximum)."""
UNIFORM_TRACES = 100
"""The number of traces with uniform choices, to measure their length."""
MAX_PROBE_TRACES = 6
"""The maximum number of traces for each scheduler in the first round of `probe`."""
FIRST_SELECTION_TRACE = 1 << 40
"""Traces with this number or a greater one are used to select schedulers."""

# The number of a scheduler consists of its kind, an automaton of the system, and an index. The kernel decodes it.
MEMORY, STARVE, FAVOUR = 1 << 56, 2 << 56, 4 << 56
_KIND_MASK = 7 << 56
_AUTOMATON_SHIFT = 32
_INDEX_MASK = (1 << _AUTOMATON_SHIFT) - 1


class Extremes(Record, frozen=True):
    """The probabilities under the selected schedulers.

    Attributes:
        least, greatest: the answers under the scheduler selected for the minimum, and under the one for the maximum.
        least_by, greatest_by: the numbers of these schedulers.
        tried: the number of schedulers that were tried.
    """

    least: Answer
    greatest: Answer
    least_by: int
    greatest_by: int
    tried: int = 0


def described(scheduler: int, actors: Sequence[str]) -> str:
    """A phrase for users that describes a scheduler.

    Args:
        actors: a noun phrase for each element of the system.
    """
    kind, number = scheduler & _KIND_MASK, scheduler & _INDEX_MASK
    actor = actors[(scheduler & ~_KIND_MASK) >> _AUTOMATON_SHIFT]
    does = {
        STARVE: f"lets {actor} proceed only where nothing else can proceed",
        FAVOUR: f"lets {actor} proceed wherever possible",
        MEMORY: "always makes the same choice after the same step in the same state",
    }
    return f"sampled scheduler {number}, which {does.get(kind, 'always makes the same choice in the same state')}"


def candidates(
    automata: int, per_automaton: int = 2, memoryless: int = INITIAL_SCHEDULERS, memory: int = INITIAL_SCHEDULERS // 4
) -> list[int]:
    """The numbers of the schedulers that are tried.

    Args:
        automata: the number of automata of the system.
        per_automaton: for each automaton, the number of schedulers that starve it; the same number of schedulers favour
            it.
        memoryless, memory: the number of schedulers that decide by the state alone, and of those that also decide by
            the last step.
    """
    biased = [
        kind | (automaton << _AUTOMATON_SHIFT) | number
        for number in range(1, per_automaton + 1)
        for automaton in range(automata)
        for kind in (STARVE, FAVOUR)
    ]
    remembering = [MEMORY | number for number in range(1, memory + 1)]
    return [*range(1, memoryless + 1), *biased, *remembering]


class Side(Vocabulary):
    """The probability that is searched for. Its value is its name in JSON."""

    LEAST = "least"
    GREATEST = "greatest"

    @property
    def extreme(self) -> str:
        """The word of reports: `minimum` or `maximum`."""
        return "minimum" if self is Side.LEAST else "maximum"


class SelectedScheduler(NamedTuple):
    """The selected scheduler for the minimum or the maximum probability, and its traces."""

    scheduler: int
    tally: Tally


class Search(Record):
    """The progress of a search for schedulers, updated during the search. If the search is interrupted, it contains the
    results so far.

    Attributes:
        side: whether the minimum or the maximum is currently searched for.
        round, rounds: the current round of the selection and the number of rounds; each keeps the better half.
        left: the number of schedulers that are tried in this round.
        done: the number of these that have been tried.
        best: the best share of successes of a scheduler in the last round; `None` before the end of the first round.
        tried: the initial number of schedulers.
        selected: the selected scheduler of each side and its traces so far.
    """

    side: Side = Side.LEAST
    round: int = 0
    rounds: int = 0
    left: int = 0
    done: int = 0
    best: float | None = None
    tried: int = 0
    selected: dict[Side, SelectedScheduler] = field(default_factory=dict)


def search(
    payload: Payload,
    question: Question,
    options: Options,
    pool: Pool,
    schedulers: Sequence[int],
    state: Search,
    watch: Callable[[Search], None] | None = None,
    pulse: Pulse | None = None,
) -> None:
    """Search for schedulers that minimise and maximise the probability.

    Args:
        state: receives the intermediate results.
        watch: called after each scheduler that was tried, and after each batch of traces with the selected one.

    Raises:
        TraceFaultError: a trace failed.
    """
    report = watch or (lambda _: None)
    usual = answer(
        payload, question, replace(options, method=EstimationMethod.FIXED, max_traces=UNIFORM_TRACES), pool, pulse=pulse
    ).tally
    usual_steps = usual.steps / usual.traces
    schedulers = schedulers[: affordable_schedulers(len(schedulers), usual_steps)]
    state.tried = len(schedulers)
    longest = min(options.max_steps, _longest(usual_steps))
    for side in Side:
        state.side, state.round, state.best = side, 0, None
        best = _best(payload, replace(options, max_steps=longest), pool, schedulers, state, report, pulse)
        state.selected[side] = SelectedScheduler(best, Tally())
        plain = sampling_options(options)
        tally = state.selected[side].tally
        answer(payload, question, plain, pool, tally, lambda _: report(state), pulse, scheduler=best)


def affordable_schedulers(count: int, length: float) -> int:
    """How many of `count` schedulers are tried: so many that the traces of the selection have about
    `affordable.MAX_STEPS` steps together, at least `LEAST_SCHEDULERS`. Each round has as many traces as the first one.

    Args:
        length: the average length of a trace with uniform choices.
    """
    from roaml.smc import affordable  # noqa: PLC0415 - most verifications search for no schedulers

    most = affordable.MAX_STEPS / FIRST_ROUND_TRACES / max(length, 1)
    while count > LEAST_SCHEDULERS and count * (count - 1).bit_length() > most:
        count -= 1
    return count


def _longest(length: float) -> int:
    """The number of steps after which a trace is abandoned while schedulers are tried. The limit is needed because many
    schedulers repeat cycles for ever.

    Args:
        length: the average length of a trace with uniform choices.
    """
    return int(20 * length) + 1000


def sampling_options(options: Options) -> Options:
    """The options for the estimate under a selected scheduler, in which the adaptive method replaces the sequential
    test."""
    return replace(options, method=EstimationMethod.ADAPTIVE) if options.method is EstimationMethod.SPRT else options


def probe(
    payload: Payload,
    question: Question,
    options: Options,
    pool: Pool,
    schedulers: Sequence[int],
    budget: int,
    length: float,
    pulse: Pulse | None = None,
) -> Extremes | None:
    """Search in two rounds: a few traces for each scheduler, then more traces for the schedulers with the smallest and
    the greatest share of successes.

    A trace that is much longer than usual is abandoned, and is undecided.

    Args:
        budget: the approximate number of steps of each round. If it is small, only the first schedulers are tried.
        length: the average length of a trace with uniform choices.

    Returns:
        `None` if the budget is too small, or no trace was decided.

    Raises:
        TraceFaultError: a trace failed.
    """
    longest = min(options.max_steps, max(_longest(length), budget // 2))
    traces = int(budget / max(1.0, length))
    if traces < 4:
        return None
    chosen = schedulers[:traces]
    size = max(1, min(MAX_PROBE_TRACES, traces // len(chosen)))
    tasks = (Task(payload, options.seed, FIRST_SELECTION_TRACE, size, longest, number) for number in chosen)
    shares: dict[int, float] = {}
    lengths: dict[int, float] = {}
    spent = 0
    for task, outcome in pool.outcomes(tasks, pulse):
        if outcome.problem is not None:
            raise TraceFaultError(outcome.problem)
        rows = outcome.questions[0]
        decided = [verdict == TRUE for verdict, steps in zip(rows.verdicts, rows.steps, strict=True)
                   if verdict in (TRUE, FALSE)]  # fmt: skip
        spent += sum(rows.steps)
        if decided:
            shares[task.scheduler] = sum(decided) / len(decided)
            lengths[task.scheduler] = sum(rows.steps) / len(rows.steps)
        if spent > 2 * budget:
            break
    if not shares:
        return None
    least_by, greatest_by = min(shares, key=shares.__getitem__), max(shares, key=shares.__getitem__)
    answers: dict[int, Answer] = {}
    for best in dict.fromkeys((least_by, greatest_by)):
        max_traces = max(20, min(400, int(budget / 2 / max(1.0, lengths[best]))))
        fixed = replace(options, method=EstimationMethod.FIXED, max_traces=max_traces, max_steps=longest)
        answers[best] = answer(payload, question, fixed, pool, pulse=pulse, scheduler=best)
    return Extremes(answers[least_by], answers[greatest_by], least_by, greatest_by, len(shares))


def _best(
    payload: Payload,
    options: Options,
    pool: Pool,
    schedulers: Sequence[int],
    state: Search,
    report: Callable[[Search], None],
    pulse: Pulse | None,
) -> int:
    """The scheduler with the smallest or greatest share of successes; an undecided trace is half a success."""
    sign = 1 if state.side is Side.GREATEST else -1
    candidates = dict.fromkeys(schedulers, (0.0, 0))
    tried, first = FIRST_ROUND_TRACES, FIRST_SELECTION_TRACE
    state.rounds = (len(candidates) - 1).bit_length()
    while len(candidates) > 1:
        state.round, state.left, state.done = state.round + 1, len(candidates), 0
        tasks = [Task(payload, options.seed, first, tried, options.max_steps, number) for number in candidates]
        for task, outcome in pool.outcomes(tasks, pulse):
            if outcome.problem is not None:
                raise TraceFaultError(outcome.problem)
            successes, traces = candidates[task.scheduler]
            verdicts = outcome.questions[0].verdicts
            good = verdicts.count(TRUE) + verdicts.count(UNKNOWN) / 2
            candidates[task.scheduler] = successes + good, traces + tried
            state.done += 1
            report(state)
        ranked = sorted(candidates, key=lambda n: (-sign * candidates[n][0] / candidates[n][1], n))
        successes, traces = candidates[ranked[0]]
        state.best = successes / traces
        candidates = {number: candidates[number] for number in ranked[: (len(ranked) + 1) // 2]}
        if state.round >= MIN_ROUNDS_IF_CERTAIN and state.best == max(sign, 0):
            return ranked[0]  # A more extreme value is impossible.
        first += tried
        tried *= 2
    return next(iter(candidates))

# SPDX-License-Identifier: Apache-2.0
"""The least and the greatest probability over schedulers, by sampling schedulers (Legay, Sedwards and Traonouez 2014):
a scheduler is a number, and its choice in a state a hash of both.

Four kinds are tried, each with many numbers:

- memoryless ones;
- some with memory: what was done last counts, too;
- for each automaton some that take its edges only where nothing else is possible;
- for each automaton some that take its edges wherever that is possible.

Smart sampling (D'Argenio, Legay, Sedwards and Traonouez 2015): many schedulers are tried a little, the better half is
tried more, until one is left. What it achieves is then estimated with traces that had no part in choosing it. So the
interval is one for the probability under the scheduler that was found; the true least or greatest probability may be
farther out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from roaml.smc.batch import Payload, Task
from roaml.smc.goal import Question
from roaml.smc.pool import Pool, Pulse
from roaml.smc.program import FALSE, TRUE
from roaml.smc.run import FIXED, SPRT, Answer, Options, TraceFaultError, Watch, answer

SCHEDULERS = 256
"""So many memoryless ones are tried at first."""
TRIED = 16
"""Traces for each in the first round; in each further round there are twice as many."""
PROBED = 6
"""Traces for each scheduler where the budget is small."""
LARGE = 1 << 40
"""Numbers of traces from here on are for choosing schedulers."""

# The number of a scheduler: its kind, an automaton of the system, and which of those it is. The kernel reads it.
MEMORY, STARVE, FAVOUR = 1 << 56, 2 << 56, 4 << 56
_KINDS = 7 << 56
_AUTOMATON = 32
_NUMBERS = (1 << _AUTOMATON) - 1


@dataclass(frozen=True, slots=True)
class Extremes:
    """What the schedulers that were found achieve. `least_by` and `greatest_by` are their numbers; `tried`: how many
    were tried."""

    least: Answer
    greatest: Answer
    least_by: int
    greatest_by: int
    tried: int = 0


def described(scheduler: int, automata: Sequence[str]) -> str:
    """A scheduler in words.

    Args:
        automata: the names of the elements of the system.
    """
    kind, number = scheduler & _KINDS, scheduler & _NUMBERS
    name = automata[(scheduler & ~_KINDS) >> _AUTOMATON]
    if kind == STARVE:
        return f"scheduler {number} that makes {name} wait"
    if kind == FAVOUR:
        return f"scheduler {number} that prefers {name}"
    return f"scheduler {number} with memory" if kind == MEMORY else f"scheduler {number}"


def candidates(automata: int, each: int = 2, memoryless: int = SCHEDULERS, memory: int = SCHEDULERS // 4) -> list[int]:
    """Numbers of schedulers.

    Args:
        automata: how many the system has.
        each: so many of both kinds for each automaton.
        memoryless, memory: so many of these kinds.
    """
    biased = [
        kind | (automaton << _AUTOMATON) | number
        for number in range(1, each + 1)
        for automaton in range(automata)
        for kind in (STARVE, FAVOUR)
    ]
    remembering = [MEMORY | number for number in range(1, memory + 1)]
    return [*range(1, memoryless + 1), *biased, *remembering]


def extremes(
    payload: Payload,
    question: Question,
    options: Options,
    pool: Pool,
    schedulers: Sequence[int],
    watch: Watch | None = None,
    pulse: Pulse | None = None,
) -> Extremes:
    """Look for schedulers under which the probability is small, and such under which it is great.

    Raises:
        TraceFaultError: a trace went wrong.
    """
    found = []
    for sign in (-1, 1):
        best = _best(payload, options, pool, schedulers, sign, pulse)
        plain = replace(options, method=options.method if options.method != SPRT else "adaptive")
        found.append((answer(payload, question, plain, pool, watch=watch, pulse=pulse, scheduler=best), best))
    (least, least_by), (greatest, greatest_by) = found
    return Extremes(least, greatest, least_by, greatest_by, len(schedulers))


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
    """The same with about so many steps as `budget`: one round for all schedulers, then some traces for the two best.

    A trace that is far longer than usual is given up, and counts as undecided.

    Args:
        budget: steps in the first round, and again in the second.
        length: of an average trace with uniform choices.

    Returns:
        None if the budget suffices for no choice.

    Raises:
        TraceFaultError: a trace went wrong.
    """
    longest = min(options.max_steps, max(int(20 * length) + 1000, budget // 2))
    traces = int(budget / max(1.0, length))
    if traces < 4:
        return None
    chosen = schedulers[:traces]
    size = max(1, min(PROBED, traces // len(chosen)))
    tasks = (Task(payload, options.seed, LARGE, size, longest, number) for number in chosen)
    shares: dict[int, float] = {}
    lengths: dict[int, float] = {}
    spent = 0
    for task, outcome in pool.outcomes(tasks, pulse):
        if outcome.problem is not None:
            raise TraceFaultError(outcome.problem)
        decided = [verdict == TRUE for verdict, steps in zip(outcome.verdicts, outcome.steps, strict=True)
                   if verdict in (TRUE, FALSE)]  # fmt: skip
        spent += sum(outcome.steps)
        if decided:
            shares[task.scheduler] = sum(decided) / len(decided)
            lengths[task.scheduler] = sum(outcome.steps) / len(outcome.steps)
        if spent > 2 * budget:
            break
    if not shares:
        return None
    found = []
    for best in (min(shares, key=shares.__getitem__), max(shares, key=shares.__getitem__)):
        wanted = max(20, min(400, int(budget / 2 / max(1.0, lengths[best]))))
        fixed = replace(options, method=FIXED, max_traces=wanted, max_steps=longest)
        found.append((answer(payload, question, fixed, pool, pulse=pulse, scheduler=best), best))
    (least, least_by), (greatest, greatest_by) = found
    return Extremes(least, greatest, least_by, greatest_by, len(shares))


def _best(
    payload: Payload, options: Options, pool: Pool, schedulers: Sequence[int], sign: int, pulse: Pulse | None
) -> int:
    """The scheduler with the greatest share of successes, times `sign`."""
    candidates = dict.fromkeys(schedulers, (0, 0))
    tried, first = TRIED, LARGE
    while len(candidates) > 1:
        tasks = [Task(payload, options.seed, first, tried, options.max_steps, number) for number in candidates]
        for task, outcome in pool.outcomes(tasks, pulse):
            if outcome.problem is not None:
                raise TraceFaultError(outcome.problem)
            successes, traces = candidates[task.scheduler]
            candidates[task.scheduler] = successes + outcome.verdicts.count(TRUE), traces + tried
        ranked = sorted(candidates, key=lambda n: (-sign * candidates[n][0] / candidates[n][1], n))
        candidates = {number: candidates[number] for number in ranked[: (len(ranked) + 1) // 2]}
        first += tried
        tried *= 2
    return next(iter(candidates))

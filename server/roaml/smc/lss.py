# SPDX-License-Identifier: Apache-2.0
"""The least and the greatest probability over memoryless schedulers, by sampling schedulers (Legay, Sedwards and
Traonouez 2014): a scheduler is a number, and its choice in a state a hash of both.

Smart sampling (D'Argenio, Legay, Sedwards and Traonouez 2015): many schedulers are tried a little, the better half is
tried more, until one is left. What it achieves is then estimated with traces that had no part in choosing it. So the
interval is one for the probability under the scheduler that was found; the true least or greatest probability may be
farther out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from roaml.smc.batch import Payload, Task
from roaml.smc.goal import Question
from roaml.smc.pool import Pool, Pulse
from roaml.smc.program import TRUE
from roaml.smc.run import Answer, Options, TraceFaultError, Watch, answer

SCHEDULERS = 256
"""So many are tried at first."""
TRIED = 16
"""Traces for each in the first round; in each further round there are twice as many."""
LARGE = 1 << 40
"""Numbers of traces from here on are for choosing schedulers."""


@dataclass(frozen=True, slots=True)
class Extremes:
    """What the schedulers that were found achieve. `least_by` and `greatest_by` are their numbers."""

    least: Answer
    greatest: Answer
    least_by: int
    greatest_by: int


def extremes(
    payload: Payload,
    question: Question,
    options: Options,
    pool: Pool,
    schedulers: int = SCHEDULERS,
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
        plain = replace(options, method=options.method if options.method != "sprt" else "adaptive")
        found.append((answer(payload, question, plain, pool, watch=watch, pulse=pulse, scheduler=best), best))
    (least, least_by), (greatest, greatest_by) = found
    return Extremes(least, greatest, least_by, greatest_by)


def _best(payload: Payload, options: Options, pool: Pool, schedulers: int, sign: int, pulse: Pulse | None) -> int:
    """The scheduler with the greatest share of successes, times `sign`."""
    candidates = dict.fromkeys(range(1, schedulers + 1), (0, 0))
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

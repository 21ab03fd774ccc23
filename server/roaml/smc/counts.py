# SPDX-License-Identifier: Apache-2.0
"""Counts the results of a batch of traces for one question.

Plain Python; Cython compiles it with the types in `counts.pxd`, like the kernel, because the traces of a model with few
states take less time than a loop of Python over their results. The worker that has generated the traces counts them.
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING

from roaml.smc.end import End
from roaml.smc.statistics import Mean
from roaml.smc.tally import Ended, StoredTrace, Tally

if TYPE_CHECKING:
    from collections.abc import Sequence

    from roaml.smc.program import Ints, Reals

FALSE, TRUE, UNKNOWN, REJECTED = 0, 1, 2, 4
DECIDED, TIME = 0, 1
CLOSED, IDLE = 0, 1
"""As in `tally.REJECTED`, `end.End` and `goal.Activity`."""
CELLS, CELLS_PER_VERDICT = 48, 16
"""The number of combinations of a verdict and a reason of the end, and that of the combinations of a verdict."""


def compiled() -> bool:
    """Whether this module is the compiled extension."""
    return not __file__.endswith(".py")


def count(
    verdicts: bytes, ends: bytes, steps: Ints, activities: bytes, rewards: Reals, first: int, kept: Sequence[int],
    can_be_late: int,
) -> Tally:  # fmt: skip
    """The results of traces in a few numbers.

    Args:
        verdicts, ends, steps, activities: those of each trace (see `batch.Rows`). The verdict REJECTED is that on a
            trace that violates the assumptions of the question.
        rewards: those of each trace, whose mean is computed; empty if the question is not about rewards.
        first: the number of the first trace.
        kept: the number of traces that are stored as examples for each of the verdicts FALSE, TRUE and UNKNOWN.
        can_be_late: 1 if traces can fail because the time ends too early; see `Tally.late`.
    """
    size = len(steps)
    verdict_of, end_of, activity_of, steps_of, reward_of = verdicts, ends, activities, steps, rewards
    has_rewards = 1 if len(rewards) == size else 0
    numbers = array("q", bytes(8 * CELLS))
    shortest = array("q", bytes(8 * CELLS))
    shortest_at = array("q", bytes(8 * CELLS))
    room = array("q", kept)
    examples: tuple[list[StoredTrace], list[StoredTrace], list[StoredTrace]] = ([], [], [])
    order = []
    total = rejected = closed = idle = successes = 0
    mean = squares = 0.0
    least, greatest = math.inf, -math.inf
    for i in range(size):
        verdict = verdict_of[i]
        length = steps_of[i]
        total += length
        if verdict == REJECTED:
            rejected += 1
            continue
        cell = verdict * CELLS_PER_VERDICT + end_of[i]
        if numbers[cell] == 0:
            order.append(cell)
        if numbers[cell] == 0 or length < shortest[cell]:
            shortest[cell] = length
            shortest_at[cell] = i
        numbers[cell] += 1
        if room[verdict] > 0:
            room[verdict] -= 1
            examples[verdict].append(StoredTrace(first + i, length))
        activity = activity_of[i]
        if end_of[i] == DECIDED:  # the trace shows what the property asks for
            pass
        elif activity == CLOSED:
            closed += 1
        elif activity == IDLE:
            idle += 1
        if verdict == TRUE and has_rewards != 0:
            # Welford 1962
            successes += 1
            step = reward_of[i] - mean
            mean += step / successes
            squares += step * (reward_of[i] - mean)
            least = min(least, reward_of[i])
            greatest = max(greatest, reward_of[i])
    tally = Tally(traces=size - rejected, steps=total, rejected=rejected, closed=closed, idle=idle)
    tally.mean = Mean(successes, mean, squares, least, greatest)
    tally.examples = {FALSE: examples[FALSE], TRUE: examples[TRUE], UNKNOWN: examples[UNKNOWN]}
    for cell in order:
        verdict = cell // CELLS_PER_VERDICT
        number = numbers[cell]
        trace = StoredTrace(first + shortest_at[cell], shortest[cell])
        if verdict == TRUE:
            tally.successes += number
        elif verdict == UNKNOWN:
            tally.undecided += number
        elif can_be_late != 0 and cell % CELLS_PER_VERDICT == TIME:
            tally.late += number
        known = tally.shortest.get(verdict)
        if known is None or (trace.steps, trace.trace) < (known.steps, known.trace):
            tally.shortest[verdict] = trace
        end = End(cell % CELLS_PER_VERDICT)
        ended = tally.ends.get(end)
        if ended is None:
            tally.ends[end] = Ended(number, trace)
            continue
        ended.count += number
        if (trace.steps, trace.trace) < (ended.shortest.steps, ended.shortest.trace):
            ended.shortest = trace
    return tally

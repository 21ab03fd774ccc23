# SPDX-License-Identifier: Apache-2.0
"""Quantiles of a reward from traces with uniform choices (docs/verification.md#quantiles).

- The interval of a quantile is between two order statistics: how many of n traces have a reward that is at most the
  quantile is binomial, whatever the distribution is. So it is right for any number of traces, and no reward is assumed
  to be impossible. All intervals are right together (Bonferroni).
- A trace that never reaches the condition of the reward has an infinite reward; under a condition, it is left out.
- A trace that was cut might have gone on in any way: the lower end of an interval assumes that its reward is the least
  possible, the upper end that it is infinite.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from roaml.experiments.traces import TraceEnd, trajectories
from roaml.record import replace
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, UNKNOWN
from roaml.smc.run import Options
from roaml.verification.results import RewardQuantile

QUANTILE_TRACES = 10_000
"""The number of traces, if it is not given and they are not long."""


def reward_quantiles(
    checker: ModelChecker, property_: CompiledProperty, shares: Sequence[float], options: Options
) -> tuple[RewardQuantile, ...]:
    """The quantiles of a reward.

    Args:
        options: the confidence, that of all intervals together; the number of traces (`max_traces`; `None` for
            `QUANTILE_TRACES`, or fewer if they are long), the limit of steps and the seed.

    Raises:
        FaultError: a trace executes an undefined operation.
    """
    traces = trajectories(checker, property_, options, None)
    chosen = traces.affordable(QUANTILE_TRACES) if options.max_traces is None else None
    ends = traces.ends(options.max_traces or QUANTILE_TRACES if chosen is None else chosen.traces)
    found = quantiles_of(ends, shares, options.confidence, is_conditional=property_.question.is_conditional)
    remark = "" if chosen is None else chosen.remark
    return tuple(replace(quantile, max_steps=options.max_steps, remark=remark) for quantile in found)


def quantiles_of(
    ends: Iterable[TraceEnd], shares: Sequence[float], confidence: float, *, is_conditional: bool
) -> tuple[RewardQuantile, ...]:
    """The quantiles of the rewards of traces; none if there are no traces that satisfy the condition.

    Args:
        is_conditional: whether traces that do not reach the condition of the reward are left out.
    """
    known, cut = [], 0
    for end in ends:
        if end.verdict == UNKNOWN:
            cut += 1
        elif end.verdict != FALSE:
            known.append(end.reward)
        elif not is_conditional:
            known.append(math.inf)
    known.sort()
    count = len(known) + cut
    error = (1 - confidence) / max(1, len(shares)) / 2
    return tuple(
        RewardQuantile(
            share,
            value_of_rank(known, math.ceil(share * count - 1e-9)),
            value_of_rank(known, _greatest_rank(count, share, error) - cut),
            value_of_rank(known, count + 1 - _greatest_rank(count, 1 - share, error)),
            count,
            cut,
        )
        for share in shares
        if count
    )


def value_of_rank(known: Sequence[float], rank: int) -> float:
    """The value of a rank from 1; an infinity if it is not known."""
    if rank < 1:
        return -math.inf
    return known[rank - 1] if rank <= len(known) else math.inf


def _greatest_rank(count: int, share: float, error: float) -> int:
    """The greatest r such that less than r of `count` traces have a share with a probability of at most `error`: the
    distribution function of the binomial distribution at r - 1; 0 if there is none."""
    log_share, log_rest = math.log(share), math.log1p(-share)
    total, rank = 0.0, 0
    while rank < count:
        total += math.exp(
            math.lgamma(count + 1)
            - math.lgamma(rank + 1)
            - math.lgamma(count - rank + 1)
            + rank * log_share
            + (count - rank) * log_rest
        )
        if total > error:
            return rank
        rank += 1
    return rank

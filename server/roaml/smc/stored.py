# SPDX-License-Identifier: Apache-2.0
"""Validates a tally from a file: since a file may have been changed, it checks whether traces can have produced the
tally."""

from __future__ import annotations

import math
from typing import Any

from roaml.smc.goal import Question
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.run import EstimationMethod, Options
from roaml.smc.statistics import Mean
from roaml.smc.tally import MAX_KEPT_TRACES, StoredTrace, Tally

_MAX_COUNT = 1 << 62
"""A limit that no counter reaches."""


def tally_from_json(value: Any, question: Question, options: Options) -> Tally:
    """A tally that `Tally.to_json` has written.

    Args:
        value: the value that a JSON parser has returned.
        question, options: the question and the options of the traces.

    Raises:
        ValueError: the value does not have this form, or its numbers contradict each other; the message names the part.
    """
    shape = _row(value, "tally")
    for key in ("traces", "successes", "undecided", "steps", "rejected", "closed", "idle", "late"):
        _whole(shape.get(key), key)
    for key in ("finished", "revised"):
        _expect(isinstance(shape.get(key), bool), key)
    _expect(shape.get("accepted") in (None, True, False), "accepted")
    mean = shape.get("mean")
    if not isinstance(mean, list) or len(mean) != 5 or not all(isinstance(term, str) for term in mean[1:]):
        raise ValueError("`mean` is invalid")
    _whole(mean[0], "mean")
    for row in _row(shape.get("ends"), "ends").values():
        _expect(isinstance(row, list) and len(row) == 3, "ends")
        for number in row:
            _whole(number, "ends")
    examples, shortest = _row(shape.get("examples"), "examples"), _row(shape.get("shortest"), "shortest")
    _expect(set(examples) == {str(verdict) for verdict in _VERDICTS}, "examples")
    _expect(set(shortest) <= set(examples), "shortest")
    for seen in examples.values():
        _expect(isinstance(seen, list) and len(seen) <= MAX_KEPT_TRACES, "examples")
        for example in seen:
            _pair(example, "examples")
    for example in shortest.values():
        _pair(example, "shortest")
    try:
        tally = Tally.from_json(shape)
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError):
        raise ValueError("it does not contain the state of a verification") from None
    _expect(sum(ended.count for ended in tally.ends.values()) == tally.traces, "ends")
    _expect(all(ended.count > 0 for ended in tally.ends.values()), "ends")
    _check_sums(tally, question, options)
    return tally


def _check_sums(tally: Tally, question: Question, options: Options) -> None:
    failures = tally.traces - tally.successes - tally.undecided
    _expect(failures >= 0, "traces")
    _expect(tally.rejected == 0 or question.is_conditional, "rejected")
    _expect(tally.closed + tally.idle <= (tally.traces if question.can_be_vacuous else 0), "idle")
    _expect(tally.late <= (failures if question.can_be_late else 0), "late")
    _expect(tally.steps <= tally.simulated * options.max_steps, "steps")
    mean = tally.mean
    _expect(mean.number == (tally.successes if question.is_reward else 0), "mean")
    _expect(math.isfinite(mean.mean) and math.isfinite(mean.squares) and mean.squares >= 0, "mean")
    _expect(mean.number > 0 or mean == Mean(), "mean")
    _expect(mean.number == 0 or mean.least <= mean.greatest, "mean")
    _expect(tally.accepted is None or options.method is EstimationMethod.SPRT or tally.is_finished, "accepted")
    counts = {TRUE: tally.successes, FALSE: failures, UNKNOWN: tally.undecided}
    numbers: set[int] = set()
    total = 0
    for verdict, count in counts.items():
        seen = tally.examples[verdict]
        _expect(len(seen) == min(count, MAX_KEPT_TRACES), "examples")
        _expect([example.trace for example in seen] == sorted({example.trace for example in seen}), "examples")
        numbers.update(example.trace for example in seen)
        total += sum(example.steps for example in seen)
        _expect((verdict in tally.shortest) == (count > 0), "shortest")
        if count:
            least: StoredTrace = tally.shortest[verdict]
            first = min(seen, key=lambda example: (example.steps, example.trace))
            _expect(least == first if count <= MAX_KEPT_TRACES else least.steps <= first.steps, "shortest")
            _expect(least.trace < tally.simulated, "shortest")
        for example in seen:
            _expect(example.trace < tally.simulated and example.steps <= options.max_steps, "examples")
    _expect(len(numbers) == sum(len(seen) for seen in tally.examples.values()), "examples")
    _expect(total == tally.steps if tally.simulated == len(numbers) else total <= tally.steps, "steps")


_VERDICTS = (TRUE, FALSE, UNKNOWN)


def _expect(holds: bool, key: str) -> None:
    if not holds:
        raise ValueError(f"the value of `{key}` is impossible")


def _row(value: Any, key: str) -> dict[str, Any]:
    _expect(isinstance(value, dict), key)
    row: dict[str, Any] = value
    return row


def _whole(value: Any, key: str) -> None:
    _expect(isinstance(value, int) and not isinstance(value, bool) and 0 <= value < _MAX_COUNT, key)


def _pair(value: Any, key: str) -> None:
    _expect(isinstance(value, list) and len(value) == 2, key)
    for number in value:
        _whole(number, key)

# SPDX-License-Identifier: Apache-2.0
"""Differences of values: exact ones, and the coverage of the intervals of sampled ones against closed forms."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from test_grid import retry, write

from roaml import api
from roaml.api.comparing import compare_values
from roaml.experiments.changes import ValueChange, ValueVerdict
from roaml.experiments.grid import ExperimentOptions
from roaml.smc.run import EstimationMethod, Options
from roaml.verification.target import VerificationTarget

RUNS = 300


def target(path: str, p: str) -> VerificationTarget:
    return api.target(path, constants=[f"p={p}", "q=0", "tries=2"])


def change(path: str, before: str, after: str, options: ExperimentOptions | None = None) -> ValueChange:
    (value,) = compare_values(target(path, before), target(path, after), ["most"], options)
    return value


def test_exact(tmp_path: Path) -> None:
    """With two attempts, the probability is 1 - (1 - p)²."""
    path = write(tmp_path, retry())
    value = change(path, "0.1", "0.5")
    assert value.verdict is ValueVerdict.CHANGED
    assert value.is_exact
    assert value.change == pytest.approx(0.75 - 0.19, abs=1e-12)
    assert change(path, "0.3", "0.3").verdict is ValueVerdict.SAME
    assert change(path, "0.3", "0.30000001").verdict is ValueVerdict.CHANGED


@pytest.mark.parametrize(("before", "after"), [("0.2", "0.2"), ("0.2", "0.25"), ("0.2", "0.4")])
def test_intervals_cover_the_difference(tmp_path: Path, before: str, after: str) -> None:
    """In 300 runs, the interval misses the difference at most as often as a confidence of 0.9 permits: 30 times are
    expected at most; more than 48 have a probability below 0.001 (binomial). A true change is never reported with the
    wrong sign, and no change where there is none, more often."""
    path = write(tmp_path, retry())
    truth = (1 - (1 - float(after)) ** 2) - (1 - (1 - float(before)) ** 2)
    missed = wrong = 0
    for seed in range(RUNS):
        sampling = Options(confidence=0.9, method=EstimationMethod.FIXED, max_traces=200, seed=seed)
        value = change(path, before, after, ExperimentOptions(sampling, exact=False))
        low, high = value.difference
        missed += not low <= truth <= high
        wrong += value.verdict is ValueVerdict.CHANGED and not (
            truth and math.copysign(1, value.change) == math.copysign(1, truth)
        )
    assert missed <= 48
    assert wrong <= 48

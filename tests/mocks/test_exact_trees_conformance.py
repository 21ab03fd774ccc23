# SPDX-License-Identifier: Apache-2.0
"""The probability of success of trees of Nav2 does not depend on the reaction time of their nodes."""

from __future__ import annotations

import pytest

import conformance
from roaml import api
from roaml.api.trees import load_tree
from roaml.durations import ANY_TIME
from roaml.experiments.exact_trees import measure_exactly
from roaml.mocks.mock import read_mock
from roaml.mocks.network import MockOptions
from roaml.verification.small import SHARED_LIMITS


@pytest.mark.parametrize("name", ["follow_point", "navigate_w_replanning_time", "odometry_calibration"])
def test_reaction_times_do_not_change_success(name: str) -> None:
    path = str(conformance.ROOT / "trees" / "nav2" / f"{name}.xml")
    mocks = (read_mock("*: 0.9 in 1 s"),)
    at_once = load_tree(path, MockOptions(mocks, counts=True))
    any_time = load_tree(path, MockOptions(mocks, counts=True, reaction_time=ANY_TIME))
    outcome = measure_exactly(at_once.mocked, at_once.target, SHARED_LIMITS)
    (found,) = api.verify(any_time.target, ["succeeds"], exact_if_small=True)
    assert found.exact is not None
    assert found.exact.least == pytest.approx(outcome.success.value, abs=1e-9)
    assert found.exact.greatest == pytest.approx(outcome.success.value, abs=1e-9)

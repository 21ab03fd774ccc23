# SPDX-License-Identifier: Apache-2.0
"""Storm reads the translation of every conformance model, and finds in it what it finds in the reference's."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest
from storm import Exact, exact, read

import conformance
from conformance_systems import load
from roaml import api

# System, property: probability and number of states that Storm 1.11.3 found in the reference's translation.
# Those of more than 50,000 states, and one whose states take long to build, are left to the
# benchmarks; reals have infinitely many.
PROBABILITIES = {
    ("ros_example/main.xml", "battery_depleted"): Exact(1, 1, 3646),
    ("ros_example/main.xml", "battery_over_depleted"): Exact(0, 0, 3654),
    ("ros_example/main.xml", "alarm_on"): Exact(1, 1, 2646),
    ("events_sync_examples/main.xml", "seq_check"): Exact(1, 1, 4287),
    ("different_rate_senders/main.xml", "counter_check"): Exact(1, 1, 3088),
    ("multiple_senders_same_event/main.xml", "seq_check"): Exact(1, 1, 46986),
    ("on_entry_exit_test/main.xml", "working"): Exact(1, 1, 159),
    ("array_model_basic/main.xml", "array_check"): Exact(1, 1, 85),
    ("array_of_data_structs/main.xml", "success"): Exact(1, 1, 14),
    ("array_of_strings/main.xml", "array_check"): Exact(1, 1, 3),
    ("ros_add_int_srv_example/main.xml", "happy_clients"): Exact(1, 1, 105),
    ("blackboard_test/main.xml", "tree_success"): Exact(1, 1, 8586),
}

TREES = {
    ("reactive_sequence", "ten_tick_zero_no_tick_one"): 1,
    ("sequence", "regular_bt_test"): 1,
    ("fallback", "regular_bt_test"): 1,
    ("repeat", "repeats_and_success"): 1,
    ("ifthenelse_then", "tree_success"): 1,
    ("ifthenelse_then", "counter_then_10"): 1,
    ("parallel_success", "parallel_success_status_action_child_test"): 1,
    ("parallel_failure", "parallel_failure_status_action_child_test"): 1,
    ("parallel_success", "parallel_success_test"): 0,
    ("parallel_success", "parallel_failure_test"): 1,
    ("parallel_success", "parallel_running_test"): 0,
    ("parallel_failure", "parallel_success_test"): 0,
    ("parallel_failure", "parallel_failure_test"): 1,
    ("parallel_failure", "parallel_running_test"): 0,
}
"""Behavior trees, property: the least and the greatest probability, which are the same."""


@cache
def loaded(path: Path) -> api.LoadedSystem:
    return load(path, as_reference=True)


@pytest.mark.parametrize("path", conformance.systems(), ids=conformance.label)
def test_read(path: Path) -> None:
    model = api.to_jani(loaded(path))
    assert len(read(model).automata) == len(model.automata)


@pytest.mark.parametrize(("system", "name"), PROBABILITIES, ids=str)
def test_probability(system: str, name: str) -> None:
    model = api.to_jani(loaded(conformance.ROOT / "models" / system), [name])
    expected = PROBABILITIES[system, name]
    actual_exact = exact(model, name)
    assert actual_exact.states == expected.states
    assert actual_exact.least == pytest.approx(expected.least, abs=1e-6)
    assert actual_exact.greatest == pytest.approx(expected.greatest, abs=1e-6)


@pytest.mark.parametrize(("tree", "name"), TREES, ids=str)
def test_tree(tree: str, name: str) -> None:
    model = api.to_jani(loaded(conformance.ROOT / "models" / f"bt_test_models/main_test_{tree}.xml"), [name])
    actual_exact = exact(model, name)
    assert actual_exact.least == pytest.approx(TREES[tree, name], abs=1e-6)
    assert actual_exact.greatest == pytest.approx(TREES[tree, name], abs=1e-6)

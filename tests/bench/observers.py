# SPDX-License-Identifier: Apache-2.0
"""The probabilities of generated properties in XML, computed by Storm on the translated observers, from all states, and
estimated from traces, for every conformance system of few enough states."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import conformance
from bench.report import Benchmark, Row
from roaml import api

if TYPE_CHECKING:
    from storm import Exact

MAX_STATES = 2_000_000
"""Of the search for one property. Systems with more states, infinitely many for example, are left out of `SYSTEMS`."""
PROPERTIES = 8
SYSTEMS = (
    "ros_example/main.xml",
    "quick_start_battery_monitor/main.xml",
    "different_rate_senders/main.xml",
    "array_of_data_structs/main.xml",
    "array_model_multi_dim/main.xml",
    "data_structs/main_xml_def.xml",
    "string_comparison/main.xml",
    "array_of_strings/main.xml",
    "ros_add_int_srv_example/main.xml",
    "set_float_srv_example/main.xml",
    "blackboard_test/main.xml",
    "bt_test_models/main_test_sequence.xml",
    "bt_test_models/main_test_fallback.xml",
    "bt_test_models/main_test_repeat.xml",
    "bt_test_models/main_test_ifthenelse_then.xml",
    "bt_test_models/main_test_parallel_success.xml",
    "bt_test_models/main_test_parallel_failure.xml",
    "bt_test_models/main_test_reactive_sequence.xml",
)
"""The conformance systems with at most 2,000,000 states. `array_model_basic` is left out: an operation in one of its
states is undefined, so neither Storm nor the search answers. All other systems have more states."""


def observers(max_states: int = MAX_STATES) -> list[Row]:
    return [_row(conformance.ROOT / "models" / system, max_states) for system in SYSTEMS if conformance.PRESENT]


def _row(path: Path, max_states: int) -> Row:
    sys.path.append(str(Path(__file__).resolve().parents[1] / "translate"))
    from generated_properties import with_properties  # noqa: PLC0415
    from three_answers import answers  # noqa: PLC0415

    source = with_properties(path, [str(conformance.INTERFACES)], PROPERTIES)
    compared = uncertain = open_ = most = 0
    different: list[str] = []
    for property_ in source.observed:
        answer = answers(source, property_.name, max_states, _limited)
        print(f"{conformance.label(path)} {property_.name}: {answer}", file=sys.stderr, flush=True)
        if answer.storm is not None:
            compared, most = compared + 1, max(most, answer.states)
            uncertain += not answer.is_certain
            open_ += answer.open > 0
        different += [f"{property_.name}: {text}" for text in answer.differences()]
    figure = f"{compared} of {len(source.observed)} compared, {len(different)} differ"
    method = f"{uncertain} not certain, {open_} with open traces, up to {most:,} states in Storm"
    return Row(conformance.label(path), figure, "0 differ", "; ".join([method, *different]))


def _limited(model: api.Model, name: str) -> Exact | None:
    """Storm's answer, from a process of its own."""
    from storm import RefusedError, StormLimits, TooLargeError, exact_within  # noqa: PLC0415

    try:
        return exact_within(model, name, StormLimits())
    except (TooLargeError, RefusedError):
        return None


BENCHMARKS: dict[str, Benchmark] = {"observers": observers}

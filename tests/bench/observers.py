# SPDX-License-Identifier: Apache-2.0
"""The probabilities of generated properties in XML, computed by Storm on the translated observers, from all states, and
estimated from traces, for every conformance system of few enough states."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import conformance
from bench.report import Benchmark, Row
from roaml import api

if TYPE_CHECKING:
    from storm import Exact

MAX_STATES = 2_000_000
"""Of the search for one property. Systems with more states, infinitely many for example, are left out of `SYSTEMS`."""
MAX_BYTES, MAX_SECONDS = 6 << 30, 600
"""Limits of Storm for one property."""
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
    from storm import Exact  # noqa: PLC0415

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.jani"
        file.write_text("".join(api.write_jani(model)), encoding="utf-8")
        command = [sys.executable, "-c", _STORM, str(Path(__file__).resolve().parents[1] / "translate"), file, name]
        limits = (MAX_BYTES, MAX_BYTES)
        try:
            ended = subprocess.run(
                command,
                capture_output=True,
                check=False,
                text=True,
                timeout=MAX_SECONDS,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, limits),
            )
        except subprocess.TimeoutExpired:
            return None
    return Exact(*json.loads(ended.stdout.splitlines()[-1])) if ended.returncode == 0 else None


_STORM = """
import json, sys
sys.path.append(sys.argv[1])
from storm import exact
from roaml import api
print(json.dumps(exact(api.read_jani(sys.argv[2])[0], sys.argv[3])))
"""
BENCHMARKS: dict[str, Benchmark] = {"observers": observers}

# SPDX-License-Identifier: Apache-2.0
"""Exact probabilities that Storm's sparse engine computes on large state spaces, which takes too long for a test."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import conformance
from bench.report import Benchmark, Row, seconds


class Expected(NamedTuple):
    """The result of Storm 1.11.3 for the translation of the reference translator: the probability, and the number of
    states."""

    system: str
    property: str
    probability: float
    states: int


EXPECTED = (
    Expected("quick_start_battery_monitor/main.xml", "battery_depleted", 0, 1293320),
    Expected("quick_start_battery_monitor/main.xml", "battery_below_20", 0, 1293320),
    Expected("quick_start_battery_monitor/main.xml", "battery_alarm_on", 1, 401346),
    Expected("array_model_multi_dim/main.xml", "array_check", 1, 9),
)

_EXACT = """
import json, sys
sys.path[:0] = [sys.argv[1], sys.argv[1] + "/translate"]
from storm import exact
from roaml import api
print(json.dumps(exact(api.to_jani(api.load(sys.argv[2], sys.argv[4:]), [sys.argv[3]]), sys.argv[3])))
"""


def probabilities() -> list[Row]:
    return [_row(expected) for expected in EXPECTED] if conformance.PRESENT else []


def _row(expected: Expected) -> Row:
    path = conformance.ROOT / "models" / expected.system
    tests = Path(__file__).resolve().parents[1]
    command = [sys.executable, "-c", _EXACT, str(tests), str(path), expected.property, str(conformance.INTERFACES)]
    before = time.perf_counter()
    output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    took = time.perf_counter() - before
    least, greatest, states = json.loads(output.splitlines()[-1])
    same = all(abs(result - expected.probability) < 1e-6 for result in (least, greatest)) and states == expected.states
    result = f"{least:g} to {greatest:g}, {states} states" + ("" if same else ", NOT AS EXPECTED")
    target = f"{expected.probability:g}, {expected.states} states"
    how = f"property {expected.property} of {expected.system}, least and greatest; {seconds(took)}"
    return Row("Storm", result, target, how)


BENCHMARKS: dict[str, Benchmark] = {"storm": probabilities}

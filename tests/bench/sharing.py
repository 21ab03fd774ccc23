# SPDX-License-Identifier: Apache-2.0
"""The CPU time of observers in traces of the largest conformance model: of one observer, compared with the same traces
without it, and of 25 that share traces, compared with one.

Properties and traces are prepared before the measurement. A trace continues until its properties are decided, at most
to `MAX_STEPS`.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

import conformance
from bench.report import Benchmark, Row, seconds
from roaml import api
from roaml.smc.pool import Pool

SYSTEM = conformance.ROOT / "models" / "uc3_museum_guide" / "Main" / "main.xml"
UNDECIDED = "alarm_raised"
"""A property in JANI of this system that no trace decides within `MAX_STEPS`, so all its traces have this length."""
PROPERTIES = 25
TRACES, MAX_STEPS, RUNS = 500, 20_000, 3


class Effort(NamedTuple):
    """CPU time in s, the minimum of several runs, and the number of steps of the traces."""

    cpu_s: float
    steps: int


def one_observer() -> list[Row]:
    if not conformance.PRESENT:
        return []
    without = _effort(api.load(str(SYSTEM), [str(conformance.INTERFACES)]), [UNDECIDED])
    same = {name: effort for name, effort in _alone().items() if effort.steps == without.steps}
    slower = sorted((effort.cpu_s / without.cpu_s - 1) * 100 for effort in same.values())
    figure = f"{statistics.median(slower):.1f} %, at most {slower[-1]:.1f} %"
    how = (
        f"CPU time that one observer adds to the same {without.steps:,} steps of {conformance.label(SYSTEM)}, which "
        f"take {seconds(without.cpu_s)} without it; median and maximum of the {len(same)} generated properties that no "
        "trace decides earlier"
    )
    return [Row("`verify`, one observer", figure, "< 10 %", how)]


def sharing() -> list[Row]:
    if not conformance.PRESENT:
        return []
    alone = {name: effort.cpu_s for name, effort in _alone().items()}
    together = _effort(_system(tuple(alone)), tuple(alone)).cpu_s
    slowest = max(alone.values())
    how = (
        f"{PROPERTIES} generated properties of {conformance.label(SYSTEM)} from one set of {TRACES} traces: "
        f"{seconds(together)} CPU; the slowest of them alone: {seconds(slowest)}; one after the other: "
        f"{seconds(sum(alone.values()))}"
    )
    return [Row("`verify`, shared traces", f"{together / slowest:.2f} times", "at most 1.5 times", how)]


@cache
def _alone() -> dict[str, Effort]:
    """The effort for each generated property in a system that has no other property in XML."""
    names = [f"g{number}" for number in range(PROPERTIES)]
    return {name: _effort(_system((name,)), [name]) for name in names}


def _system(chosen: Sequence[str]) -> api.LoadedSystem:
    sys.path.append(str(Path(__file__).resolve().parents[1] / "translate"))
    from generated_properties import with_properties  # noqa: PLC0415

    return with_properties(SYSTEM, [str(conformance.INTERFACES)], PROPERTIES, chosen)


def _effort(source: api.LoadedSystem, names: Sequence[str]) -> Effort:
    options = api.Options(method=api.EstimationMethod.FIXED, max_traces=TRACES, max_steps=MAX_STEPS, seed=1)
    verifier = api.verifier(source, names, options, only_uniform=True)
    times = []
    for _ in range(RUNS):
        with Pool() as pool:
            before = time.process_time()
            results = list(verifier.verify_all(pool))
            times.append(time.process_time() - before)
    assert all(result.answer is not None for result in results), [result.outcome for result in results]
    return Effort(min(times), max(result.answer.tally.steps for result in results if result.answer is not None))


BENCHMARKS: dict[str, Benchmark] = {"one-observer": one_observer, "shared-traces": sharing}

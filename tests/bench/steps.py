# SPDX-License-Identifier: Apache-2.0
"""The time of a step in the kernel, without remembered states, for all conformance systems and the models of the
Quantitative Verification Benchmark Set, if they are in a folder beside the project; and for systems with a clock, if
machines react at once, compared with any reaction time."""

from __future__ import annotations

import time

import conformance
from bench.report import Benchmark, Row, median
from bench.states import compiled, first
from roaml import api
from roaml.durations import AT_ONCE
from roaml.jani.reaction import reacting
from roaml.smc.kernel import Kernel
from roaml.smc.program import UNKNOWN, Compiled

STEPS = 300_000
MAX_STEPS = 10_000
"""The number of steps after which a trace is cut."""
REPETITIONS = 5
REACTING = (
    "ros_example/main.xml",
    "quick_start_battery_monitor/main.xml",
    "different_rate_senders/main.xml",
    "grid_robot_blackboard/main.xml",
    "tutorial_fetch_and_carry/main.xml",
    "uc1_docking/main.xml",
    "uc2_assembly/Main/main_bug.xml",
    "bt_test_models/main_test_sequence.xml",
)
"""Conformance systems with a clock, of different kinds."""


def step_s(program: Compiled, steps: int) -> float:
    """The CPU time in s of a step, measured with whole traces that have together at least so many steps."""
    kernel = Kernel(program.program, program.goal)
    done = trace = 0
    before = time.process_time()
    while done < steps:
        if kernel.begin(0, trace) == UNKNOWN:
            kernel.advance(MAX_STEPS)
        done += kernel.outcome()[0] or 1
        trace += 1
    return (time.process_time() - before) / done


def kernel_steps() -> list[Row]:
    """For each system and model, the minimum of the repetitions."""
    values = {name: min(step_s(program, STEPS) for _ in range(REPETITIONS)) for name, program in compiled()}
    rows = [
        Row("kernel step", f"{value * 1e9:.0f} ns", "", f"{name}, with the start of its traces")
        for name, value in values.items()
    ]
    how = f"median of {len(values)} systems and models, {STEPS:,} steps, minimum of {REPETITIONS} repetitions"
    return [*rows, Row("kernel step", f"{median(list(values.values())) * 1e9:.0f} ns", "", how)]


def reaction_steps() -> list[Row]:
    """For each system of `REACTING`, the time of a step with the reaction times `any` and `instant`. Their
    repetitions alternate, so that another load of the machine affects both."""
    rows, ratios = [], []
    for name in REACTING if conformance.PRESENT else ():
        path = conformance.ROOT / "models" / name
        model = api.to_jani(api.load(str(path), [str(conformance.INTERFACES)]))
        programs = [first(api.checker(timed)) for timed in (model, reacting(model, AT_ONCE))]
        pairs = [[step_s(program, STEPS) for program in programs] for _ in range(REPETITIONS)]
        slow, quick = (min(values) for values in zip(*pairs, strict=True))
        ratios.append(quick / slow)
        rows.append(Row("kernel step, any and instant", f"{slow * 1e9:.0f} and {quick * 1e9:.0f} ns", "", name))
    if not ratios:
        return []
    how = f"{len(ratios)} systems with a clock, {min(ratios):.2f} to {max(ratios):.2f}, compared with any"
    return [*rows, Row("kernel step, instant", f"{median(ratios):.2f} times as long", "< 1.05", f"median of {how}")]


BENCHMARKS: dict[str, Benchmark] = {"kernel-steps": kernel_steps, "kernel-steps-reactions": reaction_steps}

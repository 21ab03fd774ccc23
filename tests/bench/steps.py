# SPDX-License-Identifier: Apache-2.0
"""The time of a step in the kernel, without remembered states, for all conformance systems and the models of the
Quantitative Verification Benchmark Set, if they are in a folder beside the project."""

from __future__ import annotations

import time

from bench.report import Benchmark, Row, median
from bench.states import compiled
from roaml.smc.kernel import Kernel
from roaml.smc.program import UNKNOWN, Compiled

STEPS = 300_000
MAX_STEPS = 10_000
"""The number of steps after which a trace is cut."""
REPETITIONS = 5


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


BENCHMARKS: dict[str, Benchmark] = {"kernel-steps": kernel_steps}

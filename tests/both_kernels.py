# SPDX-License-Identifier: Apache-2.0
"""The kernel of the model checker as plain Python, for comparisons with the kernel that is in use."""

from __future__ import annotations

from typing import Any

from roaml.explicit.plain import plain_kernel
from roaml.smc import kernel
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.program import UNKNOWN


def difference(
    checker: ModelChecker, property_: CompiledProperty, seed: int, traces: int, steps: int, scheduler: int = 0
) -> str:
    """The differences between the two kernels, "" if there are none: verdict, end, steps, random numbers, rewards, all
    values, faults, and the last step."""
    compiled = checker.compiled(property_)
    both = [module.Kernel(compiled.program, compiled.goal) for module in (kernel, plain_kernel())]
    for trace in range(traces):
        results: list[Any] = []
        for simulator in both:
            verdict = simulator.begin(seed, trace, scheduler)
            if verdict == UNKNOWN:
                verdict = simulator.advance(steps)
            results.append(
                (
                    verdict,
                    simulator.ending(),
                    simulator.outcome(),
                    simulator.snapshot(),
                    simulator.problem(),
                    simulator.taken(),
                )
            )
        if repr(results[0]) != repr(results[1]):  # repr: NaN is what it is
            return f"{property_.question.name}, trace {trace}, scheduler {scheduler}:\n{results[0]}\n{results[1]}"
    return ""

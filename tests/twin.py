# SPDX-License-Identifier: Apache-2.0
"""The kernel of the model checker as plain Python, beside the one that is in use."""

from __future__ import annotations

import importlib.util
from functools import cache
from importlib.machinery import SourceFileLoader
from pathlib import Path
from typing import Any

import roaml.smc
from roaml.smc import kernel
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.program import UNKNOWN


@cache
def plain_kernel() -> Any:
    """The module of the kernel as plain Python, whether it was compiled or not."""
    path = Path(roaml.smc.__file__).with_name("kernel.py")
    loader = SourceFileLoader("plain_kernel", str(path))
    spec = importlib.util.spec_from_loader("plain_kernel", loader)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module


def difference(
    checker: ModelChecker, asked: CompiledProperty, seed: int, traces: int, steps: int, scheduler: int = 0
) -> str:
    """What the two kernels disagree about, "" if nothing: verdict, end, steps, random numbers, rewards, all values,
    faults, and what was done last."""
    compiled = checker.compiled(asked)
    both = [module.Kernel(compiled.program, compiled.goal) for module in (kernel, plain_kernel())]
    for trace in range(traces):
        found: list[Any] = []
        for each in both:
            verdict = each.begin(seed, trace, scheduler)
            if verdict == UNKNOWN:
                verdict = each.advance(steps)
            found.append((verdict, each.ending(), each.outcome(), each.snapshot(), each.problem(), each.taken()))
        if repr(found[0]) != repr(found[1]):  # repr: NaN is what it is
            return f"{asked.question.name}, trace {trace}, scheduler {scheduler}:\n{found[0]}\n{found[1]}"
    return ""

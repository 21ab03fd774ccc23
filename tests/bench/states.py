# SPDX-License-Identifier: Apache-2.0
"""The time of traces with and without states that are remembered, for all conformance systems and the models of the
Quantitative Verification Benchmark Set, if they are in a folder beside the project."""

from __future__ import annotations

import time
from collections.abc import Iterator

import conformance
from bench.qvbs import FOLDER, asked, models
from bench.report import Benchmark, Row, median, seconds
from roaml import api
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.smc.batch import Payload, Simulator, Task, run_on
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker
from roaml.smc.program import Compiled

COUNTS = (2_000, 100_000)
MAX_STEPS = 10_000
BATCH_TRACES = 500
LIMIT_S = 0.5
"""The CPU time in s after which a measurement of one simulator ends."""


def compiled() -> Iterator[tuple[str, Compiled]]:
    """Name -> program and goal of the first property of each system, and of one property of each model."""
    for path in conformance.systems():
        checker = api.checker(api.to_jani(api.load(str(path), [str(conformance.INTERFACES)])))
        yield conformance.label(path), first(checker)
    for name, content in models().items() if FOLDER.is_dir() else ():
        value, _ = parse((FOLDER / f"{name}.jani").read_text(encoding="utf-8-sig"))
        model, _ = read_model(value, name)
        try:
            assert model is not None
            yield name, first(ModelChecker(model, [p for p in model.properties if p.name == asked(name, content)]))
        except FaultError:
            continue


def first(checker: ModelChecker) -> Compiled:
    property_ = checker.compiled_properties[0]
    reduced = checker.reduced(property_)
    return reduced.compiled(reduced.compiled_properties[0])


def spent(simulator: Simulator, count: int) -> tuple[float, int]:
    """The CPU time in s of `count` traces, or of as many as `LIMIT_S` allows; and the number of their steps."""
    before = time.process_time()
    steps = done = 0
    while done < count and time.process_time() - before < LIMIT_S:
        task = Task(Payload(None), 0, done, min(BATCH_TRACES, count - done), MAX_STEPS)
        outcome = run_on(simulator, task)
        steps += sum(outcome.questions[0].steps)
        done += task.size
        if outcome.problem is not None:
            break
    return time.process_time() - before, max(1, steps)


def remembered() -> list[Row]:
    """For each system and model, the time of a step and of a trace without and with remembered states."""
    rows = []
    factors: dict[int, list[float]] = {count: [] for count in COUNTS}
    for name, program in compiled():
        for count in COUNTS:
            costs = [seconds_ / steps for seconds_, steps in (spent(Simulator(program, *m), count) for m in ((0,), ()))]
            factors[count].append(costs[0] / costs[1])
            value = f"{costs[0] * 1e9:.0f} ns, {costs[1] * 1e9:.0f} ns a step"
            rows.append(Row("remembered states", value, "", f"{name}, {count:,} traces: without, with"))
    for count, values in factors.items():
        value = f"{median(values):.1f} times as fast, at least {min(values):.2f}"
        how = f"median of {len(values)} systems and models, {count:,} traces or {seconds(LIMIT_S)} of CPU time"
        rows.append(Row("remembered states", value, "", how))
    return rows


BENCHMARKS: dict[str, Benchmark] = {"remembered-states": remembered}

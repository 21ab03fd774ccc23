# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of the verification: whole calls of the command line compared with SMC Storm, and the growth of the
time."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

import conformance
from bench.plot import growth_svg
from bench.report import Benchmark, Row, listed, megabytes, seconds

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SIZES = (10, 20, 50, 100, 200)
CONFIDENCES = (0.8, 0.9, 0.95, 0.99, 0.999, 0.9999)
TIMEOUT_S = 120
"""The maximum time in s of an exhaustive computation."""


class Cost(NamedTuple):
    """The cost of a process: wall time and CPU time in s, memory in bytes; and its output."""

    wall: float
    processor: float
    memory: int
    output: str


def call(*arguments: str, subcommand: str = "verify") -> Cost:
    """Call `as2fm-lsp verify`, or another subcommand. The cost includes that of its workers."""
    command = [sys.executable, "-m", "as2fm_lsp", subcommand, "--format", "json", *arguments]
    began = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        output = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 1):
        raise RuntimeError(f"{subcommand} ended with {process.returncode}")
    wall = time.perf_counter() - began
    return Cost(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, output)


class Case(NamedTuple):
    """A conformance model, and the cost of SMC Storm 0.1.8 for the same traces: CPU time in s and memory."""

    system: str
    property: str
    traces: int
    theirs: float
    memory: str
    target: str


CASES = (
    Case("uc2_assembly/Main/main_bug.xml", "executes_recovery_branch_or_success", 16_000, 0.36, "128 MB", "wall < 1 s"),
    Case("uc3_museum_guide/Main/main.xml", "tree_success", 500, 19.4, "2.4 GB", "CPU < 1.9 s, < 200 MB"),
    Case("grid_robot_blackboard/main.xml", "at_goal", 500, 26, "2.4 GB", "CPU < 2.6 s, < 200 MB"),
    Case("tutorial_fetch_and_carry/main_probabilistic_extended_bt.xml", "snack_at_table", 10_000, 5.1, "", "CPU < 1 s"),
)


def beside_smc_storm() -> list[Row]:
    return [_row(case) for case in CASES] if conformance.PRESENT else []


def _row(case: Case) -> Row:
    path = str(conformance.ROOT / "models" / case.system)
    fixed = ("--method", "fixed", "--max-traces", str(case.traces), "--jobs", "1")
    cost = min(
        call(path, "--property", case.property, *fixed, "--ros-path", str(conformance.INTERFACES)) for _ in range(3)
    )
    (result,) = json.loads(cost.output)["results"]
    value = f"{seconds(cost.wall)} wall, {seconds(cost.processor)} CPU, {megabytes(cost.memory)}"
    theirs = f"SMC Storm {case.theirs:g} s CPU" + (f", {case.memory}" if case.memory else "")
    steps = result["steps"] / result["traces"]
    how = f"whole command from source, {case.traces:,} traces of {steps:,.0f} steps of {case.system}; {theirs}"
    return Row("verify", value, case.target, how)


def grid(folder: Path, size: int) -> str:
    """The grid world of the examples in another size."""
    source = EXAMPLES / "grid_world"
    for name in ("main.xml", "properties.jani", "robot.ascxml"):
        text = (source / name).read_text(encoding="utf-8")
        text = text.replace('id="size" type="int32" expr="10"', f'id="size" type="int32" expr="{size}"')
        text = text.replace('id="energy" type="int32" expr="24"', f'id="energy" type="int32" expr="{size * 9 // 4}"')
        (folder / name).write_text(text, encoding="utf-8")
    return str(folder / "main.xml")


@cache
def grids() -> dict[int, tuple[float, float | None, float]]:
    """Size -> time in s for 20,000 traces, time in s of Storm (`None`: too many states, or too long), and the
    probability."""
    results = {}
    for size in SIZES:
        with tempfile.TemporaryDirectory() as folder:
            main = grid(Path(folder), size)
            cost = call(main, "--method", "fixed", "--max-traces", "20000", "--jobs", "1")
            (result,) = json.loads(cost.output)["results"]
            results[size] = (result["seconds"], _exhaustively(main), result["probability"])
    return results


def _exhaustively(main: str) -> float | None:
    """The time in s that Storm takes to build and check the model, without reading and translating."""
    script = (
        "import sys, time, stormpy\nfrom roaml import api\nfrom roaml.jani.writer import write\n"
        "text = ''.join(write(api.to_jani(api.load(sys.argv[1]))))\nbegan = time.perf_counter()\n"
        "model, properties = stormpy.parse_jani_model_from_string(text)\n"
        "built = stormpy.build_model(model, properties)\n"
        "stormpy.model_checking(built, properties[0], only_initial_states=True)\n"
        "print(time.perf_counter() - began)\n"
    )
    try:
        done = subprocess.run(
            [sys.executable, "-c", script, main], capture_output=True, text=True, timeout=TIMEOUT_S, check=True
        )
    except (subprocess.TimeoutExpired, subprocess.CalledProcessError):
        return None
    return float(done.stdout.splitlines()[-1])


def growth() -> list[Row]:
    rows = grids()
    ours = listed(seconds(ours) for ours, _, _ in rows.values())
    theirs = listed("no answer" if storm is None else seconds(storm) for _, storm, _ in rows.values())
    how = f"grids of {listed(rows)} cells a side: 20,000 traces, one process"
    return [
        Row("verify, growth", ours, "linear", how),
        Row("exhaustively", theirs, "", f"the same by Storm: all states, at most {TIMEOUT_S} s"),
    ]


@cache
def confidences() -> dict[float, tuple[int, float]]:
    """Confidence -> number of traces and time in s for the assembly robot with its bug, with an epsilon of 0.01."""
    main = str(EXAMPLES / "assembly_robot" / "main_with_bug.xml")
    results = {}
    for confidence in CONFIDENCES:
        options = ("--property", "block_placed", "--confidence", str(confidence), "--jobs", "1")
        (result,) = json.loads(call(main, *options).output)["results"]
        results[confidence] = (result["traces"], result["seconds"])
    return results


def confidence() -> list[Row]:
    rows = confidences()
    traces = listed(f"{traces:,}" for traces, _ in rows.values())
    took = listed(seconds(took) for _, took in rows.values())
    how = f"assembly robot with its bug to 0.01 with confidence {listed(rows)}: {took}"
    return [Row("traces for a confidence", traces, "", how)]


def workers() -> list[Row]:
    main = str(EXAMPLES / "assembly_robot" / "main_with_bug.xml")
    options = ("--property", "block_placed", "--method", "fixed", "--max-traces", "400000", "--jobs")
    took = [json.loads(call(main, *options, jobs).output)["results"][0]["seconds"] for jobs in ("1", "2")]
    value = f"{took[0] / took[1]:.2f} times as fast"
    return [Row("two workers", value, "nearly 2", f"400,000 traces: {seconds(took[0])} and {seconds(took[1])}")]


def million() -> list[Row]:
    main = str(EXAMPLES / "assembly_robot" / "main_with_bug.xml")
    options = ("--property", "block_placed", "--method", "fixed", "--max-traces", "1000000")
    with tempfile.TemporaryDirectory() as folder:
        cost = call(main, *options, "--resume", str(Path(folder, "state.json")), "--jobs", "1")
    value = f"{seconds(cost.wall)}, {megabytes(cost.memory)}"
    return [Row("a million traces", value, "", "assembly robot with its bug, one process, with --resume")]


def diagrams() -> dict[str, str]:
    """File name -> diagram."""
    sizes: dict[str, list[tuple[float, float]]] = {"20,000 traces": [], "all states, by Storm": []}
    for size, (ours, storm, _) in grids().items():
        sizes["20,000 traces"].append((size, ours))
        if storm is not None:
            sizes["all states, by Storm"].append((size, storm))
    levels: dict[str, Sequence[tuple[float, float]]] = {
        "traces": [(1 / (1 - level), traces) for level, (traces, _) in confidences().items()],
        "time in ms": [(1 / (1 - level), took * 1000) for level, (_, took) in confidences().items()],
    }
    return {
        "verify-grid.svg": growth_svg(
            "Verification by the size of a grid world", sizes, "cells on a side of the grid", "time (s)"
        ),
        "verify-confidence.svg": growth_svg(
            "Traces and time by the confidence", levels, "1 / (1 - confidence)", "number of traces, and time (ms)"
        ),
    }


BENCHMARKS: dict[str, Benchmark] = {
    "verify": beside_smc_storm,
    "verify-growth": growth,
    "verify-confidence": confidence,
    "verify-workers": workers,
    "verify-million": million,
}

# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of the debug adapter: the time of a launch as a client measures it, and the CPU time of the adapter for a
step and a jump."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import conformance
from bench.report import Benchmark, Row, median, seconds
from debug.dap_client import Client

ROBOT = Path(__file__).resolve().parents[2] / "examples" / "assembly_robot" / "main_with_bug.xml"
LAUNCHES = 5
STEPS = 100
RUN_LENGTH = 16_000
JUMPS = 20


def launch() -> list[Row]:
    times: list[float] = []
    starts: list[float] = []
    against: list[float] = []
    for _ in range(LAUNCHES):
        with Client(validates=False) as client:
            client.ask("initialize", adapterID="as2fm")
            client.ask("threads")
            against.append(_elapsed(lambda: _begin(client, ROBOT, property="never_placed_empty", against=1)))
        started = time.perf_counter()
        with Client(validates=False) as client:
            client.ask("initialize", adapterID="as2fm")
            client.ask("threads")  # answered when the adapter is ready for a launch
            times.append(_elapsed(lambda: _begin(client, ROBOT)))
            starts.append(time.perf_counter() - started)
    method = "the assembly robot, from the request to the first stop"
    return [
        Row("`debug`, launch", seconds(median(times)), "< 0.3 s", method),
        Row("", seconds(median(starts)), "", "the same, from the start of the process"),
        Row("", seconds(median(against)), "", "the same, on the first trace that violates `never_placed_empty`"),
    ]


def moves() -> list[Row]:
    """Steps and jumps in the conformance model with the most automata; in the example if there are no conformance
    models."""
    main = conformance.ROOT / "models" / "uc3_museum_guide" / "Main" / "main.xml"
    main = main if main.is_file() else ROBOT
    with Client(validates=False) as client:
        client.ask("initialize", adapterID="as2fm")
        _begin(client, main)
        steps = [_spent(client, lambda: _step(client)) for _ in range(STEPS)]
        _go_to(client, RUN_LENGTH)
        length = client.step()
        places = [length * number * 7 // JUMPS % length for number in range(JUMPS)]
        jumps = []
        for place in places:
            jumps.append(_spent(client, lambda: _go_to(client, place)))  # noqa: B023 - called at once
            steps.append(_spent(client, lambda: _step(client)))
    name = main.parent.parent.name if main != ROBOT else "assembly_robot"
    method = f"{name}, with stack and all variables; median (at most {seconds(max(steps))}); CPU time of the adapter"
    return [
        Row("`debug`, a step", seconds(median(steps)), "< 20 ms", method),
        Row("`debug`, a jump", seconds(max(jumps)), "< 100 ms", f"within a run of {length:,} steps, at most; CPU time"),
    ]


def _spent(client: Client, action: Callable[[], None]) -> float:
    """The CPU time of the adapter for an action, in s; on systems other than Linux, which have no clock of another
    process, the elapsed time."""
    if sys.platform != "linux":
        return _elapsed(action)
    clock = (~client.process.pid << 3) | 2  # MAKE_PROCESS_CPUCLOCK of the kernel
    started = time.clock_gettime(clock)
    action()
    return time.clock_gettime(clock) - started


def _elapsed(action: Callable[[], None]) -> float:
    started = time.perf_counter()
    action()
    return time.perf_counter() - started


def _begin(client: Client, main: Path, **options: str | int) -> None:
    arguments = {"rosPath": [str(conformance.INTERFACES)]} if conformance.PRESENT else {}
    client.ask("launch", program=str(main), stopOnEntry=True, **arguments, **options)
    client.ask("configurationDone")
    client.event("stopped")


def _step(client: Client) -> None:
    stopped = client.move("stepIn")
    frame = client.stack(stopped["threadId"])[0]["id"]
    for scope in client.ask("scopes", frameId=frame)["scopes"]:
        client.ask("variables", variablesReference=scope["variablesReference"])


def _go_to(client: Client, step: int) -> None:
    client.ask("goToStep", step=step)
    client.event("stopped")


BENCHMARKS: dict[str, Benchmark] = {"debug-launch": launch, "debug-moves": moves}

# SPDX-License-Identifier: Apache-2.0
"""Benchmarks on the models of the Quantitative Verification Benchmark Set, if it is in a folder beside the project."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Sequence
from typing import Any, NamedTuple

import conformance
from bench.report import Benchmark, Row, median, seconds

FOLDER = conformance.ROOT.parent / "qvbs"
COUNTS = (2_000, 100_000)
"""The numbers of traces that are measured; each also without the time of one trace."""
TIMEOUT_S, TRACES_TIMEOUT_S = 120, 60
"""The wall time in s after which a command is ended; of those that generate traces."""
REPETITIONS, LONG_S = 3, 3
"""The number of calls of which the cheapest is shown; a call that takes more CPU time than LONG_S, in s, is not
repeated."""
LIMITS = ("--max-states", "5000000", "--max-memory", "2G")
STORM = 2e-6
"""The distance of the known values, which Storm has computed by value iteration without bounds."""
KINDS = ("dtmc", "mdp")
"""The types of models that can be answered."""


class Command(NamedTuple):
    """A call of a command: its CPU time in s, its exit status (-1 if it took too long), and its output."""

    processor: float
    status: int
    output: str


def verify(*arguments: str, timeout_s: int = TIMEOUT_S) -> Command:
    """Call `as2fm-lsp verify` with results in JSON."""
    return called([sys.executable, "-m", "as2fm_lsp", "verify", "--format", "json", *arguments], timeout_s)


def called(command: Sequence[str], timeout_s: int = TIMEOUT_S) -> Command:
    """Call a command, with a limit of elapsed time."""
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, start_new_session=True
    ) as process:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        try:
            output, _ = process.communicate(timeout=timeout_s)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return Command(timeout_s, -1, "")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Command(spent, process.returncode, output)


def models() -> dict[str, Any]:
    """Name -> content of each model, in alphabetical order."""
    texts = {path.stem: path.read_text(encoding="utf-8-sig") for path in sorted(FOLDER.glob("*.jani"))}
    return {name: json.loads(text) for name, text in texts.items()}


def expected() -> list[dict[str, Any]]:
    """The answers that are known."""
    rows: list[dict[str, Any]] = json.loads((FOLDER / "expected.json").read_text(encoding="utf-8"))
    return rows


def asked(name: str, model: Any) -> str:
    """The property of a model for which traces are generated: the first one with a known answer, else the first one."""
    known = [row["property"] for row in expected() if row["model"] == f"{name}.jani"]
    return str(known[0] if known else model["properties"][0]["name"])


def best(name: str, property_: str, count: int, *scheduler: str) -> Command:
    """The cheapest call that generates a number of traces for a property of a model."""
    options = ("--method", "fixed", "--max-traces", str(count), "--jobs", "1", *scheduler)
    calls: list[Command] = []
    while len(calls) < REPETITIONS and (not calls or calls[-1].processor < LONG_S):
        calls.append(
            verify(str(FOLDER / f"{name}.jani"), "--property", property_, *options, timeout_s=TRACES_TIMEOUT_S)
        )
    return min(calls, key=lambda call: call.processor)


def traces(*scheduler: str) -> list[Row]:
    """The CPU time of the traces for one property of each model, and the part that exceeds the time of one trace."""
    if not FOLDER.is_dir():
        return []
    label = "QVBS traces" if scheduler else "QVBS traces, default scheduler"
    rows = []
    whole: dict[int, list[float]] = {count: [] for count in COUNTS}
    net: dict[int, list[float]] = {count: [] for count in COUNTS}
    for name, model in models().items():
        if model["type"] not in KINDS:
            continue
        property_ = asked(name, model)
        one = best(name, property_, 1, *scheduler)
        figures, length = [f"{seconds(one.processor)} for 1"], ""
        for count in COUNTS:
            call = best(name, property_, count, *scheduler)
            if call.status not in (0, 1):
                why = f"more than {TRACES_TIMEOUT_S} s" if call.status < 0 else f"ended with {call.status}"
                figures.append(f"{why} for {count:,}")
                if call.status < 0:
                    # A model that takes too long is among the slowest ones.
                    whole[count].append(TRACES_TIMEOUT_S)
                    net[count].append(TRACES_TIMEOUT_S)
                continue
            results = json.loads(call.output)["results"]
            if not results or results[0].get("traces") is None:
                figures.append("not answered")
                break
            whole[count].append(call.processor)
            net[count].append(call.processor - one.processor)
            length = f", {results[0]['steps'] / max(1, results[0]['traces']):,.0f} steps in a trace"
            figures.append(f"{seconds(call.processor)} for {count:,}")
        rows.append(Row(label, "; ".join(figures), "", f"{name}, {property_}{length}"))
    for count in COUNTS:
        if whole[count]:
            value = f"{seconds(median(whole[count]))} whole, {seconds(median(net[count]))} net"
            how = f"median of {len(whole[count])} models: CPU time of {count:,} traces, minimum of {REPETITIONS}"
            rows.append(Row(label, value, "", f"{how}; net of a run of one trace"))
    return rows


def uniform_traces() -> list[Row]:
    """The CPU time of traces under uniform choices."""
    return traces("--scheduler", "uniform")


def exact() -> list[Row]:
    """The exact value of each property of all models, beside the known one; or why there is none."""
    if not FOLDER.is_dir():
        return []
    known = {(row["model"], row["property"]): row["asked"] for row in expected()}
    rows = []
    for name, model in models().items():
        for property_ in [row["name"] for row in model["properties"]]:
            call = verify(str(FOLDER / f"{name}.jani"), "--property", property_, "--exhaustive", *LIMITS)
            answer = known.get((f"{name}.jani", property_))
            rows.append(Row("QVBS exact", *_exact(call, answer), f"{name}, {property_}; {seconds(call.processor)} CPU"))
    return rows


def _exact(call: Command, known: float | None) -> tuple[str, str]:
    """The value that was computed, or why there is none; and the known value with the difference from it."""
    target = "" if known is None else f"{known:.9g}"
    if call.status < 0:
        return f"more than {TIMEOUT_S} s", target
    if call.status not in (0, 1):
        return f"ended with {call.status}", target
    document = json.loads(call.output)
    if not document["results"]:
        return f"refused: {document['errors'][0]['message']}", target
    (result,) = document["results"]
    if "exact" not in result:
        reason = result["error"]["message"] if "error" in result else result["undecided"]
        return f"refused: {reason.partition(';')[0]}", target
    values = result["exact"]
    # A property that asks for the minimum or maximum is `Pmin` or `Pmax`; both agree in a dtmc.
    least, greatest = values["least"], values["greatest"]
    value = f"{least}" if least == greatest else f"{least} to {greatest}"
    text = f"{value}, {values['states']:,} states"
    if known is None:
        return text, target
    error = min(abs(number - known) for number in (least, greatest))
    return text, f"{target}, {error:.1g} apart" + ("" if error <= STORM else ", NOT AS EXPECTED")


BENCHMARKS: dict[str, Benchmark] = {
    "qvbs-traces": uniform_traces,
    "qvbs-traces-default": traces,
    "qvbs-exact": exact,
}

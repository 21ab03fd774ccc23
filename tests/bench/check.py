# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of the checker: whole folders, the server as an editor uses it, the command line, and the growth of times
with the size of a system."""

from __future__ import annotations

import itertools
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import conformance
from bench.generate import FIRST, machine, write_system
from bench.keystrokes import keys
from bench.report import Benchmark, Row, listed, median, megabytes, percentile, seconds
from bench.server import Server, started

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SYSTEM_FILES = 30
SESSIONS = 5
RUNS = 5
GROWTH = (10, 30, 100, 300)
"""The numbers of machines in a system."""

MACHINE_LINES = (700, 5_000, 20_000)
KEYS = 44
"""The number of keys in a long machine: each word twice, and the beginning of the statement."""

NAME = '<data id="sum'
"""The declaration of a variable that is unused with another name."""

RIGHT, WRONG = 'expr="0"', 'expr="O"'
"""An error at the beginning of a document, because the server publishes nothing for a document without findings."""


def models() -> list[Row]:
    """The check of many small systems at once."""
    if conformance.PRESENT:
        name, folder, ros_path = "conformance models", conformance.ROOT / "models", str(conformance.INTERFACES)
    else:
        name, folder, ros_path = "examples (there are no conformance models)", EXAMPLES, ""
    files, took = checks(folder, RUNS, ros_path)
    how = f"{files} files in one call of `api.check`, the first in its process; median of {len(took)}"
    return [Row(f"check of the {name}", seconds(median(took)), "< 3 s", how)]


def editing() -> list[Row]:
    """Typing in a long machine of a system, and the memory of the server afterwards."""
    with system(SYSTEM_FILES) as folder:
        lines = (folder / FIRST).read_text(encoding="utf-8").count("\n")
        took, memory = zip(*(session(folder) for _ in range(SESSIONS)), strict=True)
    how = (
        f"{len(took[0])} keys in a machine of {lines} lines in a system of {SYSTEM_FILES} files, each from `didChange` "
        f"to the file's diagnostics, over stdio; median of {SESSIONS} sessions"
    )
    middle, slow = median(map(median, took)), median(percentile(durations, 95) for durations in took)
    return [
        Row("keystroke, median", seconds(middle), "", how),
        Row("keystroke, 95th percentile", seconds(slow), "< 60 ms", "the same keys"),
        Row("memory", megabytes(memory[0]), "< 150 MB", "resident memory of the server after these keys"),
    ]


def long_machines() -> list[Row]:
    """Typing in machines of different lengths."""
    rows = []
    for lines in MACHINE_LINES:
        with system(SYSTEM_FILES, lines) as folder:
            took, memory = session(folder, rounds=1, at_most=KEYS, in_cpu_time=True)
            complete = complete_check(folder)
        how = (
            f"CPU time of the server for each of {len(took)} keys in a machine of about {lines:,} lines, from "
            "`didChange` to its provisional diagnostics, over stdio; its memory afterwards"
        )
        times = f"{seconds(median(took))}, 95th percentile {seconds(percentile(took, 95))}, {megabytes(memory)}"
        rows.append(Row(f"keystroke, {lines:,} lines", times, "95th percentile < 50 ms", how))
        how = (
            "CPU time from `didChange` to the diagnostics of the complete check, which begins 0.3 s after the last key"
        )
        rows.append(Row(f"complete check after keys, {lines:,} lines", seconds(complete), "", how))
    return rows


def complete_check(folder: Path) -> float:
    """The CPU time in s from a key to a finding that only a complete check reports."""
    path = folder / FIRST
    with opened(folder) as (server, text):
        before = server.cpu_time()
        server.change(path, 3, {"text": text.replace(NAME, f"{NAME}s", 1)})
        while not any(d["code"] == "unused-variable" for d in server.diagnostics(path, 3)[1]):
            pass
        return server.cpu_time() - before


def session(
    folder: Path, rounds: int = 3, at_most: int | None = None, *, in_cpu_time: bool = False
) -> tuple[list[float], int | None]:
    """The time in s that a server takes for each key, if the next key is pressed after the answer; and its memory.

    Args:
        rounds: how often each word is changed.
        at_most: the number of keys; all by default.
        in_cpu_time: return CPU time, which other work on the machine hardly changes, instead of elapsed time.
    """
    path = folder / FIRST
    took = []
    with opened(folder) as (server, text):
        for version, key in enumerate(itertools.islice(keys(text, rounds), at_most), 3):
            before = server.cpu_time()
            sent = server.change(path, version, key.change())
            arrived, _ = server.diagnostics(path, version)
            took.append(server.cpu_time() - before if in_cpu_time else arrived - sent)
        return took, server.resident_memory()


@contextmanager
def opened(folder: Path, rest: float = 0.0) -> Iterator[tuple[Server, str]]:
    """A server in which the second version of the long machine is open and checked, after a pause of some seconds; and
    the text of the machine."""
    path = folder / FIRST
    text = path.read_text(encoding="utf-8")
    with started() as server:
        server.initialize(folder)
        server.open(path, text.replace(RIGHT, WRONG, 1))
        server.diagnostics(path, 1)
        server.change(path, 2, {"text": text})
        server.diagnostics(path, 2)
        time.sleep(rest)
        yield server, text


def cold_start() -> list[Row]:
    """The time from the start of the server to the first diagnostics in the editor."""
    took = []
    with system(SYSTEM_FILES) as folder:
        path = folder / FIRST
        text = path.read_text(encoding="utf-8").replace(RIGHT, WRONG, 1)
        for _ in range(7):
            with started() as server:
                server.initialize(folder)
                server.open(path, text)
                arrived, _ = server.diagnostics(path, 1)
                took.append(arrived - server.started)
    how = f"from the start of the process to that file's diagnostics, over stdio; median of {len(took)}"
    return [Row("cold start", seconds(median(took)), "< 1.2 s", how)]


def large_file() -> list[Row]:
    """Opening a very large file."""
    lines = 1000
    text = machine(0, 2, round(lines * 10e6 / len(machine(0, 2, lines))))
    took = []
    with tempfile.TemporaryDirectory() as name:
        path = Path(name).resolve() / "large.ascxml"
        path.write_text(text, encoding="utf-8")
        for _ in range(RUNS):
            with started() as server:
                server.initialize(path.parent)
                sent = server.open(path, text)
                arrived, diagnostics = server.diagnostics(path, 1)
                took.append(arrived - sent)
    answer = " and ".join(f"`{diagnostic['code']}`: {diagnostic['message']}" for diagnostic in diagnostics)
    how = f"a machine of {len(text) / 1e6:.1f} MB, from `didOpen` to its diagnostics, over stdio. {answer}"
    return [Row("10 MB opened", seconds(median(took)), "< 10 s", how)]


def command_line() -> list[Row]:
    """A whole call of the command line, as in CI."""
    main = EXAMPLES / "delivery_robot" / "main.xml"
    took = []
    for _ in range(9):
        before = time.perf_counter()
        subprocess.run([sys.executable, "-m", "as2fm_lsp", "--check", str(main)], capture_output=True, check=True)
        took.append(time.perf_counter() - before)
    how = f"`as2fm-lsp --check examples/delivery_robot/main.xml`, the whole process; median of {len(took)}"
    return [Row("command line", seconds(median(took)), "", how)]


def formatting() -> list[Row]:
    """Formatting of a whole folder, as a hook does before each commit."""
    folder = conformance.ROOT / "models" if conformance.PRESENT else EXAMPLES
    took = []
    for _ in range(RUNS):
        before = time.perf_counter()
        command = [sys.executable, "-m", "as2fm_lsp", "format", "--diff", str(folder)]
        subprocess.run(command, capture_output=True, check=False)
        took.append(time.perf_counter() - before)
    files = sum(path.suffix in (".ascxml", ".scxml", ".xml", ".jani") for path in folder.rglob("*"))
    how = f"`as2fm-lsp format --diff` of the {files} files in {folder.name}, the whole process; median of {len(took)}"
    return [Row("format", seconds(median(took)), "", how)]


def growth() -> list[Row]:
    """The growth of the time of a check with the size of a system."""
    medians = []
    for machines in GROWTH:
        with system(machines + 3) as folder:
            medians.append(median(checks(folder / "main.xml", RUNS)[1]))
    rates = [f"{duration / machines * 1000:.1f}" for duration, machines in zip(medians, GROWTH, strict=True)]
    how = f"generated systems of {listed(GROWTH)} machines: {listed(rates)} ms a machine; median of {RUNS}"
    return [Row("growth", listed(map(seconds, medians)), "linear", how)]


BENCHMARKS: dict[str, Benchmark] = {
    "models": models,
    "editing": editing,
    "long-machines": long_machines,
    "cold-start": cold_start,
    "large-file": large_file,
    "command-line": command_line,
    "format": formatting,
    "growth": growth,
}


_CHECK = """
import sys, time
from as2fm_lsp.collector import spare_the_collector
from roaml import api
spare_the_collector()
before = time.perf_counter()
result = api.check([sys.argv[1]], sys.argv[2:])
print(len(result.files), time.perf_counter() - before)
"""


def checks(path: Path, runs: int, *ros_paths: str) -> tuple[int, list[float]]:
    """The number of checked files, and the time in s of the check in each of some processes, without imports."""
    files, took = 0, []
    for _ in range(runs):
        command = [sys.executable, "-c", _CHECK, str(path), *filter(None, ros_paths)]
        files_there, spent = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
        files = int(files_there)
        took.append(float(spent))
    return files, took


@contextmanager
def system(files: int, lines: int = 700) -> Iterator[Path]:
    """The folder of a generated system. `lines` is the length of its long machine."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        write_system(folder, files, lines)
        yield folder

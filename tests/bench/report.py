# SPDX-License-Identifier: Apache-2.0
"""Figures that all benchmarks share, and their display."""

from __future__ import annotations

import os
import platform
import statistics
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import NamedTuple, TypeAlias

median = statistics.median


class Row(NamedTuple):
    """A row of the table. `target` is empty if there is none; `method` describes what was measured and how."""

    measure: str
    value: str
    target: str
    method: str


Benchmark: TypeAlias = Callable[[], list[Row]]


def percentile(values: Sequence[float], percent: int) -> float:
    """The smallest value that is not less than a given percentage of the values."""
    return sorted(values)[max(0, -(-len(values) * percent // 100) - 1)]


def seconds(value: float) -> str:
    return f"{value * 1000:.0f} ms" if value < 0.3 else f"{value:.2f} s"


def megabytes(size: int | None) -> str:
    return "not known" if size is None else f"{size / 1e6:.0f} MB"


def listed(values: Iterable[object]) -> str:
    return ", ".join(map(str, values))


def table(rows: Iterable[Row]) -> str:
    lines = ["| measure | figure | target | method |", "| --- | --- | --- | --- |"]
    lines += [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join(lines)


def machine() -> str:
    """A description of the machine, without its name."""
    return f"{os.cpu_count()} cores of an {_processor()}, {platform.system()}, Python {platform.python_version()}"


def _processor() -> str:
    information = Path("/proc/cpuinfo")
    if information.is_file():
        for line in information.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()

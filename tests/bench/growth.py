# SPDX-License-Identifier: Apache-2.0
"""The growth of the time of a check with each dimension of a system: the second size is ten times the first one."""

from __future__ import annotations

import os
import time

from bench.report import Benchmark, Row, seconds
from fuzz.corpus import NOWHERE
from fuzz.growth import DIMENSIONS, Dimension
from roaml import api
from roaml.project.settings import Settings

LARGEST = 2000
"""The larger of the two sizes. Enormous systems are rejected, which takes no time at any size."""


def growth() -> list[Row]:
    rows = []
    for dimension in DIMENSIONS:
        size = min(LARGEST, dimension.most)
        small, large = (_time(dimension, length) for length in (max(1, size // 10), size))
        method = f"{dimension.name}: {size // 10:,} and {size:,}; `api.check` of one system"
        rows.append(Row("check, growth", f"{seconds(small)}, {seconds(large)}", "at most ten times", method))
    return rows


def _time(dimension: Dimension, size: int) -> float:
    """CPU time in s, the best of three runs."""
    texts = dimension.texts(size)
    times = []
    for _ in range(3):
        before = time.process_time()
        api.check([os.path.join(NOWHERE, "main.xml")], [], Settings(), texts)
        times.append(time.process_time() - before)
    return min(times)


BENCHMARKS: dict[str, Benchmark] = {"dimensions": growth}

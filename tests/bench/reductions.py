# SPDX-License-Identifier: Apache-2.0
"""The numbers of states of all complete systems, under two reaction times, without and with reductions."""

from __future__ import annotations

import sys
import time
from typing import NamedTuple

from bench.asked import complete_systems
from bench.report import Benchmark, Row, seconds
from roaml import api
from roaml.durations import AT_ONCE
from roaml.explicit.independence import can_be_reduced
from roaml.explicit.space import LimitError, StateLimits, explore
from roaml.jani.reaction import reacting
from roaml.record import replace
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.verification.exhaustive import alone

LIMITS = StateLimits(states=2_000_000, bytes=1 << 30, transitions=20_000_000)


class Size(NamedTuple):
    """The number of states of a search, whether there are more, and its CPU time in s."""

    states: int
    is_more: bool
    cpu_s: float

    def __str__(self) -> str:
        return f"{'more than ' if self.is_more else ''}{self.states:,} ({seconds(self.cpu_s)})"


def size(checker: ModelChecker, property_: CompiledProperty, *, reduces: bool) -> Size:
    """The number of states of a property."""
    limits = LIMITS if reduces else replace(LIMITS, reduces=False)
    own, subject = alone(checker, property_)
    is_reduced = reduces and can_be_reduced(own.program, subject.goal)
    before = time.process_time()
    try:
        states, is_more = explore(own, subject, limits, is_reduced=is_reduced).states, False
    except LimitError as error:
        states, is_more = error.states, True
    return Size(states, is_more, time.process_time() - before)


def rows() -> list[Row]:
    """For each property of each system, the number of states without and with reductions."""
    found = []
    for name, path, folders in complete_systems():
        model = api.to_jani(api.load(str(path), folders))
        is_timed = model.metadata is not None and model.metadata.clock is not None
        for reaction in ("any", "instant") if is_timed else ("any",):
            try:
                checker = api.checker(model if reaction == "any" else reacting(model, AT_ONCE))
            except FaultError as error:
                found.append(Row(f"states, {reaction}", f"refused: {error}", "", name))
                continue
            for property_ in checker.compiled_properties:
                whole, reduced = (size(checker, property_, reduces=reduces) for reduces in (False, True))
                row = Row(f"states, {reaction}", f"{whole}; {reduced}", "", f"{name}, {property_.question.name}")
                print(*row, sep=" | ", file=sys.stderr)
                found.append(row)
    return found


BENCHMARKS: dict[str, Benchmark] = {"state-counts": rows}

# SPDX-License-Identifier: Apache-2.0
"""The numbers of states of the conformance systems, under two reaction times, without and with reductions, and the
table of the documentation that lists them."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import conformance
from bench.report import Benchmark, Row, seconds
from roaml import api
from roaml.durations import AT_ONCE
from roaml.explicit.independence import can_be_reduced
from roaml.explicit.space import LimitError, StateLimits, explore
from roaml.jani.reaction import reacting
from roaml.record import replace
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.verification.exhaustive import alone

LIMITS = StateLimits(states=2_000_000, bytes=1 << 30, transitions=20_000_000)
"""The limits of the search for one property."""
REACTION_TIMES = ("any", "instant")
HEADING = "| system | property | `any`: all | `any`: reduced | `instant`: all | `instant`: reduced |"
"""The first line of the table in the documentation."""


class Size(NamedTuple):
    """The number of states of a search, whether there are more, and its CPU time in s."""

    states: int
    is_more: bool
    cpu_s: float

    @property
    def number(self) -> str:
        return f"{'more than ' if self.is_more else ''}{self.states:,}"

    def __str__(self) -> str:
        return f"{self.number} ({seconds(self.cpu_s)})"


class Counted(NamedTuple):
    """The numbers of states for one property of a system under one reaction time, without and with reductions."""

    system: str
    property: str
    reaction: str
    whole: Size
    reduced: Size

    @classmethod
    def read(cls, line: str) -> Counted:
        system, property_, reaction, whole, reduced = json.loads(line)
        return cls(system, property_, reaction, Size(*whole), Size(*reduced))


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


def counted(path: Path, known: Sequence[Counted]) -> Iterator[Counted]:
    """The numbers of states of a system, for each property and reaction time.

    Args:
        known: those that were counted before, of any system.
    """
    name = conformance.label(path)
    model = api.to_jani(api.load(str(path), [str(conformance.INTERFACES)]))
    is_timed = model.metadata is not None and model.metadata.clock is not None
    before = {row[:3]: row for row in known}
    for reaction in REACTION_TIMES if is_timed else REACTION_TIMES[:1]:
        checker = api.checker(model if reaction == "any" else reacting(model, AT_ONCE))
        for property_ in checker.compiled_properties:
            asked = property_.question.name
            if row := before.get((name, asked, reaction)):
                yield row
                continue
            whole, reduced = (size(checker, property_, reduces=reduces) for reduces in (False, True))
            yield Counted(name, asked, reaction, whole, reduced)


def rows(record: Path | None = None, page: Path | None = None) -> list[Row]:
    """For each property of each conformance system, the numbers of states without and with reductions.

    Args:
        record: the file that keeps the numbers, so that an interrupted call is continued.
        page: the page of the documentation with the table, which is replaced.
    """
    lines = record.read_text(encoding="utf-8").splitlines() if record is not None and record.exists() else []
    known = [Counted.read(line) for line in lines]
    found = []
    for path in conformance.systems():
        for row in counted(path, known):
            found.append(row)
            print(*_row(row), sep=" | ", file=sys.stderr, flush=True)
            if record is not None and row not in known:
                with record.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
    if page is not None:
        page.write_text(with_table(page.read_text(encoding="utf-8"), found), encoding="utf-8")
    return [_row(row) for row in found]


def _row(row: Counted) -> Row:
    return Row(f"states, {row.reaction}", f"{row.whole}; {row.reduced}", "", f"{row.system}, {row.property}")


def with_table(text: str, found: Iterable[Counted]) -> str:
    """The text of a page with the table of the numbers of states in place of the one that it has."""
    before, heading, rest = text.partition(HEADING)
    if not heading:
        raise ValueError(f"the page has no table that begins with the line\n{HEADING}")
    after = rest.partition("\n\n")[2]
    return f"{before}{HEADING}\n| --- | --- | --- | --- | --- | --- |\n{''.join(_lines(found))}\n{after}"


def _lines(found: Iterable[Counted]) -> Iterator[str]:
    by_property: dict[tuple[str, str], dict[str, Counted]] = {}
    for row in found:
        by_property.setdefault((row.system, row.property), {})[row.reaction] = row
    for (system, property_), by_time in by_property.items():
        cells: list[str] = []
        for reaction in REACTION_TIMES:
            row = by_time.get(reaction)
            cells += ["no timers"] * 2 if row is None else [row.whole.number, row.reduced.number]
        name = system.removeprefix("models/").removesuffix(".xml").replace("/Main/", "/").removesuffix("/main")
        yield f"| `{name}` | `{property_}` | {' | '.join(cells)} |\n"


BENCHMARKS: dict[str, Benchmark] = {"state-counts": rows}

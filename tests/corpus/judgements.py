# SPDX-License-Identifier: Apache-2.0
"""What the comparison with Storm found, and the page of the documentation that lists it."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

EQUAL, DIFFERENT, TOO_LARGE, REFUSED = "equal", "different", "too large", "refused"
COLUMNS = ("any", "two steps", "one step", "instant")
"""The reaction times: `any`, durations of two steps and of one step of the clock, and `instant`."""
NETWORK = "network "
"""The start of the names of random networks, which the page counts and does not list."""
TITLE = """\
# Comparison with Storm

The program `tests/corpus/run.py --step storm` wrote this page. It compares three answers to each property: the minimum
and the maximum that `verify --exhaustive` computes, those that [Storm](https://www.stormchecker.org) computes on the
[translated JANI](jani.md), and an estimate from 200 traces, whose bounds must contain the value under uniform choices.
It does so for four [reaction times](semantics.md#reaction-time): `any`, a duration of two steps of the clock, of one
step, and `instant`. It also compares the reaction times with each other: a shorter one must not widen the range from
minimum to maximum.
"""


class Judgement(NamedTuple):
    """The comparison for one property and reaction time.

    Attributes:
        name: of the property.
        column: the reaction time, one of `COLUMNS`.
        verdict: one of `EQUAL`, `DIFFERENT`, `TOO_LARGE`, `REFUSED`.
        reason: of a verdict other than `EQUAL`.
        searched: states of the search, which applies the reductions; 0 if it did not end.
        storm: states of Storm's model; 0 if Storm has no answer.
        storm_s: CPU time of Storm in s.
    """

    name: str
    column: str
    verdict: str
    reason: str = ""
    searched: int = 0
    storm: int = 0
    storm_s: float = 0.0

    def __str__(self) -> str:
        return f"{self.name}, reaction time {self.column}: {self.reason or self.verdict}"

    @property
    def cell(self) -> str:
        """The judgement in a table."""
        searched = f"{self.searched:,}; " if self.searched else ""
        if self.verdict == EQUAL:
            return f"{searched}{self.storm:,}, {self.storm_s:.1f} s"
        return searched + self.why

    @property
    def why(self) -> str:
        """The reason without the advice for users, which follows a semicolon."""
        return self.reason.partition(";")[0].replace("|", "\\|")


def read(files: Iterable[Path]) -> list[tuple[str, Judgement]]:
    """The systems and judgements in files that `run.py --resume` wrote. A later one replaces an earlier one of the same
    property and reaction time."""
    found: dict[tuple[str, str, str], Judgement] = {}
    for file in files:
        for row in map(json.loads, file.read_text(encoding="utf-8").splitlines()):
            for values in row["judged"]:
                judgement = Judgement(*values)
                found[row["system"], judgement.name, judgement.column] = judgement
    return [(system, judgement) for (system, _, _), judgement in found.items()]


def page(rows: Iterable[tuple[str, Judgement]], limits: str, names: Iterable[str] = ()) -> str:
    """The page in Markdown.

    Args:
        limits: of the search and of Storm, as a sentence.
        names: all systems that are to be compared, in their order; those without a judgement are named.
    """
    systems: dict[tuple[str, str], dict[str, Judgement]] = {}
    networks: list[Judgement] = []
    for system, judgement in rows:
        if system.startswith(NETWORK):
            networks.append(judgement)
        else:
            systems.setdefault((system, judgement.name), {})[judgement.column] = judgement
    places = {name: place for place, name in enumerate(names)}
    systems = dict(sorted(systems.items(), key=lambda item: places.get(item[0][0], len(places))))
    missing = sorted(places.keys() - {system for system, _ in systems}, key=places.__getitem__)
    listed = [judgement for columns in systems.values() for judgement in columns.values()]
    parts = [TITLE, limits, "", '<a id="systems"></a>', "", "## 1. Systems", "", *_counts(listed), "", *_list(systems)]
    parts += ["", f"Not compared: {', '.join(missing)}." if missing else "All conformance systems are listed."]
    parts += ["", '<a id="networks"></a>', "", "## 2. Random networks", "", *_counts(networks), *_reasons(networks)]
    return "\n".join([*parts, ""])


def _counts(judgements: Iterable[Judgement]) -> Iterator[str]:
    """A table of the verdicts by reaction time."""
    counts = Counter((judgement.column, judgement.verdict) for judgement in judgements)
    verdicts = (EQUAL, DIFFERENT, TOO_LARGE, REFUSED)
    yield f"| reaction time | {' | '.join(verdicts)} |"
    yield "| --- | --- | --- | --- | --- |"
    for column in COLUMNS:
        yield f"| {column} | {' | '.join(str(counts[column, verdict]) for verdict in verdicts)} |"


def _reasons(judgements: Iterable[Judgement]) -> Iterator[str]:
    """How often there is no comparison for a reason."""
    for reason, count in sorted(Counter(judgement.why for judgement in judgements if judgement.reason).items()):
        yield f"\n{count} without a comparison: {reason}."


def _list(systems: Mapping[tuple[str, str], Mapping[str, Judgement]]) -> Iterator[str]:
    yield "Each cell has the states of the search, which applies [reductions](reductions.md) where they help, then the"
    yield "states and the CPU time of Storm, or the reason why there is no comparison."
    yield ""
    yield f"| system, property | {' | '.join(COLUMNS)} |"
    yield "| --- | --- | --- | --- | --- |"
    for (system, property_), columns in systems.items():
        cells = [columns[column].cell if column in columns else "no clock" for column in COLUMNS]
        yield f"| {system}, {property_} | {' | '.join(cells)} |"

# SPDX-License-Identifier: Apache-2.0
"""Divides instructions that use the blackboard into steps: scripts, outputs of mocks, and checks of observed
entries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from roaml.expr.tree import Expr
from roaml.libraries.programs.statuses import Known
from roaml.lower.build import equal, floor, integer, name
from roaml.lower.programs.entries import BoardEntry
from roaml.lower.programs.scripts import CompiledScript
from roaml.lower.programs.values import expr
from roaml.record import Record

Place: TypeAlias = "tuple[str, int]"
"""The name of a segment of the code, and the index of an instruction in it."""

EXCEPTION: Place = ("exception", 0)
"""The place at which the execution continues after an exception of the library."""


class ReadEntries(Record, frozen=True):
    """Reads the entries `entries` at once."""

    entries: tuple[BoardEntry, ...]


class Update(Record, frozen=True):
    """Assigns variables of the automaton, and writes entries."""

    assignments: tuple[tuple[str, Expr], ...]
    writes: tuple[BoardEntry, ...]


class Decide(Record, frozen=True):
    """Continues at `yes` if the condition holds, otherwise at `no`."""

    condition: Expr | bool
    yes: Place
    no: Place


class Draw(Record, frozen=True):
    """Continues at `yes` with the probability `probability`, otherwise at `no`."""

    probability: float
    yes: Place
    no: Place


Step: TypeAlias = ReadEntries | Update | Decide | Draw


def update_steps(segment: str, flag: BoardEntry, following: Place, otherwise: Place) -> tuple[Step, ...]:
    """The steps that check whether the observed entry was written. If it was, they reset its flag and continue at
    `following`; otherwise they continue at `otherwise`."""
    return (
        ReadEntries((flag,)),
        Decide(equal(name(flag.local), integer(1)), (segment, 2), otherwise),
        Update(((flag.local, integer(0)),), (flag,)),
        # The blackboard receives pending writes in any order, and a read waits for all of them. Without a read here,
        # the entry could be written before its flag is reset, and the flag would lose that write.
        ReadEntries((flag,)),
        Decide(True, following, otherwise),
    )


def port_steps(
    segment: str, entries: tuple[BoardEntry, ...], whole: Sequence[BoardEntry], following: Place
) -> tuple[Step, ...]:
    """The steps that read the entries of ports. If the value of an entry in `whole` is not an integer, the library
    throws an exception."""
    steps: list[Step] = [ReadEntries(entries)]
    for entry in whole:
        value = name(entry.local)
        steps.append(Decide(equal(floor(value), value), (segment, len(steps) + 1), EXCEPTION))
    return (*steps, Decide(True, following, following))


def output_steps(
    segment: str, outputs: Sequence[tuple[BoardEntry, tuple[Known, ...]]], following: Place
) -> tuple[Step, ...]:
    """The steps that write one of its possible values to each output. All values have the same probability."""
    steps: list[Step] = []
    for entry, values in outputs:
        end = len(steps) + 3 * len(values)
        for position, value in enumerate(values):
            share = 1 / (len(values) - position)
            here = len(steps)
            steps.append(Draw(share, (segment, here + 1), (segment, here + 3)))
            steps.append(Update(((entry.local, expr(value)),), (entry,)))
            steps.append(Decide(True, (segment, end), following))
    return (*steps, Decide(True, following, following))


def script_steps(segment: str, script: CompiledScript, following: Place, otherwise: Place | None) -> tuple[Step, ...]:
    """The steps of a script: they read all entries at once, compute, and write all assigned entries. They continue at
    `following`, or at `otherwise` if that is not `None` and the value of the script is false."""
    steps: list[Step] = [ReadEntries(script.reads)] if script.reads else []
    for condition in script.conditions:
        steps.append(Decide(condition, (segment, len(steps) + 1), EXCEPTION))
    steps.append(Update(script.assignments, script.writes))
    if otherwise is None:
        return (*steps, Decide(True, following, following))
    assert script.truth is not None
    return (*steps, Decide(script.truth, following, otherwise))

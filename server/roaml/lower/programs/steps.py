# SPDX-License-Identifier: Apache-2.0
"""Steps into which instructions on the blackboard are divided: scripts, outputs of mocks, and observed entries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

from roaml.expr.tree import Expr
from roaml.lower.build import equal, integer, name
from roaml.lower.programs.code import Known
from roaml.lower.programs.entries import BoardEntry
from roaml.lower.programs.scripts import CompiledScript
from roaml.lower.programs.values import expr

Place: TypeAlias = "tuple[str, int]"
"""A segment of the code, and the index of an instruction in it."""

EXCEPTION: Place = ("exception", 0)
"""The place after an exception of the library."""


class Ask(NamedTuple):
    """Reads entries."""

    entries: tuple[BoardEntry, ...]


class Update(NamedTuple):
    """Assigns variables of the automaton, and writes entries."""

    assignments: tuple[tuple[str, Expr], ...]
    writes: tuple[BoardEntry, ...]


class Decide(NamedTuple):
    """Continues at `yes` if the condition holds, otherwise at `no`."""

    condition: Expr | bool
    yes: Place
    no: Place


class Draw(NamedTuple):
    """Continues at `yes` with the probability, otherwise at `no`."""

    probability: float
    yes: Place
    no: Place


Step: TypeAlias = Ask | Update | Decide | Draw


def update_steps(segment: str, flag: BoardEntry, following: Place, otherwise: Place) -> tuple[Step, ...]:
    """Whether the observed entry was written; if so, it counts as seen."""
    return (
        Ask((flag,)),
        Decide(equal(name(flag.local), integer(1)), (segment, 2), otherwise),
        Update(((flag.local, integer(0)),), (flag,)),
        Decide(True, following, otherwise),
    )


def output_steps(
    segment: str, outputs: Sequence[tuple[BoardEntry, tuple[Known, ...]]], following: Place
) -> tuple[Step, ...]:
    """Each output gets one of its values, all with the same probability."""
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
    """A script: it reads all entries at once, computes, and writes all that it has assigned. With `otherwise`, it
    continues there if its value is false."""
    steps: list[Step] = [Ask(script.reads)] if script.reads else []
    for condition in script.conditions:
        steps.append(Decide(condition, (segment, len(steps) + 1), EXCEPTION))
    steps.append(Update(script.assignments, script.writes))
    if otherwise is None:
        return (*steps, Decide(True, following, following))
    assert script.truth is not None
    return (*steps, Decide(script.truth, following, otherwise))

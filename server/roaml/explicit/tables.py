# SPDX-License-Identifier: Apache-2.0
"""Tables about a program for a search: which cells each way writes, and which cells belong to variables that guards or
properties read.

A state consists of numbered *cells*: the location of each instance, the integer variables, the real ones, the status of
each until of the goal, and the number of steps, if the goal depends on it.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable

from roaml.jani.expressions import ArrayAccess, Expression, Name
from roaml.jani.model import Assignment
from roaml.record import Record
from roaml.smc.compile import Legend
from roaml.smc.names import Storage
from roaml.smc.program import Goal, Ints, Program
from roaml.smc.registers import REAL, product


class Tables(Record, frozen=True, eq=False):
    """The tables about one program.

    Attributes:
        way_start, way_cell: the cells of variables that each way writes.
        settled: the cells that any step can change: those of transient variables and of accumulated rewards.
        cell_watch: for each cell of a location or variable, the number of the variable among the watched variables, or
            -1.
    """

    way_start: Ints
    way_cell: Ints
    settled: Ints
    cell_watch: Ints


def tables_of(program: Program, goal: Goal, legend: Legend, transient: Iterable[Storage]) -> Tables:
    """The tables of a program with a goal."""
    way_start, way_cell = [0], list[int]()
    instance_of = [number for number, _ in legend.locations]
    for way, (_, destination) in enumerate(legend.ways):
        names = legend.layout.instances[instance_of[program.way_target[way]]].names
        written: dict[int, None] = {}
        for assignment in destination.assignments:
            storage = names.values[_root(assignment)]
            assert isinstance(storage, Storage)
            written.update(dict.fromkeys(_cells(storage, program)))
        way_cell += written
        way_start.append(len(way_cell))
    watch = [-1] * (program.instances + program.int_count + program.real_count)
    for storage in legend.layout.storages:
        for cell in _cells(storage, program):
            watch[cell] = storage.watch
    settled = [cell for storage in transient for cell in _cells(storage, program)]
    settled += [program.instances + program.int_count + register for register in goal.sum_register]
    return Tables(array("i", way_start), array("i", way_cell), array("i", settled), array("i", watch))


def _cells(storage: Storage, program: Program) -> range:
    first = program.instances + storage.base + (program.int_count if storage.kind == REAL else 0)
    return range(first, first + product(storage.shape))


def _root(assignment: Assignment) -> str:
    target: Expression = assignment.target
    while isinstance(target, ArrayAccess):
        target = target.array
    assert isinstance(target, Name)
    return target.identifier

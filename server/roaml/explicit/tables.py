# SPDX-License-Identifier: Apache-2.0
"""Tables about a program for a search: which cells each way writes, and which cells belong to variables that guards or
properties read.

A state consists of numbered *cells*: the location of each instance, the integer variables, the real ones, the status of
each until of the goal, and the number of steps, if the goal depends on it.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable

from roaml.explicit.liveness import Liveness
from roaml.explicit.uses import bits
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
        cell_watch: for each cell of a variable, the number of the variable among the watched variables, or -1.
        drop_start, drop_cell: for each move, the cells that are dead in its target location, but not in its source
            location.
        owner_start: for each cell of a location or variable, the index of its first owner.
        owner_instance: the instances on whose locations it depends whether the cell is dead.
        owner_table: for each of these, the index in `is_dead` for the location with the number 0.
        is_dead: whether a cell is dead in a location of an owner.
    """

    way_start: Ints
    way_cell: Ints
    settled: Ints
    cell_watch: Ints
    drop_start: Ints
    drop_cell: Ints
    owner_start: Ints
    owner_instance: Ints
    owner_table: Ints
    is_dead: Ints


def tables_of(
    program: Program,
    goal: Goal,
    legend: Legend,
    transient: Iterable[Storage],
    liveness: Liveness,
    written: tuple[Ints, Ints],
) -> Tables:
    """The tables of a program with a goal.

    Args:
        written: the result of `cells_written`.
    """
    settled = [cell for storage in transient for cell in _cells(storage, program)]
    settled += [program.instances + program.int_count + register for register in goal.sum_register]
    return Tables(
        *written,
        array("i", settled),
        program.cell_watch,
        *_dropped(program, legend, liveness),
        *_owners(program, legend, liveness),
    )


def cells_written(program: Program, legend: Legend) -> tuple[Ints, Ints]:
    """`way_start` and `way_cell` of the tables of a program."""
    way_start, way_cell = [0], list[int]()
    instance_of = [number for number, _ in legend.locations]
    for way, (_, destination) in enumerate(legend.ways):
        names = legend.layout.instances[instance_of[program.way_target[way]]].names
        written: dict[int, None] = {}
        for assignment in destination.assignments:
            storage = names.values[assignment.variable]
            assert isinstance(storage, Storage)
            written.update(dict.fromkeys(_cells(storage, program)))
        way_cell += written
        way_start.append(len(way_cell))
    return array("i", way_start), array("i", way_cell)


def _dropped(program: Program, legend: Legend, liveness: Liveness) -> tuple[Ints, Ints]:
    """`drop_start` and `drop_cell`."""
    storages = legend.layout.storages
    moves = dict(zip(program.way_move, legend.moves, strict=True))
    starts, cells = [0], list[int]()
    for move in range(max(program.way_move, default=-1) + 1):
        source, target = moves[move]
        dropped = liveness.dead[target] & ~liveness.dead[source]
        for number in bits(dropped):
            cells += _cells(storages[number], program)
        starts.append(len(cells))
    return array("i", starts), array("i", cells)


def _owners(program: Program, legend: Legend, liveness: Liveness) -> tuple[Ints, Ints, Ints, Ints]:
    """`owner_start`, `owner_instance`, `owner_table` and `is_dead`."""
    storages = legend.layout.storages
    ranges = [*program.first_location, len(legend.locations)]
    owners: dict[int, list[tuple[int, int]]] = {}
    is_dead = list[int]()

    def add(number: int, instance: int, dead: Iterable[int]) -> None:
        pair = instance, len(is_dead) - ranges[instance]
        is_dead.extend(dead)
        for cell in _cells(storages[number], program):
            owners.setdefault(cell, []).append(pair)

    for number in bits(liveness.unobserved):
        add(number, 0, [1] * (ranges[1] - ranges[0]))
    for instance, variables in enumerate(liveness.owned):
        locations = range(ranges[instance], ranges[instance + 1])
        for number in bits(variables):
            dead = [liveness.dead[location] >> number & 1 for location in locations]
            if any(dead):
                add(number, instance, dead)
    starts, pairs = [0], list[tuple[int, int]]()
    for cell in range(program.instances + program.int_count + program.real_count):
        pairs += owners.get(cell, ())
        starts.append(len(pairs))
    instances, tables = zip(*pairs, strict=True) if pairs else ((), ())
    return array("i", starts), array("i", instances), array("i", tables), array("i", is_dead)


def _cells(storage: Storage, program: Program) -> range:
    first = program.instances + storage.base + (program.int_count if storage.kind == REAL else 0)
    return range(first, first + product(storage.shape))

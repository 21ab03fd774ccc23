# SPDX-License-Identifier: Apache-2.0
"""`Program.updates`: what a step changes, prepared for the kernel, so that it need not be computed in each step."""

from __future__ import annotations

from array import array
from collections.abc import Sequence

from roaml.record import Record
from roaml.smc.program import Ints

MAX_STEP_ITEMS = 1 << 20
"""The number of items from which no more steps are written, only moves."""


class UpdateTables(Record, frozen=True):
    """The parts of a program from which updates are computed; `Program` defines those of the same name.

    Attributes:
        location_instance: the instance of each location.
        way_source: the source location of each way.
        counts: for each group, the number of its enabled edges, -1 if that depends on the guards of several edges, and
            -2 - g if it depends on the guard g of a single edge.
        active: the slots of each vector that have an effect.
    """

    location_instance: Sequence[int]
    group_start: Sequence[int]
    group_slot: Sequence[int]
    group_way: Sequence[int]
    counts: Sequence[int]
    edge_start: Sequence[int]
    way_start: Sequence[int]
    way_source: Sequence[int]
    way_target: Sequence[int]
    way_code: Sequence[int]
    way_move: Sequence[int]
    slot_vector: Sequence[int]
    active: Sequence[Sequence[int]]
    entangled: Sequence[bool]


class Updates(Record, frozen=True):
    """The members of `Program` with these names."""

    way_update: Ints
    vector_update: Ints
    group_update: Ints
    updates: Ints


class _Move(Record, frozen=True):
    """The four parts of a move of one instance."""

    places: tuple[int, int]
    left: list[tuple[int, int]]
    entered: list[int]
    others: list[int]


def write_updates(tables: UpdateTables) -> Updates:
    """Compute the steps of vectors of which at most one slot has several groups, and the moves of all other ways."""
    return _UpdateWriter(tables).updates()


class _UpdateWriter:
    def __init__(self, tables: UpdateTables) -> None:
        self.tables = tables
        self.records: list[int] = []
        self.moves: dict[int, _Move] = {}
        self.groups: list[list[int]] = [[] for _ in tables.slot_vector]
        for group, slot in enumerate(tables.group_slot):
            self.groups[slot].append(group)
        self.way_update = array("i", [-1]) * len(tables.way_move)
        self.group_update = array("i", [-1]) * len(tables.group_slot)

    def updates(self) -> Updates:
        vector_update = array("i")
        chosen = set[int]()
        for vector, slots in enumerate(self.tables.active):
            update, is_complete = self._of_vector(vector, slots)
            vector_update.append(update)
            if not is_complete:
                chosen.update(slots)
        self._write_ways(chosen)
        return Updates(self.way_update, vector_update, self.group_update, array("i", self.records))

    def _of_vector(self, vector: int, slots: Sequence[int]) -> tuple[int, bool]:
        """The item of `Program.vector_update`, and whether all steps of the vector are written."""
        tables = self.tables
        ways, varying = list[int](), list[int]()
        for slot in slots:
            groups = self.groups[slot]
            if len(groups) == 1:
                ways.append(tables.group_way[groups[0]])
            else:
                varying.append(slot)
        if -1 in ways or tables.entangled[vector] or len(self.records) >= MAX_STEP_ITEMS:
            return -1, False
        if not varying:
            return self._write(vector, slots, ways), True
        slot = varying[0]
        if len(varying) > 1 or tables.slot_vector[slot] != vector:
            return -1, False
        at = list(slots).index(slot)
        is_complete = True
        for group in self.groups[slot]:
            way = tables.group_way[group]
            if way >= 0 and len(self.records) < MAX_STEP_ITEMS:
                self.group_update[group] = self._write(vector, slots, [*ways[:at], way, *ways[at:]])
            else:
                is_complete = False
        return -2 - slot, is_complete

    def _write(self, vector: int, slots: Sequence[int], ways: list[int]) -> int:
        """Write the step that takes a vector with these ways; return its index."""
        tables = self.tables
        codes = [tables.way_code[way] for way in ways if tables.way_code[way] >= 0]
        moves = [self._move(way) for way in ways if tables.way_move[way] >= 0]
        own = [slot for move in moves for slot, only in move.left if only == vector]
        records = self.records
        start = len(records)
        end = start + 2 + len(codes)
        records += (end, end + len(own), *codes, *own)
        self._write_moves(moves, vector)
        records.append(len(ways))
        for pair in zip(slots, ways, strict=True):
            records += pair
        return start

    def _write_ways(self, slots: set[int]) -> None:
        """Write the moves of all ways of some slots."""
        tables = self.tables
        starts: dict[int, int] = {-1: -1}
        for slot in sorted(slots):
            for group in self.groups[slot]:
                first, end = tables.edge_start[group], tables.edge_start[group + 1]
                for way in range(tables.way_start[first], tables.way_start[end]):
                    move = tables.way_move[way]
                    if move not in starts:
                        starts[move] = len(self.records)
                        self._write_moves([self._move(way)], -1)
                    self.way_update[way] = starts[move]

    def _write_moves(self, moves: list[_Move], vector: int) -> None:
        """Write one move that does the same as several ones, except for slots that are left and take part in `vector`
        only."""
        places: list[int] = []
        left: list[int] = []
        entered: list[int] = []
        others: list[int] = []
        for move in moves:
            places += move.places
            for pair in move.left:
                if pair[1] != vector or vector < 0:
                    left += pair
            entered += move.entered
            others += move.others
        end_places = len(self.records) + 4 + len(places)
        end_left = end_places + len(left)
        end_entered = end_left + len(entered)
        self.records += (end_places, end_left, end_entered, end_entered + len(others))
        self.records += places
        self.records += left
        self.records += entered
        self.records += others

    def _move(self, way: int) -> _Move:
        """The move of a way whose source and target differ."""
        tables = self.tables
        move = self.moves.get(tables.way_move[way])
        if move is None:
            source, target = tables.way_source[way], tables.way_target[way]
            move = _Move((tables.location_instance[target], target), [], [], [])
            before, after = self._groups(source), self._groups(target)
            for slot, group in before.items():
                if slot not in after:
                    if tables.counts[group] == 1 or tables.counts[group] < -1:
                        move.left.append((slot, tables.slot_vector[slot]))
                    else:
                        move.others.extend((slot, group, 0))
            for slot, group in after.items():
                if tables.counts[group] == 1 and slot not in before:
                    move.entered.extend((slot, tables.slot_vector[slot], group))
                else:
                    move.others.extend((slot, group, tables.counts[group]))
            self.moves[tables.way_move[way]] = move
        return move

    def _groups(self, location: int) -> dict[int, int]:
        """The slots of a location, with their groups."""
        groups = range(self.tables.group_start[location], self.tables.group_start[location + 1])
        return {self.tables.group_slot[group]: group for group in groups}

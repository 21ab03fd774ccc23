# SPDX-License-Identifier: Apache-2.0
"""A JANI model -> a `Program`, once for all traces and properties: code for guards and destinations, and tables."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from roaml.jani.expressions import Real
from roaml.jani.model import Assignment, Destination, Edge, Model, ModelType
from roaml.jani.node import Origin
from roaml.jani.properties import Formula, identifiers
from roaml.record import Record
from roaml.smc.assemble import ExpressionAssembler
from roaml.smc.assign import AssignmentAssembler
from roaml.smc.cells import CellAssembler
from roaml.smc.end import Marks
from roaml.smc.fault import FaultError
from roaml.smc.index import MIN_INDEXED, Indexes, dimensions_of, fixed_values, is_fixed
from roaml.smc.initial import MAX_INITIAL_STATES, Cells
from roaml.smc.layout import MemoryLayout, lay_out
from roaml.smc.names import Storage, StorageNames
from roaml.smc.network import CompiledNetwork, EdgeStep, Reads, Slot
from roaml.smc.program import Ints, Program
from roaml.smc.registers import REAL, Tape, product
from roaml.smc.updates import Updates, UpdateTables, write_updates

SUPPORTED = (ModelType.DTMC, ModelType.MDP, ModelType.LTS)


class Legend(Record, frozen=True):
    """The meanings of the numbers in a program (`roaml.smc.program` defines the terms). Workers do not need them.

    Attributes:
        layout: the registers of all variables.
        locations: the number of the instance and the name of each location.
        ways: the edge and the destination of each way.
        moves: the numbers of the source and the target location of each way.
        vectors: the numbers of the slots of each synchronisation vector, and its action.
        slots: the edges of each instance for one action.
        reads: the names that the expressions and assignments of the model read.
    """

    layout: MemoryLayout
    locations: list[tuple[int, str]]
    ways: list[tuple[Edge, Destination]]
    moves: list[tuple[int, int]]
    vectors: list[tuple[list[int], str | None]]
    slots: list[Slot]
    reads: Reads


class Compilation:
    """Compiles `model` so that changes of the variables in `formulas` can be tracked; `program` returns the result.

    Raises:
        FaultError: the model has unsupported or invalid parts, or no initial state.
    """

    def __init__(self, model: Model, formulas: Iterable[Formula] = ()) -> None:
        if model.type not in SUPPORTED:
            raise FaultError(
                f"models of type `{model.type.value}` are not supported; use `dtmc`, `lts` or `mdp`", model.origin
            )
        self.model = model
        self.tape = Tape()
        self.cells = CellAssembler(self.tape)
        self.expressions = ExpressionAssembler(self.cells)
        self.assignments = AssignmentAssembler(self.expressions)
        self.layout = lay_out(model, self.tape)
        self.int_count, self.real_count = len(self.tape.ints), len(self.tape.reals)
        self.network = CompiledNetwork(model, self.layout)
        self.watched: list[Storage] = []
        self._watch(formulas)
        self._write()

    def _watch(self, formulas: Iterable[Formula]) -> None:
        """Number the variables whose changes must be tracked: those that guards and properties read."""

        def watch(name: str, names: StorageNames) -> None:
            meaning = names.values.get(name)
            if isinstance(meaning, Storage) and meaning.watch < 0 and not meaning.is_constant:
                meaning.watch = len(self.watched)
                self.watched.append(meaning)

        for slot in self.network.slots:
            names = self.layout.instances[slot.instance].names
            if not slot.vectors:
                continue
            for steps in slot.steps.values():
                for step in steps:
                    if step.guard is not None:
                        for name in sorted(self.network.reads.names_in(step.guard, names)):
                            watch(name, names)
        for formula in formulas:
            for name, _ in identifiers(formula):
                watch(name, self.layout.names)

    # ------------------------------------------------------------ code

    def _write(self) -> None:
        self.group_start, self.group_slot = [0], list[int]()
        self.edge_start, self.guard = [0], list[int]()
        self.way_start, self.way_target, self.way_code = [0], list[int](), list[int]()
        self.way_sum, self.way_chance, self.way_move = list[float](), list[int](), list[int]()
        self.phase_start, self.phase_index = [0], list[int]()
        self.phase_read, self.phase_write = list[int](), list[int]()
        self.ways: list[tuple[Edge, Destination]] = []
        self.way_source: list[int] = []
        self.group_of: dict[tuple[int, int], int] = {}
        self.group_steps: list[list[EdgeStep]] = []
        self.group_way: list[int] = []
        self.entangled = [self._is_entangled(slots) for slots, _ in self.network.vectors]
        phased = {s for (slots, _), yes in zip(self.network.vectors, self.entangled, strict=True) if yes for s in slots}
        here: dict[int, list[int]] = {}
        for number, slot in enumerate(self.network.slots):
            if slot.vectors:
                for location in slot.steps:
                    here.setdefault(location, []).append(number)
        for location in range(len(self.network.locations)):
            for number in here.get(location, ()):
                self.group_of[location, number] = len(self.group_slot)
                self.group_slot.append(number)
                steps = self.network.slots[number].steps[location]
                self.group_steps.append(steps)
                self.group_way.append(len(self.way_target) if len(steps) == 1 == len(steps[0].ways) else -1)
                for step in steps:
                    self._write_step(step, location, number in phased)
                self.edge_start.append(len(self.guard))
            self.group_start.append(len(self.group_slot))
        self._write_moves()

    def _is_entangled(self, slots: list[int]) -> bool:
        """Whether the assignments of one part of a vector affect another part."""
        if len(slots) < 2:
            return False
        shared = []
        for number in slots:
            slot = self.network.slots[number]
            if slot.writes:
                own = {storage.name for storage in self.layout.instances[slot.instance].own}
                shared.append((slot.writes - own, slot.reads - own))
        for i, (writes, _) in enumerate(shared):
            for k, (other_writes, other_reads) in enumerate(shared):
                if i != k and writes & (other_writes | other_reads):
                    return True
        return False

    def _write_step(self, step: EdgeStep, location: int, is_phased: bool) -> None:
        number, _ = self.network.locations[location]
        instance = self.layout.instances[number]
        names = instance.names
        self.guard.append(-1 if step.guard is None else self.expressions.condition(step.guard, names, step.edge.origin))
        total = 0.0
        for way in step.ways:
            destination = way.destination
            target = self.network.location_of[number].get(destination.location)
            if target is None:
                raise FaultError(
                    f"there is no location `{destination.location}`", destination.origin or step.edge.origin
                )
            self.way_source.append(location)
            self.way_target.append(target)
            self.ways.append((step.edge, destination))
            chance = -1
            if way.probability is None:
                clause = destination.probability
                exp = Real(1.0) if clause is None else clause.exp
                chance = self.expressions.real_register(exp, names, destination.origin or step.edge.origin)
            else:
                total += way.probability
            self.way_chance.append(chance)
            self.way_sum.append(total)
            origin = destination.origin or step.edge.origin
            self.way_code.append(self._write_assignments(destination.assignments, names, origin))
            if is_phased:
                self._write_phases(destination.assignments, names, origin)
            self.phase_start.append(len(self.phase_index))
        if step.ways[-1].probability is not None:
            self.way_sum[-1] = 1.0
        self.way_start.append(len(self.way_target))

    def _write_assignments(
        self, assignments: tuple[Assignment, ...], names: StorageNames, origin: Origin | None
    ) -> int:
        if not assignments:
            return -1
        start = self.tape.begin(origin)
        for group in _by_index(assignments):
            if len(group) == 1 or not self._has_hazard(group, names):
                for assignment in group:
                    self.assignments.assign(assignment.target, assignment.value, names, assignment.origin)
                continue
            for later in [
                self.assignments.early(assignment.target, assignment.value, names, assignment.origin)
                for assignment in group
            ]:
                self.assignments.finish(later)
        self.cells.end()
        return start

    def _has_hazard(self, group: list[Assignment], names: StorageNames) -> bool:
        """Whether one of the simultaneous assignments reads a variable that an earlier one writes."""
        written: set[str] = set()
        for assignment in group:
            if written & self.network.reads.by(assignment, names):
                return True
            written.add(assignment.variable)
        return False

    def _write_phases(self, assignments: tuple[Assignment, ...], names: StorageNames, origin: Origin | None) -> None:
        for group in _by_index(assignments):
            self.phase_index.append(group[0].index)
            self.phase_read.append(self.tape.begin(origin))
            computed = [
                self.assignments.early(assignment.target, assignment.value, names, assignment.origin)
                for assignment in group
            ]
            self.cells.end()
            self.phase_write.append(self.tape.begin(origin))
            for later in computed:
                self.assignments.finish(later)
            self.cells.end()

    def _write_moves(self) -> None:
        """Number the pairs of a source and a target location."""
        known: dict[tuple[int, int], int] = {}
        for source, target in zip(self.way_source, self.way_target, strict=True):
            if source == target:
                self.way_move.append(-1)
                continue
            if (source, target) not in known:
                known[source, target] = len(known)
            self.way_move.append(known[source, target])

    def _updates(self, slot_vector: list[int], active: list[list[int]]) -> Updates:
        return write_updates(
            UpdateTables(
                [number for number, _ in self.network.locations],
                self.group_start,
                self.group_slot,
                self.group_way,
                [self._count(group) for group in range(len(self.group_slot))],
                self.edge_start,
                self.way_start,
                self.way_source,
                self.way_target,
                self.way_code,
                self.way_move,
                slot_vector,
                active,
                self.entangled,
            )
        )

    def _count(self, group: int) -> int:
        """The number of enabled edges of a group, see `UpdateTables.counts`."""
        steps = self.group_steps[group]
        if len(steps) == 1:
            guard = self.guard[self.edge_start[group]]
            return 1 if guard < 0 else -2 - guard
        return -1 if any(step.guard is not None for step in steps) else len(steps)

    # ------------------------------------------------------------ the end

    def program(self, marks: Marks) -> Program:
        """The program with all code that has been written so far."""
        slot_vector, gate_tables = self._gate_tables()
        inert = [all(s.is_inert for steps in slot.steps.values() for s in steps) for slot in self.network.slots]
        active = [[s for s in slots if not inert[s]] for slots, _ in self.network.vectors]
        active_start, active_slot = _ranges(active)
        updates = self._updates(slot_vector, active)
        all_start, all_slot = _ranges([slots for slots, _ in self.network.vectors])
        settle, location_code = self._write_transient()
        index_tables = self._index_tables()
        return Program(
            code=_ints(self.tape.code),
            functions=list(self.tape.functions),
            ints=array("q", self.tape.ints),
            reals=array("d", self.tape.reals),
            int_count=self.int_count,
            real_count=self.real_count,
            instances=len(self.layout.instances),
            initial=_ints(
                self.network.location_of[number][instance.automaton.initial_locations[0]]
                for number, instance in enumerate(self.layout.instances)
            ),
            **self._initial_tables(),
            **gate_tables,
            **index_tables,
            first_location=_ints(self.network.first_location),
            group_start=_ints(self.group_start),
            group_slot=_ints(self.group_slot),
            group_way=_ints(self.group_way),
            edge_start=_ints(self.edge_start),
            guard=_ints(self.guard),
            way_start=_ints(self.way_start),
            way_target=_ints(self.way_target),
            way_code=_ints(self.way_code),
            way_sum=array("d", self.way_sum),
            way_chance=_ints(self.way_chance),
            way_move=_ints(self.way_move),
            way_update=updates.way_update,
            vector_update=updates.vector_update,
            group_update=updates.group_update,
            updates=updates.updates,
            slot_instance=_ints([slot.instance for slot in self.network.slots]),
            first_held=self.network.first_held,
            active_start=active_start,
            active_slot=active_slot,
            all_start=all_start,
            all_slot=all_slot,
            entangled=_ints([int(yes) for yes in self.entangled]),
            phase_start=_ints(self.phase_start),
            phase_index=_ints(self.phase_index),
            phase_read=_ints(self.phase_read),
            phase_write=_ints(self.phase_write),
            settle=settle,
            location_code=location_code,
            location_mark=_ints(
                marks.get((self.layout.instances[number].automaton.name, location), 0)
                for number, location in self.network.locations
            ),
        )

    @property
    def initial_states(self) -> int:
        """The number of initial states.

        Raises:
            FaultError: there are too many to number them.
        """
        count = 1
        for _, rows in self._initial_choices():
            count *= len(rows)
        if count > MAX_INITIAL_STATES:
            raise FaultError(
                "the model has more than 2⁶² initial states; give more variables an `initial-value`", self.model.origin
            )
        return count

    def _initial_choices(self) -> list[tuple[list[int], Sequence[Cells]]]:
        """The independent choices between initial locations or values: their cells (see `Program.root_cell`) and the
        combinations of values."""
        choices: list[tuple[list[int], Sequence[Cells]]] = []
        for number, instance in enumerate(self.layout.instances):
            names = dict.fromkeys(instance.automaton.initial_locations)
            if len(names) > 1:
                choices.append(([number], [(self.network.location_of[number][name],) for name in names]))
        instances = len(self.layout.instances)
        for choice in self.layout.choices:
            firsts = [instances + (self.int_count if s.kind == REAL else 0) for s in choice.storages]
            cells = [first + s.base for first, s in zip(firsts, choice.storages, strict=True)]
            choices.append((cells, choice.rows))
        return choices

    def _gate_tables(self) -> tuple[list[int], dict[str, Any]]:
        """For each slot its only vector, or -2 minus the gate of its vectors, or -1 if there is no vector; and the
        members of `Program` about gates."""
        gates: dict[tuple[int, ...], list[int]] = {}
        slot_vector = [-1] * len(self.network.slots)
        vector_missing = [0] * len(self.network.vectors)
        for number, slot in enumerate(self.network.slots):
            if len(slot.vectors) == 1:
                slot_vector[number] = slot.vectors[0]
                vector_missing[slot.vectors[0]] += 1
            elif slot.vectors:
                gates.setdefault(tuple(slot.vectors), []).append(number)
        gate_start, gate_vector, gate_missing = [0], list[int](), list[int]()
        for gate, (vectors, slots) in enumerate(gates.items()):
            for number in slots:
                slot_vector[number] = -2 - gate
            gate_vector += vectors
            gate_start.append(len(gate_vector))
            gate_missing.append(len(slots))
            for vector in vectors:
                vector_missing[vector] += 1
        return slot_vector, {
            "slot_vector": _ints(slot_vector),
            "gate_start": _ints(gate_start),
            "gate_vector": _ints(gate_vector),
            "gate_missing": _ints(gate_missing),
            "vector_missing": _ints(vector_missing),
        }

    def _index_tables(self) -> dict[str, Any]:
        """The members of `Program` about watched variables and indexes of guards."""
        indexes = Indexes()
        self._constants, self._fixed = self.tape.constants, dict[int, dict[int, int]]()
        group_index = self._edge_indexes(indexes)
        watch_start, watch_instance, watch_table, watched_start, watched_group, watched_index = self._watch_tables(
            indexes
        )
        cell_watch = self._cell_watch()
        indexed: list[list[int]] = [[] for _ in self.watched]
        for register in sorted({dimension.register for dimension in indexes.dimensions}):
            if cell_watch[register] >= 0:  # a cell of a constant array is not watched
                indexed[cell_watch[register]].append(register)
        indexed_start, indexed_register = _ranges(indexed)
        return {
            "watch_start": watch_start,
            "watch_instance": watch_instance,
            "watch_table": watch_table,
            "watched_start": watched_start,
            "watched_group": watched_group,
            "cell_watch": cell_watch,
            "watched_index": watched_index,
            "indexed_start": indexed_start,
            "indexed_register": indexed_register,
            "group_index": _ints(group_index),
            "dimension_start": _ints(indexes.dimension_start),
            "dimension_register": _ints([dimension.register for dimension in indexes.dimensions]),
            "dimension_low": array("q", [dimension.low for dimension in indexes.dimensions]),
            "dimension_size": _ints([dimension.size for dimension in indexes.dimensions]),
            "first_list": _ints(indexes.first_list),
            "list_start": _ints(indexes.list_start),
            "list_item": _ints(indexes.items),
        }

    def _initial_tables(self) -> dict[str, Any]:
        """The members of `Program` about the choices between initial values."""
        start, cells, first = [0], list[int](), list[int]()
        ints, reals, counts = array("q"), array("d"), array("q")
        for own, rows in self._initial_choices():
            cells += own
            start.append(len(cells))
            first.append(len(ints))
            counts.append(len(rows))
            for row in rows:
                ints.extend(0 if isinstance(value, float) else int(value) for value in row)
                reals.extend(float(value) for value in row)
        return {
            "root_start": _ints(start),
            "root_cell": _ints(cells),
            "root_count": counts,
            "root_first": _ints(first),
            "root_int": ints,
            "root_real": reals,
        }

    @property
    def legend(self) -> Legend:
        network = self.network
        moves = list(zip(self.way_source, self.way_target, strict=True))
        return Legend(self.layout, network.locations, self.ways, moves, network.vectors, network.slots, network.reads)

    def _cell_watch(self) -> Ints:
        numbers = [-1] * (self.int_count + self.real_count)
        for storage in self.layout.storages:
            first = storage.base + (self.int_count if storage.kind == REAL else 0)
            size = product(storage.shape)
            numbers[first : first + size] = [storage.watch] * size
        return _ints(numbers)

    def _write_transient(self) -> tuple[int, Ints]:
        """Write code that resets transient variables, and code for each location that sets the values that they have
        there.

        Returns:
            The start of the first code, -1 if there are no transient variables; and the start of the code of each
            location, -1 if the location sets no values.
        """
        model = self.model
        code = [-1] * len(self.network.locations)
        scopes: list[tuple[StorageNames, Iterable[Storage], Mapping[str, bool]]] = [
            (self.layout.names, self.layout.shared, {v.name: v.transient for v in model.variables})
        ]
        for instance in self.layout.instances:
            flags = {v.name: v.transient for v in instance.automaton.variables}
            scopes.append((instance.names, instance.own, flags))
        transient = [storage for _, storages, flags in scopes for storage in storages if flags[storage.name]]
        if not transient:
            return -1, _ints(code)
        settle = self.tape.begin()
        for storage in transient:
            self.assignments.reset(storage)
        self.cells.end()
        for number, instance in enumerate(self.layout.instances):
            for location in instance.automaton.locations:
                if location.transient_values:
                    code[self.network.location_of[number][location.name]] = self.tape.begin()
                    for value in location.transient_values:
                        self.assignments.assign(value.target, value.value, instance.names, value.origin)
                    self.cells.end()
        return settle, _ints(code)

    def _edge_indexes(self, indexes: Indexes) -> list[int]:
        """For each group, the index of its edges, or -1."""
        numbers = [-1] * len(self.group_slot)
        for group in range(len(self.group_slot)):
            edges = range(self.edge_start[group], self.edge_start[group + 1])
            if len(edges) >= MIN_INDEXED:
                guards = {edge: self._fixed_values(self.guard[edge]) for edge in edges}
                dimensions = dimensions_of(list(guards.values()))
                if dimensions:
                    fixed = {edge for edge, values in guards.items() if self._is_fixed(edge, values)}
                    numbers[group] = indexes.add(dimensions, guards, fixed, has_all=True)
        return numbers

    def _add_index(self, groups: list[int], indexes: Indexes) -> tuple[int, list[int]]:
        """Add an index of groups. Return its number, -1 if there is none; and the groups that are not in it."""
        if len(groups) < MIN_INDEXED:
            return -1, groups
        guards = {group: self._fixed_in_all(group) for group in groups}
        dimensions = dimensions_of(list(guards.values()))
        if not dimensions:
            return -1, groups
        keyed = {
            group: values
            for group, values in guards.items()
            if all(dimension.register in values for dimension in dimensions)
        }
        fixed = {
            group
            for group, values in keyed.items()
            if len(self.group_steps[group]) == 1 and self._is_fixed(self.edge_start[group], values)
        }
        return indexes.add(dimensions, keyed, fixed, has_all=False), [group for group in groups if group not in keyed]

    def _fixed_in_all(self, group: int) -> dict[int, int]:
        """The values that registers must have for one of the edges of a group to be enabled."""
        first, *others = range(self.edge_start[group], self.edge_start[group + 1])
        values = self._fixed_values(self.guard[first])
        for edge in others:
            values = dict(values.items() & self._fixed_values(self.guard[edge]).items())
        return values

    def _is_fixed(self, edge: int, values: Mapping[int, int]) -> bool:
        return is_fixed(self.tape.code, self.guard[edge], self.tape.ints, self.int_count, self._constants, values)

    def _fixed_values(self, guard: int) -> dict[int, int]:
        values = self._fixed.get(guard)
        if values is None:
            values = fixed_values(self.tape.code, guard, self.tape.ints, self.int_count, self._constants)
            self._fixed[guard] = values
        return values

    def _watch_tables(self, indexes: Indexes) -> tuple[Ints, Ints, Ints, Ints, Ints, Ints]:
        """Two tables: the instances whose guards read each watched variable, and the groups of these guards in each
        location of these instances; for each of these locations, an index of groups, which are left out of the table,
        or -1."""
        readers: dict[tuple[int, int], dict[int, list[int]]] = {}
        for (location, _), group in self.group_of.items():
            number, _ = self.network.locations[location]
            names = self.layout.instances[number].names
            variables = set()
            for step in self.group_steps[group]:
                if step.guard is not None:
                    variables |= self.network.reads.names_in(step.guard, names)
            for name in variables:
                meaning = names.values.get(name)
                if isinstance(meaning, Storage) and meaning.watch >= 0:
                    readers.setdefault((meaning.watch, number), {}).setdefault(location, []).append(group)
        watch_start, watch_instance, watch_table = [0], list[int](), list[int]()
        watched_start, watched_group, watched_index = array("i", [0]), list[int](), array("i")

        def skip(count: int) -> None:
            """Add locations whose guards do not read the variable. A node with many children has thousands of them."""
            watched_index.extend(array("i", [-1]) * count)
            watched_start.extend(array("i", [len(watched_group)]) * count)

        by_variable: dict[int, list[int]] = {}
        for variable, number in sorted(readers):
            by_variable.setdefault(variable, []).append(number)
        for variable in range(len(self.watched)):
            for number in by_variable.get(variable, ()):
                watch_instance.append(number)
                watch_table.append(len(watched_start) - 1)
                next_location = self.network.first_location[number]
                end = next_location + len(self.network.location_of[number])
                for location, groups in sorted(readers[variable, number].items()):
                    skip(location - next_location)
                    index, others = self._add_index(groups, indexes)
                    watched_index.append(index)
                    watched_group += others
                    watched_start.append(len(watched_group))
                    next_location = location + 1
                skip(end - next_location)
            watch_start.append(len(watch_instance))
        tables = watch_start, watch_instance, watch_table, watched_start, watched_group, watched_index
        return tuple(map(_ints, tables))  # type: ignore[return-value]


def _ints(values: Iterable[int]) -> Ints:
    return array("i", values)


def _ranges(lists: Iterable[list[int]]) -> tuple[Ints, Ints]:
    starts, items = [0], list[int]()
    for numbers in lists:
        items += numbers
        starts.append(len(items))
    return _ints(starts), _ints(items)


def _by_index(assignments: tuple[Assignment, ...]) -> list[list[Assignment]]:
    """The assignments grouped by their index, in the order of their execution."""
    groups: dict[int, list[Assignment]] = {}
    for assignment in assignments:
        groups.setdefault(assignment.index, []).append(assignment)
    return [groups[index] for index in sorted(groups)]

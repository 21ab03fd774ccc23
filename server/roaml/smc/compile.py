# SPDX-License-Identifier: Apache-2.0
"""A JANI model -> a `Program`, once for all traces and properties.

- Every edge without action and every combination of edges of a synchronisation vector is one choice.
- Edges that can never be taken and ways of probability 0 are left out.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from roaml.jani.expressions import ArrayAccess, Binary, Boolean, Expression, Real, Unary
from roaml.jani.model import Assignment, Destination, Edge, Model, ModelType
from roaml.jani.node import Origin
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.jani.properties import Formula, identifiers
from roaml.jani.semantics import EvaluationError, Value, evaluate
from roaml.smc.assign import AssignmentAssembler
from roaml.smc.fault import FaultError
from roaml.smc.layout import Instance, Layout, lay_out
from roaml.smc.names import Names, Storage, variables_in
from roaml.smc.program import Ints, Program
from roaml.smc.registers import Operand

SUPPORTED = (ModelType.DTMC, ModelType.MDP, ModelType.LTS)
_CLOSE = 1e-6


@dataclass(slots=True)
class Way:
    """A destination of an edge; `probability` is None where it depends on the state."""

    destination: Destination
    probability: float | None


@dataclass(slots=True)
class Step:
    """An edge of an instance that can be taken. `guard` is None if it is always enabled."""

    edge: Edge
    ways: list[Way]
    guard: Expression | None
    is_inert: bool


@dataclass(slots=True)
class Slot:
    """The edges of an instance for one action, by location."""

    instance: int
    action: str | None
    steps: dict[int, list[Step]] = field(default_factory=dict)
    vectors: list[int] = field(default_factory=list)
    reads: set[str] = field(default_factory=set)
    writes: set[str] = field(default_factory=set)


@dataclass(frozen=True, slots=True)
class Legend:
    """What the numbers of a program stand for; workers do not need it.

    Attributes:
        locations: instance and name of each location.
        ways: the edge and the destination of each way.
        vectors: the slots of each vector, and its action.
    """

    layout: Layout
    locations: list[tuple[int, str]]
    ways: list[tuple[Edge, Destination]]
    vectors: list[tuple[list[int], str | None]]
    slots: list[Slot]


class Compilation:
    """Compiles `model` so that conditions over `formulas` can be watched; `program` closes it.

    Raises:
        FaultError: the model has parts that cannot be run, or that are wrong whatever happens.
    """

    def __init__(self, model: Model, formulas: Iterable[Formula] = ()) -> None:
        if model.type not in SUPPORTED:
            raise FaultError(f"models of type {model.type.value} are not supported; dtmc and mdp are", model.origin)
        self.model = model
        self.assembler = AssignmentAssembler()
        self.tape = self.assembler.tape
        self.layout = lay_out(model, self.tape)
        self.int_count, self.real_count = len(self.tape.ints), len(self.tape.reals)
        self.locations: list[tuple[int, str]] = []
        self.first_location: list[int] = []
        self.location_of: list[dict[str, int]] = []
        self.slots: list[Slot] = []
        self.slot_of: dict[tuple[int, str | None, int], int] = {}
        self.vectors: list[tuple[list[int], str | None]] = []
        self.watched: list[Storage] = []
        self._reads: dict[int, set[str]] = {}
        self._check_start()
        self._number_locations()
        self._collect_steps()
        self._collect_vectors()
        self._watch(formulas)
        self._write()

    # ------------------------------------------------------------ what there is

    def _check_start(self) -> None:
        known: dict[str, Value] = dict(self.layout.names.constants())
        for storage in self.layout.shared:
            known[storage.name] = self.layout.initial[id(storage)]
        scopes = [(self.model.restrict_initial, known)]
        for instance in self.layout.instances:
            own = {storage.name: self.layout.initial[id(storage)] for storage in instance.own}
            scopes.append((instance.automaton.restrict_initial, {**known, **own}))
        for clause, values in scopes:
            if clause is None:
                continue
            try:
                holds = evaluate(clause.exp, values, self.layout.names.functions)
            except EvaluationError as error:
                raise FaultError(error.message, error.origin) from None
            if not holds:
                raise FaultError("there is no initial state: the initial values do not fulfil this", clause.exp.origin)

    def _number_locations(self) -> None:
        for number, instance in enumerate(self.layout.instances):
            self.first_location.append(len(self.locations))
            table = {}
            for location in instance.automaton.locations:
                if location.time_progress is not None:
                    raise FaultError("conditions for time progress are not supported", location.origin)
                table[location.name] = len(self.locations)
                self.locations.append((number, location.name))
            self.location_of.append(table)
            if len(instance.automaton.initial_locations) != 1:
                name = instance.automaton.name
                raise FaultError(f"`{name}` must have one initial location", instance.automaton.origin)

    def _collect_steps(self) -> None:
        prepared: dict[int, list[Step | None]] = {}
        for number, (instance, element) in enumerate(
            zip(self.layout.instances, self.model.system.elements, strict=True)
        ):
            edges = [*instance.automaton.edges, *_accepting(instance, element.input_enable)]
            key = id(instance.automaton)
            if element.input_enable or key not in prepared:
                prepared[key] = [self._step(edge, instance) for edge in edges]
            silent: dict[int, int] = {}
            for edge, step in zip(edges, prepared[key], strict=True):
                if step is None:
                    continue
                source = self.location_of[number].get(edge.source)
                if source is None:
                    raise FaultError(f"there is no location `{edge.source}`", edge.origin)
                count = 0
                if edge.action is None:
                    count = silent[source] = silent.get(source, 0) + 1
                slot = self._slot(number, edge.action, count)
                slot.steps.setdefault(source, []).append(step)
                for way in step.ways:
                    for assignment in way.destination.assignments:
                        slot.reads |= self._read(assignment, instance)
                        slot.writes.add(_root(assignment))

    def _slot(self, instance: int, action: str | None, count: int) -> Slot:
        key = (instance, action, count)
        if key not in self.slot_of:
            self.slot_of[key] = len(self.slots)
            self.slots.append(Slot(instance, action))
        return self.slots[self.slot_of[key]]

    def _step(self, edge: Edge, instance: Instance) -> Step | None:
        """None for what can never be taken."""
        if edge.rate is not None:
            raise FaultError("rates are not supported", edge.origin)
        guard = None if edge.guard is None else edge.guard.exp
        if guard is not None:
            known = self._known(guard, instance)
            if known is False:
                return None
            if known is True:
                guard = None
        ways = []
        for destination in edge.destinations:
            clause = destination.probability
            probability = 1.0 if clause is None else self._known(clause.exp, instance)
            if probability is not None and probability < 0:
                raise FaultError("a probability must not be negative", destination.origin or edge.origin)
            if probability != 0:
                ways.append(Way(destination, None if probability is None else float(probability)))
        if not ways:
            raise FaultError("the probabilities of this edge do not add up to 1", edge.origin)
        if any(way.probability is None for way in ways):
            for way in ways:
                way.probability = None
        else:
            total = sum(way.probability or 0 for way in ways)
            if abs(total - 1) > _CLOSE:
                raise FaultError(f"the probabilities of this edge add up to {total:g}, not to 1", edge.origin)
        is_inert = all(way.destination.location == edge.source and not way.destination.assignments for way in ways)
        return Step(edge, ways, guard, is_inert)

    def _known(self, expression: Expression, instance: Instance) -> bool | float | None:
        """The value of an expression that does not depend on the state."""
        names = instance.names
        if isinstance(expression, Boolean):
            return expression.value
        read = self._names_in(expression, names)
        if any(not isinstance(names.values.get(name), Operand) for name in read):
            return None
        try:
            value = evaluate(expression, names.constants() if read else {}, names.functions)
        except EvaluationError:
            return None
        return value if isinstance(value, (bool, int, float)) else None

    def _names_in(self, expression: Expression, names: Names) -> set[str]:
        key = id(expression)
        if key not in self._reads:
            self._reads[key] = variables_in(expression, names.functions)
        return self._reads[key]

    def _read(self, assignment: Assignment, instance: Instance) -> set[str]:
        read = set(self._names_in(assignment.value, instance.names))
        target: Expression = assignment.target
        while isinstance(target, ArrayAccess):
            read |= self._names_in(target.index, instance.names)
            target = target.array
        return read

    def _collect_vectors(self) -> None:
        syncs = [(list(sync.participants), sync.result) for sync in self.model.system.syncs]
        if not syncs and len(self.layout.instances) == 1:
            actions = dict.fromkeys(slot.action for slot in self.slots if slot.action is not None)
            syncs = [([(0, action)], action) for action in actions]
        found = [([self.slot_of.get((i, action, 0), -1) for i, action in parts], result) for parts, result in syncs]
        silent = [([number], None) for number, slot in enumerate(self.slots) if slot.action is None]
        for slots, result in (*found, *silent):
            if slots and -1 not in slots:
                for slot in slots:
                    self.slots[slot].vectors.append(len(self.vectors))
                self.vectors.append((slots, result))

    def _watch(self, formulas: Iterable[Formula]) -> None:
        """Number the variables whose changes must be known: those that guards and properties read."""

        def watch(name: str, names: Names) -> None:
            meaning = names.values.get(name)
            if isinstance(meaning, Storage) and meaning.watch < 0 and not meaning.is_constant:
                meaning.watch = len(self.watched)
                self.watched.append(meaning)

        for slot in self.slots:
            names = self.layout.instances[slot.instance].names
            if not slot.vectors:
                continue
            for steps in slot.steps.values():
                for step in steps:
                    if step.guard is not None:
                        for name in sorted(self._names_in(step.guard, names)):
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
        self.group_steps: list[list[Step]] = []
        self.entangled = [self._is_entangled(slots) for slots, _ in self.vectors]
        phased = {s for (slots, _), yes in zip(self.vectors, self.entangled, strict=True) if yes for s in slots}
        here: dict[int, list[int]] = {}
        for number, slot in enumerate(self.slots):
            if slot.vectors:
                for location in slot.steps:
                    here.setdefault(location, []).append(number)
        for location in range(len(self.locations)):
            for number in here.get(location, ()):
                self.group_of[location, number] = len(self.group_slot)
                self.group_slot.append(number)
                steps = self.slots[number].steps[location]
                self.group_steps.append(steps)
                for step in steps:
                    self._write_step(step, location, number in phased)
                self.edge_start.append(len(self.guard))
            self.group_start.append(len(self.group_slot))
        self._write_moves()

    def _is_entangled(self, slots: list[int]) -> bool:
        """Whether what one part of a vector assigns matters to another one."""
        if len(slots) < 2:
            return False
        shared = []
        for number in slots:
            slot = self.slots[number]
            if slot.writes:
                own = {storage.name for storage in self.layout.instances[slot.instance].own}
                shared.append((slot.writes - own, slot.reads - own))
        for i, (writes, _) in enumerate(shared):
            for k, (other_writes, other_reads) in enumerate(shared):
                if i != k and writes & (other_writes | other_reads):
                    return True
        return False

    def _write_step(self, step: Step, location: int, is_phased: bool) -> None:
        number, _ = self.locations[location]
        instance = self.layout.instances[number]
        names = instance.names
        self.guard.append(-1 if step.guard is None else self.assembler.condition(step.guard, names, step.edge.origin))
        total = 0.0
        for way in step.ways:
            destination = way.destination
            target = self.location_of[number].get(destination.location)
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
                exp = _one() if clause is None else clause.exp
                chance = self.assembler.real_register(exp, names, destination.origin or step.edge.origin)
            else:
                total += way.probability
            self.way_chance.append(chance)
            self.way_sum.append(total)
            origin = destination.origin or step.edge.origin
            self.way_code.append(self._write_assignments(destination.assignments, instance, origin))
            if is_phased:
                self._write_phases(destination.assignments, names, origin)
            self.phase_start.append(len(self.phase_index))
        if step.ways[-1].probability is not None:
            self.way_sum[-1] = 1.0
        self.way_start.append(len(self.way_target))

    def _write_assignments(self, assignments: tuple[Assignment, ...], instance: Instance, origin: Origin | None) -> int:
        if not assignments:
            return -1
        names, assembler = instance.names, self.assembler
        start = self.tape.begin(origin)
        for group in _by_index(assignments):
            if len(group) == 1 or not self._has_hazard(group, instance):
                for assignment in group:
                    assembler.assign(assignment.target, assignment.value, names, assignment.origin)
                continue
            for later in [assembler.early(each.target, each.value, names, each.origin) for each in group]:
                assembler.finish(later)
        assembler.end()
        return start

    def _has_hazard(self, group: list[Assignment], instance: Instance) -> bool:
        """Whether one of the simultaneous assignments reads what an earlier one writes."""
        written: set[str] = set()
        for assignment in group:
            if written & self._read(assignment, instance):
                return True
            written.add(_root(assignment))
        return False

    def _write_phases(self, assignments: tuple[Assignment, ...], names: Names, origin: Origin | None) -> None:
        assembler = self.assembler
        for group in _by_index(assignments):
            self.phase_index.append(group[0].index)
            self.phase_read.append(self.tape.begin(origin))
            computed = [assembler.early(each.target, each.value, names, each.origin) for each in group]
            assembler.end()
            self.phase_write.append(self.tape.begin(origin))
            for later in computed:
                assembler.finish(later)
            assembler.end()

    def _write_moves(self) -> None:
        """What changes between the locations of each way."""
        self.move_start, self.move_slot, self.move_count = [0], list[int](), list[int]()
        known: dict[tuple[int, int], int] = {}
        for source, target in zip(self.way_source, self.way_target, strict=True):
            if source == target:
                self.way_move.append(-1)
                continue
            if (source, target) not in known:
                known[source, target] = len(self.move_start) - 1
                before, after = self._counts(source), self._counts(target)
                for slot in before.keys() - after.keys():
                    after[slot] = 0
                for slot in sorted(after):
                    if after[slot] < 0 or before.get(slot, 0) != after[slot]:
                        self.move_slot.append(slot)
                        self.move_count.append(after[slot])
                self.move_start.append(len(self.move_slot))
            self.way_move.append(known[source, target])

    def _counts(self, location: int) -> dict[int, int]:
        """For each slot the number of edges that are enabled here, or -1 - group if that depends on guards."""
        found = {}
        for group in range(self.group_start[location], self.group_start[location + 1]):
            steps = self.group_steps[group]
            is_guarded = any(step.guard is not None for step in steps)
            found[self.group_slot[group]] = -1 - group if is_guarded else len(steps)
        return found

    # ------------------------------------------------------------ the end

    def program(self) -> Program:
        """The program with all code that was written so far."""
        gates: dict[tuple[int, ...], list[int]] = {}
        for number, slot in enumerate(self.slots):
            if slot.vectors:
                gates.setdefault(tuple(slot.vectors), []).append(number)
        slot_gate = [-1] * len(self.slots)
        gate_start, gate_vector, gate_missing = [0], list[int](), list[int]()
        vector_missing = [0] * len(self.vectors)
        for gate, (vectors, slots) in enumerate(gates.items()):
            for number in slots:
                slot_gate[number] = gate
            gate_vector += vectors
            gate_start.append(len(gate_vector))
            gate_missing.append(len(slots))
            for vector in vectors:
                vector_missing[vector] += 1
        inert = [all(s.is_inert for steps in slot.steps.values() for s in steps) for slot in self.slots]
        active_start, active_slot = _ranges([[s for s in slots if not inert[s]] for slots, _ in self.vectors])
        all_start, all_slot = _ranges([slots for slots, _ in self.vectors])
        settle, location_code = self._write_transient()
        watch_start, watch_instance, watch_table, watched_start, watched_group = self._watch_tables()
        initial = [
            self.location_of[number][instance.automaton.initial_locations[0]]
            for number, instance in enumerate(self.layout.instances)
        ]
        return Program(
            code=_ints(self.tape.code),
            functions=list(self.tape.functions),
            ints=array("q", self.tape.ints),
            reals=array("d", self.tape.reals),
            int_count=self.int_count,
            real_count=self.real_count,
            instances=len(self.layout.instances),
            initial=_ints(initial),
            first_location=_ints(self.first_location),
            group_start=_ints(self.group_start),
            group_slot=_ints(self.group_slot),
            edge_start=_ints(self.edge_start),
            guard=_ints(self.guard),
            way_start=_ints(self.way_start),
            way_target=_ints(self.way_target),
            way_code=_ints(self.way_code),
            way_sum=array("d", self.way_sum),
            way_chance=_ints(self.way_chance),
            way_move=_ints(self.way_move),
            move_start=_ints(self.move_start),
            move_slot=_ints(self.move_slot),
            move_count=_ints(self.move_count),
            slot_instance=_ints([slot.instance for slot in self.slots]),
            slot_gate=_ints(slot_gate),
            gate_start=_ints(gate_start),
            gate_vector=_ints(gate_vector),
            gate_missing=_ints(gate_missing),
            vector_missing=_ints(vector_missing),
            active_start=active_start,
            active_slot=active_slot,
            all_start=all_start,
            all_slot=all_slot,
            entangled=_ints([int(yes) for yes in self.entangled]),
            phase_start=_ints(self.phase_start),
            phase_index=_ints(self.phase_index),
            phase_read=_ints(self.phase_read),
            phase_write=_ints(self.phase_write),
            watch_start=watch_start,
            watch_instance=watch_instance,
            watch_table=watch_table,
            watched_start=watched_start,
            watched_group=watched_group,
            settle=settle,
            location_code=location_code,
            zero_slots=_ints([0] * len(self.slots)),
            zero_vectors=_ints([0] * len(self.vectors)),
            zero_variables=_ints([0] * len(self.watched)),
            zero_instances=_ints([0] * len(self.layout.instances)),
        )

    @property
    def legend(self) -> Legend:
        return Legend(self.layout, self.locations, self.ways, self.vectors, self.slots)

    def _write_transient(self) -> tuple[int, Ints]:
        """Code that resets transient variables, and for each location the values that they have in it."""
        model, assembler = self.model, self.assembler
        code = [-1] * len(self.locations)
        scopes: list[tuple[Names, Iterable[Storage], Mapping[str, bool]]] = [
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
            assembler.reset(storage)
        assembler.end()
        for number, instance in enumerate(self.layout.instances):
            for location in instance.automaton.locations:
                if location.transient_values:
                    code[self.location_of[number][location.name]] = self.tape.begin()
                    for value in location.transient_values:
                        assembler.assign(value.target, value.value, instance.names, value.origin)
                    assembler.end()
        return settle, _ints(code)

    def _watch_tables(self) -> tuple[Ints, Ints, Ints, Ints, Ints]:
        """For each watched variable the instances whose guards read it, and for their locations the groups."""
        readers: dict[tuple[int, int], dict[int, list[int]]] = {}
        for (location, _), group in self.group_of.items():
            number, _ = self.locations[location]
            names = self.layout.instances[number].names
            variables = set()
            for step in self.group_steps[group]:
                if step.guard is not None:
                    variables |= self._names_in(step.guard, names)
            for name in variables:
                meaning = names.values.get(name)
                if isinstance(meaning, Storage) and meaning.watch >= 0:
                    readers.setdefault((meaning.watch, number), {}).setdefault(location, []).append(group)
        watch_start, watch_instance, watch_table = [0], list[int](), list[int]()
        watched_start, watched_group = [0], list[int]()
        by_variable: dict[int, list[int]] = {}
        for variable, number in sorted(readers):
            by_variable.setdefault(variable, []).append(number)
        for variable in range(len(self.watched)):
            for number in by_variable.get(variable, ()):
                watch_instance.append(number)
                watch_table.append(len(watched_start) - 1)
                places = readers[variable, number]
                first = self.first_location[number]
                for location in range(first, first + len(self.location_of[number])):
                    watched_group += places.get(location, ())
                    watched_start.append(len(watched_group))
            watch_start.append(len(watch_instance))
        return tuple(map(_ints, (watch_start, watch_instance, watch_table, watched_start, watched_group)))  # type: ignore[return-value]


def _ints(values: Iterable[int]) -> Ints:
    return array("i", values)


def _ranges(lists: Iterable[list[int]]) -> tuple[Ints, Ints]:
    starts, items = [0], list[int]()
    for each in lists:
        items += each
        starts.append(len(items))
    return _ints(starts), _ints(items)


def _one() -> Expression:
    return Real(1.0)


def _by_index(assignments: tuple[Assignment, ...]) -> list[list[Assignment]]:
    """The assignments of each index, in the order in which they are executed."""
    groups: dict[int, list[Assignment]] = {}
    for assignment in assignments:
        groups.setdefault(assignment.index, []).append(assignment)
    return [groups[index] for index in sorted(groups)]


def _root(assignment: Assignment) -> str:
    """The variable that is assigned to."""
    target: Expression = assignment.target
    while isinstance(target, ArrayAccess):
        target = target.array
    return getattr(target, "identifier", "")


def _accepting(instance: Instance, actions: tuple[str, ...]) -> list[Edge]:
    """Loops that accept an action wherever no edge for it is enabled: what `input-enable` means."""
    found = []
    for action in actions:
        for location in instance.automaton.locations:
            there = [e for e in instance.automaton.edges if e.action == action and e.source == location.name]
            guard: Expression | None = None
            if any(edge.guard is None for edge in there):
                continue
            for edge in there:
                assert edge.guard is not None
                closed: Expression = Unary(UnaryOperator.NOT, edge.guard.exp)
                guard = closed if guard is None else _both(guard, closed)
            clause = None if guard is None else replace(there[0].guard, exp=guard)  # type: ignore[type-var]
            loop = Destination(location.name)
            found.append(Edge(location.name, (loop,), action, clause, origin=location.origin))
    return found


def _both(left: Expression, right: Expression) -> Expression:
    return Binary(BinaryOperator.AND, left, right)

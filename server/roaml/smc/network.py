# SPDX-License-Identifier: Apache-2.0
"""The behaviour of a model: locations, the edges that can be taken, and their synchronisation.

- Every edge without an action and every combination of edges of a synchronisation vector is one choice.
- Edges that can never be taken and ways of probability 0 are left out.
"""

from __future__ import annotations

from roaml.jani.expressions import Binary, Boolean, Expression, Unary
from roaml.jani.model import Assignment, Destination, Edge, Model
from roaml.jani.node import Node
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.jani.semantics import EvaluationError, evaluate
from roaml.record import Record, field, replace
from roaml.smc.fault import FaultError
from roaml.smc.layout import AutomatonInstance, MemoryLayout
from roaml.smc.names import StorageNames, read_by, variables_in
from roaml.smc.registers import Operand

_PROBABILITY_TOLERANCE = 1e-6
"""The maximum distance of the sum of the probabilities of an edge from 1."""


class WeightedDestination(Record):
    """A destination of an edge. `probability` is `None` if the probability of a destination of the edge depends on the
    state."""

    destination: Destination
    probability: float | None


class EdgeStep(Record):
    """An edge of an instance that can be taken. `guard` is `None` if the edge is always enabled. `is_inert` states
    whether taking the edge changes nothing."""

    edge: Edge
    ways: list[WeightedDestination]
    guard: Expression | None
    is_inert: bool


class Slot(Record):
    """The edges of an instance for one action. An edge without an action shares its slot only with edges of other
    locations.

    Attributes:
        steps: number of a location -> its edges.
        vectors: the numbers of the synchronisation vectors in which the slot takes part.
        reads, writes: the names that the assignments of the edges read and write.
    """

    instance: int
    action: str | None
    steps: dict[int, list[EdgeStep]] = field(default_factory=dict)
    vectors: list[int] = field(default_factory=list)
    reads: set[str] = field(default_factory=set)
    writes: set[str] = field(default_factory=set)


class Reads:
    """Computes the names that an expression or an assignment reads, once for each. These parts are kept alive, so that
    their `id` is not reused."""

    def __init__(self) -> None:
        self._found: dict[int, tuple[Node, set[str]]] = {}

    def names_in(self, expression: Expression, names: StorageNames) -> set[str]:
        if id(expression) not in self._found:
            self._found[id(expression)] = expression, variables_in(expression, names.functions)
        return self._found[id(expression)][1]

    def by(self, assignment: Assignment, names: StorageNames) -> set[str]:
        if id(assignment) not in self._found:
            self._found[id(assignment)] = assignment, read_by(assignment, names.functions)
        return self._found[id(assignment)][1]


class CompiledNetwork:
    """The locations, slots and vectors of a model.

    Attributes:
        locations: the number of the instance and the name of each location.
        first_location: the number of the first location of each instance.
        location_of: for each instance, name of a location -> its number.
        vectors: the numbers of the slots of each synchronisation vector, and its action. Those that the model holds
            (`Model.holds_clock`) are last.
        first_held: the number of the first vector that is held.
    """

    def __init__(self, model: Model, layout: MemoryLayout) -> None:
        self.model = model
        self.layout = layout
        self.reads = Reads()
        self.locations: list[tuple[int, str]] = []
        self.first_location: list[int] = []
        self.location_of: list[dict[str, int]] = []
        self.slots: list[Slot] = []
        self.vectors: list[tuple[list[int], str | None]] = []
        self._slot_of: dict[tuple[int, str | None, int], int] = {}
        self._number_locations()
        self._collect_steps()
        self._collect_vectors()

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
            if not instance.automaton.initial_locations:
                name = instance.automaton.name
                raise FaultError(f"`{name}` has no initial location", instance.automaton.origin)

    def _collect_steps(self) -> None:
        prepared: dict[int, list[EdgeStep | None]] = {}
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
                        slot.reads |= self.reads.by(assignment, instance.names)
                        slot.writes.add(assignment.variable)

    def _slot(self, instance: int, action: str | None, count: int) -> Slot:
        key = (instance, action, count)
        if key not in self._slot_of:
            self._slot_of[key] = len(self.slots)
            self.slots.append(Slot(instance, action))
        return self.slots[self._slot_of[key]]

    def _step(self, edge: Edge, instance: AutomatonInstance) -> EdgeStep | None:
        """The step of an edge; `None` if the edge can never be taken."""
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
                ways.append(WeightedDestination(destination, None if probability is None else float(probability)))
        if not ways:
            raise FaultError("the probabilities of this edge do not add up to 1", edge.origin)
        if any(way.probability is None for way in ways):
            for way in ways:
                way.probability = None
        else:
            total = sum(way.probability or 0 for way in ways)
            if abs(total - 1) > _PROBABILITY_TOLERANCE:
                raise FaultError(f"the probabilities of this edge add up to {total:g}, not to 1", edge.origin)
        is_inert = all(way.destination.location == edge.source and not way.destination.assignments for way in ways)
        return EdgeStep(edge, ways, guard, is_inert)

    def _known(self, expression: Expression, instance: AutomatonInstance) -> bool | float | None:
        """The value of an expression; `None` if it depends on the state or cannot be computed."""
        names = instance.names
        if isinstance(expression, Boolean):
            return expression.value
        read = self.reads.names_in(expression, names)
        if any(not isinstance(names.values.get(name), Operand) for name in read):
            return None
        try:
            value = evaluate(expression, names.constants() if read else {}, names.functions)
        except EvaluationError:
            return None
        return value if isinstance(value, (bool, int, float)) else None

    def _collect_vectors(self) -> None:
        syncs = [(list(sync.participants), sync.result) for sync in self.model.system.syncs]
        if not syncs and len(self.layout.instances) == 1:
            actions = dict.fromkeys(slot.action for slot in self.slots if slot.action is not None)
            syncs = [([(0, action)], action) for action in actions]
        vectors = [([self._slot_of.get((i, action, 0), -1) for i, action in parts], result) for parts, result in syncs]
        silent = [([number], None) for number, slot in enumerate(self.slots) if slot.action is None]
        held = self._begins_time()
        steps = [(slots, result) for slots, result in (*vectors, *silent) if slots and -1 not in slots]
        steps.sort(key=lambda step: not held.isdisjoint(step[0]))
        self.first_held = sum(held.isdisjoint(slots) for slots, _ in steps)
        for slots, result in steps:
            for slot in slots:
                self.slots[slot].vectors.append(len(self.vectors))
            self.vectors.append((slots, result))

    def _begins_time(self) -> set[int]:
        """The slots with which the clock begins its steps, if the model holds them."""
        clock = self.model.metadata.clock if self.model.metadata is not None else None
        if clock is None or not self.model.holds_clock:
            return set()
        elements = [number for number, e in enumerate(self.model.system.elements) if e.automaton == clock.automaton]
        return {self._slot_of.get((i, action, 0), -1) for i in elements for action in clock.actions} - {-1}


def _accepting(instance: AutomatonInstance, actions: tuple[str, ...]) -> list[Edge]:
    """Loops that accept an action in each location and state in which no edge for it is enabled, as `input-enable`
    requires."""
    loops = []
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
            loops.append(Edge(location.name, (loop,), action, clause, origin=location.origin))
    return loops


def _both(left: Expression, right: Expression) -> Expression:
    return Binary(BinaryOperator.AND, left, right)

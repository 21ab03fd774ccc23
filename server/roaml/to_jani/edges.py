# SPDX-License-Identifier: Apache-2.0
"""Translates the moves of one automaton to locations and edges (docs/spec/jani.md#edges).

- The number of edges of a move affects probabilities and step bounds, so it is fixed: an assignment is part of the edge
  before it, but each `send`, each branch of an `if` and each draw of a random number is a separate edge.
- An automaton receives no events while it is between two states.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence

from roaml.expr.transform import map_children
from roaml.expr.tree import Expr, Number, is_draw, walk
from roaml.expr.types import EmptyArray
from roaml.jani import expressions as jani
from roaml.jani.expressions import Expression
from roaml.jani.model import Assignment, Clause, Destination, Edge, Location
from roaml.record import Record, field
from roaml.scxml.events import Role
from roaml.scxml.model import Assign, Body, If, Send, State
from roaml.scxml.names import flag_of, on_receive, on_send
from roaml.text import Location as Origin
from roaml.to_jani.assignments import Write, assigned, stored_in
from roaml.to_jani.events import EventUsage
from roaml.to_jani.moves import AutomatonMoves, Move
from roaml.to_jani.shapes import shape_of
from roaml.to_jani.values import JaniScope, all_of, negated

FIRST = "-first-exec"


class _Destination(Record):
    """A destination under construction."""

    probability: Clause | None
    origin: Origin
    location: str = ""
    assignments: list[Assignment] = field(default_factory=list)

    def store(self, writes: Iterable[Write], origin: Origin) -> None:
        """Add simultaneous assignments, after all earlier ones."""
        index = len(self.assignments)
        self.assignments += [Assignment(target, value, index, origin=origin) for target, value in writes]

    def send(self, writes: Iterable[Write], origin: Origin) -> None:
        """Add assignments that are executed simultaneously, before all others."""
        self.assignments += [Assignment(target, value, origin=origin) for target, value in writes]


class _Draft(Record):
    """An edge under construction."""

    source: str
    action: str
    guard: Expression | None
    ways: list[_Destination]
    origin: Origin

    def finished(self) -> Edge:
        guard = None if self.guard is None else Clause(self.guard)
        destinations = tuple(
            Destination(
                destination.location, destination.probability, tuple(destination.assignments), origin=destination.origin
            )
            for destination in self.ways
        )
        return Edge(self.source, destinations, self.action, guard, origin=self.origin)


class Flow(Record, frozen=True):
    """The locations and edges of an automaton."""

    locations: tuple[Location, ...]
    initial: str
    edges: tuple[Edge, ...]


def flow_of(behavior: AutomatonMoves, table: Mapping[str, EventUsage], max_array_size: int, random_values: int) -> Flow:
    """The locations and edges of an automaton. Transitions on an event that no automaton sends are left out.

    Args:
        table: name of an event -> its usage.
        max_array_size: the maximum number of elements of an array without a bound.
        random_values: the number of values of `Math.random()` (docs/spec/expressions.md#random).
    """
    return _FlowBuilder(behavior, table, max_array_size, random_values).build()


_CERTAIN = Clause(jani.Real(1.0))


class _FlowBuilder:
    def __init__(
        self, behavior: AutomatonMoves, table: Mapping[str, EventUsage], max_array_size: int, random_values: int
    ) -> None:
        self.behavior = behavior
        self.table = table
        self.max_array_size = max_array_size
        self.random_values = random_values
        self.variables = {data.id: shape_of(data.type, max_array_size) for data in behavior.automaton.data}
        self.locations: dict[str, Origin] = {state.id: state.origin for state in behavior.automaton.states}
        self.drafts: list[_Draft] = []
        self.scopes: dict[str, JaniScope] = {}

    def build(self) -> Flow:
        events = self.behavior.events()
        for state, moves in self.behavior.moves:
            self.discarding(state, self.state(moves), events)
        initial = self.behavior.automaton.initial
        if self.behavior.start is not None:
            initial = self.start(self.behavior.start, initial)
        dead = {on_receive(self.table[event].event) for event in events if not self.table[event].senders}
        edges = tuple(draft.finished() for draft in self.drafts if draft.action not in dead)
        locations = tuple(Location(name, origin=origin) for name, origin in self.locations.items())
        return Flow(locations, initial, edges)

    def scope(self, event: str) -> JaniScope:
        if event not in self.scopes:
            types = self.table[event].params if event else {}
            params = {name: shape_of(type_, self.max_array_size, sent=True) for name, type_ in types.items()}
            empty = frozenset(name for name, type_ in types.items() if isinstance(type_, EmptyArray))
            self.scopes[event] = JaniScope(self.variables, event, params, empty)
        return self.scopes[event]

    def location(self, stem: str, origin: Origin) -> str:
        """Add a location and return its name: `stem`, with `'` appended if a state of the user has that name."""
        name = stem
        while name in self.locations:
            name += "'"
        self.locations[name] = origin
        return name

    # ------------------------------------------------------------------- states

    def state(self, moves: Sequence[Move]) -> dict[str, list[Expression | None]]:
        """Add the edges of all transitions of a state.

        Returns:
            Name of an event -> the conditions of the transitions on it; `None` for a transition without a condition.
        """
        conditions: dict[str, list[Expression | None]] = {}
        for move in moves:
            scope, earlier = self.scope(move.event), conditions.setdefault(move.event, [])
            cond = None if move.transition.cond is None else scope.scalar(move.transition.cond)
            self.move(move, scope, _unless(cond, earlier))
            earlier.append(cond)
        return conditions

    def move(self, move: Move, scope: JaniScope, guard: Expression | None) -> None:
        stem = f"{move.source}-{move.number}"
        awaited = move.transition.event
        action = on_receive(awaited) if awaited else stem
        # What an outcome with the probability 0 sends is declared, but it is no destination.
        outcomes = [outcome for outcome in move.outcomes if outcome.probability > 0]
        ways = [
            _Destination(
                _CERTAIN if outcome.probability == 1 else Clause(jani.Real(outcome.probability)), outcome.origin
            )
            for outcome in outcomes
        ]
        self.drafts.append(_Draft(move.source, action, guard, ways, move.transition.origin))
        for k, (destination, outcome) in enumerate(zip(ways, outcomes, strict=True)):
            tag = stem if len(ways) == 1 else f"{stem}.{k}"
            self.run(outcome.body, destination, tag, outcome.state, scope)

    def start(self, body: Body, initial: str) -> str:
        """Add the edges that execute the `<onentry>` of the initial state, and return the location at which they
        begin."""
        origin = self.behavior.automaton.origin
        first = self.location(f"{initial}{FIRST}", origin)
        destination = _Destination(_CERTAIN, origin)
        self.drafts.append(_Draft(first, first, None, [destination], origin))
        self.run(body, destination, first, initial, self.scope(""))
        return first

    def discarding(
        self, state: State, handled: Mapping[str, Sequence[Expression | None]], events: Iterable[str]
    ) -> None:
        """Add the loops that discard the events which a state does not handle (docs/spec/jani.md#discarding)."""
        if self.behavior.automaton.role in (Role.TREE_ROOT, Role.HANDLER) or None in handled.get("", ()):
            return
        for event in events:
            conditions = handled.get(event, ())
            if None not in conditions and (conditions or not self.table[event].role.is_synchronising):
                destination = _Destination(_CERTAIN, state.origin, state.id)
                guard = _unless(None, conditions)
                self.drafts.append(
                    _Draft(state.id, on_receive(self.table[event].event), guard, [destination], state.origin)
                )

    # ------------------------------------------------------------------- bodies

    def run(self, body: Body, destination: _Destination, tag: str, final: str, scope: JaniScope) -> None:
        """Add all statements of `body` to `destination` and to new edges. The last one ends in the location `final`."""
        for i, statement in enumerate(body):
            stem = f"{tag}-{i}"
            match statement:
                case Assign():
                    destination = self.assign(statement, destination, stem, scope)
                case Send():
                    destination = self.send(statement, destination, stem, scope)
                case If():
                    destination = self.choose(statement, destination, stem, tag, scope)
        destination.location = final

    def next_destination(self, source: str, action: str, origin: Origin) -> _Destination:
        """Add an edge with one destination, and return the destination."""
        destination = _Destination(None, origin)
        self.drafts.append(_Draft(source, action, None, [destination], origin))
        return destination

    def assign(self, statement: Assign, destination: _Destination, stem: str, scope: JaniScope) -> _Destination:
        draws = _count_draws(statement.value)
        if draws == 0:
            destination.store(assigned(statement.location, statement.value, scope), statement.origin)
            return destination
        origin = statement.origin
        before, after = self.location(f"{stem}-draw", origin), self.location(f"{stem}-drawn", origin)
        destination.location = before
        chance = Clause(jani.Real(1 / self.random_values**draws))
        ways = []
        for numbers in itertools.product(range(self.random_values), repeat=draws):
            drawn = _with_numbers(statement.value, (number / self.random_values for number in numbers))
            drawn_destination = _Destination(chance, origin, after)
            drawn_destination.store(assigned(statement.location, drawn, scope), origin)
            ways.append(drawn_destination)
        self.drafts.append(_Draft(before, before, None, ways, origin))
        return self.next_destination(after, "after-draw", origin)

    def send(self, statement: Send, destination: _Destination, stem: str, scope: JaniScope) -> _Destination:
        destination.location = self.location(stem, statement.origin)
        following = self.next_destination(destination.location, on_send(statement.event), statement.origin)
        if not statement.event.role.is_internal:
            params = self.table[statement.event.name].params
            for param in statement.params:
                shape = shape_of(params[param.name], self.max_array_size, sent=True)
                variable = f"{statement.event.name}__{param.name}"
                following.send(stored_in(variable, shape, param.value, scope), param.origin)
            following.send([(jani.Name(flag_of(statement.event.name)), jani.Boolean(True))], statement.origin)
        return following

    def choose(self, statement: If, destination: _Destination, stem: str, tag: str, scope: JaniScope) -> _Destination:
        origin = statement.origin
        before, after = self.location(f"{stem}-if", origin), self.location(f"{stem}-endif", origin)
        destination.location = before
        earlier: list[Expression | None] = []
        branches = [(branch.cond, branch.body, branch.origin) for branch in statement.branches]
        for j, (cond, body, place) in enumerate([*branches, (None, statement.otherwise, origin)]):
            condition = None if cond is None else scope.scalar(cond)
            inner = _Destination(_CERTAIN, place)
            branch_tag = f"{stem}.{j}"
            self.drafts.append(_Draft(before, branch_tag, _unless(condition, earlier), [inner], place))
            self.run(body, inner, branch_tag, after, scope)
            earlier.append(condition)
        return self.next_destination(after, f"{tag}-endif", origin)


def _unless(cond: Expression | None, earlier: Iterable[Expression | None]) -> Expression | None:
    """The condition that none of the earlier conditions holds and `cond` holds; `None` if it is always true.

    The earlier conditions come first, because `cond` may have no value where one of them holds: in SCXML, the
    conditions after the first one that holds are not evaluated."""
    terms = [negated(condition) for condition in earlier if condition is not None]
    return all_of(terms if cond is None else [*terms, cond])


# --------------------------------------------------------------- random numbers


def _count_draws(expr: Expr) -> int:
    return sum(map(is_draw, walk(expr)))


def _with_numbers(expr: Expr, numbers: Iterator[float]) -> Expr:
    """A copy of `expr` in which each call of `Math.random()` is replaced by the next number of `numbers`."""
    if is_draw(expr):
        return Number(expr.span, next(numbers), True)
    return map_children(expr, lambda part: _with_numbers(part, numbers))

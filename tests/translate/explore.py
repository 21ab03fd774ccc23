# SPDX-License-Identifier: Apache-2.0
"""All states of a small JANI model, by its semantics alone: nothing here knows what the model was made from."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from reach import reachable

from roaml.jani.expressions import ArrayAccess, Name
from roaml.jani.model import Assignment, Destination, Edge, Model
from roaml.jani.semantics import evaluate


@dataclass(frozen=True)
class State:
    """`values` are the global variables, `own` those of each automaton, both in the order of their declaration."""

    locations: tuple[str, ...]
    values: tuple[Any, ...]
    own: tuple[tuple[Any, ...], ...]


class Explorer:
    def __init__(self, model: Model) -> None:
        self.model = model
        self.names = [v.name for v in model.variables]
        self.own_names = [[v.name for v in a.variables] for a in model.automata]
        self.edges: list[dict[tuple[str, str | None], list[Edge]]] = []
        for automaton in model.automata:
            table: dict[tuple[str, str | None], list[Edge]] = {}
            for edge in automaton.edges:
                table.setdefault((edge.source, edge.action), []).append(edge)
            self.edges.append(table)

    def initial(self) -> State:
        return State(
            tuple(automaton.initial_locations[0] for automaton in self.model.automata),
            tuple(evaluate(v.initial_value, {}) for v in self.model.variables),
            tuple(tuple(evaluate(v.initial_value, {}) for v in a.variables) for a in self.model.automata),
        )

    def globals(self, state: State) -> dict[str, Any]:
        return dict(zip(self.names, state.values, strict=True))

    def locals(self, state: State, automaton: int) -> dict[str, Any]:
        return dict(zip(self.own_names[automaton], state.own[automaton], strict=True))

    def reachable(self, limit: int) -> set[State]:
        """All reachable states.

        Raises:
            OverflowError: there are more than `limit`.
        """
        return reachable(self.initial(), self.successors, limit)

    def successors(self, state: State) -> Iterator[State]:
        for sync in self.model.system.syncs:
            if not all((state.locations[i], action) in self.edges[i] for i, action in sync.participants):
                continue
            enabled = [self._enabled(state, i, action) for i, action in sync.participants]
            for edges in itertools.product(*enabled):
                for ways in itertools.product(*(edge.destinations for edge in edges)):
                    if all(self._possible(way, state) for way in ways):
                        yield self._taken(state, [i for i, _ in sync.participants], ways)
        for i, location in enumerate(state.locations):
            for edge in self._enabled(state, i, None) if (location, None) in self.edges[i] else ():
                yield from (self._taken(state, [i], (way,)) for way in edge.destinations if self._possible(way, state))

    def _enabled(self, state: State, automaton: int, action: str | None) -> list[Edge]:
        candidates = self.edges[automaton][state.locations[automaton], action]
        known = {**self.globals(state), **self.locals(state, automaton)}
        return [edge for edge in candidates if edge.guard is None or evaluate(edge.guard.exp, known)]

    def _possible(self, way: Destination, state: State) -> bool:
        return way.probability is None or bool(evaluate(way.probability.exp, {}) > 0)  # type: ignore[operator]

    def _taken(self, state: State, automata: list[int], ways: tuple[Destination, ...]) -> State:
        values = self.globals(state)
        own = [list(row) for row in state.own]
        locations = list(state.locations)
        steps = sorted({a.index for way in ways for a in way.assignments})
        for step in steps:
            writes = []
            for automaton, way in zip(automata, ways, strict=True):
                known = {**values, **dict(zip(self.own_names[automaton], own[automaton], strict=True))}
                for assignment in way.assignments:
                    if assignment.index == step:
                        writes.append((automaton, *_target(assignment, known), evaluate(assignment.value, known)))
            for automaton, name, indexes, value in writes:
                if name in self.own_names[automaton]:
                    k = self.own_names[automaton].index(name)
                    own[automaton][k] = _stored(own[automaton][k], indexes, value)
                else:
                    values[name] = _stored(values[name], indexes, value)
        for automaton, way in zip(automata, ways, strict=True):
            locations[automaton] = way.location
        return State(tuple(locations), tuple(values.values()), tuple(map(tuple, own)))


def _target(assignment: Assignment, known: dict[str, Any]) -> tuple[str, tuple[int, ...]]:
    indexes: list[int] = []
    target = assignment.target
    while isinstance(target, ArrayAccess):
        indexes.insert(0, evaluate(target.index, known))  # type: ignore[arg-type]
        target = target.array  # type: ignore[assignment]
    assert isinstance(target, Name)
    return target.identifier, tuple(indexes)


def _stored(old: Any, indexes: tuple[int, ...], value: Any) -> Any:
    if not indexes:
        return value
    first, *rest = indexes
    assert 0 <= first < len(old)
    return (*old[:first], _stored(old[first], tuple(rest), value), *old[first + 1 :])

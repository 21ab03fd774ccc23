# SPDX-License-Identifier: Apache-2.0
"""Passive automata: they follow steps of others and only write variables that no other automaton reads. Without them, a
model behaves in the same way."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from roaml.jani.expressions import ArrayAccess, Expression, Name
from roaml.jani.expressions import walk as walk_expression
from roaml.jani.model import Assignment, Automaton, Edge, Model
from roaml.jani.properties import Formula, identifiers


def without_passive(model: Model, *formulas: Formula) -> Model:
    """The model without the passive automata whose variables no formula reads, and without these variables. The model
    itself if there are none. Its other properties may name variables that were removed."""
    candidates = {number: _written(a) for number, a in enumerate(model.automata) if _follows(a)}
    if not candidates or model.restrict_initial is not None:
        return model
    kept = {name for formula in formulas for name, _ in identifiers(formula)}
    for number, automaton in enumerate(model.automata):
        if number not in candidates:
            kept |= _read(automaton)
    shared = {variable.name for variable in model.variables}
    dropped = {n: names for n, names in candidates.items() if names and names <= shared and not names & kept}
    if not dropped or any(element.input_enable for element in model.system.elements):
        return model
    gone = frozenset().union(*dropped.values())
    numbers = [number for number in range(len(model.automata)) if number not in dropped]
    place = {number: position for position, number in enumerate(numbers)}
    syncs = tuple(
        replace(sync, participants=tuple((place[i], action) for i, action in sync.participants if i in place))
        for sync in model.system.syncs
    )
    elements = tuple(model.system.elements[number] for number in numbers)
    return replace(
        model,
        automata=tuple(model.automata[number] for number in numbers),
        system=replace(model.system, elements=elements, syncs=syncs),
        variables=tuple(variable for variable in model.variables if variable.name not in gone),
    )


def _follows(automaton: Automaton) -> bool:
    """Whether an automaton has one location, with at most one edge per action, which is always enabled."""
    actions = [edge.action for edge in automaton.edges]
    return (
        len(automaton.locations) == 1
        and not automaton.variables
        and None not in actions
        and len(set(actions)) == len(actions)
        and all(edge.guard is None and edge.rate is None and len(edge.destinations) == 1 for edge in automaton.edges)
    )


def _assignments(edges: tuple[Edge, ...]) -> Iterator[Assignment]:
    return (a for edge in edges for destination in edge.destinations for a in destination.assignments)


def _written(automaton: Automaton) -> frozenset[str]:
    names = set()
    for assignment in _assignments(automaton.edges):
        target: Expression = assignment.target
        while isinstance(target, ArrayAccess):
            target = target.array
        names.add(target.identifier if isinstance(target, Name) else "")
    return frozenset(names)


def _read(automaton: Automaton) -> set[str]:
    """The names in the expressions of an automaton, and those of the variables that it writes."""
    expressions: list[Expression] = []
    for edge in automaton.edges:
        if edge.guard is not None:
            expressions.append(edge.guard.exp)
        expressions += [d.probability.exp for d in edge.destinations if d.probability is not None]
    for assignment in _assignments(automaton.edges):
        expressions += (assignment.target, assignment.value)
    return {part.identifier for e in expressions for part in walk_expression(e) if isinstance(part, Name)}

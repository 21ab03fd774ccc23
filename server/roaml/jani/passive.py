# SPDX-License-Identifier: Apache-2.0
"""Removes passive automata from a model. A passive automaton only takes part in steps of other automata, and only
writes variables that no other automaton reads, so the other automata behave in the same way without it."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.jani.expressions import Expression, Name
from roaml.jani.expressions import walk as walk_expression
from roaml.jani.model import Assignment, Automaton, Edge, Model
from roaml.jani.properties import Formula, identifiers
from roaml.record import replace


def unread_variables(model: Model, *formulas: Formula) -> frozenset[str]:
    """The variables of the model that only passive automata write, and on which no other automaton and no formula
    depends. There are none if the model restricts its initial states, or an element has `input-enable`."""
    passive = [_follows(automaton) for automaton in model.automata]
    if model.restrict_initial is not None or any(element.input_enable for element in model.system.elements):
        return frozenset()
    needed = {name for formula in formulas for name, _ in identifiers(formula)}
    written: set[str] = set()
    sources: dict[str, set[str]] = {}
    for automaton, is_passive in zip(model.automata, passive, strict=True):
        if not is_passive:
            needed |= _read(automaton)
            continue
        for assignment in _assignments(automaton.edges):
            target = assignment.variable
            written.add(target)
            sources.setdefault(target, set()).update(_names(assignment.target), _names(assignment.value))
    waiting = list(needed)
    while waiting:
        for name in sources.pop(waiting.pop(), ()):
            if name not in needed:
                needed.add(name)
                waiting.append(name)
    return frozenset(variable.name for variable in model.variables if variable.name in written - needed)


def without_passive(model: Model, *formulas: Formula) -> Model:
    """The model without the `unread_variables`, and without the passive automata that then have no assignments.

    If there are no unread variables, the result is `model` itself. Properties of the model that are not in `formulas`
    may refer to variables that were removed.
    """
    gone = unread_variables(model, *formulas)
    if not gone:
        return model
    automata = [_without(automaton, gone) for automaton in model.automata]
    numbers = [
        number
        for number, (automaton, before) in enumerate(zip(automata, model.automata, strict=True))
        if automaton is before or any(True for _ in _assignments(automaton.edges))
    ]
    place = {number: position for position, number in enumerate(numbers)}
    syncs = tuple(
        replace(sync, participants=tuple((place[i], action) for i, action in sync.participants if i in place))
        for sync in model.system.syncs
    )
    return replace(
        model,
        automata=tuple(automata[number] for number in numbers),
        system=replace(model.system, elements=tuple(model.system.elements[number] for number in numbers), syncs=syncs),
        variables=tuple(variable for variable in model.variables if variable.name not in gone),
    )


def _without(automaton: Automaton, gone: frozenset[str]) -> Automaton:
    """The automaton without its assignments to the variables `gone`; `automaton` itself if there are none."""
    if all(assignment.variable not in gone for assignment in _assignments(automaton.edges)):
        return automaton
    edges = tuple(
        replace(
            edge,
            destinations=tuple(
                replace(d, assignments=tuple(a for a in d.assignments if a.variable not in gone))
                for d in edge.destinations
            ),
        )
        for edge in automaton.edges
    )
    return replace(automaton, edges=edges)


def _follows(automaton: Automaton) -> bool:
    """Whether an automaton has a single location, no variables, no silent edges, and at most one edge for each action,
    which is always enabled and has one destination."""
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


def _read(automaton: Automaton) -> set[str]:
    """The names in the expressions of an automaton, including the variables that it writes."""
    expressions: list[Expression] = []
    for edge in automaton.edges:
        if edge.guard is not None:
            expressions.append(edge.guard.exp)
        expressions += [d.probability.exp for d in edge.destinations if d.probability is not None]
    for assignment in _assignments(automaton.edges):
        expressions += (assignment.target, assignment.value)
    return {name for expression in expressions for name in _names(expression)}


def _names(expression: Expression) -> set[str]:
    return {part.identifier for part in walk_expression(expression) if isinstance(part, Name)}

# SPDX-License-Identifier: Apache-2.0
"""What a server does while it handles the requests of one of its clients.

The model is explored again with a variable that is true while the request is handled. Each edge of the server becomes
two edges: one that is taken while the variable is true, and one that is taken at other times.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from roaml.jani.expressions import Binary, Boolean, Expression, Name, Unary
from roaml.jani.model import Assignment, Automaton, Clause, Destination, Edge, Model, Variable
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.jani.types import BasicType
from roaml.project.explored_steps import ClientRequests, ExploredSteps, ExploredWay
from roaml.record import replace

_HANDLED = Name("request handled")
"""The variable. No name of a translation contains a blank."""

Explore = Callable[[Model], "list[ExploredWay] | None"]
"""All steps of a model, and whether they are taken; `None` if it has too many states."""


def steps_while_handled(model: Model, request: ClientRequests, explore: Explore) -> ExploredSteps | None:
    """The steps of a model; those of the server count as taken in the context if they are taken while it handles the
    request. `None` if the model has too many states."""
    copies: dict[int, tuple[Edge, bool]] = {}
    automata = tuple(_instrumented(automaton, request, copies) for automaton in model.automata)
    variable = Variable(_HANDLED.identifier, BasicType.BOOL, Boolean(False))
    ways = explore(replace(model, automata=automata, variables=(*model.variables, variable)))
    return None if ways is None else ExploredSteps(model, _joined(ways, request, copies))


def _instrumented(automaton: Automaton, request: ClientRequests, copies: dict[int, tuple[Edge, bool]]) -> Automaton:
    if automaton.name == request.handler:
        return replace(automaton, edges=tuple(_marking(edge, request.location) for edge in automaton.edges))
    if automaton.name != request.server:
        return automaton
    edges = []
    for edge in automaton.edges:
        for is_handled in (True, False):
            term: Expression = _HANDLED if is_handled else Unary(UnaryOperator.NOT, _HANDLED)
            guard = term if edge.guard is None else Binary(BinaryOperator.AND, term, edge.guard.exp)
            copy = replace(edge, guard=Clause(guard))
            copies[id(copy)] = (edge, is_handled)
            edges.append(copy)
    return replace(automaton, edges=tuple(edges))


def _marking(edge: Edge, location: str) -> Edge:
    """An edge of the handler that also sets the variable, if the request begins or ends."""
    if location != edge.source and all(location != destination.location for destination in edge.destinations):
        return edge
    return replace(edge, destinations=tuple(_marked(destination, location) for destination in edge.destinations))


def _marked(destination: Destination, location: str) -> Destination:
    mark = Assignment(_HANDLED, Boolean(destination.location == location))
    return replace(destination, assignments=(*destination.assignments, mark))


def _joined(
    ways: list[ExploredWay], request: ClientRequests, copies: dict[int, tuple[Edge, bool]]
) -> Iterator[ExploredWay]:
    """The ways of the original edges, without the requests that the handler never passes on: what they contain does not
    matter for the others."""
    handled: dict[tuple[int, int], list[ExploredWay]] = {}
    for way in ways:
        if way.automaton != request.server:
            if way.automaton != request.handler or way.is_taken:
                yield way
        elif id(way.edge) in copies:
            edge, is_handled = copies[id(way.edge)]
            number = next(i for i, d in enumerate(way.edge.destinations) if d is way.destination)
            known = handled.setdefault((id(edge), number), [])
            in_context = way.is_taken and is_handled
            known.append(ExploredWay(request.server, edge, edge.destinations[number], way.is_taken, in_context))
    for both in handled.values():
        is_taken = any(way.is_taken for way in both)
        yield replace(both[0], is_taken=is_taken, in_context=any(way.in_context for way in both))

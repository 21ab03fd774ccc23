# SPDX-License-Identifier: Apache-2.0
"""Models in which rare random outcomes are as frequent as the others."""

from __future__ import annotations

from roaml.jani.expressions import Binary, Expression, Integer, Real
from roaml.jani.model import Clause, Destination, Edge, Model
from roaml.jani.operators import BinaryOperator
from roaml.record import replace


def with_equal_probabilities(model: Model) -> Model:
    """A copy of the model in which all destinations of an edge are equally probable, except those with the probability
    0. It has the same traces, with other probabilities: what never happens in few of its traces, although it can
    happen, is improbable for other reasons than a rare outcome."""
    automata = (replace(a, edges=tuple(map(_with_equal_destinations, a.edges))) for a in model.automata)
    return replace(model, automata=tuple(automata))


def is_random(model: Model) -> bool:
    """Whether some edge of the model has several destinations."""
    return any(len(edge.destinations) > 1 for automaton in model.automata for edge in automaton.edges)


def _with_equal_destinations(edge: Edge) -> Edge:
    number = sum(not _is_impossible(destination) for destination in edge.destinations)
    if number < 2:
        return edge
    share: Expression = Binary(BinaryOperator.DIVIDE, Integer(1), Integer(number))
    changed = (d if _is_impossible(d) else replace(d, probability=Clause(share)) for d in edge.destinations)
    return replace(edge, destinations=tuple(changed))


def _is_impossible(destination: Destination) -> bool:
    probability = destination.probability
    return probability is not None and isinstance(probability.exp, Integer | Real) and probability.exp.value == 0

# SPDX-License-Identifier: Apache-2.0
"""The meaning of the final state of a trace of a translated system (`roaml.smc.end`).

If the clock has ended, the time is over. If the root of the tree has ended, the tree has finished. Otherwise a clock
that does not advance, or an event that is not received, means that automata wait for one another. In a system without a
clock, the remaining case is that there is nothing left to do.
"""

from __future__ import annotations

from collections.abc import Mapping

from roaml.jani.expressions import Expression, Name
from roaml.jani.model import Automaton, Model
from roaml.scxml.names import (
    CLOCK,
    RECEIVED,
    TIME_IS_OVER,
    TREE_HAS_FINISHED,
    TREE_ROOT_PREFIX,
    WAITING,
    named,
    on_send,
    open_variable,
)
from roaml.smc.end import End


def marks(model: Model) -> Mapping[tuple[str, str], End]:
    """(automaton, location) -> the meaning of a trace that ends there; empty for a model that is not a translation."""
    marks = {(a.name, location.name): _mark(a, location.name) for a in model.automata for location in a.locations}
    is_translated = any(a.name == CLOCK or is_event(a) for a in model.automata)
    return marks if is_translated else {}


def is_event(automaton: Automaton) -> bool:
    """Whether an automaton buffers an event between sending and receiving, if the event has a receiver."""
    locations = {location.name for location in automaton.locations}
    sends = on_send(named(automaton.name))
    return locations <= {WAITING, RECEIVED} and any(edge.action == sends for edge in automaton.edges)


def _mark(automaton: Automaton, location: str) -> End:
    if automaton.name == CLOCK:
        return End.TIME if location == TIME_IS_OVER else End.STUCK
    if automaton.name.startswith(TREE_ROOT_PREFIX):
        return End.FINISHED if location == TREE_HAS_FINISHED else End.QUIET
    return End.STUCK if location == RECEIVED and is_event(automaton) else End.QUIET


def open_conditions(model: Model) -> Mapping[str, Expression]:
    """Property -> the condition under which it is open at the end of time (docs/spec/jani.md#observers)."""
    variables = {variable.name for variable in model.variables}
    names = {property_.name: open_variable(property_.name) for property_ in model.properties}
    return {property_: Name(variable) for property_, variable in names.items() if variable in variables}

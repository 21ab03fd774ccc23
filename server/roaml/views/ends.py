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
    asked_variable,
    named,
    on_send,
    open_variable,
    opened_variable,
    pending_variable,
)
from roaml.smc.end import End
from roaml.smc.goal import ObserverOutputs


def marks(model: Model) -> Mapping[tuple[str, str], End]:
    """(automaton, location) -> the meaning of a trace that ends there; empty for a model that is not a translation."""
    marks = {(a.name, location.name): _mark(a, location.name) for a in model.automata for location in a.locations}
    is_translated = any(a.name == CLOCK or is_event(a) for a in model.automata)
    return marks if is_translated else {}


def is_event(automaton: Automaton) -> bool:
    """Whether it holds an event between sending and receiving, if the event has a receiver."""
    locations = {location.name for location in automaton.locations}
    sends = on_send(named(automaton.name))
    return locations <= {WAITING, RECEIVED} and any(edge.action == sends for edge in automaton.edges)


def _mark(automaton: Automaton, location: str) -> End:
    if automaton.name == CLOCK:
        return End.TIME if location == TIME_IS_OVER else End.STUCK
    if automaton.name.startswith(TREE_ROOT_PREFIX):
        return End.FINISHED if location == TREE_HAS_FINISHED else End.QUIET
    return End.STUCK if location == RECEIVED and is_event(automaton) else End.QUIET


def observer_outputs(model: Model) -> Mapping[str, ObserverOutputs]:
    """Property -> the variables of its observer that say more than its formula (docs/spec/jani.md#observers)."""
    variables = {variable.name for variable in model.variables}

    def read(variable: str) -> Expression | None:
        return Name(variable) if variable in variables else None

    return {
        name: ObserverOutputs(
            read(open_variable(name)),
            read(asked_variable(name)),
            read(opened_variable(name)),
            can_be_late=pending_variable(name) in variables,
        )
        for name in (property_.name for property_ in model.properties)
    }

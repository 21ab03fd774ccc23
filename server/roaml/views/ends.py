# SPDX-License-Identifier: Apache-2.0
"""Why a trace of a translated system has ended (`roaml.smc.end`), determined from its final state.

If the clock has ended, the maximum time is reached. If the root of the tree has ended, the tree has finished. Otherwise
a clock that does not advance, or an event that is not received, means that automata wait for one another. In a system
without a clock, the remaining case is that no event is left to be handled.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from roaml.jani.expressions import Expression, Name
from roaml.jani.model import PREFIX, Automaton, Model
from roaml.jani.properties import identifiers
from roaml.scxml.names import (
    ASKED,
    CLOCK,
    OPEN,
    OPENED,
    PENDING,
    RECEIVED,
    SATISFIED,
    TIME_IS_OVER,
    TREE_HAS_FINISHED,
    TREE_ROOT_PREFIX,
    VIOLATED,
    WAITING,
    named,
    observer_automaton,
    observer_prefix,
    observer_variable,
    on_send,
)
from roaml.smc.end import End
from roaml.smc.goal import ObserverOutputs


def marks(model: Model) -> Mapping[tuple[str, str], End]:
    """(automaton, location) -> the reason why a trace ends if the automaton stays in the location; empty for a model
    that is not a translation."""
    marks = {(a.name, location.name): _mark(a, location.name) for a in model.automata for location in a.locations}
    return marks if is_translation(model) else {}


def is_translation(model: Model) -> bool:
    """Whether a model is the translation of a system."""
    return any(automaton.name == CLOCK or is_event(automaton) for automaton in model.automata)


def is_event(automaton: Automaton) -> bool:
    """Whether an automaton buffers an event that has a receiver."""
    locations = {location.name for location in automaton.locations}
    sends = on_send(named(automaton.name))
    return locations <= {WAITING, RECEIVED} and any(edge.action == sends for edge in automaton.edges)


def _mark(automaton: Automaton, location: str) -> End:
    if automaton.name == CLOCK:
        return End.TIME if location == TIME_IS_OVER else End.STUCK
    if automaton.name.startswith(TREE_ROOT_PREFIX):
        # With several trees, the root of one that has ended still takes ticks, and does not end the trace.
        # Loops with which an automaton lets the clock begin a step (`roaml.jani.reaction`) are no ticks.
        own = (edge for edge in automaton.edges if not (edge.action or "").startswith(PREFIX))
        is_last = location == TREE_HAS_FINISHED and all(edge.source != location for edge in own)
        return End.FINISHED if is_last else End.QUIET
    return End.STUCK if location == RECEIVED and is_event(automaton) else End.QUIET


def observer_outputs(model: Model) -> Mapping[str, ObserverOutputs]:
    """Property -> what its observers report in addition to the variables that its formula reads
    (docs/spec/jani.md#observers)."""
    variables = {variable.name: variable.comment or "" for variable in model.variables}
    observers = {automaton.name for automaton in model.automata}
    outputs = {}
    for property_ in model.properties:
        read = [name for name, _ in identifiers(property_.expression)]
        prefixes = [observer_prefix(name, VIOLATED, SATISFIED) for name in read]
        prefixes = [prefix for prefix in prefixes if observer_automaton(prefix) in observers]
        if not prefixes:
            continue
        own = prefixes[0]  # the other observers belong to its assumptions
        outputs[property_.name] = ObserverOutputs(
            tuple(
                (observer_variable(prefix, PENDING), Name(observer_variable(prefix, OPEN)))
                for prefix in prefixes
                if observer_variable(prefix, OPEN) in variables
            ),
            _variable(observer_variable(own, ASKED), variables),
            _variable(observer_variable(own, OPENED), variables),
            can_be_late=observer_variable(own, PENDING) in read or observer_variable(own, SATISFIED) in read,
            trigger=variables.get(observer_variable(own, ASKED), ""),
            scope=variables.get(observer_variable(own, OPENED), ""),
        )
    return outputs


def _variable(name: str, variables: Collection[str]) -> Expression | None:
    return Name(name) if name in variables else None

# SPDX-License-Identifier: Apache-2.0
"""Adds a separate action for the end of time to a JANI model, so that observers can join it
(docs/spec/jani.md#observers)."""

from __future__ import annotations

from roaml.jani.model import Action, Edge, Model, Sync
from roaml.record import replace
from roaml.scxml.names import CLOCK, CLOCK_ACTION, TIME_IS_OVER, TIME_OVER_ACTION


def with_end_of_time(model: Model) -> Model:
    """A copy of the model in which the last step of the clock has the action `TIME_OVER_ACTION`. A model without a
    clock, or with this action, is returned unchanged."""
    index = next((i for i, automaton in enumerate(model.automata) if automaton.name == CLOCK), None)
    if index is None or any(action.name == TIME_OVER_ACTION for action in model.actions):
        return model
    clock = model.automata[index]

    def renamed(edge: Edge) -> Edge:
        is_last = edge.action == CLOCK_ACTION and edge.destinations[0].location == TIME_IS_OVER
        return replace(edge, action=TIME_OVER_ACTION) if is_last else edge

    syncs: list[Sync] = []
    for sync in model.system.syncs:
        syncs.append(sync)
        if (index, CLOCK_ACTION) in sync.participants:
            last = tuple((i, TIME_OVER_ACTION if i == index else action) for i, action in sync.participants)
            syncs.append(replace(sync, participants=last))
    clock = replace(clock, edges=tuple(renamed(edge) for edge in clock.edges))
    automata = (*model.automata[:index], clock, *model.automata[index + 1 :])
    actions = (*model.actions, Action(TIME_OVER_ACTION))
    metadata = model.metadata
    if metadata is not None and metadata.clock is not None:
        metadata = replace(metadata, clock=replace(metadata.clock, actions=(CLOCK_ACTION, TIME_OVER_ACTION)))
    return replace(
        model,
        automata=automata,
        system=replace(model.system, syncs=tuple(syncs)),
        actions=actions,
        metadata=metadata,
    )

# SPDX-License-Identifier: Apache-2.0
"""Collects the moves of an automaton: each transition, with all statements that it executes.

The body of a move is the `<onexit>` of the source, the body of the transition, and the `<onentry>` of the target
(docs/spec/jani.md#transitions). If the initial state has an `<onentry>`, the start is a move, too.
"""

from __future__ import annotations

from collections.abc import Iterator

from roaml.record import Record
from roaml.scxml.model import Automaton, Body, State, Transition
from roaml.text import Location


class MoveOutcome(Record, frozen=True):
    """One target of a transition, with all statements that are executed if it is selected, including the `<onentry>` of
    the target."""

    state: str
    probability: float
    body: Body
    origin: Location


class Move(Record, frozen=True):
    """A transition with its outcomes. `number` is its index among the transitions of its state."""

    source: str
    number: int
    transition: Transition
    outcomes: tuple[MoveOutcome, ...]

    @property
    def event(self) -> str:
        """The name of the event; "" for an eventless transition."""
        return self.transition.event.name if self.transition.event else ""


class AutomatonMoves(Record, frozen=True):
    """The moves of an automaton.

    Attributes:
        start: the `<onentry>` of the initial state, which is executed at the start; `None` if it is empty.
        moves: each state with its moves, in document order.
    """

    automaton: Automaton
    start: Body | None
    moves: tuple[tuple[State, tuple[Move, ...]], ...]

    def bodies(self) -> Iterator[tuple[str, Body]]:
        """Every body with the name of the event whose data it may read ("" for none). The body that is executed at the
        start is last."""
        for _, moves in self.moves:
            for move in moves:
                for outcome in move.outcomes:
                    yield move.event, outcome.body
        if self.start is not None:
            yield "", self.start

    def events(self) -> dict[str, None]:
        """The names of the events on which the automaton has transitions, in document order. The values are not
        used."""
        return dict.fromkeys(move.event for _, moves in self.moves for move in moves if move.event)


def behavior_of(automaton: Automaton) -> AutomatonMoves:
    entries = {state.id: state.entry for state in automaton.states}

    def move(state: State, number: int, transition: Transition) -> Move:
        outcomes = tuple(
            MoveOutcome(
                target.state,
                target.probability,
                (*state.exit, *target.body, *entries.get(target.state, ())),
                target.origin,
            )
            for target in transition.targets
        )
        return Move(state.id, number, transition, outcomes)

    moves = tuple((s, tuple(move(s, n, t) for n, t in enumerate(s.transitions))) for s in automaton.states)
    return AutomatonMoves(automaton, entries.get(automaton.initial) or None, moves)

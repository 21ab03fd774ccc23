# SPDX-License-Identifier: Apache-2.0
"""Choices that make no difference, such as the order in which the blackboard receives the values of a script."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from typing import TypeAlias

Branches: TypeAlias = Sequence[tuple[float, int]]
"""The destinations of a choice with their probabilities."""


def merged_choices(
    choices_of: Callable[[int], Sequence[Branches]],
    root: int,
    outcome_of: Callable[[int], Hashable] = lambda last: last,
) -> dict[int, Branches] | None:
    """The Markov chain that the states reachable from `root` are under all schedulers: state -> its destinations.

    States that behave alike from their next step on are one state. If all choices of a state then have the same
    destinations, no scheduler makes a difference there. States before a certain step are skipped.

    Args:
        choices_of: returns the choices of a state; none for a last state.
        outcome_of: returns what matters of a last state. Last states in which this is equal behave alike: they may
            differ in what nobody reads any more, such as an event that is still under way. By default, all are
            different.

    Returns:
        `None` if a choice may make a difference.
    """
    alike: dict[int, int] = {}  # a state -> the state that stands for it
    known: dict[tuple[tuple[int, float], ...], int] = {}
    outcomes: dict[Hashable, int] = {}
    chain: dict[int, Branches] = {}
    entered = {root}
    first = choices_of(root)
    stack = [(root, first, _successors(first))]
    while stack:
        state, choices, successors = stack[-1]
        below = next(successors, None)
        if below is not None:
            if below not in entered:
                entered.add(below)
                inner = choices_of(below)
                stack.append((below, inner, _successors(inner)))
            continue
        stack.pop()
        if not choices:
            chain[state] = []
            alike[state] = outcomes.setdefault(outcome_of(state), state)
            continue
        found = set()
        for branches in choices:
            destinations = _merged(branches, alike)
            # A state that has these destinations stands for them.
            found.add(((known[destinations], 1.0),) if destinations in known else destinations)
        if len(found) > 1:
            return None
        (destinations,) = found
        chain[state] = [(chance, successor) for successor, chance in destinations]
        if len(destinations) == 1:
            alike[state] = destinations[0][0]
        else:
            alike[state] = known.setdefault(destinations, state)
    return chain


def _successors(choices: Sequence[Branches]) -> Iterator[int]:
    return (successor for branches in choices for _, successor in branches)


def _merged(branches: Branches, alike: Mapping[int, int]) -> tuple[tuple[int, float], ...]:
    """The destinations, in a fixed order and each once, with the states that stand for them."""
    chances: dict[int, float] = {}
    for chance, successor in branches:
        place = alike.get(successor, successor)
        chances[place] = chances.get(place, 0.0) + chance
    return tuple(sorted(chances.items()))

# SPDX-License-Identifier: Apache-2.0
"""Choices that lead to the same are one step of a Markov chain; all others are none."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import pytest

from roaml.experiments.confluence import Branches, merged_choices
from roaml.experiments.visits import expected_visits


def chances(choices: Mapping[int, Sequence[Branches]], root: int = 0) -> dict[int, float] | None:
    """The probabilities of the last states; `None` if they depend on a scheduler."""
    chain = merged_choices(lambda state: choices.get(state, ()), root)
    if chain is None:
        return None
    numbers = itertools.count()
    table: list[float] = []
    steps = {}
    for state, branches in chain.items():
        steps[state] = [(successor, next(numbers)) for _, successor in branches]
        table += [chance for chance, _ in branches]
    visits = expected_visits(steps, root, table.__getitem__)
    return {state: visits[state] for state in visits if not choices.get(state) and visits[state]}


def in_any_order(count: int) -> dict[int, list[Branches]]:
    """Independent steps in all orders; a state is the set of those that have been taken."""
    return {
        taken: [[(1.0, taken | 1 << step)] for step in range(count) if not taken >> step & 1]
        for taken in range(2**count - 1)
    }


@pytest.mark.parametrize("count", [1, 2, 3, 7])
def test_the_order_of_independent_steps_makes_no_difference(count: int) -> None:
    assert chances(in_any_order(count)) == {2**count - 1: 1.0}


def test_a_draw_may_be_one_of_the_steps() -> None:
    # The draw, to 1 or 2, before or after a step that does not matter.
    draw = [(0.25, 1), (0.75, 2)]
    choices = {0: [draw, [(1.0, 3)]], 1: [[(1.0, 4)]], 2: [[(1.0, 5)]], 3: [[(0.25, 4), (0.75, 5)]]}
    assert chances(choices) == {4: 0.25, 5: 0.75}


@pytest.mark.parametrize(
    "choices",
    [
        {0: [[(1.0, 1)], [(1.0, 2)]]},
        {0: [[(0.5, 1), (0.5, 2)], [(0.4, 1), (0.6, 2)]]},
        {0: [[(1.0, 1)], [(1.0, 2)]], 1: [[(1.0, 3)]], 2: [[(0.5, 3), (0.5, 4)]]},
    ],
)
def test_a_choice_that_makes_a_difference(choices: Mapping[int, Sequence[Branches]]) -> None:
    assert chances(choices) is None


def test_last_states_with_the_same_outcome_are_one() -> None:
    choices = {0: [[(1.0, 1)], [(0.5, 2), (0.5, 4)]], 1: [[(0.5, 3), (0.5, 4)]]}
    assert merged_choices(lambda state: choices.get(state, ()), 0) is None
    chain = merged_choices(lambda state: choices.get(state, ()), 0, {2: "ends", 3: "ends", 4: "fails"}.get)
    assert chain is not None
    assert chain[0] == [(1.0, 1)]
    assert chain[1] in ([(0.5, 3), (0.5, 4)], [(0.5, 4), (0.5, 3)])


def test_a_cycle_may_be_left() -> None:
    assert chances({0: [[(1.0, 1)]], 1: [[(0.5, 0), (0.5, 2)]]}) == {2: pytest.approx(1.0)}

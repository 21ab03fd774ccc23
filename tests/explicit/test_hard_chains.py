# SPDX-License-Identifier: Apache-2.0
"""Components in which value iteration converges slowly: elimination gives values with proved bounds; and it is decided
exactly whether a probability is 1."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

from roaml.explicit import chain as compiled_chain
from roaml.explicit import solver
from roaml.explicit.plain import plain_chain
from roaml.explicit.space import Space, StateLimits, explore
from roaml.explicit.values import values_of
from roaml.smc.model import ModelChecker
from roaml.smc.statistics import Bounds
from roaml.verification.exhaustive import exact_values

WORK = 100_000_000
"""The work of each value that `verify` does without being asked, in additions."""


def space_of(written: Json) -> Space:
    checker = ModelChecker(model(written))
    return explore(checker, checker.compiled_properties[0], StateLimits())


def returning(size: int, right: float) -> Json:
    """The chain of Haddad and Monmege: from the middle, two arms of `size` states; each step along an arm has the
    probability 1/2 and otherwise leads back to the middle. The end of the right arm is reached with the probability
    `right`, after about 2^size visits of the middle."""
    ends = op("∧", op("<", "x", size), op(">", "x", -size))
    steps = [
        edge("l", way("l", right, x=1), way("l", 1 - right, x=-1), guard=op("=", "x", 0)),
        edge("l", way("l", 0.5, x=op("+", "x", 1)), way("l", 0.5, x=0), guard=op("∧", ends, op(">", "x", 0))),
        edge("l", way("l", 0.5, x=op("-", "x", 1)), way("l", 0.5, x=0), guard=op("∧", ends, op("<", "x", 0))),
    ]
    goal = {"p": probability(op("F", op("=", "x", size)))}
    return document(automaton("a", "l", steps), variables=[variable("x")], properties=goal)


def walk(size: int) -> Json:
    """A symmetric random walk that starts at a quarter of its length: the upper end is reached first with the
    probability 1/4."""
    inside = op("∧", op("<", "x", size), op(">", "x", 0))
    steps = [edge("l", way("l", 0.5, x=op("+", "x", 1)), way("l", 0.5, x=op("-", "x", 1)), guard=inside)]
    goal = {"p": probability(op("F", op("=", "x", size)))}
    start = variable("x", initial=size // 4)
    return document(automaton("a", "l", steps), variables=[start], properties=goal)


@pytest.mark.parametrize(
    ("written", "value"),
    [(returning(20, 0.75), 0.75), (returning(100, 0.75), 0.75), (returning(800, 0.625), 0.625), (walk(40_000), 0.25)],
    ids=["20", "100", "800", "walk"],
)
def test_slow_chains_have_exact_values(written: Json, value: float) -> None:
    values = values_of(space_of(written), solver, WORK)
    assert values.is_precise
    for bounds in (values.minimum, values.maximum, values.uniform):
        assert bounds is not None
        assert bounds.lower <= value <= bounds.upper
        assert bounds.upper - bounds.lower < 1e-8


def solved(module: Any, rows: list[list[tuple[int, float]]], leaves: list[float], gain: list[float]) -> Any:
    chain = module.Chain(len(rows))
    for state, row in enumerate(rows):
        chain.leaves[state], chain.gain[state] = leaves[state], gain[state]
        for target, chance in row:
            chain.add(state, target, chance)
    error = chain.solve()
    return error, [chain.values[state] for state in range(len(rows))]


def exactly(rows: list[list[tuple[int, float]]], leaves: list[float], gain: list[float]) -> list[Fraction]:
    """The solution of `sum of the row * value = gain + the row's values` in rational numbers (Gauss-Jordan)."""
    size = len(rows)
    lines = [[Fraction(0)] * size + [Fraction(gain[state])] for state in range(size)]
    for state, row in enumerate(rows):
        lines[state][state] += Fraction(leaves[state])
        for target, chance in row:
            if target != state:
                lines[state][state] += Fraction(chance)
                lines[state][target] -= Fraction(chance)
    for i in range(size):
        pivot = next(k for k in range(i, size) if lines[k][i] != 0)
        lines[i], lines[pivot] = lines[pivot], lines[i]
        lines[i] = [number / lines[i][i] for number in lines[i]]
        for k in range(size):
            if k != i and lines[k][i] != 0:
                lines[k] = [a - lines[k][i] * b for a, b in zip(lines[k], lines[i], strict=True)]
    return [line[size] for line in lines]


@st.composite
def chains(draw: st.DrawFn) -> tuple[list[list[tuple[int, float]]], list[float], list[float]]:
    size = draw(st.integers(1, 9))
    chances = st.sampled_from([0.5, 0.1, 1e-3, 1e-9, 1e-30, 1 / 3])
    rows = [draw(st.lists(st.tuples(st.integers(0, size - 1), chances), max_size=5)) for _ in range(size)]
    leaves = [draw(chances) for _ in range(size)]
    return rows, leaves, [draw(st.sampled_from([0.0, 1.0, 1e-20, 1e20])) for _ in range(size)]


@given(chains())
@settings(max_examples=150, deadline=None, derandomize=True)
def test_elimination_has_the_proved_relative_error(written: Any) -> None:
    error, values = solved(compiled_chain, *written)
    assert 0 < error < 1e-12
    for value, expected in zip(values, exactly(*written), strict=True):
        assert abs(Fraction(value) - expected) <= Fraction(error) * expected
    assert solved(plain_chain(), *written) == (error, values)


def test_a_chain_that_need_not_end_has_no_solution() -> None:
    error, _ = solved(compiled_chain, [[(1, 1.0)], [(0, 1.0)]], [0.0, 0.0], [0.0, 0.0])
    assert error < 0


def tossing(chance: float, *, ends: bool) -> Json:
    """Tosses until a success; if `ends`, another result ends the trace without success."""
    lost = "lost" if ends else "l"
    edges = [edge("l", way("l", 1 - 2 * chance), way("won", chance, x=1), way(lost, chance))]
    goal = {"p": probability(op("F", op("=", "x", 1)))}
    return document(automaton("a", "l won lost", edges), variables=[variable("x")], properties=goal)


def test_a_probability_that_is_1_has_exact_bounds() -> None:
    assert values_of(space_of(tossing(1e-3, ends=False))).minimum == Bounds(1, 1)


def unlikely(chance: float, *, negated: bool) -> Json:
    """A trace fails with a probability of `chance` squared."""
    edges = [
        edge("l", way("m", 1 - chance, x=1), way("k", chance)),
        edge("k", way("m", 1 - chance, x=1), way("n", chance, y=1)),
    ]
    goal = op("G", op("=", "y", 0)) if negated else op("F", op("=", "x", 1))
    variables = [variable("x"), variable("y")]
    return document(automaton("a", "l k m n", edges), variables=variables, properties={"p": probability(goal)})


@pytest.mark.parametrize("negated", [True, False])
def test_a_probability_that_is_less_than_1_has_bounds_below_1(negated: bool) -> None:
    written = unlikely(1e-15, negated=negated)
    checker = ModelChecker(model(written))
    exact = exact_values(checker, checker.compiled_properties[0], StateLimits())
    assert exact.minimum.lower <= exact.minimum.upper < 1
    assert exact.maximum.upper < 1
    assert exact.least == pytest.approx(1)

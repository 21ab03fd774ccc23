# SPDX-License-Identifier: Apache-2.0
"""Actions with more combinations of edges than an integer can represent: each has its weight, and each edge its
probability."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from smc_models import Json, answers, automaton, document, edge, model, op, probability, variable, way

from both_kernels import difference
from examples import examples
from explorer import Explorer, TooManyChoicesError
from fuzz.networks import wide as wide_network
from roaml.smc import kernel
from roaml.smc.model import ModelChecker
from roaml.smc.statistics import clopper_pearson
from roaml.verification.small import LIMITS, attempt

SURE = 1 - 1e-9
"""The probability that a test which compares a frequency with an interval fails by chance."""


def wide(count: int, edges: int, **more: Json) -> Json:
    """`count` automata with `edges` edges each on one action. The variables `x0`, `x1`, ... contain the taken edges."""
    parts = []
    for number in range(count):
        taken = [edge("s", way("t", **{f"x{number}": pick}), action="a") for pick in range(edges)]
        parts.append(automaton(f"m{number}", "s t", taken))
    chosen = (0, count // 2, count - 1)
    goals = {f"x{n}": probability(op("F", op("=", f"x{n}", edges - 1))) for n in chosen}
    variables = [variable(f"x{number}", initial=-1) for number in range(count)]
    return document(*parts, variables=variables, syncs=[["a"] * count], properties=goals, **more)


@pytest.mark.parametrize(("count", "edges"), [(11, 2), (12, 2), (13, 2), (31, 3), (63, 2), (64, 2), (1100, 2)])
def test_each_automaton_draws_its_edge(count: int, edges: int) -> None:
    """From one combination for each of 2^11 to one of 2^1100, which exceeds every register."""
    traces = 500
    for answer in answers(wide(count, edges), traces).values():
        lower, upper = clopper_pearson(answer.tally.successes, traces, SURE)
        assert lower < 1 / edges < upper, (answer.question.name, answer.value)


def test_one_edge_with_three_among_many_with_two() -> None:
    """With 3 * 2^30 combinations and one number of 32 bits, every third combination would be twice as probable as the
    others."""
    parts = [automaton("three", "s t", [edge("s", way("t", x=n), action="a") for n in range(3)])]
    parts += [automaton(f"m{n}", "s t", [edge("s", "t", action="a"), edge("s", "t", action="a")]) for n in range(30)]
    goals = {"p": probability(op("F", op("=", "x", 0)))}
    written = document(*parts, variables=[variable("x", initial=-1)], syncs=[["a"] * 31], properties=goals)
    answer = answers(written, 4000)["p"]
    lower, upper = clopper_pearson(answer.tally.successes, 4000, SURE)
    assert lower < 1 / 3 < upper


@pytest.mark.parametrize("common", [8, 40, 1100])
@pytest.mark.parametrize("more", [0, 2])
def test_the_weight_of_an_action_is_the_number_of_its_combinations(common: int, more: int) -> None:
    """Two actions, one of which has 2^more times as many combinations as the other."""
    parts = []
    for number in range(common + more):
        edges = [edge("s", "t", action="a")] * 2 + [edge("s", "t", action="b")] * (2 if number < common else 1)
        parts.append(automaton(f"m{number}", "s t", edges))
    first = automaton("first", "s a b", [edge("s", way("a", x=1), action="a"), edge("s", way("b", x=2), action="b")])
    goals = {"p": probability(op("F", op("=", "x", 2)))}
    size = common + more + 1
    written = document(first, *parts, variables=[variable("x")], syncs=[["a"] * size, ["b"] * size], properties=goals)
    answer = answers(written, 600)["p"]
    lower, upper = clopper_pearson(answer.tally.successes, 600, SURE)
    assert lower < 1 / (1 + 2**more) < upper


def test_an_action_that_is_negligible_is_never_taken() -> None:
    """One choice beside 2^1200 others has a probability below the smallest number of 64 bits."""
    parts = [automaton(f"m{n}", "s t", [edge("s", "t", action="a")] * 2) for n in range(1200)]
    alone = automaton("alone", "s t", [edge("s", way("t", x=1))])
    goals = {
        "p": probability(
            op(
                "F",
                op("=", "x", 1),
            ),
            "Pmax",
        )
    }
    written = document(alone, *parts, variables=[variable("x")], syncs=[[None, *["a"] * 1200]], properties=goals)
    checker = ModelChecker(model(written))
    compiled = checker.compiled(checker.compiled_properties[0])
    actual_kernel = kernel.Kernel(compiled.program, compiled.goal)
    for trace in range(50):
        actual_kernel.begin(0, trace)
        actual_kernel.step()
        assert actual_kernel.integer(0) == 0


@pytest.mark.parametrize(("count", "edges"), [(12, 2), (64, 2), (40, 5)])
@pytest.mark.parametrize("scheduler", [0, 77])
def test_both_kernels_draw_the_same(count: int, edges: int, scheduler: int) -> None:
    checker = ModelChecker(model(wide(count, edges)))
    for property_ in checker.compiled_properties:
        assert difference(checker, property_, 7, 10, 3, scheduler) == ""


def test_schedulers_choose_every_edge() -> None:
    """No scheduler considers all combinations, but together they choose all edges equally often."""
    checker = ModelChecker(model(wide(64, 2)))
    compiled = checker.compiled(checker.compiled_properties[0])
    actual_kernel = kernel.Kernel(compiled.program, compiled.goal)
    chosen = [0] * 64
    for scheduler in range(1, 301):
        actual_kernel.begin(0, 0, scheduler)
        actual_kernel.step()
        for number in range(64):
            chosen[number] += actual_kernel.integer(number)
    for ones in chosen:
        lower, upper = clopper_pearson(ones, 300, SURE)
        assert lower < 0.5 < upper


def test_a_scheduler_is_a_function_of_the_state() -> None:
    """A scheduler makes the same choice in the same state, whatever the trace and its random numbers are."""
    checker = ModelChecker(model(wide(64, 3)))
    compiled = checker.compiled(checker.compiled_properties[0])
    actual_kernel = kernel.Kernel(compiled.program, compiled.goal)
    seen = set()
    for trace in range(20):
        actual_kernel.begin(trace, trace, 5)
        actual_kernel.step()
        seen.add(tuple(actual_kernel.snapshot()[0]))
    assert len(seen) == 1


@settings(max_examples=examples(15), suppress_health_check=list(HealthCheck))
@given(st.integers(2, 100), st.randoms(use_true_random=False), st.sampled_from([0, 3]))
def test_both_kernels_draw_the_same_in_random_networks(count: int, random: Random, scheduler: int) -> None:
    checker = ModelChecker(model(wide_network(random, count)))
    assert difference(checker, checker.compiled_properties[0], 7, 3, 20, scheduler) == ""


# ------------------------------------------------------------------ states, where they are looked at one by one


@pytest.mark.parametrize(("count", "edges"), [(21, 2), (64, 2), (1100, 3)])
def test_combinations_are_counted_before_they_are_enumerated(count: int, edges: int) -> None:
    checker = ModelChecker(model(wide(count, edges)))
    explorer = Explorer(checker.compiled(checker.compiled_properties[0]))
    with pytest.raises(TooManyChoicesError):
        next(explorer.choices(explorer.initial))
    with pytest.raises(TooManyChoicesError):
        explorer.reachable(10)


def test_combinations_of_destinations_are_counted_as_well() -> None:
    """One choice with 2^64 successors."""
    parts = [automaton(f"m{n}", "s t", [edge("s", way("s", 0.5), way("t", 0.5), action="a")]) for n in range(64)]
    goals = {"p": probability(op("F", op("=", "x", 1)))}
    written = document(*parts, variables=[variable("x")], syncs=[["a"] * 64], properties=goals)
    checker = ModelChecker(model(written))
    explorer = Explorer(checker.compiled(checker.compiled_properties[0]))
    with pytest.raises(TooManyChoicesError):
        explorer.reachable(10)


def test_equal_choices_are_one_choice_with_their_weight() -> None:
    """Edges without effect: 2^62 combinations of them, and one successor."""
    parts = [automaton("a", "s t", [edge("s", way("t", x=1), action="a")])]
    parts += [automaton(f"m{n}", "s", [edge("s", "s", action="a"), edge("s", "s", action="a")]) for n in range(62)]
    goals = {"p": probability(op("F", op("=", "x", 1)))}
    written = document(*parts, variables=[variable("x")], syncs=[["a"] * 63], properties=goals)
    checker = ModelChecker(model(written))
    explorer = Explorer(checker.compiled(checker.compiled_properties[0]))
    ((times, branches),) = explorer.choices(explorer.initial)
    assert (times, len(branches)) == (2**62, 1)
    assert len(explorer.reachable(10)) == 2


def test_agreement_is_not_looked_for_among_too_many_combinations() -> None:
    for written in (wide(64, 2), wide(1100, 2)):
        checker = ModelChecker(model(written))
        assert attempt(checker, checker.compiled_properties[0], LIMITS).exact is None

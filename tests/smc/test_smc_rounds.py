# SPDX-License-Identifier: Apache-2.0
"""Traces that repeat some states for ever are decided: deterministic and random cycles, of any goal without a bound."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from smc_models import Json, answers, automaton, document, edge, model, op, probability, variable, way

from roaml.explicit.plain import plain_kernel
from roaml.smc import kernel
from roaml.smc.batch import Simulator, Task, run_on
from roaml.smc.end import End
from roaml.smc.model import ModelChecker
from roaml.smc.pool import Pool
from roaml.smc.program import TRUE, UNKNOWN
from roaml.smc.record import Recorder, Recording
from roaml.smc.rounds import FIRST_CHECK, Rounds, limits
from roaml.smc.run import EstimationMethod, Options
from roaml.smc.states import MAX_BYTES
from roaml.smc.tally import Tally

NEVER, ODD = op("=", "x", 9), op("=", "x", 1)
TOGGLE = [edge("a", way("b", x=1)), edge("b", way("a", x=0))]
RANDOM = [
    edge("a", way("b", 0.5, x=1), way("c", 0.5)),
    edge("b", way("a", x=0), guard=op("=", "x", 1)),
    edge("c", way("a", 0.25), way("c", 0.75)),
]
CHOICE = [edge("a", "b"), edge("a", way("c", x=1)), edge("b", "a"), edge("c", way("a", x=0))]
DEAD_END = [edge("a", way("b", 0.5), way("e", 0.5, x=9)), edge("b", "c"), edge("c", "b")]
RARE_EXIT = [edge("a", "b"), edge("b", way("a", 0.99995), way("e", 0.00005, x=9))]
RING = [edge("a", way("a", x=op("%", op("+", "x", 10), 800)))]


def reward(condition: Json, operator: str = "Emin") -> Json:
    value = {"op": operator, "exp": 1, "accumulate": ["steps"], "reach": condition}
    return {"op": "filter", "fun": "values", "values": value, "states": {"op": "initial"}}


def written(edges: list[Json], **properties: Json) -> Json:
    return document(automaton("m", "a b c e", edges), variables=[variable("x")], properties=properties)


@pytest.mark.parametrize("edges", [TOGGLE, RANDOM, CHOICE, RING], ids=["toggle", "random", "choice", "ring"])
def test_goals_that_are_never_decided(edges: list[Json]) -> None:
    paths = {"f": op("F", NEVER), "g": op("G", op("≠", "x", 9)), "u": op("U", op("<", "x", 900), NEVER)}
    properties = {name: probability(path) for name, path in paths.items()}
    found = answers(written(edges, **properties, e=reward(NEVER)), 20, max_steps=100_000)
    assert {name: answer.value for name, answer in found.items()} == {"f": 0, "g": 1, "u": 0, "e": float("inf")}
    assert all(answer.tally.ended(End.ROUND) == 20 for answer in found.values())


@pytest.mark.parametrize(
    ("condition", "lasts", "recurs"), [(ODD, 0, 1), (op("≤", "x", 1), 1, 1), (op("=", "x", 7), 0, 0)]
)
@pytest.mark.parametrize("edges", [TOGGLE, RANDOM, CHOICE], ids=["toggle", "random", "choice"])
def test_what_holds_in_all_or_some_of_the_states(
    edges: list[Json], condition: Json, lasts: float, recurs: float
) -> None:
    paths = {"lasts": op("F", op("G", condition)), "recurs": op("G", op("F", condition))}
    found = answers(written(edges, **{name: probability(path) for name, path in paths.items()}), 20, 100_000)
    assert {name: answer.value for name, answer in found.items()} == {"lasts": lasts, "recurs": recurs}


def test_some_traces_reach_a_dead_end() -> None:
    found = answers(written(DEAD_END, f=probability(op("F", NEVER)), e=reward(NEVER)), 2_000)
    tally = found["f"].tally
    assert tally.ended(End.ROUND) + tally.ended(End.DECIDED) == 2_000
    assert abs(found["f"].value - 0.5) < 0.06
    assert found["e"].value == float("inf")


def test_a_rare_exit_is_an_exit() -> None:
    found = answers(written(RARE_EXIT, f=probability(op("F", NEVER))), 50, max_steps=10_000_000)["f"]
    assert found.tally.ended(End.DECIDED) == 50
    assert found.tally.steps > 50 * FIRST_CHECK


def test_bounds_on_steps_are_awaited() -> None:
    bounded = {**op("F", op("=", "x", 9)), "step-bounds": {"upper": 30_000}}
    late = {**op("F", ODD), "step-bounds": {"lower": 30_000}}
    found = answers(written(TOGGLE, bounded=probability(bounded), late=probability(late)), 2, max_steps=100_000)
    assert (found["bounded"].value, found["late"].value) == (0, 1)
    assert {answer.tally.ended(End.DECIDED) for answer in found.values()} == {2}
    assert found["bounded"].tally.steps == 2 * 30_000


def test_numbers_that_grow_for_ever_are_cut() -> None:
    edges = [edge("a", way("a", x=op("+", "x", 10)))]
    found = answers(written(edges, f=probability(op("F", NEVER))), 2, max_steps=30_000)["f"]
    assert (found.tally.ended(End.CUT), found.tally.undecided) == (2, 2)


def test_shared_separate_and_recorded_traces_have_the_same_verdicts() -> None:
    properties = {
        "never": probability(op("F", NEVER)),
        "slow": probability({**op("F", NEVER), "step-bounds": {"upper": 25_000}}),
        "lasts": probability(op("F", op("G", op("≤", "x", 1)))),
    }
    checker = ModelChecker(model(written(DEAD_END, **properties)))
    options = Options(method=EstimationMethod.FIXED, max_traces=40, max_steps=50_000)
    compiled = checker.compiled_properties
    outcomes = []
    with Pool() as pool:
        tallies = [Tally() for _ in compiled]
        checker.answer_together(compiled, options, pool, tallies, lambda *_: None)
        for property_, tally in zip(compiled, tallies, strict=True):
            alone = checker.answer(property_, options, pool).tally
            assert alone.to_json() == tally.to_json()
            outcomes.append(alone)
    for property_, tally in zip(compiled, outcomes, strict=True):
        recorder = Recorder(checker, property_, 0, 50_000)
        recordings = [Recording(trace) for trace in range(40)]
        for recording in recordings:
            recorder.rush(recording)
        assert sum(recording.verdict == TRUE for recording in recordings) == tally.successes
        assert sum(recording.end is End.ROUND for recording in recordings) == tally.ended(End.ROUND)
    walked = Recording(next(r.trace for r in recordings if r.end is End.ROUND))
    assert sum(1 for _ in recorder.walk(walked)) == FIRST_CHECK
    assert (walked.verdict, walked.end) == (TRUE, End.ROUND)


def test_a_check_depends_only_on_the_trace() -> None:
    """Sets of states that other traces have found do not change the result."""
    checker = ModelChecker(model(written(RING, f=probability(op("F", NEVER)))))
    compiled = checker.compiled(checker.compiled_properties[0])
    simulator = kernel.Kernel(compiled.program, compiled.goal)
    kept = Rounds(compiled)
    found: list[list[tuple[int, int]]] = [[], []]
    for outcomes, rounds in ((found[0], lambda: kept), (found[1], lambda: Rounds(compiled))):
        for trace in range(3):
            simulator.begin(0, trace)
            for limit in limits(100_000):
                if simulator.advance(limit) == UNKNOWN and rounds().check(simulator, 0, trace) != UNKNOWN:
                    outcomes.append((trace, limit))
                    break
    # 80 states are collected only after 8,000 steps or more.
    assert found[0] == found[1] == [(trace, FIRST_CHECK) for trace in range(3)]


def test_both_kernels_repeat_in_the_same_way() -> None:
    properties: dict[str, Any] = {"f": probability(op("F", NEVER)), "l": probability(op("F", op("G", ODD)))}
    checker = ModelChecker(model(written(RANDOM, **properties)))
    for property_ in checker.compiled_properties:
        compiled = checker.compiled(property_)
        results = []
        for module in (kernel, plain_kernel()):
            simulator = module.Kernel(compiled.program, compiled.goal)
            simulator.begin(1, 1)
            simulator.advance(50)
            state = [simulator.conditions(), simulator.repeat([True], [True])]
            simulator.begin(1, 1)
            simulator.advance(50)
            state += [simulator.repeat([False], [True]), simulator.ending(), simulator.result(0)]
            simulator.begin(1, 2)
            results.append([*state, simulator.returns(1), simulator.returns(100), simulator.snapshot()])
        assert results[0] == results[1]


@pytest.mark.parametrize("edges", [TOGGLE, RANDOM, CHOICE, RING, DEAD_END, RARE_EXIT])
def test_known_states_change_no_result(edges: list[Json]) -> None:
    path = {**op("F", NEVER), "step-bounds": {"upper": 45_000}}
    properties = {"f": probability(op("F", NEVER)), "l": probability(op("F", op("G", ODD))), "b": probability(path)}
    checker = ModelChecker(model(written(edges, **properties)))
    payload = checker.payload(*checker.compiled_properties)
    task = Task(payload, 3, 0, 20, 50_000, 0, (0, 1, 2))
    results = []
    for memory in (0, MAX_BYTES):
        simulator = Simulator(payload.compiled, memory)
        if memory and simulator.batch is not None:
            simulator.batch.use_nodes()
        outcome = run_on(simulator, task)
        results.append([(rows.verdicts, rows.ends, rows.steps, rows.rewards) for rows in outcome.questions])
    assert results[0] == results[1]


@given(st.lists(st.lists(st.integers(0, 8), max_size=3), min_size=9, max_size=9), st.integers(0, 99))
@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
def test_states_that_are_remembered_change_no_check(graph: list[list[int]], seed: int) -> None:
    """Whether a state repeats does not depend on the states that were examined before: dead ends, exits, and states
    that are in no set of a small number of states."""
    edges = [
        edge("a", way("a", 0.998, x=targets[i]), way("a", 0.002, x=targets[i - 1]), guard=op("=", "x", source))
        for source, targets in enumerate(graph)
        for i in range(len(targets))
    ]
    checker = ModelChecker(model(written(edges, f=probability(op("F", op("=", "x", 10))))))
    compiled = checker.compiled(checker.compiled_properties[0])
    simulator = kernel.Kernel(compiled.program, compiled.goal)
    kept = Rounds(compiled)
    for trace in range(12):
        for limit in range(100, 1_200, 150):
            results = []
            for rounds in (Rounds(compiled), kept):
                simulator.begin(seed, trace)
                if simulator.advance(limit) == UNKNOWN and simulator.ending() == End.DECIDED:
                    results.append((rounds.check(simulator, seed, trace), simulator.result(0), simulator.ending()))
            assert results[1:] == results[:-1]


def test_states_before_a_cycle_do_not_exclude_it() -> None:
    """Some traces are examined before they enter the cycle of `c` and `e`, others afterwards, in both orders."""
    edges = [edge("a", "b"), edge("b", way("a", 0.998), way("c", 0.002)), edge("c", "e"), edge("e", "c")]
    checker = ModelChecker(model(written(edges, f=probability(op("F", NEVER)))))
    compiled = checker.compiled(checker.compiled_properties[0])
    simulator = kernel.Kernel(compiled.program, compiled.goal)
    places: dict[bool, list[int]] = {True: [], False: []}
    for trace in range(100):
        simulator.begin(0, trace)
        simulator.advance(1_000)
        places[simulator.location(0) < 2].append(trace)
    assert min(map(len, places.values())) > 20
    for first in (True, False):
        kept = Rounds(compiled)
        for is_before in (first, not first):
            for trace in places[is_before]:
                simulator.begin(0, trace)
                simulator.advance(1_000)
                assert (kept.check(simulator, 0, trace) == UNKNOWN) == is_before

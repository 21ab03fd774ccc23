# SPDX-License-Identifier: Apache-2.0
"""Properties that are explored at the same time have the same results as one after the other."""

from __future__ import annotations

import multiprocessing
from pathlib import Path
from typing import Any

import pytest
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

from roaml import api
from roaml.explicit.space import ExplorationProgress, StateLimits
from roaml.smc.fault import FaultError
from roaml.verification import searches
from roaml.verification.results import Result
from roaml.verification.target import target_of
from roaml.verification.verifier import Verifier, verifier_of

EXAMPLES = Path(__file__).parents[2] / "examples"
SIDE = 200
WITHOUT_LIMITS = StateLimits()


@pytest.fixture(autouse=True)
def _without_delay(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(searches, "WORKER_START_DELAY_S", -1.0)


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The names of the properties that are explored in other processes, in the order in which they begin."""
    names: list[str] = []
    original = searches._OwnProcess.__init__

    def init(self: Any, checker: Any, property_: Any, limits: Any) -> None:
        names.append(property_.question.name)
        original(self, checker, property_, limits)

    monkeypatch.setattr(searches._OwnProcess, "__init__", init)
    return names


def verifier(written: Json) -> Verifier:
    return verifier_of(target_of(model(written), "model.jani", (), lambda _: None))


def grid(*properties: str, **more: Any) -> Json:
    """Two counters up to SIDE, which a walk increases in any order, and properties about their end."""
    steps = [
        edge("s", way("s", x=op("+", "x", 1)), guard=op("<", "x", SIDE)),
        edge("s", way("s", y=op("+", "y", 1)), guard=op("<", "y", SIDE)),
    ]
    corner = {"a": op("=", "x", SIDE), "b": op("=", "y", SIDE), "c": op("<", op("+", "x", "y"), 0)}
    chosen = {name: probability(op("F", corner[name])) for name in properties}
    variables = [variable("x"), variable("y")]
    return document(automaton("walk", "s", steps), variables=variables, properties={**chosen, **more})


def results_of(
    exhaustively: Verifier, jobs: int, limits: StateLimits = WITHOUT_LIMITS, watch: Any = None
) -> dict[str, Result | str]:
    results: dict[str, Result | str] = {}
    with exhaustively.searches(limits, jobs) as together:
        for property_ in exhaustively.checker.compiled_properties:
            try:
                result = exhaustively.exhaustive(property_, together.limits, watch, together)
            except FaultError as fault:
                results[property_.question.name] = str(fault)
            else:
                results[property_.question.name] = result
    assert not multiprocessing.active_children()
    return results


def compared(results: dict[str, Result | str]) -> dict[str, object]:
    """What does not depend on time: values, and the stories of traces."""
    rows: dict[str, object] = {}
    for name, result in results.items():
        if isinstance(result, str) or result.exact is None:
            rows[name] = result if isinstance(result, str) else result.outcome
            continue
        exact = result.exact
        stories = [(trace.verdict, trace.is_reduced, trace.story(None)) for trace in exact.traces]
        values = exact.minimum, exact.maximum, exact.uniform, exact.states, exact.proof, exact.is_reduced
        rows[name] = values, [verdict.is_met for verdict in result.verdicts], stories
    return rows


@pytest.mark.parametrize("jobs", [2, 3, 8])
def test_values_and_traces(jobs: int, started: list[str]) -> None:
    written = grid("a", "b", "c", likely=op("≥", probability(op("F", op("=", "x", SIDE))), 0.5))
    one_by_one = results_of(verifier(written), 1)
    assert started == []
    together = results_of(verifier(written), jobs)
    assert compared(together) == compared(one_by_one)
    assert started[:1] == ["b"], "`a` and `likely` have one subject, so `b` is the next property"
    assert "likely" not in started


def test_limits_of_states_and_faults() -> None:
    written = grid("a", "b", worse=probability(op("F", op("=", op("%", "x", op("-", "y", 3)), 1))))
    for limits in (StateLimits(), StateLimits(states=100)):
        one_by_one = compared(results_of(verifier(written), 1, limits))
        assert compared(results_of(verifier(written), 3, limits)) == one_by_one
        assert isinstance(one_by_one["worse"], str) or limits.states == 100


def test_a_process_that_is_killed(started: list[str]) -> None:
    written = grid("a", "b", "c")

    def kill(_: ExplorationProgress) -> None:
        for process in multiprocessing.active_children():
            process.kill()

    assert compared(results_of(verifier(written), 2, watch=kill)) == compared(results_of(verifier(written), 1))
    assert started


def test_memory_of_all_searches(monkeypatch: pytest.MonkeyPatch, started: list[str]) -> None:
    """If the searches need too much memory, the last one is stopped, and its property is explored later."""
    written = grid("a", "b", "c")
    limits = StateLimits(bytes=1 << 30)
    original = searches._OwnProcess.__init__

    def init(self: Any, *arguments: Any) -> None:
        original(self, *arguments)
        self.progress = ExplorationProgress(0, 0, limits.bytes)

    monkeypatch.setattr(searches._OwnProcess, "__init__", init)
    assert compared(results_of(verifier(written), 3, limits)) == compared(results_of(verifier(written), 1, limits))
    assert started == ["b"]


def test_an_interruption_stops_all_processes(started: list[str]) -> None:
    def interrupt(_: ExplorationProgress) -> None:
        if started:
            raise KeyboardInterrupt

    exhaustively = verifier(grid("a", "b", "c"))
    with pytest.raises(KeyboardInterrupt):
        results_of(exhaustively, 3, watch=interrupt)
    assert started
    assert not multiprocessing.active_children()


@pytest.mark.parametrize("name", ["assembly_robot", "delivery_robot"])
def test_shipped_systems(name: str, started: list[str]) -> None:
    """Their properties have observers, and some have reductions."""
    target = api.target(str(EXAMPLES / name / "main.xml"))
    limits = StateLimits(30_000)
    one_by_one, together = (compared(results_of(api.verifier(target), jobs, limits)) for jobs in (1, 2))
    assert started
    assert together == one_by_one

# SPDX-License-Identifier: Apache-2.0
"""Steps that the compiler has prepared do the same as steps whose ways the kernel chooses."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from smc_models import automaton, document, edge, model, op, probability, variable, way
from smc_random import networks

from both_kernels import plain_kernel
from examples import examples
from roaml import api
from roaml.smc import kernel, updates
from roaml.smc.model import ModelChecker
from roaml.smc.program import UNKNOWN, Compiled, Program

ROOT = Path(__file__).resolve().parents[2]

State = tuple[Any, ...]


def first_program(checker: ModelChecker) -> Compiled:
    return checker.compiled(checker.compiled_properties[0])


def visited(compiled: Compiled, module: Any, traces: int, steps: int) -> list[State]:
    """What the steps of some traces take, and the states after them with everything that is enabled there. It is
    compared with what a kernel enables that has not taken the step."""
    simulator, fresh = (module.Kernel(compiled.program, compiled.goal) for _ in range(2))
    instances = range(compiled.program.instances)
    states: list[State] = []
    for trace in range(traces):
        simulator.begin(3, trace)
        for _ in range(steps):
            before = [simulator.location(i) for i in instances]
            if simulator.step() != UNKNOWN:
                break
            places = [simulator.location(i) for i in instances]
            for instance, taken in simulator.taken():
                before[instance] = compiled.program.way_target[taken]
            assert before == places
            choices = simulator.choices()
            fresh.restore(places, *simulator.snapshot())
            assert fresh.choices() == choices
            states.append((simulator.vector, simulator.taken(), places, simulator.snapshot(), choices))
        states.append((simulator.outcome(), simulator.problem()))
    return states


def given_steps(compiled: Compiled, traces: int, steps: int) -> list[State]:
    """Like `visited`, for steps that are chosen by the number of the trace."""
    simulator = kernel.Kernel(compiled.program, compiled.goal)
    states: list[State] = []
    for trace in range(traces):
        simulator.begin(3, trace)
        for number in range(steps):
            choices = simulator.choices()
            if not choices:
                break
            vector, _, slots = choices[(trace + number) % len(choices)]
            if simulator.go(vector, [0] * len(slots), [len(edges[0]) - 1 for edges in slots]) != UNKNOWN:
                break
            states.append((simulator.vector, simulator.taken(), simulator.snapshot(), simulator.choices()))
        states.append((simulator.outcome(), simulator.problem()))
    return states


def without_steps(written: Any, monkeypatch: pytest.MonkeyPatch) -> Compiled:
    """The program with moves only."""
    with monkeypatch.context() as patch:
        patch.setattr(updates, "MAX_STEP_ITEMS", 0)
        compiled = first_program(ModelChecker(model(written)))
    assert set(compiled.program.vector_update) == {-1}
    return compiled


def kinds(program: Program) -> set[int]:
    """Which kinds of vectors a program has: 0 with a known step, -1 without one, -2 with a step for each group."""
    return {max(-2, min(0, update)) for update in program.vector_update}


SENDS = [edge("l", "m", action="a"), edge("m", "l", action="b")]
SELECTS = [edge("l", way("m", x=1), action="c"), edge("m", way("l", x=0), action="c", guard=op("=", "x", 1))]
CHOOSES = [edge("l", "m", action="d"), edge("l", "l", action="d"), edge("m", "l", action="d")]
RECEIVES = [edge("l", "l", "m", action="a")]
RECEIVES[0]["destinations"] = [way("l", 0.5), way("m", 0.5)]


def network(*edges: Sequence[Any], syncs: Sequence[Any], transient: bool = False) -> Any:
    automata = [automaton(f"m{i}", "l m", own) for i, own in enumerate(edges)]
    goal = {"p": probability(op("F", op("=", "x", 2)))}
    variables = [variable("x"), *([variable("t", transient=True)] if transient else [])]
    return document(*automata, variables=variables, syncs=syncs, properties=goal)


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        (network(SENDS, SENDS, syncs=[["a", "a"], ["b", "b"]]), {0}),
        (network(SELECTS, SENDS, syncs=[["c", "a"], [None, "b"]], transient=True), {-2, 0}),
        (network(SENDS, SENDS, syncs=[["a", "b"], ["a", None], ["b", None], [None, "a"]]), {0}),
        (network(SELECTS, SENDS, syncs=[["c", "a"], [None, "b"]]), {-2, 0}),
        (network(SELECTS, SENDS, syncs=[["c", "a"], ["c", "b"]]), {-1}),
        (network(CHOOSES, SENDS, syncs=[["d", None], [None, "a"], [None, "b"]]), {-2, 0}),
        (network(RECEIVES, SENDS, syncs=[["a", "a"], [None, "b"]]), {-1, 0}),
    ],
    ids=["known", "transient-variable", "gates", "location", "location-of-several", "edges", "random"],
)
def test_every_kind_of_vector(written: Any, expected: set[int], monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = first_program(ModelChecker(model(written)))
    assert kinds(compiled.program) == expected
    moves = without_steps(written, monkeypatch)
    states = visited(compiled, kernel, 4, 60)
    assert len(states) > 4 * 2
    assert states == visited(moves, kernel, 4, 60) == visited(compiled, plain_kernel(), 4, 60)
    assert given_steps(compiled, 4, 60) == given_steps(moves, 4, 60)


@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck))
@given(networks())
def test_random_networks(written: Any) -> None:
    compiled = first_program(ModelChecker(model(written)))
    with pytest.MonkeyPatch.context() as monkeypatch:
        moves = without_steps(written, monkeypatch)
    assert visited(compiled, kernel, 3, 40) == visited(moves, kernel, 3, 40)
    assert given_steps(compiled, 3, 40) == given_steps(moves, 3, 40)


def test_the_example() -> None:
    loaded = api.load(str(ROOT / "examples/delivery_robot/main.xml"))
    compiled = first_program(api.checker(api.to_jani(loaded)))
    assert kinds(compiled.program) == {-2, -1, 0}
    assert len(visited(compiled, kernel, 6, 1_000)) > 1_000

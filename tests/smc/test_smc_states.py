# SPDX-License-Identifier: Apache-2.0
"""Traces over states that were expanded before are exactly those of the kernel."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way
from smc_random import conditions, networks

import roaml.smc
from examples import examples
from roaml.explicit.plain import plain_kernel, plain_states
from roaml.record import replace
from roaml.smc import states
from roaml.smc.batch import BatchOutcome, Payload, Simulator, Task, run_on
from roaml.smc.model import ModelChecker
from roaml.smc.program import Compiled, merged

FOLDER = Path(roaml.smc.__file__).parent
NO_PAYLOAD = Payload(None)  # type: ignore[arg-type]


def results(outcome: BatchOutcome) -> str:
    """Everything that a batch reports."""
    rows = [(r.verdicts, r.ends, r.steps, r.activities, r.rewards) for r in outcome.questions]
    return repr((rows, outcome.problem))  # repr: NaN is what it is


def compiled_model(written: Json) -> Compiled:
    checker = ModelChecker(model(written))
    return checker.compiled(checker.compiled_properties[0])


def with_nodes(compiled: Compiled, memory: int = states.MAX_BYTES, *, plain: bool = False) -> Simulator:
    """A simulator that uses nodes from its first trace on."""
    simulator = Simulator(compiled, 0)
    if plain:
        simulator.kernel = plain_kernel().Kernel(compiled.program, compiled.goal)
    module = plain_states() if plain else states
    simulator.batch = module.TraceBatch(simulator.kernel, compiled.program, memory, simulator.rounds)
    simulator.batch.use_nodes()
    return simulator


def assert_same(compiled: Compiled, traces: int, steps: int, memory: int = states.MAX_BYTES, questions: int = 1) -> Any:
    """Compare nodes with the kernel, also after traces under another scheduler; return the nodes."""
    task = Task(NO_PAYLOAD, 7, 0, traces, steps, 0, tuple(range(questions)))
    alone, nodes = Simulator(compiled, 0), with_nodes(compiled, memory)
    for first, size in ((0, 1), (1, traces), (traces + 1, 5)):
        part = replace(task, first=first, size=size)
        expected, actual = run_on(alone, part), run_on(nodes, part)
        assert results(actual) == results(expected)
        if expected.problem is not None:
            break
        run_on(nodes, replace(task, size=2, scheduler=3))
    assert alone.batch is not None
    assert alone.batch.count == 0
    return nodes.batch


def test_every_attribute_has_a_c_type() -> None:
    """A name without a declaration would fail only in the extension."""
    text = (FOLDER / "states.py").read_text(encoding="utf-8")
    declared = "".join((FOLDER / name).read_text(encoding="utf-8") for name in ("states.pxd", "packing.pxd"))
    for name in set(re.findall(r"self\.(\w+)(?: =|\[)", text)):
        assert re.search(rf"\b{name}\b", declared), name


def test_is_compiled_where_there_is_a_compiler() -> None:
    assert states.compiled() or shutil.which("cc") is None, "pip install -e . compiles it"
    assert not plain_states().compiled()


def test_numbers_are_those_of_the_kernel() -> None:
    plain, other = plain_states(), plain_kernel()
    for name in ("GOLDEN", "MIX_1", "MIX_2", "TO_UNIT", "MAX_DRAWN_COMBINATIONS", "GOES_ON", "DECIDED", "FAULTY"):
        assert getattr(plain, name) == getattr(other, name)


PATHS = st.one_of(
    conditions(("x", "y")).map(lambda c: op("F", c)),
    conditions(("x", "y")).map(lambda c: op("G", c)),
    st.tuples(conditions(("x", "y")), conditions(("x", "y"))).map(lambda both: op("U", *both)),
    conditions(("x", "y")).map(lambda c: op("F", op("G", c))),
    conditions(("x", "y")).map(lambda c: {**op("F", c), "step-bounds": {"lower": 2, "upper": 9}}),
    st.tuples(conditions(("x", "y")), conditions(("x", "y"))).map(
        lambda both: op("∧", op("F", both[0]), op("¬", op("F", both[1])))
    ),
    st.just(op("F", {"op": "deadlock"})),
)


@settings(max_examples=examples(80), suppress_health_check=list(HealthCheck))
@given(networks(), PATHS, st.sampled_from([states.MAX_BYTES, 4000]))
def test_random_networks(written: Json, path: Json, memory: int) -> None:
    """With little memory, all nodes are forgotten again and again."""
    checker = ModelChecker(
        model({**written, "properties": document(properties={"p": probability(path)})["properties"]})
    )
    assert_same(checker.compiled(checker.compiled_properties[0]), 40, 60, memory)


@settings(max_examples=examples(40), suppress_health_check=list(HealthCheck))
@given(networks(), st.lists(PATHS, min_size=2, max_size=4))
def test_several_questions(written: Json, paths: list[Json]) -> None:
    properties = {f"p{i}": probability(path) for i, path in enumerate(paths)}
    checker = ModelChecker(model({**written, "properties": document(properties=properties)["properties"]}))
    compiled = [checker.compiled(property_) for property_ in checker.compiled_properties]
    if any(part.goal.is_bounded > 1 for part in compiled):
        return
    joined = Compiled(compiled[0].program, merged([part.goal for part in compiled]))
    assert_same(joined, 40, 60, questions=len(paths))


@settings(max_examples=examples(40), suppress_health_check=list(HealthCheck))
@given(networks())
def test_the_extension_and_python_agree(written: Json) -> None:
    checker = ModelChecker(model(written))
    compiled = checker.compiled(checker.compiled_properties[0])
    task = Task(NO_PAYLOAD, 3, 0, 12, 30)
    both = [with_nodes(compiled, plain=plain) for plain in (False, True)]
    assert results(run_on(both[0], task)) == results(run_on(both[1], task))
    assert both[0].batch is not None
    assert both[1].batch is not None
    assert both[0].batch.count == both[1].batch.count


def expected(names: dict[str, Any], path: Any, **more: Any) -> dict[str, Json]:
    """A property about the expected reward until a condition holds."""
    value = {"op": "Emin", "exp": names["exp"], "accumulate": names["accumulate"], "reach": path, **more}
    return {"p": {"op": "filter", "fun": "values", "values": value, "states": {"op": "initial"}}}


def dice(**more: Any) -> Json:
    """Two automata that synchronise; destinations depend on probabilities that are constant or computed."""
    computed = op("/", 1, op("+", "x", 2))
    first = [
        edge("l", way("l", 0.2, x=op("%", op("+", "x", 1), 5)), way("m", 0.3), way("l", 0.5, y=1), action="a"),
        edge("l", way("m"), action="a", guard=op("=", "y", 1)),
        edge("m", way("l", computed, x=0), way("m", op("-", 1, computed), x=op("%", op("+", "x", 1), 7)), action="a"),
    ]
    second = [edge("n", way("n", 0.4), way("o", 0.6, y=0), action="a"), edge("o", way("n"), action="a")]
    return document(
        automaton("a", "l m", first),
        automaton("b", "n o", second),
        variables=[variable("x"), variable("y"), variable("r", "real", 0.0, transient=True)],
        syncs=[["a", "a"]],
        **more,
    )


def test_several_dice_in_a_step() -> None:
    written = dice(properties={"p": probability(op("F", op("∧", op("=", "x", 6), op("=", "y", 1))))})
    nodes = assert_same(compiled_model(written), 500, 300)
    assert 20 < nodes.count < 80


@pytest.mark.parametrize("accumulate", [["steps"], ["exit"], ["steps", "exit"]])
def test_rewards_are_added_in_the_same_order(accumulate: list[str]) -> None:
    names = {"exp": op("/", op("+", "x", 0.1), 3), "accumulate": accumulate}
    nodes = assert_same(compiled_model(dice(properties=expected(names, op("=", "x", 6)))), 500, 300)
    assert nodes.count > 20


@pytest.mark.parametrize("accumulate", [["steps"], ["exit"], ["steps", "exit"]])
def test_a_step_has_its_own_reward(accumulate: list[str]) -> None:
    """The reward of a step is assigned by its destination; the reward for leaving a state is that of its location."""
    stays = way("l", 0.5, x=op("+", "x", 1), r=op("/", "x", 8))
    written = document(
        automaton("a", "l m", [edge("l", way("m", 0.5, r=2), stays), edge("m", way("l", x=op("+", "x", 1), r=3))]),
        variables=[variable("x"), variable("r", "real", 0.0, transient=True)],
        properties=expected({"exp": "r", "accumulate": accumulate}, op("≥", "x", 9)),
    )
    for location, value in zip(written["automata"][0]["locations"], (5, 7), strict=True):
        location["transient-values"] = [{"ref": "r", "value": value}]
    assert_same(compiled_model(written), 50, 300)


@pytest.mark.parametrize("place", ["value", "guard", "goal"])
def test_an_undefined_operation_ends_the_same_trace(place: str) -> None:
    quotient = op("%", 7, op("-", 4, "x"))
    steps = {"x": quotient} if place == "value" else {"x": op("+", "x", 1)}
    guard = op("≤", quotient, 9) if place == "guard" else None
    edges = [
        edge("l", way("l", 0.5, x=op("+", "x", 1)), way("l", 0.5, x=0), guard=op("<", "x", 4)),
        edge("l", way("l", **steps), guard=guard),
    ]
    condition = op("=", quotient, 9) if place == "goal" else op("=", "x", 9)
    written = document(
        automaton("a", "l", edges), variables=[variable("x")], properties={"p": probability(op("F", condition))}
    )
    compiled = compiled_model(written)
    task = Task(NO_PAYLOAD, 7, 0, 50, 500)
    assert run_on(Simulator(compiled, 0), task).problem is not None
    assert_same(compiled, 50, 500)


def test_several_initial_states() -> None:
    """Each trace begins in one of 20 states."""
    bounded = {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 19}
    steps = [edge("l", way("l", 0.5, x=op("%", op("+", "x", 7), 20)), way("l", 0.5, y=op("%", op("+", "y", 1), 3)))]
    free = {"name": "x", "type": bounded}
    written = document(
        automaton("a", "l", steps),
        variables=[free, variable("y")],
        properties={"p": probability(op("F", op("∧", op("=", "x", 3), op("=", "y", 2))))},
        **{"restrict-initial": {"exp": op("<", "x", 20)}},
    )
    nodes = assert_same(compiled_model(written), 300, 200)
    assert 50 < nodes.count <= 60


def test_very_many_choices_are_left_to_the_kernel() -> None:
    edges = [edge("l", way("l", x=i % 7), action="a") for i in range(70)]
    parts = [automaton(name, "l", edges, [variable("x")]) for name in ("a", "b")]
    written = document(
        *parts,
        automaton("c", "l m", [edge("l", way("l", 0.9), way("m", 0.1)), edge("m", way("l"), action="a")]),
        syncs=[["a", "a", "a"], [None, None, None]],
        variables=[variable("y")],
        properties={"p": probability(op("F", op("=", "y", 1)))},
    )
    written["system"]["syncs"] = [{"synchronise": ["a", "a", "a"]}]
    assert_same(compiled_model(written), 20, 50)


def test_states_that_do_not_repeat_switch_the_nodes_off() -> None:
    def scrambled(factor: int, addend: int) -> Json:
        return op("%", op("+", op("*", "x", factor), addend), 2**31 - 1)

    written = document(
        automaton("a", "l", [edge("l", way("l", 0.5, x=scrambled(5, 1)), way("l", 0.5, x=scrambled(7, 3)))]),
        variables=[variable("x")],
        properties={"p": probability(op("F", op("<", "x", 0)))},
    )
    compiled = compiled_model(written)
    simulators = Simulator(compiled, 0), Simulator(compiled, 50_000)
    for first in (0, 10, 20):
        task = Task(NO_PAYLOAD, 7, first, 10, 20_000)
        assert results(run_on(simulators[0], task)) == results(run_on(simulators[1], task))
    batch = simulators[1].batch
    assert batch is not None
    assert (batch.is_on, batch.count) == (0, 0)


def test_nodes_are_paused_until_they_may_cost_time_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The nodes of many states cost time before they save time; they never cost more than their share."""
    module: Any = plain_states()
    kernel_step_s, new_step_s = 20e-6, 25e-6
    spent_s = 0.0
    pauses = 0

    class Measured(module.TraceBatch):  # type: ignore[misc]
        def _new_step(self, *at: int) -> int:
            nonlocal spent_s
            spent_s += new_step_s
            status: int = super()._new_step(*at)
            return status

        def _review(self) -> None:
            nonlocal pauses
            super()._review()
            pauses += not self.is_measured

    def step() -> None:
        nonlocal spent_s
        spent_s += kernel_step_s
        type(simulator.kernel)._step(simulator.kernel)

    monkeypatch.setattr(module, "process_time", lambda: spent_s)
    edges = [edge("l", way("l", 0.5, x=op("%", op("+", op("*", "x", 5), k), 8191))) for k in (1, 2)]
    for some in edges:
        some["destinations"].append(way("l", 0.5, x=op("%", op("+", "x", 1), 8191)))
    written = document(
        automaton("a", "l", edges),
        variables=[variable("x")],
        properties={"p": probability(op("F", op("<", "x", 0)))},
    )
    compiled = compiled_model(written)
    simulator = Simulator(compiled, 0)
    simulator.kernel = plain_kernel().Kernel(compiled.program, compiled.goal)
    monkeypatch.setattr(simulator.kernel, "_step", step)
    simulator.batch = batch = Measured(simulator.kernel, compiled.program)
    total = 0
    alone = Simulator(compiled, 0)
    while total < 400_000:
        task = Task(NO_PAYLOAD, 7, total // 1000, 10, 1000)
        outcome = run_on(simulator, task)
        assert results(outcome) == results(run_on(alone, task))
        total += sum(outcome.questions[0].steps)
        needed = total * kernel_step_s
        slack = module.MAX_LOSS_S + module.REVIEW_STEPS * new_step_s
        assert spent_s <= needed / (1 - module.MAX_LOSS_SHARE) + slack
    assert pauses > 1
    assert batch.is_on
    assert batch.count > 8000
    before = spent_s
    run_on(simulator, Task(NO_PAYLOAD, 7, total // 1000, 10, 1000))
    assert spent_s - before < 10_000 * kernel_step_s / 10


def test_few_states_are_kept() -> None:
    compiled = compiled_model(dice(properties={"p": probability(op("F", op("=", "x", 6)))}))
    simulator = Simulator(compiled)
    run_on(simulator, Task(NO_PAYLOAD, 7, 0, 5000, 300))
    assert simulator.batch is not None
    assert simulator.batch.is_on
    assert simulator.batch.count > 20

# SPDX-License-Identifier: Apache-2.0
"""The result of a batch does not depend on the batches that the same simulator has run before."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from unittest.mock import patch

from hypothesis import HealthCheck, given, settings
from smc_models import automaton, document, edge, model, op, probability, variable, way
from smc_random import networks
from test_smc_states import NO_PAYLOAD, PATHS, compiled_model, expected, results, with_nodes

import kept_strategies as st
from examples import examples
from roaml.explicit.plain import plain_states
from roaml.smc import rounds, states
from roaml.smc.batch import Simulator, Task, run_on
from roaml.smc.model import ModelChecker
from roaml.smc.program import Compiled, merged

Batch = tuple[Task, int]
"""A batch, and the number of the call of `pulse` that interrupts it; 0 if none does."""


class InterruptError(Exception):
    """Ends a batch."""


def interrupting(count: int) -> Callable[[int, int], None]:
    """A pulse whose call number `count` ends the batch."""
    calls = 0

    def pulse(trace: int, steps: int) -> None:
        nonlocal calls
        calls += 1
        if calls == count:
            raise InterruptError

    return pulse


@st.composite
def undefined(draw: st.DrawFn, written: Any) -> Any:
    """The model, in which some remainders and probabilities are undefined in some states."""
    if isinstance(written, list):
        return [draw(undefined(part)) for part in written]
    if not isinstance(written, dict):
        return written
    if written.get("op") == "%" and draw(st.integers(0, 3)) == 0:
        return {**written, "right": draw(st.sampled_from(["x", "y"]))}
    if len(written.get("destinations", ())) == 2 and draw(st.booleans()):
        chance = op("/", 1, draw(st.sampled_from(["x", "y", op("+", "x", 2)])))
        chances = [chance, op("-", 1, chance)]
        destinations = [
            {**part, "probability": {"exp": share}}
            for part, share in zip(written["destinations"], chances, strict=True)
        ]
        return {**written, "destinations": draw(undefined(destinations))}
    return {key: draw(undefined(part)) for key, part in written.items()}


@st.composite
def goals(draw: st.DrawFn) -> tuple[Compiled, int]:
    """A random network, possibly with several initial states and faults, and the number of questions of its goal."""
    written = draw(networks())
    if draw(st.booleans()):
        written = {**written, "automata": draw(undefined(written["automata"]))}
    if draw(st.booleans()):
        kinds = {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 3}
        written["variables"][0] = {"name": "x", "type": kinds}
        written["restrict-initial"] = {"exp": op("<", "x", 3)}
    count = draw(st.integers(0, 3))
    if count == 0:
        accumulate = draw(st.sampled_from([["steps"], ["exit"], ["steps", "exit"]]))
        properties = expected({"exp": op("+", op("/", "x", 3), "y"), "accumulate": accumulate}, op("=", "x", 2))
    else:
        properties = {f"p{i}": probability(draw(PATHS)) for i in range(count)}
    checker = ModelChecker(model({**written, "properties": document(properties=properties)["properties"]}))
    compiled = [checker.compiled(property_) for property_ in checker.compiled_properties]
    if len(compiled) == 1 or any(part.goal.is_bounded > 1 for part in compiled):
        return compiled[0], 1
    return Compiled(compiled[0].program, merged([part.goal for part in compiled])), len(compiled)


@st.composite
def orders(draw: st.DrawFn, questions: int) -> list[Batch]:
    """Batches for some of the questions of a goal, also under sampled schedulers, some of which are interrupted. Some
    occur several times, so that the later ones find many nodes."""
    batches = []
    for steps in draw(st.lists(st.sampled_from([1, 2, 3, 7, 60]), min_size=2, max_size=4)):
        asked = draw(st.sets(st.integers(0, questions - 1), min_size=1))
        task = Task(
            NO_PAYLOAD,
            seed=draw(st.integers(0, 2)),
            first=draw(st.sampled_from([0, 0, 1, 2**64 - 3])),
            size=draw(st.sampled_from([1, 2, 5, 70])),
            max_steps=steps,
            scheduler=draw(st.sampled_from([0, 0, 5, 1 << 56])),
            questions=tuple(sorted(asked)),
        )
        batches.append((task, draw(st.sampled_from([0, 0, 0, 1, 2]))))
    return draw(st.lists(st.sampled_from(batches), min_size=4, max_size=12))


GOALS_AND_ORDERS = goals().flatmap(lambda found: st.tuples(st.just(found[0]), orders(found[1])))


def assert_same_in_any_order(compiled: Compiled, order: list[Batch], used: Simulator) -> int:
    """Compare the results of one simulator with those of a new one for each batch. Return the number of batches that
    were interrupted."""
    interrupted = 0
    for task, count in order:
        try:
            outcome = run_on(used, task, interrupting(count) if count > 0 else None)
        except InterruptError:
            interrupted += 1
            continue
        assert results(outcome) == results(run_on(Simulator(compiled, 0), task))
    return interrupted


def test_a_batch_goes_on_where_the_nodes_end_and_not_where_the_kernel_is() -> None:
    """The nodes know one step; its first trace has only determined the bits of `x`. Then a sampled scheduler takes the
    kernel one step further."""
    edges = [edge("l", way("m", x=1)), edge("m", way("n", x=2)), edge("n", way("l", x=3))]
    written = document(
        automaton("a", "l m n", edges),
        variables=[variable("x")],
        properties={"p": probability(op("F", op("=", "x", 2)))},
    )
    compiled = compiled_model(written)
    order = [(Task(NO_PAYLOAD, 7, 0, 1, steps, scheduler), 0) for steps, scheduler in ((1, 0), (1, 0), (3, 5), (9, 0))]
    assert_same_in_any_order(compiled, order, with_nodes(compiled))


def test_any_order() -> None:
    """With little memory, all nodes are forgotten again and again."""
    interrupted: list[int] = []

    @settings(max_examples=examples(40), deadline=None, suppress_health_check=list(HealthCheck))
    @given(GOALS_AND_ORDERS, st.sampled_from([states.MAX_BYTES, 4000]))
    def check(drawn: tuple[Compiled, list[Batch]], memory: int) -> None:
        compiled, order = drawn
        interrupted.append(assert_same_in_any_order(compiled, order, with_nodes(compiled, memory)))

    check()
    assert sum(interrupted) > examples(15)


@settings(max_examples=examples(15), deadline=None, suppress_health_check=list(HealthCheck))
@given(GOALS_AND_ORDERS)
def test_any_order_with_examined_traces(drawn: tuple[Compiled, list[Batch]]) -> None:
    """Traces are examined for repetitions after a few steps."""
    compiled, order = drawn
    with patch.multiple(rounds, FIRST_CHECK=5, STEPS_PER_RETURN_STEP=1, STEPS_PER_STATE=1):
        assert_same_in_any_order(compiled, order, with_nodes(compiled))


@settings(max_examples=examples(10), deadline=None, suppress_health_check=list(HealthCheck))
@given(GOALS_AND_ORDERS)
def test_any_order_with_interruptions_within_traces(drawn: tuple[Compiled, list[Batch]]) -> None:
    compiled, order = drawn
    with patch.object(plain_states(), "PULSE_STEPS", 3), patch.object(rounds, "FIRST_CHECK", 5):
        assert_same_in_any_order(compiled, order, with_nodes(compiled, plain=True))

# SPDX-License-Identifier: Apache-2.0
"""The search through all states: compared with a simple search, compiled and as plain Python; limits; shortest
traces."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way
from smc_random import networks

from explorer import Explorer, StateFaultError
from roaml import explicit
from roaml.explicit import codes, solver
from roaml.explicit.path import shortest
from roaml.explicit.path_recorder import PathRecorder
from roaml.explicit.plain import plain_kernel, plain_search, plain_solver
from roaml.explicit.space import LimitError, Space, StateLimits, explore
from roaml.explicit.values import NoValueError, values_of
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, TRUE
from roaml.smc.record import SHORTEST, Recording


def space_of(written: Json, limits: StateLimits | None = None, modules: Any = None) -> Space:
    checker = ModelChecker(model(written))
    return explore(checker, checker.compiled_properties[0], limits or StateLimits(), modules=modules)


def plainly(written: Json) -> Space:
    return space_of(written, modules=(plain_kernel(), plain_search()))


def keys(space: Space) -> list[tuple[int, ...]]:
    return [tuple(space.search.key(state)) for state in range(space.states)]


def choices(space: Space) -> list[Any]:
    return [space.search.choices_of(state) for state in range(space.search.expanded)]


@given(networks())
@settings(max_examples=60, deadline=None, derandomize=True)
def test_all_states_are_those_of_a_simple_search(written: Json) -> None:
    checker = ModelChecker(model(written))
    compiled = checker.compiled(checker.compiled_properties[0])
    try:
        expected = {(*s.place, *s.ints) for s in Explorer(compiled).reachable(100_000)}
    except StateFaultError:
        assert space_of(written).problem is not None
        return
    space = space_of(written, StateLimits(reduces=False))
    variables = compiled.program.instances + compiled.program.int_count
    states = [key[:variables] for key in keys(space)]
    assert len(set(states)) == len(states)
    assert set(states) == expected


@given(networks())
@settings(max_examples=40, deadline=None, derandomize=True)
def test_both_searches_and_solvers_do_the_same(written: Json) -> None:
    ours, plain = space_of(written), plainly(written)
    assert ours.problem == plain.problem
    if ours.problem is not None:
        return
    assert keys(ours) == keys(plain)
    assert choices(ours) == choices(plain)
    assert values_of(ours, solver) == values_of(plain, plain_solver())


def everything(space: Space) -> Any:
    search, known = space.search, range(space.search.expanded)
    parents, labels = [search.parent_of(state) for state in range(space.states)], [search.label_of(s) for s in known]
    return keys(space), choices(space), parents, labels, search.depth, space.fault_at, space.problem


@given(networks(), st.sampled_from([1, 2, 7]), st.integers(1, 40))
@settings(max_examples=60, deadline=None, derandomize=True)
def test_states_have_the_same_numbers_however_many_are_looked_up_together(
    written: Json, waiting: int, most: int
) -> None:
    expected = space_of(written)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plain_search(), "MAX_WAITING", waiting)
        assert everything(plainly(written)) == everything(expected)
        ends = []
        for modules in (None, (plain_kernel(), plain_search())):
            try:
                space = space_of(written, StateLimits(states=most), modules)
            except LimitError as error:
                ends.append(str(error))
            else:
                ends.append(str(space.problem))
        assert ends[0] == ends[1]


class _Direct(plain_solver().Solver):  # type: ignore[misc, name-defined]
    """A solver that solves each component directly, without value iteration."""

    solved = 0

    def _direct_work(self, first: int, last: int) -> int:
        return -(10**12)

    def _solve_directly(self, first: int, last: int, gap: float) -> int:
        solved = super()._solve_directly(first, last, gap)
        type(self).solved += solved
        return int(solved)


@given(networks())
@settings(max_examples=40, deadline=None, derandomize=True)
def test_direct_solutions_are_those_of_value_iteration(written: Json) -> None:
    space = space_of(written)
    if space.problem is not None:
        return
    iterated, direct = values_of(space, solver), values_of(space, SimpleNamespace(Solver=_Direct))
    for name in ("minimum", "maximum", "uniform"):
        one, other = getattr(iterated, name), getattr(direct, name)
        assert one.lower <= other.upper, name
        assert other.lower <= one.upper, name
        assert other.upper - other.lower <= 1e-7 * max(1.0, other.upper) or other.upper == other.lower, name


def test_some_components_are_solved_directly() -> None:
    """Steps up a ladder with probability 1/2, else back to the ground: rewards need about 2¹⁶ steps."""
    rungs = 15
    up = [way("l", 0.5, x=op("+", "x", 1)), way("l", 0.5, x=0)]
    written = document(
        automaton("a", "l", [edge("l", *up, guard=op("<", "x", rungs))]),
        variables=[variable("x")],
        properties={"p": {"op": "Emax", "exp": 1, "accumulate": ["steps"], "reach": op("=", "x", rungs)}},
    )
    before = _Direct.solved
    for module in (SimpleNamespace(Solver=_Direct), solver):
        values = values_of(space_of(written), module)
        assert values.is_precise
        for bounds in (values.minimum, values.maximum, values.uniform):
            assert bounds.lower <= 2 ** (rungs + 1) - 2 <= bounds.upper
    assert _Direct.solved > before


def test_numbers_that_callers_know_are_those_of_the_compiled_modules() -> None:
    for name, value in vars(codes).items():
        if name.isupper():
            for module in (plain_search(), plain_solver()):
                assert getattr(module, name, value) == value
            assert hasattr(plain_search(), name)
    for name in ("MAXIMUM", "MINIMUM", "MEAN", "NOTHING", "AS_JUDGED", "NEGATED"):
        assert getattr(explicit.values, name) == getattr(plain_solver(), name)


def counting(last: int, steps: int = 1, first: int = 0) -> Json:
    """A machine that counts up and down between two numbers, beginning at the first one."""
    up = edge("l", way("l", x=op("+", "x", steps)), guard=op("<", "x", last))
    down = edge("l", way("l", x=op("-", "x", steps)), guard=op(">", "x", -last))
    return document(
        automaton("a", "l", [up, down]),
        variables=[variable("x", initial=first)],
        properties={"p": probability(op("F", op("=", "x", last)))},
    )


@pytest.mark.parametrize("last", [3, 100, 40_000])
def test_numbers_get_as_many_bits_as_they_need(last: int) -> None:
    space = space_of(counting(last))
    assert space.states == 2 * last + 1
    assert sorted(key[1] for key in keys(space)) == list(range(-last, last + 1))


@pytest.mark.parametrize("modules", [None, (plain_kernel(), plain_search())], ids=["compiled", "plain"])
def test_counters_outgrow_their_bits_in_a_large_search(modules: Any) -> None:
    """Random traces begin again too often to show how large the counters become, so thousands of states are packed
    again. A counter that has no bits until then gets some."""
    lasts = {"x": 40, "y": 130, "z": 1}
    ups = [edge("l", way("l", **{n: op("+", n, 1)}), guard=op("<", n, last)) for n, last in lasts.items()]
    late = edge("l", way("l", w=op("+", "w", 1)), guard=op("∧", op("=", "y", 130), op("<", "w", 9)))
    again = edge("l", way("l", x=0, y=0, z=0, w=0))
    written = document(
        automaton("a", "l", [*ups, late, again]),
        variables=[variable(name, initial=0) for name in [*lasts, "w"]],
        properties={"p": probability(op("F", op("=", "w", 10)))},
    )
    space = space_of(written, StateLimits(reduces=False), modules)
    expected = {
        (x, y, z, w) for x in range(41) for y in range(131) for z in range(2) for w in range(10 if y == 130 else 1)
    }
    assert space.states == len(expected)
    assert {key[1:5] for key in keys(space)} == expected


@pytest.mark.parametrize("first", [(1 << 62) - 5, -(1 << 62)])
def test_numbers_of_64_bits(first: int) -> None:
    """All states are kept apart, though the distance of two numbers needs more than 64 bits."""
    far = edge("l", way("m", x=-first), guard=op("=", "x", first))
    on = edge("m", way("m", x=op("+", "x", 1)), guard=op("<", "x", -first + 9))
    written = document(
        automaton("a", "l m", [far, on]),
        variables=[variable("x", initial=first)],
        properties={"p": probability(op("F", op("=", "x", 0)))},
    )
    assert {key[1] for key in keys(space_of(written))} == {first, *range(-first, -first + 10)}


def test_real_numbers_are_states() -> None:
    step = edge("l", way("l", x=op("/", "x", 2)), guard=op(">", "x", 0.001))
    written = document(
        automaton("a", "l", [step]),
        variables=[variable("x", "real", 1.0)],
        properties={"p": probability(op("F", op("<", "x", 0.0005)))},
    )
    assert space_of(written).states == 11


def test_limits_end_a_search() -> None:
    with pytest.raises(LimitError, match=r"^stopped at 1,000 states \(max-states\)$"):
        space_of(counting(5000), StateLimits(states=1000))
    with pytest.raises(LimitError, match=r"^stopped at [\d,]+ states, which occupy 1 MiB \(max-memory; half of"):
        space_of(counting(5000), StateLimits(bytes=20_000))


def test_a_state_with_too_many_combinations_ends_a_search() -> None:
    parts = [automaton(f"m{n}", "s", [edge("s", way("s"), action="a")] * 3) for n in range(9)]
    goals = {"p": probability(op("F", op("=", "x", 1)))}
    for part in parts:
        part["edges"] = [edge("s", way("s", x=k), action="a") for k in (2, 3, 2)]
    parts[1:] = [automaton(f"m{n}", "s t", [edge("s", way(to), action="a") for to in "stt"]) for n in range(1, 9)]
    written = document(*parts, variables=[variable("x")], syncs=[["a"] * 9], properties=goals)
    with pytest.raises(LimitError, match=r"one of them has more than 5,000 combinations of edges"):
        space_of(written, StateLimits(combinations=5000))


def test_undefined_operations_are_in_a_state() -> None:
    step = edge("l", way("l", x=op("+", "x", 1)), guard=op("<", "x", 5))
    bad = edge("l", way("l", x=op("%", 1, op("-", "x", 3))), guard=op("=", "x", 3))
    written = document(
        automaton("a", "l", [step, bad]),
        variables=[variable("x")],
        properties={"p": probability(op("F", op("=", "x", 9)))},
    )
    space = space_of(written)
    assert space.problem is not None
    assert space.search.key(space.fault_at)[1] == 3


@given(networks())
@settings(max_examples=40, deadline=None, derandomize=True)
def test_the_shortest_trace_leads_to_a_state_with_its_verdict(written: Json) -> None:
    """The steps lead the kernel to the state, and no shorter path exists: the goal holds in no state with fewer
    steps."""
    space = space_of(written)
    if space.problem is not None:
        return
    explorer = Explorer(space.checker.compiled(space.compiled_property))
    layers, seen = [{explorer.initial}], {explorer.initial}
    path = shortest(space, TRUE)
    length = 10_000 if path is None else len(path.steps)
    while layers[-1] and len(layers) <= length:
        assert not any(explorer.verdict(state) == TRUE for state in layers[-1])
        states = {
            branch.state
            for state in layers[-1]
            if explorer.verdict(state) not in (TRUE, FALSE)
            for _, branches in explorer.choices(state)
            for branch in branches
        }
        layers.append(states - seen)
        seen |= states
    if path is not None:
        recorder = PathRecorder(space.checker, space.compiled_property, path)
        recording = Recording(SHORTEST)
        steps = list(recorder.walk(recording))
        assert len(steps) == length
        assert recording.verdict == TRUE
        assert any(explorer.verdict(state) == TRUE for state in layers[-1])


def test_rewards_that_are_negative_in_a_loop_have_no_minimum() -> None:
    loop = edge("l", way("l", x=op("-", 1, "x")))
    out = edge("l", way("m", end=True))
    written = document(
        automaton("a", "l m", [loop, out]),
        variables=[variable("x"), variable("end", "bool", False)],
        properties={"p": {"op": "Emin", "exp": op("-", 0, 1), "accumulate": ["steps"], "reach": "end"}},
    )
    with pytest.raises(NoValueError, match="negative"):
        values_of(space_of(written))

# SPDX-License-Identifier: Apache-2.0
"""Indexes of guards change no trace and no state."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from smc_models import at, automaton, document, edge, model, op, probability, variable, way, ways
from smc_random import networks

import kept_strategies as st
from both_kernels import difference
from examples import examples
from roaml.explicit.space import StateLimits, explore
from roaml.smc import compile as compilation
from roaml.smc import index, kernel, opcodes
from roaml.smc.model import ModelChecker
from roaml.smc.program import UNKNOWN

VARIABLES = ("x", "y", "z")
ARRAYS = ("v", "w")
"""Arrays of two numbers, as strings are."""
CONSTANT = "c"
"""A constant array."""


def written_variable(change: tuple[Any, Any, int]) -> str:
    target = change[0]
    return str(target["exp"] if isinstance(target, dict) else target)


@st.composite
def guarded(draw: st.DrawFn) -> dict[str, Any]:
    """Automata with many edges whose guards compare variables and cells of arrays with constants."""
    value = st.integers(-1, 3)
    pair = st.builds(lambda first, second: {"op": "av", "elements": [first, second]}, value, value)
    cells = st.builds(at, st.sampled_from(ARRAYS), st.sampled_from([0, 1]))
    places = st.one_of(st.sampled_from(VARIABLES), cells)
    read = st.one_of(places, places, places, st.builds(at, st.sampled_from([CONSTANT, *ARRAYS]), st.integers(0, 1)))
    equal = st.builds(lambda place, number, swaps: op("=", *((number, place) if swaps else (place, number))),
                      read, value, st.booleans())  # fmt: skip
    same = st.builds(lambda array, first, second: op("∧", op("=", at(array, 0), first), op("=", at(array, 1), second)),
                     st.sampled_from(ARRAYS), value, value)  # fmt: skip
    other = st.builds(op, st.sampled_from(["<", "≠", "≤"]), places, value)
    computed = st.builds(lambda name: at("v", op("%", op("abs", name), 2)), st.sampled_from(VARIABLES))
    whole = st.tuples(st.sampled_from(ARRAYS), st.one_of(pair, st.sampled_from(ARRAYS)), st.just(0))
    change = st.one_of(st.tuples(st.one_of(places, computed), value, st.just(0)), whole)
    changed = st.lists(change, min_size=1, max_size=3, unique_by=written_variable)

    def some_edge(action: str | None) -> Any:
        guard = draw(st.one_of(equal, same))
        for part in draw(st.lists(st.one_of(equal, equal, other), max_size=2)):
            guard = op("∧", guard, part)
        if draw(st.integers(0, 9)) == 0:
            guard = draw(other)
        return edge("l", ways("l", draw(changed)), action=action, guard=guard)

    first = automaton("a", "l", [some_edge(None) for _ in range(draw(st.integers(4, 14)))])
    actions = draw(st.lists(st.sampled_from(["s", "t", "u"]), min_size=4, max_size=14))
    second = automaton("b", "l", [some_edge(action) for action in actions])
    return document(
        first,
        second,
        variables=[
            *(variable(name, initial=draw(value)) for name in VARIABLES),
            *(variable(name, {"kind": "array", "base": "int"}, draw(pair)) for name in ARRAYS),
        ],
        constants=[{"name": CONSTANT, "type": {"kind": "array", "base": "int"}, "value": draw(pair)}],
        properties={"p": probability(op("F", op("=", "x", 77)))},
    )


def with_threshold(patch: pytest.MonkeyPatch, threshold: int, written: dict[str, Any]) -> ModelChecker:
    """The model with indexes of at least this many guards."""
    for module in (index, compilation):
        patch.setattr(module, "MIN_INDEXED", threshold)
    return ModelChecker(model(written))


def outcomes(checker: ModelChecker) -> list[Any]:
    results = []
    for property_ in checker.compiled_properties:
        compiled = checker.compiled(property_)
        simulator = kernel.Kernel(compiled.program, compiled.goal)
        for trace in range(5):
            for scheduler in (0, 5):
                verdict = simulator.begin(3, trace, scheduler)
                if verdict == UNKNOWN:
                    verdict = simulator.advance(60)
                results.append((verdict, simulator.ending(), simulator.outcome(), simulator.snapshot()))
        space = explore(checker, property_, StateLimits(states=2_000, bytes=1 << 24)) if is_finite(checker) else None
        if space is not None:
            search = space.search
            results.append([(search.key(s), search.choices_of(s)) for s in range(search.expanded)])
    return results


def is_finite(checker: ModelChecker) -> bool:
    return all(name in VARIABLES + ARRAYS for name in (v.name for v in checker.model.variables))


def check_same(written: dict[str, Any]) -> ModelChecker:
    with pytest.MonkeyPatch.context() as patch:
        plain = with_threshold(patch, 1 << 30, written)
        assert len(plain.program.first_list) == 1
        indexed = with_threshold(patch, 1, written)
    assert repr(outcomes(indexed)) == repr(outcomes(plain))
    return indexed


@settings(max_examples=examples(75), suppress_health_check=list(HealthCheck))
@given(guarded())
def test_many_guards(written: dict[str, Any]) -> None:
    indexed = check_same(written)
    for property_ in indexed.compiled_properties:
        assert difference(indexed, property_, 3, 3, 40) == ""


@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck))
@given(networks())
def test_random_networks(written: dict[str, Any]) -> None:
    check_same(written)


def grid(size: int) -> dict[str, Any]:
    """A robot on a grid: one edge for each cell and direction."""
    edges = []
    for x in range(size):
        for y in range(size):
            for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1)):
                if 0 <= x + dx < size and 0 <= y + dy < size:
                    here = op("∧", op("=", "x", x), op("=", "y", y))
                    there = way("l", x=x + dx, y=y + dy)
                    edges.append(edge("l", there, action=f"go{len(edges)}", guard=here))
    return document(
        automaton("robot", "l", edges),
        variables=[variable("x"), variable("y")],
        properties={"p": probability(op("F", op("=", "x", size)))},
    )


def test_few_guards_of_a_grid_are_evaluated() -> None:
    """The lists for a cell contain its edges only, and the two variables share one index."""
    program = check_same(grid(6)).program
    assert len(program.guard) == 120
    assert list(program.watched_group) == []
    lengths = [program.list_start[i + 1] - program.list_start[i] for i in range(len(program.list_start) - 1)]
    assert max(lengths) == 4
    assert sum(lengths) == 120


def test_values_after_another_instruction_are_not_used() -> None:
    """Its evaluation might fail, which an index must not hide."""
    code = [opcodes.FAIL_NE, 0, 0, 2, 0, opcodes.DIVIDE, 0, 0, 0, 0, opcodes.IS_EQ, 0, 1, 2, 0]
    assert index.fixed_values(code, 0, [0, 0, 7], 2, {2}) == {0: 7}
    assert index.fixed_values(code, 10, [0, 0, 7], 2, {2}) == {1: 7}
    assert index.fixed_values(code, -1, [0, 0, 7], 2, {2}) == {}

# SPDX-License-Identifier: Apache-2.0
"""Models with several initial states: their initial states are those that satisfy the conditions; exact values are
those of models with a single initial state each; traces draw initial states uniformly."""

from __future__ import annotations

import itertools
import json
from copy import deepcopy
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from smc_models import Json, answers, automaton, document, edge, model, op, probability, variable, way
from smc_random import conditions, networks

from both_kernels import difference
from roaml.explicit.plain import plain_kernel, plain_search, plain_solver
from roaml.explicit.space import LimitError, StateLimits, explore
from roaml.explicit.values import values_of
from roaml.simulation.run import Run
from roaml.smc import initial
from roaml.smc.fault import FaultError
from roaml.smc.initial import NO_INITIAL_STATE
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, TRUE
from roaml.smc.record import Recorder, Recording
from roaml.smc.story import build_story
from roaml.verification.exhaustive import exact_values

SIDE = range(3)


def between(low: Any, high: Any) -> Json:
    return {"kind": "bounded", "base": "int", "lower-bound": low, "upper-bound": high}


def unset(name: str, type_: Any = "int") -> Json:
    """A variable without initial value."""
    return {"name": name, "type": type_}


def filtered(fun: str, values: Json) -> Json:
    return {"op": "filter", "fun": fun, "values": values, "states": {"op": "initial"}}


def bounded(name: str) -> Json:
    """A condition that limits a variable to the numbers in SIDE."""
    return op("∧", op("≤", SIDE[0], name), op("≤", name, SIDE[-1]))


def opened(written: Json, condition: Json, fun: str = "values", operator: str = "Pmin") -> Json:
    """A model in which x and y may have all initial values in SIDE that satisfy a condition."""
    written = deepcopy(written)
    for row in written["variables"]:
        if row["name"] in ("x", "y"):
            del row["initial-value"]
            row["type"] = between(-1000, 1000)
    written["restrict-initial"] = {"exp": op("∧", op("∧", bounded("x"), bounded("y")), condition)}
    (property_,) = written["properties"]
    property_["expression"] |= {"fun": fun}
    property_["expression"]["values"]["op"] = operator
    return written


def started(written: Json, x: int, y: int) -> Json:
    """The same model with one initial state."""
    written = deepcopy(written)
    for row in written["variables"]:
        if row["name"] in ("x", "y"):
            row["initial-value"] = {"x": x, "y": y}[row["name"]]
    return written


def roots(checker: ModelChecker) -> list[tuple[int, ...]]:
    """The values of x and y in each initial state."""
    kernel = Kernel(checker.program, checker.stuck.goal)
    storages = {storage.name: storage for storage in checker.legend.layout.shared}
    found = []
    for number in range(checker.initial_states):
        kernel.root(number)
        found.append(tuple(kernel.integer(storages[name].base) for name in ("x", "y")))
    return found


def values(written: Json, modules: Any = None, solver: Any = None) -> list[tuple[float, float]] | None:
    """The bounds of minimum, maximum and uniform value; `None` if a trace can fail."""
    checker = ModelChecker(model(written))
    space = explore(checker, checker.compiled_properties[0], StateLimits(), modules=modules)
    if space.problem is not None:
        return None
    found = values_of(space, solver)
    return [(bounds.lower, bounds.upper) for bounds in (found.minimum, found.maximum, found.uniform)]


def is_one_of(written: Json) -> bool:
    """Whether the initial values of a model satisfy its condition."""
    try:
        ModelChecker(model(written))
    except FaultError as fault:
        if fault.message == NO_INITIAL_STATE:
            return False
        raise
    return True


@given(networks(), conditions(("x", "y")), st.sampled_from(["min", "max", "avg", "values"]), st.booleans())
@settings(max_examples=30, deadline=None, derandomize=True)
def test_values_are_combined_from_those_of_single_initial_states(
    written: Json, condition: Json, fun: str, is_maximum: bool
) -> None:
    written = opened(written, condition, fun, "Pmax" if is_maximum else "Pmin")
    every = [(x, y) for x, y in itertools.product(SIDE, SIDE) if is_one_of(started(written, x, y))]
    if not every:
        with pytest.raises(FaultError, match=NO_INITIAL_STATE):
            ModelChecker(model(written))
        return
    assert sorted(roots(ModelChecker(model(written)))) == every
    singles = [values(started(written, x, y)) for x, y in every]
    combined = values(written)
    assert values(written, (plain_kernel(), plain_search()), plain_solver()) == combined
    if combined is None:
        assert None in singles
        return
    for mode, (low, high) in enumerate(combined):
        middles = [(bounds[mode][0] + bounds[mode][1]) / 2 for bounds in singles if bounds is not None]
        assert len(middles) == len(every)
        mean = sum(middles) / len(middles)
        choice = (min(middles), max(middles), mean)[mode]
        expected = {"min": min(middles), "max": max(middles), "avg": mean, "values": choice}[fun]
        assert low - 1e-7 <= expected <= high + 1e-7


@given(networks(), conditions(("x", "y")), st.integers(0, 3))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_both_kernels_begin_in_the_same_states(written: Json, condition: Json, scheduler: int) -> None:
    try:
        checker = ModelChecker(model(opened(written, condition)))
    except FaultError:
        return
    for property_ in (*checker.compiled_properties, checker.stuck):
        assert difference(checker, property_, 5, 40, 30, scheduler) == ""


def counting(*conditions_: Json, fun: str = "values", operator: str = "Pmin") -> Json:
    """A model whose location l is left for `good` if x is 2 and y is true, else for `bad`."""
    edges = [
        edge("l", "good", guard=op("∧", op("=", "x", 2), "y")),
        edge("l", "bad", guard=op("∨", op("≠", "x", 2), op("¬", "y"))),
        edge("good", way("good", w="x", done=True)),
    ]
    condition: Any = True
    for part in conditions_:
        condition = op("∧", condition, part)
    return document(
        automaton("m", "l good bad", edges),
        variables=[unset("x", between(0, 3)), unset("y", "bool"), variable("w"), variable("done", "bool", False)],
        properties={"p": filtered(fun, {"op": operator, "exp": op("F", "done")})},
        **{"restrict-initial": {"exp": condition}},
    )


def test_traces_draw_initial_states_uniformly() -> None:
    checker = ModelChecker(model(counting()))
    assert checker.initial_states == 8
    property_ = checker.compiled_properties[0]
    kernel = Kernel(checker.program, property_.goal)
    counts: dict[tuple[int, ...], int] = {}
    for trace in range(8_000):
        kernel.begin(7, trace)
        key = tuple(kernel.snapshot()[0][:2])
        counts[key] = counts.get(key, 0) + 1
    assert len(counts) == 8
    # Six standard deviations of a binomial distribution.
    assert all(abs(count - 1000) < 6 * (8_000 * 7 / 64) ** 0.5 for count in counts.values())
    answer = answers(counting(), 8_000)["p"]
    assert abs(answer.value - 1 / 8) < 0.02


def test_stories_and_runs_begin_in_the_initial_state_of_their_trace() -> None:
    checker = ModelChecker(model(counting()))
    property_ = checker.compiled_properties[0]
    kernel = Kernel(checker.program, property_.goal)
    recorder = Recorder(checker, property_, 3, 100)
    seen = set()
    for trace in range(30):
        kernel.begin(3, trace)
        start = dict(zip(("x", "y"), kernel.snapshot()[0], strict=False))
        story = build_story(recorder, trace)
        assert {name: story.start[name] for name in start} == start
        assert (story.recording.verdict == TRUE) is (start == {"x": 2, "y": 1})
        assert Run(checker, property_, 3, trace).start == story.start
        seen.add(tuple(start.values()))
    assert len(seen) == 8


def test_the_shortest_trace_begins_in_its_initial_state() -> None:
    checker = ModelChecker(model(counting()))
    exact = exact_values(checker, checker.compiled_properties[0], StateLimits())
    assert (exact.least, exact.greatest, exact.average, exact.initial_states) == (0, 1, 1 / 8, 8)
    good, bad = exact.shortest(TRUE), exact.shortest(FALSE)
    assert good is not None
    assert bad is not None
    story = good.story(None)
    assert (story.start["x"], story.start["y"], good.steps) == (2, True, 2)
    assert [change.after for change in story.steps[-1].changes] == [2, True]
    other = bad.story(None).start
    assert (other["x"], other["y"]) != (2, True)


@pytest.mark.parametrize(
    ("fun", "operator", "least", "greatest"),
    [("min", "Pmax", 0, 0), ("max", "Pmin", 1, 1), ("avg", "Pmin", 1 / 8, 1 / 8), ("values", "Pmax", 0, 1)],
)
def test_filters(fun: str, operator: str, least: float, greatest: float) -> None:
    checker = ModelChecker(model(counting(fun=fun, operator=operator)))
    exact = exact_values(checker, checker.compiled_properties[0], StateLimits())
    assert (exact.least, exact.greatest) == (least, greatest)


@pytest.mark.parametrize(
    ("fun", "relation", "value"), [("∀", "≥", 0), ("∃", "≥", 1), ("∀", "≤", 1), ("∃", "<", 0), ("values", "≥", 0)]
)
def test_comparisons_for_all_or_some_initial_states(fun: str, relation: str, value: float) -> None:
    written = counting(fun=fun)
    expression = written["properties"][0]["expression"]
    expression["values"] = op(relation, expression["values"], 0.5)
    checker = ModelChecker(model(written))
    exact = exact_values(checker, checker.compiled_properties[0], StateLimits())
    assert (exact.least, exact.greatest) == (value, value)


def test_a_sum_over_several_initial_states_is_refused() -> None:
    assert "`sum`" in ModelChecker(model(counting(fun="sum"))).refused["p"].message
    assert not ModelChecker(model(counting(op("=", "x", 2), "y", fun="sum"))).refused


def test_several_initial_locations() -> None:
    written = counting(op("=", "x", 2), "y")
    written["automata"][0]["initial-locations"] = ["l", "bad"]
    checker = ModelChecker(model(written))
    exact = exact_values(checker, checker.compiled_properties[0], StateLimits())
    assert (exact.least, exact.greatest, exact.average, exact.initial_states) == (0, 1, 0.5, 2)
    property_ = checker.compiled_properties[0]
    ends = [Recording(trace) for trace in range(40)]
    recorder = Recorder(checker, property_, 0, 100)
    for recording in ends:
        recorder.rush(recording)
    assert {recording.verdict for recording in ends} == {TRUE, FALSE}
    written["automata"][0]["initial-locations"] = []
    with pytest.raises(FaultError, match="no initial location"):
        ModelChecker(model(written))


def test_transient_variables_have_the_values_of_the_initial_location() -> None:
    written = counting(op("=", "x", 2), "y")
    written["automata"][0]["initial-locations"] = ["l", "bad"]
    written["variables"].append(variable("ok", "bool", False, transient=True))
    written["automata"][0]["locations"][2]["transient-values"] = [{"ref": "ok", "value": True}]
    written["properties"][0]["expression"]["values"]["exp"] = op("F", op("∧", "ok", op("¬", "done")))
    path = written["properties"][0]["expression"]["values"]["exp"]
    path["step-bounds"] = {"upper": 0}
    checker = ModelChecker(model(written))
    exact = exact_values(checker, checker.compiled_properties[0], StateLimits())
    assert (exact.least, exact.greatest, exact.average) == (0, 1, 0.5)
    assert abs(answers(written, 2_000)["p"].value - 0.5) < 0.06


def test_own_variables_of_automata_and_their_conditions() -> None:
    written = counting(op("=", "x", 2), "y")
    own = automaton("other", "l", [], [unset("a", between(0, 9)), unset("b"), unset("r", "real")])
    own["restrict-initial"] = {"exp": op("∧", op("=", "b", op("*", "a", "x")), op("=", op("/", "b", 4), "r"))}
    written["automata"].append(own)
    written["system"]["elements"].append({"automaton": "other"})
    written["system"]["syncs"] = []
    checker = ModelChecker(model(written))
    assert checker.initial_states == 10
    kernel = Kernel(checker.program, checker.compiled_properties[0].goal)
    found = set()
    for number in range(10):
        kernel.root(number)
        ints, reals = kernel.snapshot()
        found.add((*ints[-2:], *reals))
    assert found == {(a, 2 * a, a / 2) for a in range(10)}


def test_equations_and_independent_variables_need_no_enumeration() -> None:
    names = [f"x{i}" for i in range(30)]
    chain: Any = True
    for before, after in itertools.pairwise(names[:15]):
        chain = op("∧", chain, op("=", after, op("+", before, 1)))
    written = document(
        automaton("m", "l", [edge("l", "l")]),
        variables=[unset(name, between(0, 999)) for name in names[:20]],
        properties={"p": probability(op("F", op("=", "x14", 500)))},
        **{"restrict-initial": {"exp": chain}},
    )
    checker = ModelChecker(model(written))
    assert checker.initial_states == (1000 - 14) * 1000**5
    with pytest.raises(LimitError, match=r"there are 986,000,000,000,000,000 initial states, more than"):
        explore(checker, checker.compiled_properties[0], StateLimits())
    assert abs(answers(written, 20_000)["p"].value - 1 / 986) < 0.002


@pytest.mark.parametrize(
    ("variables", "condition", "message"),
    [
        ([unset("x")], True, "has no bounds"),
        ([unset("x")], op(">", "x", 0), "has no bounds"),
        ([unset("x", "real")], True, "has no bounds"),
        ([unset("x", between(0, 5_000_000))], True, "more than 1,000,000 initial values"),
        ([unset("x", between(0, 1))], op("=", "x", 2), "there is no initial state"),
        ([unset("x", between(0, 1))], op("=", op("/", 1, "x"), 0.5), "division by zero"),
        ([unset("x", {"kind": "array", "base": "int"})], True, "array `x` has no initial value"),
        ([unset("x", "bool") | {"transient": True}], True, "transient variable `x` has no initial value"),
        (
            [unset(f"x{i}", between(0, 999)) for i in range(4)],
            op("=", op("+", op("+", "x0", "x1"), op("+", "x2", "x3")), -1),
            "not found within",
        ),
        ([unset(f"x{i}", between(0, 999_999)) for i in range(4)], True, "more than 2⁶² initial states"),
    ],
)
def test_refusals(variables: list[Json], condition: Any, message: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(initial, "MAX_TRIED", 10_000)
    written = document(
        automaton("m", "l", [edge("l", "l")]), variables=variables, **{"restrict-initial": {"exp": condition}}
    )
    if "array" in json.dumps(variables):
        condition = True
    with pytest.raises(FaultError, match=message):
        ModelChecker(model(written))


def test_a_condition_guards_an_undefined_operation() -> None:
    condition = op("∧", op(">", "x", 0), op("≤", op("/", 1, "x"), 0.5))
    written = document(
        automaton("m", "l", [edge("l", "l")]),
        variables=[unset("x", between(0, 9))],
        **{"restrict-initial": {"exp": condition}},
    )
    assert ModelChecker(model(written)).initial_states == 8

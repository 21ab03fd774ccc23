# SPDX-License-Identifier: Apache-2.0
"""The model checker compared with the definitions: `roaml.jani.semantics` for expressions, and a slow explorer for
networks."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from explore import Explorer as SlowExplorer
from explore import State as SlowState
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from smc_models import Json, answers, at, automaton, document, edge, model, op, probability, variable, way, ways
from smc_random import networks

from examples import examples
from explorer import Explorer, StateFaultError
from roaml import api
from roaml.jani.model import Model
from roaml.jani.semantics import EvaluationError, Value, evaluate
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker

ROOT = Path(__file__).resolve().parents[2]
VALUES: dict[str, Value] = {"i": 3, "k": -2, "r": 2.5, "z": 0.0, "yes": True, "no": False}
VALUES |= {"v": (4, 5, 6), "w": (0.5, -1.5)}
MATRIX: Value = ((1, 2, 3), (4, 5, 6))
TYPES: dict[str, Any] = {
    "i": "int",
    "k": "int",
    "r": "real",
    "z": "real",
    "yes": "bool",
    "no": "bool",
    "v": {"kind": "array", "base": "int"},
    "w": {"kind": "array", "base": "real"},
    "m": {"kind": "array", "base": {"kind": "array", "base": "int"}},
}


def written(value: Value) -> Any:
    return {"op": "av", "elements": [written(item) for item in value]} if isinstance(value, tuple) else value


def system(type_: str, expression: Any) -> Json:
    """A model that computes an expression once."""
    variables = [variable(name, TYPES[name], written(value)) for name, value in {**VALUES, "m": MATRIX}.items()]
    zero: Any = {"bool": False, "int": 0, "real": 0.0}[type_]
    steps = [edge("l", way("done", result=expression))]
    return document(
        automaton("a", "l done", steps),
        variables=[*variables, variable("result", type_, zero), variable("done", "bool", False)],
        functions=FUNCTIONS,
        properties={"p": probability(op("F", "done"))},
    )


FUNCTIONS = [
    {
        "name": "twice",
        "type": "int",
        "parameters": [{"name": "n", "type": "int"}],
        "body": op("*", "n", 2),
    },
    {
        "name": "mean",
        "type": "real",
        "parameters": [{"name": "i", "type": "int"}, {"name": "a", "type": {"kind": "array", "base": "int"}}],
        "body": op("/", op("+", at("a", 0), {"op": "call", "function": "twice", "args": ["i"]}), 2),
    },
]


def ints(depth: int) -> st.SearchStrategy[Any]:
    if depth == 0:
        return st.one_of(st.sampled_from(["i", "k"]), st.integers(-5, 5))
    inner, real, bool_ = ints(depth - 1), reals(depth - 1), bools(depth - 1)
    return st.one_of(
        inner,
        st.builds(op, st.sampled_from(["+", "-", "*", "%", "min", "max"]), inner, inner),
        st.builds(lambda a: op("abs", a), inner),
        st.builds(lambda a: op("pow", a, 3), inner),
        st.builds(op, st.sampled_from(["floor", "ceil", "trc", "sgn"]), real),
        st.builds(lambda c, a, b: {"op": "ite", "if": c, "then": a, "else": b}, bool_, inner, inner),
        st.builds(lambda a: at("v", a), inner),
        st.builds(lambda a, b: at(at("m", a), b), inner, inner),
        st.builds(lambda a, b, c: at({"op": "av", "elements": [a, b]}, c), inner, inner, inner),
        st.builds(lambda a, b: at({"op": "ac", "var": "q", "length": 3, "exp": op("+", "q", a)}, b), inner, inner),
        st.builds(lambda a: {"op": "call", "function": "twice", "args": [a]}, inner),
        st.builds(lambda c, a: at({"op": "ite", "if": c, "then": "v", "else": at("m", 1)}, a), bool_, inner),
    )


def reals(depth: int) -> st.SearchStrategy[Any]:
    if depth == 0:
        return st.one_of(st.sampled_from(["r", "z"]), st.sampled_from([0.5, -1.25, 3.0]))
    inner, int_ = reals(depth - 1), ints(depth - 1)
    mixed = st.one_of(inner, int_)
    return st.one_of(
        inner,
        st.builds(op, st.sampled_from(["+", "-", "*", "min", "max", "%"]), inner, mixed),
        st.builds(op, st.sampled_from(["/", "log", "pow"]), mixed, mixed),
        st.builds(op, st.sampled_from(["sin", "cos", "atan", "abs"]), inner),
        st.builds(lambda a: at("w", a), int_),
        st.builds(lambda a: {"op": "call", "function": "mean", "args": [a, "v"]}, int_),
        st.builds(lambda c, a, b: {"op": "ite", "if": c, "then": a, "else": b}, bools(depth - 1), inner, mixed),
    )


def bools(depth: int) -> st.SearchStrategy[Any]:
    if depth == 0:
        return st.sampled_from(["yes", "no", True, False])
    inner, numbers = bools(depth - 1), st.one_of(ints(depth - 1), reals(depth - 1))
    return st.one_of(
        inner,
        st.builds(op, st.sampled_from(["∧", "∨", "⇒"]), inner, inner),
        st.builds(lambda a: op("¬", a), inner),
        st.builds(op, st.sampled_from(["=", "≠", "<", "≤", ">", "≥"]), numbers, numbers),
        st.builds(op, st.sampled_from(["=", "≠"]), inner, inner),
        st.builds(op, st.sampled_from(["=", "≠"]), st.just("v"), st.sampled_from(["v", at("m", 0), at("m", 1)])),
        st.builds(lambda c, a, b: {"op": "ite", "if": c, "then": a, "else": b}, inner, inner, inner),
    )


@settings(max_examples=examples(120), suppress_health_check=list(HealthCheck))
@given(st.sampled_from(["int", "real", "bool"]).flatmap(
    lambda type_: st.tuples(st.just(type_), {"int": ints, "real": reals, "bool": bools}[type_](2))
))  # fmt: skip
def test_expressions_mean_what_is_defined(case: tuple[str, Any]) -> None:
    type_, text = case
    actual_model = model(system(type_, text))
    (assignment,) = actual_model.automata[0].edges[0].destinations[0].assignments
    functions = {function.name: function for function in actual_model.functions}
    try:
        expected: Value | str = evaluate(assignment.value, {**VALUES, "m": MATRIX}, functions)
    except EvaluationError as error:
        expected = error.message
    assume(not isinstance(expected, float) or not math.isnan(expected))
    assume(isinstance(expected, (str, float)) or abs(expected) < 1 << 62)  # type: ignore[arg-type]
    checker = ModelChecker(actual_model)
    explorer = Explorer(checker.compiled(checker.compiled_properties[0]))
    try:
        ((_, (branch,)),) = explorer.choices(explorer.initial)
    except StateFaultError:
        fails = True
    else:
        fails = False
    assert isinstance(expected, str) is fails, expected
    if isinstance(expected, str):
        return
    if type_ == "real":
        before, after = explorer.initial.reals, branch.state.reals
        assert sum(a != b for a, b in zip(before, after, strict=True)) <= 1
        assert after[-1] == float(expected)  # type: ignore[arg-type]
    else:
        assert branch.state.ints[-2] == int(expected)  # type: ignore[arg-type]


def states_of(actual_model: Model, limit: int) -> set[tuple[Any, ...]]:
    """All reachable states of the model checker, in the form of the slow explorer."""
    checker = ModelChecker(actual_model)
    explorer = Explorer(checker.compiled(checker.compiled_properties[0]))
    layout = checker.legend.layout
    states = set()
    for place, integers, real_numbers in explorer.reachable(limit):

        def values(storages: Any, integers: Any = integers, real_numbers: Any = real_numbers) -> tuple[Any, ...]:
            result = []
            for storage in storages:
                cells = real_numbers if storage.kind == "real" else integers
                (size,) = storage.shape or (0,)
                if storage.shape:
                    result.append(tuple(cells[storage.base : storage.base + size]))
                else:
                    result.append(cells[storage.base])
            return tuple(result)

        locations = tuple(checker.legend.locations[number][1] for number in place)
        states.add((locations, values(layout.shared), tuple(values(i.own) for i in layout.instances)))
    return states


def as_tuple(state: SlowState) -> tuple[Any, ...]:
    return state.locations, state.values, state.own


def never(written: Json) -> Json:
    """The same model with a property that is never decided, so that all states are explored."""
    written["properties"][0]["expression"] = probability(op("F", False))
    return written


@settings(max_examples=examples(80), suppress_health_check=list(HealthCheck))
@given(networks())
def test_networks_reach_the_states_that_are_defined(written: Json) -> None:
    actual_model = model(never(written))
    try:
        expected = {as_tuple(state) for state in SlowExplorer(actual_model).reachable(120)}
    except OverflowError:
        assume(False)
    assert states_of(actual_model, 10_000) == expected


def test_the_states_of_a_translated_system(tmp_path: Path) -> None:
    """A whole small system: machines that exchange events, a choice and a clock."""
    (tmp_path / "a.ascxml").write_text(
        """<ascxml name="a" version="1.0" initial="s">
<datamodel><data id="n" type="int32" expr="0" /></datamodel>
<ros_topic_publisher name="out" topic="t" type="std_msgs/Int32" /><ros_time_rate name="r" rate_hz="1" />
<state id="s"><ros_rate_callback name="r" target="s"><assign location="n" expr="n + 1" />
<if cond="n % 2 == 0"><ros_topic_publish name="out"><field name="data" expr="n" /></ros_topic_publish></if>
</ros_rate_callback></state></ascxml>"""
    )
    (tmp_path / "b.ascxml").write_text(
        """<ascxml name="b" version="1.0" initial="s">
<datamodel><data id="heard" type="int32" expr="0" /></datamodel>
<ros_topic_subscriber name="in" topic="t" type="std_msgs/Int32" />
<state id="s"><ros_topic_callback name="in"><target id="s" prob="0.5"><assign location="heard" expr="_msg.data" />
</target><target id="s" /></ros_topic_callback></state></ascxml>"""
    )
    goal = probability(op("F", False))
    (tmp_path / "p.jani").write_text(json.dumps({"properties": [{"name": "p", "expression": goal}]}))
    (tmp_path / "main.xml").write_text(
        """<roaml><parameters><max_time value="4" unit="s" /></parameters><node_models>
<input type="node-ascxml" src="a.ascxml" /><input type="node-ascxml" src="b.ascxml" /></node_models>
<properties><input type="jani" src="p.jani" /></properties></roaml>"""
    )
    actual_model = api.to_jani(api.load(str(tmp_path / "main.xml")))
    expected = {as_tuple(state) for state in SlowExplorer(actual_model).reachable(5000)}
    assert len(expected) > 50
    assert states_of(actual_model, 10_000) == expected


# ------------------------------------------------------------ single rules


def reaches(written: Json, traces: int = 1) -> float:
    (answer,) = answers(written, traces).values()
    return answer.value


def test_assignments_of_one_index_are_simultaneous() -> None:
    swap = ways("m", [("x", "y", 0), ("y", "x", 0), (at("v", "x"), "y", 0), ("x", op("+", "x", 10), 1)])
    values = {"op": "av", "elements": [0, 0, 0]}
    expected = op("∧", op("=", "x", 12), op("=", "y", 1))
    written = document(
        automaton("a", "l m", [edge("l", swap)]),
        variables=[variable("x", initial=1), variable("y", initial=2), variable("v", TYPES["v"], values)],
        properties={"p": probability(op("F", op("∧", expected, op("=", "v", {"op": "av", "elements": [0, 2, 0]}))))},
    )
    assert reaches(written) == 1


def test_assignments_of_synchronised_edges_are_simultaneous() -> None:
    """Indexes count through all parts of a step."""
    first = ways("l", [("x", "y", 0), ("x", op("+", "x", op("*", "y", 10)), 2)])
    second = ways("l", [("y", "x", 0), ("y", op("+", "y", 5), 1)])
    written = document(
        automaton("a", "s l", [edge("s", first, action="go")]),
        automaton("b", "s l", [edge("s", second, action="go")]),
        variables=[variable("x", initial=1), variable("y", initial=2)],
        syncs=[["go", "go"]],
        properties={"p": probability(op("F", op("∧", op("=", "x", 62), op("=", "y", 6))))},
    )
    assert reaches(written) == 1


def test_every_combination_of_a_vector_is_one_choice() -> None:
    """Two edges of one automaton and three of the other: six of seven choices are steps of the vector."""
    first = [edge("l", way("done", x=1), action="go"), edge("l", way("done", x=1), action="go")]
    second = [edge("l", "done", action="go") for _ in range(3)]
    third = [edge("l", way("done", x=2))]
    written = document(
        automaton("a", "l done", first),
        automaton("b", "l done", second),
        automaton("c", "l done", third),
        variables=[variable("x")],
        syncs=[["go", "go", None]],
        properties={
            "first": probability(op("U", op("=", "x", 0), op("=", "x", 1))),
            "loops": probability(op("U", op("=", "x", 0), op("=", "x", 2))),
        },
    )
    found_values = answers(written, 20_000)
    assert found_values["first"].value == pytest.approx(6 / 7, abs=0.01)
    assert found_values["loops"].value == pytest.approx(1 / 7, abs=0.01)


def test_a_loop_is_a_choice_too() -> None:
    """Because of the loop, the other step is taken with probability 1/2: after three steps, with 1 - 1/8."""
    written = document(
        automaton("a", "l", [edge("l", "l"), edge("l", way("l", x=1))]),
        variables=[variable("x")],
        properties={"p": probability({**op("F", op("=", "x", 1)), "step-bounds": {"upper": 3}})},
    )
    assert reaches(written, 20_000) == pytest.approx(7 / 8, abs=0.01)


def test_input_enabled_automata_never_block() -> None:
    walker = automaton("a", "l m", [edge("l", way("m", x=1), action="go")])
    listener = automaton("b", "l", [edge("l", way("l", y=1), action="go", guard=op("=", "y", 5))])
    written = document(
        walker,
        listener,
        variables=[variable("x"), variable("y")],
        syncs=[["go", "go"]],
        properties={"p": probability(op("F", op("=", "x", 1)))},
    )
    assert reaches(written) == 0
    written["system"]["elements"][1]["input-enable"] = ["go"]
    assert reaches(written) == 1


def test_an_automaton_may_have_two_instances() -> None:
    counter = automaton("a", "l m", [edge("l", way("m", own=1, x=op("+", "x", 1)))], [variable("own")])
    written = document(counter, variables=[variable("x")], properties={"p": probability(op("F", op("=", "x", 2)))})
    assert reaches(written) == 0
    written["system"]["elements"] *= 2
    written["system"]["syncs"] = []
    assert reaches(written) == 1


def test_arrays_take_the_longest_value() -> None:
    """A longer value than the first one determines the size; a shorter one is padded with zeros."""
    long, short = ({"op": "av", "elements": list(range(1, n))} for n in (5, 2))
    written = document(
        automaton("a", "l m n", [edge("l", way("m", v=long)), edge("m", way("n", x=at("v", 3), v=short))]),
        variables=[variable("x"), variable("v", TYPES["v"], {"op": "av", "elements": [0, 0]})],
        properties={"p": probability(op("F", op("∧", op("=", "x", 4), op("=", at("v", 1), 0))))},
    )
    assert reaches(written) == 1


def test_probabilities_that_depend_on_the_state() -> None:
    share = op("/", "n", 10)
    written = document(
        automaton("a", "l m k", [edge("l", way("k", share), way("m", op("-", 1, share), x=1))]),
        variables=[variable("n", initial=9), variable("x")],
        properties={"p": probability(op("F", op("=", "x", 1)))},
    )
    assert reaches(written, 10_000) == pytest.approx(0.1, abs=0.01)
    written["variables"][0]["initial-value"] = 11
    with pytest.raises(FaultError, match="do not add up to 1"):
        reaches(written, 10)

# SPDX-License-Identifier: Apache-2.0
"""The kernel computes the same numbers compiled and as plain Python."""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from smc_models import answers, at, automaton, document, edge, model, op, probability, variable, way, ways
from smc_random import networks

import roaml.smc
from both_kernels import difference, plain_kernel
from examples import examples
from roaml import api
from roaml.smc import kernel, opcodes, program
from roaml.smc.batch import TraceProblem
from roaml.smc.fault import FaultError
from roaml.smc.lss import FAVOUR, MEMORY, STARVE
from roaml.smc.model import ModelChecker

ROOT = Path(__file__).resolve().parents[2]
FOLDER = Path(roaml.smc.__file__).parent


def test_the_kernel_has_a_branch_for_each_code() -> None:
    text = (FOLDER / "kernel.py").read_text(encoding="utf-8")
    branches = {name: getattr(opcodes, name) for name in re.findall(r"if op == ([A-Z_]+):\n", text)}
    assert sorted(branches.values()) == list(range(len(branches)))
    assert branches == {name: code for name, code in vars(opcodes).items() if type(code) is int and name in branches}
    assert max(branches.values()) == max(opcodes.ORDERS)


def test_numbers_of_verdicts_are_those_of_the_kernel() -> None:
    assert (program.FALSE, program.TRUE, program.UNKNOWN, program.FAULTY) == (
        plain_kernel().FALSE,
        plain_kernel().TRUE,
        plain_kernel().UNKNOWN,
        plain_kernel().FAULTY,
    )


def test_every_attribute_has_a_c_type() -> None:
    """A name without a declaration would fail only in the extension, and so would a table that is not copied."""
    text = (FOLDER / "kernel.py").read_text(encoding="utf-8")
    declared = set(re.findall(r"\w+", (FOLDER / "kernel.pxd").read_text(encoding="utf-8")))
    tables = {*program.ProgramTables.__struct_fields__, *program.Goal.__struct_fields__}
    assert set(re.findall(r"self\.(\w+)(?: =|\[)", text)) <= declared | tables
    assert set(re.findall(r"self\.(\w+) = (?:program|goal)\.\1\n", text)) == tables


def test_is_compiled_where_there_is_a_compiler() -> None:
    assert kernel.compiled() or shutil.which("cc") is None, "pip install -e . compiles it"
    assert not plain_kernel().compiled()


def same_traces(checker: ModelChecker, traces: int, steps: int) -> None:
    for property_ in checker.compiled_properties:
        for scheduler in (0, 5, MEMORY | 3, STARVE | 2, FAVOUR | 1):
            assert difference(checker, property_, 11, traces, steps, scheduler) == ""


def test_same_traces_of_the_example() -> None:
    loaded = api.load(str(ROOT / "examples/delivery_robot/main.xml"))
    same_traces(api.checker(api.to_jani(loaded)), traces=3, steps=400)


@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck))
@given(networks())
def test_same_traces_of_random_models(written: dict[str, Any]) -> None:
    same_traces(ModelChecker(model(written)), traces=4, steps=40)


LARGE = (1 << 63) - 1


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (op("+", "x", 1), "integer overflow"),
        (op("*", "x", 2), "integer overflow"),
        (op("-", op("-", 0, "x"), 2), "integer overflow"),
        (op("*", op("-", op("-", 0, "x"), 1), op("-", 0, "one")), "integer overflow"),
        (op("abs", op("-", op("-", 0, "x"), 1)), "integer overflow"),
        (op("%", "x", op("-", "one", 1)), "division by zero"),
        (op("floor", op("/", "x", op("-", "one", 1))), "division by zero"),
        (op("floor", op("*", op("*", "x", 1.0), 4.0)), "integer overflow"),
        (op("ceil", op("log", op("-", "one", 2), 2)), "no value"),
        (op("%", 1, 0), "division by zero"),
    ],
)
def test_numbers_that_do_not_fit(value: Any, message: str) -> None:
    written = document(
        automaton("a", "l", [edge("l", way("l", y=value))]),
        variables=[variable("x", initial=LARGE), variable("y"), variable("one", initial=1)],
        properties={"p": probability(op("F", op("=", "y", 77)))},
    )
    compiled = ModelChecker(model(written)).compiled(ModelChecker(model(written)).compiled_properties[0])
    for module in (kernel, plain_kernel()):
        simulator = module.Kernel(compiled.program, compiled.goal)
        assert simulator.begin(0, 0) == program.UNKNOWN
        assert simulator.advance(5) == program.FAULTY
    with pytest.raises(Exception, match=message):
        answers(written)


@pytest.mark.parametrize(
    ("value", "number"), [(op("floor", op("log", -2, 2)), "-2.0"), (op("floor", op("log", "x", 2)), "-3.0")]
)
def test_faults_of_functions_name_the_argument(value: Any, number: str) -> None:
    """Also that of a constant, which is not computed in a trace."""
    written = document(
        automaton("a", "l", [edge("l", way("l", y=value))]),
        variables=[variable("x", initial=-3), variable("y")],
        properties={"p": probability(op("F", op("=", "y", 77)))},
    )
    with pytest.raises(FaultError, match=f"no value for {number}$"):
        answers(written)


FAULTS = {
    "index 7 is outside of the array, whose length is 2": ("u", at("v", op("+", "u", 7))),
    "index 9 is outside of the array, whose length is 3": ("w", at("longer", op("+", "w", 9))),
    "index 2 is outside of the array, whose length is 2": ("u", at("v", 2)),
    "12 is outside of the bounds of the variable's type": ("small", op("+", "w", 12)),
    "2.5 is outside of the bounds of the variable's type": ("portion", op("+", "half", 2.0)),
    "this function has no value for -1.5": ("u", op("floor", op("log", op("-", "half", 2.0), 2))),
    "division by zero": ("u", op("%", 1, "u")),
}


@pytest.mark.parametrize("second", FAULTS)
@pytest.mark.parametrize("first", FAULTS)
def test_the_first_of_several_faults_of_a_step_is_reported(first: str, second: str) -> None:
    """Both with its place and with its numbers."""
    bounds = {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 3}
    part = {"kind": "bounded", "base": "real", "lower-bound": 0.0, "upper-bound": 1.0}
    array = {"kind": "array", "base": "int"}
    written = document(
        *(
            automaton(name, "l", [edge("l", ways("l", [(*FAULTS[fault], 0)]), action="both")])
            for name, fault in (("a", first), ("b", second))
        ),
        variables=[
            variable("u"),
            variable("w"),
            variable("half", "real", 0.5),
            variable("v", array, {"op": "av", "elements": [1, 2]}),
            variable("longer", array, {"op": "av", "elements": [1, 2, 3]}),
            variable("small", bounds),
            variable("portion", part, 0.5),
        ],
        syncs=[["both", "both"]],
        properties={"p": probability(op("F", op("=", "u", 77)))},
    )
    checker = ModelChecker(model(written))
    compiled = checker.compiled(checker.compiled_properties[0])
    for module in (kernel, plain_kernel()):
        simulator = module.Kernel(compiled.program, compiled.goal)
        assert simulator.begin(0, 0) == program.UNKNOWN
        assert simulator.advance(5) == program.FAULTY
        assert checker.fault(TraceProblem(0, *simulator.problem())).message == first


def test_numbers_that_just_fit() -> None:
    value = op("-", op("-", 0, "x"), 1)
    written = document(
        automaton("a", "l", [edge("l", way("l", y=value), guard=op("=", "y", 0))]),
        variables=[variable("x", initial=LARGE), variable("y")],
        properties={"p": probability(op("F", op("=", op("+", "y", 1), op("-", 0, "x"))))},
    )
    assert answers(written)["p"].value == 1


def test_python_version_is_named_in_the_build() -> None:
    """The extension was built for this version of Python; otherwise it would not be found."""
    if kernel.compiled():
        assert f"{sys.version_info[0]}{sys.version_info[1]}" in Path(kernel.__file__).name


@given(st.integers(0, (1 << 64) - 1), st.integers(0, 1 << 40))
def test_random_numbers_are_those_of_splitmix(seed: int, trace: int) -> None:
    """A draw depends only on the seed, the trace and its number: two kernels with different histories agree."""
    written = document(
        automaton("a", "l m", [edge("l", way("l", 0.5, x=0), way("m", 0.5, x=1))]),
        variables=[variable("x")],
        properties={"p": probability(op("F", op("=", "x", 1)))},
    )
    checker = ModelChecker(model(written))
    compiled = checker.compiled(checker.compiled_properties[0])
    first, second = (kernel.Kernel(compiled.program, compiled.goal) for _ in range(2))
    second.begin(1, 1)
    second.advance(100)
    results = []
    for simulator in (first, second):
        simulator.begin(seed, trace)
        simulator.advance(100)
        results.append(simulator.outcome())
    assert results[0] == results[1]

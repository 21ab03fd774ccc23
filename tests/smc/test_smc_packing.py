# SPDX-License-Identifier: Apache-2.0
"""Packed states, without the search and the traces that use them."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from smc_models import automaton, document, edge, model, op, probability, variable, way

import roaml
from roaml.explicit.plain import plain_kernel, plain_packing, plain_search, plain_states
from roaml.smc import packing
from roaml.smc.model import ModelChecker

PACKAGE = Path(roaml.__file__).parent


@pytest.mark.parametrize("module", ["smc/packing", "explicit/search"])
def test_every_attribute_has_a_c_type(module: str) -> None:
    """A name without a declaration would fail only in the extension."""
    text = (PACKAGE / f"{module}.py").read_text(encoding="utf-8")
    files = PACKAGE / f"{module}.pxd", PACKAGE / "smc/packing.pxd"
    declared = "".join(file.read_text(encoding="utf-8") for file in files)
    for name in set(re.findall(r"self\.(\w+)(?: =|\[)", text)):
        assert re.search(rf"\b{name}\b", declared), name


def test_is_compiled_where_there_is_a_compiler() -> None:
    assert packing.compiled() or shutil.which("cc") is None, "pip install -e . compiles it"
    assert not plain_packing().compiled()


@pytest.mark.parametrize("module", [plain_search(), plain_states()])
def test_plain_modules_use_plain_states(module: ModuleType) -> None:
    assert module.PackedStates is plain_packing().PackedStates
    assert module.PackedStates is not packing.PackedStates


def packed(*names: str) -> Any:
    """The states of a model with some variables and an automaton with three locations, as plain Python."""
    written = document(
        automaton("a", "l m n", [edge("l", way("m")), edge("m", way("n"))]),
        variables=[variable(name) for name in names],
        properties={"p": probability(op("F", op("=", names[0], 1)))},
    )
    checker = ModelChecker(model(written))
    compiled = checker.compiled(checker.compiled_properties[0])
    kernel = plain_kernel().Kernel(compiled.program, compiled.goal)
    states = plain_packing().PackedStates(kernel, compiled.program.cell_watch, 1)
    kernel.root(0)
    states.memory[0] = 5
    states._start()
    return states


def put(states: Any, values: list[int]) -> int:
    """The number of the state with some values; states are packed again whenever values do not fit."""
    for cell, value in enumerate(values[:-1]):
        states._set_current(cell, value)
    states.memory[0] = values[-1]
    states._pack_all()
    while states.misfit >= 0:
        if states._widen():
            states._repack()
        states._pack_all()
    at = states._look_up()
    known = states._state_at(at)
    if known >= 0:
        return int(known)
    if states.count == states.state_room:
        states._grow()
    return int(states._add(at))


def values_of(states: Any, state: int) -> list[int]:
    return [states._decoded(state, cell) for cell in range(states.cell_count)]


def test_states_keep_their_numbers_and_values_in_every_layout() -> None:
    states = packed("x", "y", "z")
    variables = (0, 0, 0), (1, 0, 0), (1, -3, 0), (900, 4, 0), (-70_000, 1, 1), (1 << 62, 5, -(1 << 63)), (3, 3, 3)
    written = [[place, *xyz, further] for xyz in variables for place in (0, 1, 2) for further in (5, 6, 9)]
    for number, values in enumerate(written):
        assert put(states, values) == number
    assert states.words > 2
    assert [values_of(states, number) for number in range(states.count)] == written
    assert [put(states, values) for values in written] == list(range(len(written)))


def test_a_cell_with_one_value_has_no_bits() -> None:
    states = packed("x", "y")
    for value in range(200):
        put(states, [0, value, 0, 5])
    assert list(states.bits) == [2, 8, 0, 0]
    assert states.words == 1
    keys = list(states.keys)
    put(states, [0, 7, 1, 5])
    assert list(states.keys[: states.count - 1]) == keys[: states.count - 1], "unused bits need no other layout"


def test_the_kernel_returns_to_the_state_before_a_step() -> None:
    states = packed("x", "y")
    states.changed[0], states.changed[1], states.changed_count = 1, 2, 2
    before = list(states.kernel.ints)
    states._set_current(1, 4)
    states._set_current(2, 6)
    states._pack_changed()
    assert states.misfit >= 0
    while states.misfit >= 0:
        states._widen()
        states._repack()
        states._pack_all()
    state = states._add(states._look_up())
    states._undo()
    assert list(states.kernel.ints) == before
    states._visit(state)
    assert list(states.value) == values_of(states, state) == [0, 4, 6, 5]
    assert list(states.now) == list(states.following)

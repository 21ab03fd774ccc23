# SPDX-License-Identifier: Apache-2.0
"""Real variables as integers, for Storm: values keep their meaning, or the model is refused."""

from __future__ import annotations

from typing import Any

import pytest
from fixed_point import NotExactError, in_fixed_point

TIMES_TEN = {"op": "*", "left": "level", "right": 10}


def assigned(value: Any, ref: str = "bit") -> Any:
    """What is assigned instead of a value to a variable of a model in which `level` is real and `bit` an integer."""
    assignment = {"ref": ref, "value": value}
    document = {
        "variables": [
            {"name": "level", "type": "real", "initial-value": 0.5},
            {"name": "bit", "type": "int", "initial-value": 0},
        ],
        "automata": [{"edges": [{"location": "a", "destinations": [{"location": "a", "assignments": [assignment]}]}]}],
        "properties": [],
    }
    (automaton,) = in_fixed_point(document)["automata"]
    return automaton["edges"][0]["destinations"][0]["assignments"][0]["value"]


@pytest.mark.parametrize("operator", ["floor", "ceil"])
def test_a_rounding_divides_by_the_scale(operator: str) -> None:
    shifted = {"op": "+", "left": TIMES_TEN, "right": 0.5}
    scaled = {"op": "+", "left": TIMES_TEN, "right": 500}
    rounded = {"op": operator, "exp": {"op": "/", "left": scaled, "right": 1000}}
    parity = assigned({"op": "%", "left": {"op": operator, "exp": shifted}, "right": 2})
    assert parity == {"op": "%", "left": rounded, "right": 2}


def test_a_rounded_number_is_scaled_where_it_becomes_real() -> None:
    rounded = {"op": "floor", "exp": {"op": "/", "left": "level", "right": 1000}}
    assert assigned({"op": "floor", "exp": "level"}, "level") == {"op": "*", "left": rounded, "right": 1000}


def test_a_product_with_an_integer_is_scaled_once() -> None:
    assert assigned({"op": "*", "left": "bit", "right": "level"}, "level") == {
        "op": "*",
        "left": "bit",
        "right": "level",
    }


@pytest.mark.parametrize(
    "value",
    [
        {"op": "%", "left": "level", "right": 2},
        {"op": "floor", "exp": {"op": "*", "left": "level", "right": "level"}},
        {"op": "floor", "exp": {"op": "*", "left": "level", "right": 0.5}},
        {"op": "floor", "exp": {"op": "*", "left": "level", "right": {"op": "/", "left": "bit", "right": 2}}},
    ],
)
def test_what_integers_cannot_represent_is_refused(value: Any) -> None:
    with pytest.raises(NotExactError):
        assigned(value)

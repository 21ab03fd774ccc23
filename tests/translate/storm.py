# SPDX-License-Identifier: Apache-2.0
"""What Storm, an independent model checker, says about a translated model."""

from __future__ import annotations

import json
from typing import NamedTuple

import stormpy
from fixed_point import in_fixed_point

from roaml.jani.model import Model
from roaml.jani.writer import write


class Exact(NamedTuple):
    """The least and the greatest probability over all schedulers, and the states that were built for it."""

    least: float
    greatest: float
    states: int


def read(model: Model) -> stormpy.JaniModel:
    """
    Raises:
        RuntimeError: Storm refuses the file.
    """
    return stormpy.parse_jani_model_from_string("".join(write(model)))[0]


def exact(model: Model, name: str) -> Exact:
    """The probability of one property, computed by Storm's sparse engine.

    Raises:
        NotExactError: the model has real variables that integers cannot represent (`fixed_point`).
    """
    (least, states), (greatest, _) = (_checked(model, name, operator) for operator in ("Pmin", "Pmax"))
    return Exact(least, greatest, states)


def _checked(model: Model, name: str, operator: str) -> tuple[float, int]:
    """One property at a time: then Storm need not go on where it is decided, without which nothing would be finite."""
    document = json.loads("".join(write(model)))
    (property_,) = (p for p in document["properties"] if p["name"] == name)
    property_["expression"]["values"]["op"] = operator
    document["properties"] = [property_]
    parsed, properties = stormpy.parse_jani_model_from_string(json.dumps(in_fixed_point(document)))
    built = stormpy.build_model(parsed, properties)
    result = stormpy.model_checking(built, properties[0], only_initial_states=True)
    return result.get_value(built.initial_states[0]), built.nr_states

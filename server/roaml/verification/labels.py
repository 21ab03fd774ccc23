# SPDX-License-Identifier: Apache-2.0
"""Names of properties as conditions in properties that are written as text: the name of a property `F c` means `c`, as
labels do in PRISM (docs/verification.md#rewards)."""

from __future__ import annotations

import json
from typing import Any

from roaml.jani.model import Model
from roaml.jani.properties import (
    Filter,
    Probability,
    ProperFormula,
    Property,
    UnaryPath,
    UnaryPathOperator,
)
from roaml.jani.writer import write_properties

_WORDS = frozenset({"op", "fun"})
"""The members of a formula in JSON whose texts are not names."""


def with_labels(expression: Any, model: Model) -> Any:
    """A formula, as a value for JSON, in which the names of properties are replaced by their conditions. Names of
    variables and constants have precedence."""
    declared = {variable.name for variable in model.variables} | {constant.name for constant in model.constants}
    declared |= {variable.name for automaton in model.automata for variable in automaton.variables}
    properties = {p.name: p for p in model.properties if p.name not in declared and _is_reachability(p)}

    def replaced(value: Any) -> Any:
        if isinstance(value, str):
            return _condition(properties[value]) if value in properties else value
        if isinstance(value, dict):
            return {key: part if key in _WORDS else replaced(part) for key, part in value.items()}
        return [replaced(part) for part in value] if isinstance(value, list) else value

    return replaced(expression)


def _is_reachability(property_: Property) -> bool:
    """Whether a property is the probability of `F c` without bounds, and c is a condition on the state."""
    match property_.expression:
        case Filter(values=Probability(path=UnaryPath(operator=UnaryPathOperator.FINALLY, operand=operand) as path)):
            is_bounded = path.step_bounds or path.time_bounds or path.reward_bounds
            return not is_bounded and not isinstance(operand, ProperFormula)
    return False


def _condition(property_: Property) -> Any:
    (written,) = json.loads(write_properties([property_]))
    return written["expression"]["values"]["exp"]["exp"]

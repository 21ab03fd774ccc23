# SPDX-License-Identifier: Apache-2.0
"""Exact minimum and maximum over all schedulers, computed by Storm (https://www.stormchecker.org).

The states are counted first; Storm is used only if there are few.
"""

from __future__ import annotations

import importlib
import json
from typing import Any

from roaml.jani.operators import BinaryOperator
from roaml.jani.writer import write
from roaml.smc.explore import MOST_CHOICES, Explorer, StateFaultError, TooManyChoicesError, TooManyStatesError
from roaml.smc.goal import NO_OUTPUTS, CompiledProperty, Question
from roaml.smc.model import ModelChecker
from roaml.verification.expectations import Expectation, Verdict
from roaml.verification.results import Exact
from roaml.verification.schedulers import asks_for_minimum

_SLACK = 1e-6
"""The accuracy of Storm's values."""


class ExactError(ValueError):
    """There is no exact answer; the message contains the reason."""


def exact_values(checker: ModelChecker, asked: CompiledProperty, limit: int) -> Exact:
    """The exact least and greatest value of a property.

    Args:
        limit: more states are refused.

    Raises:
        ExactError: there are too many states, Storm is not there, or it does not know the model's features.
        FaultError: the model did something that has no meaning.
    """
    if asked.question.is_conditional:
        raise ExactError(
            "the minimum and the maximum given assumptions are not ratios of minimum and maximum; omit --exact to "
            "estimate the probability under uniform choices"
        )
    try:
        stormpy: Any = importlib.import_module("stormpy")
    except ImportError:
        raise ExactError("--exact needs the package stormpy: pip install 'stormpy>=2'") from None
    if asked.goal.is_bounded:
        raise ExactError("step bounds cannot be computed exactly; omit --exact")
    reduced = checker.reduced(asked)
    if reduced is not checker:
        checker, asked = reduced, reduced.asked[0]
    try:
        states = len(Explorer(checker.compiled(asked)).reachable(limit))
    except TooManyStatesError:
        message = f"there are more than {limit:,} states (--max-states); omit --exact to estimate"
        raise ExactError(message) from None
    except TooManyChoicesError:
        raise ExactError(
            f"in one state there are more than {MOST_CHOICES:,} combinations of edges; omit --exact to estimate"
        ) from None
    except StateFaultError as error:
        raise checker.fault(error.problem) from None
    if asked.property not in checker.model.properties:
        raise ExactError("this can be decided only by traces; omit --exact")
    document = json.loads("".join(write(checker.model)))
    (property_,) = (row for row in document["properties"] if row["name"] == asked.question.name)
    operators = ("Emin", "Emax") if asked.question.is_reward else ("Pmin", "Pmax")
    least, greatest = (
        _value(stormpy, document, {**_inner(property_["expression"]), "op": operator}) for operator in operators
    )
    for _, condition in checker.outputs.get(asked.property.name, NO_OUTPUTS).open:
        stays = {"op": "F", "exp": {"op": "G", "exp": condition.identifier}}
        share = _value(stormpy, document, {"op": "Pmax", "exp": stays})
        if share > _SLACK:
            raise ExactError(
                "the time ends (max_time) before a deadline of the property; the probability of such traces is up to "
                f"{share:.6g}; leave --exact out to estimate"
            )
    return Exact(least, greatest, states)


def _value(stormpy: Any, document: dict[str, Any], expression: dict[str, Any]) -> float:
    """The value of a formula in the initial state of a model in JANI.

    Raises:
        ExactError: Storm cannot answer.
    """
    whole = {"op": "filter", "fun": "values", "values": expression, "states": {"op": "initial"}}
    asked = {**document, "properties": [{"name": "asked", "expression": whole}]}
    try:
        model, properties = stormpy.parse_jani_model_from_string(json.dumps(asked))
        built = stormpy.build_model(model, properties)
        result = stormpy.model_checking(built, properties[0], only_initial_states=True)
        if result is None:
            raise ExactError("Storm does not answer properties of this form")
        return float(result.get_value(built.initial_states[0]))
    except (RuntimeError, IndexError) as error:
        raise ExactError(f"Storm failed: {error}") from None


def judge_exactly(expectation: Expectation, exact: Exact, question: Question) -> Verdict:
    """Whether the value that a property asks for, the minimum or the maximum, satisfies an expectation."""
    threshold = expectation.threshold
    what, value = ("least", exact.least) if asks_for_minimum(question) else ("greatest", exact.greatest)
    if threshold.relation is BinaryOperator.EQUAL:
        met = abs(value - threshold.number) <= _SLACK
    else:
        is_strict = threshold.relation in (BinaryOperator.LESS, BinaryOperator.GREATER)
        slack = 0.0 if is_strict else _SLACK
        met = threshold.met(value + slack) or threshold.met(value - slack)
    return Verdict(expectation, met, True, under="" if met else f"by the {what} value, which is {value:.6g}")


def _inner(formula: dict[str, Any]) -> dict[str, Any]:
    """The probability or reward inside of filters and comparisons."""
    while formula["op"] not in ("Pmin", "Pmax", "Emin", "Emax"):
        if formula["op"] == "filter":
            formula = formula["values"]
        else:
            formula = formula["left"] if isinstance(formula["left"], dict) else formula["right"]
    return formula

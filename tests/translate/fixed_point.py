# SPDX-License-Identifier: Apache-2.0
"""JANI models with real variables as models with integers, because Storm builds no models with real variables.

Each real value is represented by its product with `SCALE`, an integer. Only what keeps this exact is allowed: copies,
sums, differences, products with integers, minima, maxima, absolute values, roundings and comparisons.
"""

from __future__ import annotations

from decimal import Decimal
from typing import Any, TypeAlias

Json: TypeAlias = Any
SCALE = 1000
_LINEAR = {"+", "-", "min", "max", "abs"}
_COMPARISONS = {"=", "≠", "<", "≤", ">", "≥"}
_ROUNDINGS = {"floor", "ceil"}
_OPERANDS = ("left", "right", "exp", "then", "else")


class NotExactError(ValueError):
    """A real value is not a multiple of 1 / `SCALE`, or an operation on reals is not in the list above."""


def in_fixed_point(document: Json) -> Json:
    """The same model with integers instead of reals. `document` is not changed.

    Raises:
        NotExactError: this is not possible.
    """
    shared = {variable["name"] for variable in document["variables"] if _is_real(variable["type"])}
    automata = []
    for automaton in document["automata"]:
        own = {variable["name"] for variable in automaton.get("variables", ()) if _is_real(variable["type"])}
        hidden = {variable["name"] for variable in automaton.get("variables", ())} - own
        scaled = _Scaled((shared | own) - hidden)
        variables = [scaled.variable(variable) for variable in automaton.get("variables", ())]
        automata.append(
            {**automaton, "variables": variables, "edges": [scaled.edge(edge) for edge in automaton["edges"]]}
        )
    scaled = _Scaled(shared)
    variables = [scaled.variable(variable) for variable in document["variables"]]
    properties = [scaled.integer(property_) for property_ in document["properties"]]
    return {**document, "variables": variables, "automata": automata, "properties": properties}


def _is_real(type_: Json) -> bool:
    return type_ == "real" or (isinstance(type_, dict) and _is_real(type_.get("base")))


class _Scaled:
    """Rewrites what is below one automaton. `reals` are the names of its real variables."""

    def __init__(self, reals: set[str]) -> None:
        self.reals = reals

    def variable(self, variable: Json) -> Json:
        if not _is_real(variable["type"]):
            return variable
        return {**variable, "type": _integers(variable["type"]), "initial-value": self.real(variable["initial-value"])}

    def edge(self, edge: Json) -> Json:
        rest = {key: self.integer(value) for key, value in edge.items() if key != "destinations"}
        return {**rest, "destinations": [self.destination(way) for way in edge["destinations"]]}

    def destination(self, way: Json) -> Json:
        rest = {key: self.integer(value) for key, value in way.items() if key != "assignments"}
        return {**rest, "assignments": [self.assignment(assignment) for assignment in way.get("assignments", ())]}

    def assignment(self, assignment: Json) -> Json:
        convert = self.real if self.is_real(assignment["ref"]) else self.integer
        return {**assignment, "value": convert(assignment["value"])}

    def is_real(self, expression: Json) -> bool:
        """Whether an expression has a real value because it reads a real variable."""
        match expression:
            case str():
                return expression in self.reals
            case {"op": "aa", "exp": array}:
                return self.is_real(array)
            case {"op": "ite"}:
                return self.is_real(expression["then"]) or self.is_real(expression["else"])
            case {"op": operator} if operator not in _COMPARISONS | _ROUNDINGS:
                return any(self.is_real(expression[key]) for key in _OPERANDS if key in expression)
        return False

    def real(self, expression: Json) -> Json:
        """An expression whose value is real, or is converted to a real one."""
        match expression:
            case bool():
                raise NotExactError(expression)
            case int() | float():
                scaled = Decimal(str(expression)) * SCALE
                if scaled != int(scaled):
                    raise NotExactError(expression)
                return int(scaled)
            case {"op": "av", "elements": elements}:
                return {"op": "av", "elements": [self.real(element) for element in elements]}
            case {"op": "ac", "exp": element}:
                return {**expression, "exp": self.real(element)}
            case {"op": "ite", "if": test, "then": then, "else": otherwise}:
                return {**expression, "if": self.integer(test), "then": self.real(then), "else": self.real(otherwise)}
            case _ if not self.is_real(expression):
                return {"op": "*", "left": self.integer(expression), "right": SCALE}
            case {"op": operator} if operator in _LINEAR:
                return {key: self.real(value) if key in _OPERANDS else value for key, value in expression.items()}
            case {"op": "*", "left": left, "right": right} if not (self.is_real(left) and self.is_real(right)):
                return {"op": "*", "left": self.factor(left), "right": self.factor(right)}
            case {"op": "aa"} | str():
                return expression
        raise NotExactError(expression)

    def factor(self, expression: Json) -> Json:
        """A factor of a product that has a single real factor, which alone is scaled."""
        if self.is_real(expression):
            return self.real(expression)
        if _has_fraction(expression):
            raise NotExactError(expression)
        return self.integer(expression)

    def integer(self, part: Json) -> Json:
        """Any part of a model that has no real value itself, with scaled comparisons and roundings of reals."""
        match part:
            case list():
                return [self.integer(element) for element in part]
            case {"op": operator, "left": left, "right": right} if operator in _COMPARISONS and (
                self.is_real(left) or self.is_real(right)
            ):
                return {**part, "left": self.real(left), "right": self.real(right)}
            case {"op": operator, "exp": operand} if operator in _ROUNDINGS and self.is_real(operand):
                return {**part, "exp": {"op": "/", "left": self.real(operand), "right": SCALE}}
            case {"op": _} if any(self.is_real(part[key]) for key in _OPERANDS if key in part):
                raise NotExactError(part)
            case dict():
                return {key: self.integer(value) for key, value in part.items()}
        return part


def _has_fraction(expression: Json) -> bool:
    """Whether an expression contains a number that is not an integer, or a quotient or a function with real values."""
    match expression:
        case float():
            return not expression.is_integer()
        case {"op": operator} if operator not in _COMPARISONS | _ROUNDINGS:
            is_real = operator not in {*_LINEAR, "*", "%", "aa", "ite"}
            return is_real or any(_has_fraction(expression[key]) for key in _OPERANDS if key in expression)
    return False


def _integers(type_: Json) -> Json:
    return "int" if type_ == "real" else {**type_, "base": _integers(type_["base"])}

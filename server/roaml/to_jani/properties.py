# SPDX-License-Identifier: Apache-2.0
"""Converts JANI properties of users to the form in which they are checked (docs/spec/jani.md#properties).

- Comparisons with an array literal are replaced by comparisons of lengths and elements.
- Bounds on time and rewards are kept, because a property has a different meaning without them. `roaml.smc.forms`
  reports properties with these bounds, as the model has only steps and no rewards.
- Properties, path formulas and operators keep their comments; that of a property is its sentence in reports.
"""

from __future__ import annotations

from collections.abc import Mapping

from roaml.jani.expressions import ArrayAccess, ArrayValue, Binary, Expression, Name
from roaml.jani.node import Node
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import Filter, Probability, Property
from roaml.jani.rewrite import rewrite
from roaml.record import replace
from roaml.to_jani.shapes import ArrayShape
from roaml.to_jani.values import Listed, Stored, equal_arrays, negated


def expanded(property_: Property, variables: Mapping[str, ArrayShape]) -> Property:
    """The property in which comparisons with array literals are replaced. `variables` contains the shapes of the global
    variables."""

    def change(node: Node) -> Node:
        match node:
            case Binary(BinaryOperator.EQUAL | BinaryOperator.NOT_EQUAL as operator, left, right):
                if isinstance(left, ArrayValue):
                    left, right = right, left
                stored = _stored(left, variables)
                if stored is not None and isinstance(right, ArrayValue):
                    same = equal_arrays(stored, _listed(right))
                    return same if operator is BinaryOperator.EQUAL else negated(same)
            case Filter() | Probability():
                return replace(node, comment=None)
        return node

    return rewrite(property_, change)


def _stored(expression: Expression, variables: Mapping[str, ArrayShape]) -> Stored | None:
    indexes: list[Expression] = []
    while isinstance(expression, ArrayAccess):
        indexes.insert(0, expression.index)
        expression = expression.array
    if not isinstance(expression, Name) or expression.identifier not in variables:
        return None
    stored = Stored(expression.identifier, variables[expression.identifier], tuple(indexes))
    return stored if stored.dimensions > 0 else None


def _listed(value: ArrayValue) -> Listed:
    return Listed(tuple(_listed(item) if isinstance(item, ArrayValue) else item for item in value.elements))

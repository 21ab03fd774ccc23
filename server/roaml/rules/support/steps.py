# SPDX-License-Identifier: Apache-2.0
"""Assignments that add something to a variable or subtract something from it."""

from __future__ import annotations

from collections.abc import Collection

from roaml.expr.infer import constant
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Expr
from roaml.model.values.evaluate import place_of


def step_of(tree: Expr, place: str, positive: Collection[str] = ()) -> int:
    """1 if `tree` is the value at `place` plus something positive, -1 if it is that value minus something positive,
    otherwise 0.

    Args:
        positive: the names of variables that are always positive.
    """
    if not isinstance(tree, Binary) or tree.operator not in (Operator.ADD, Operator.SUBTRACT):
        return 0
    direction = 1 if tree.operator is Operator.ADD else -1
    sides = [(tree.left, tree.right)]
    if direction > 0:
        sides.append((tree.right, tree.left))
    for variable, amount in sides:
        number = constant(amount)
        if place_of(variable) == place:
            if number is not None and number != 0:
                return direction if number > 0 else -direction
            if place_of(amount) in positive:
                return direction
    return 0

# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about assignments."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.expr.format import format_expr
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Boolean, Expr, Number
from roaml.model.machine import Assign
from roaml.model.syntax import Expression


def is_unchanged(statement: Assign) -> bool:
    """Whether a statement assigns a variable to itself, perhaps in a neutral operation such as `x + 0` or `x * 1`."""
    location, value = statement.location, statement.value
    if location is None or not isinstance(value, Expression) or location.broken or value.broken:
        return False
    return format_expr(location.tree) == format_expr(_without_neutral(value.tree))


_NEUTRAL_BEHIND: Mapping[Operator, tuple[float | bool, ...]] = {
    Operator.ADD: (0,),
    Operator.SUBTRACT: (0,),
    Operator.MULTIPLY: (1,),
    Operator.DIVIDE: (1,),
    Operator.OR: (False,),
    Operator.AND: (True,),
}
_COMMUTES = (Operator.ADD, Operator.MULTIPLY, Operator.OR, Operator.AND)


def _without_neutral(expr: Expr) -> Expr:
    """`x` for `x + 0`, `x * 1`, `x || false` and similar expressions."""
    while isinstance(expr, Binary) and expr.operator in _NEUTRAL_BEHIND:
        neutral = _NEUTRAL_BEHIND[expr.operator]
        if _is_one_of(expr.right, neutral):
            expr = expr.left
        elif expr.operator in _COMMUTES and _is_one_of(expr.left, neutral):
            expr = expr.right
        else:
            break
    return expr


def _is_one_of(expr: Expr, values: tuple[float | bool, ...]) -> bool:
    return isinstance(expr, Number | Boolean) and any(
        expr.value == value and isinstance(expr.value, bool) == isinstance(value, bool) for value in values
    )

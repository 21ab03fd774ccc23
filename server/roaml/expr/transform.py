# SPDX-License-Identifier: Apache-2.0
"""Transformations of expression trees."""

from __future__ import annotations

from collections.abc import Callable

from roaml.expr.tree import (
    ArrayLiteral,
    Binary,
    Call,
    Conditional,
    ErrorExpr,
    Expr,
    Index,
    Member,
    ObjectLiteral,
    Unary,
)
from roaml.record import replace


def map_children(expr: Expr, change: Callable[[Expr], Expr]) -> Expr:
    """`expr` with a function applied to each of its direct subexpressions, left to right."""
    match expr:
        case Member():
            return Member(expr.span, change(expr.object), expr.name, expr.name_span)
        case Index():
            return Index(expr.span, change(expr.object), change(expr.index))
        case Call():
            return Call(expr.span, change(expr.function), tuple(map(change, expr.arguments)))
        case Unary():
            return Unary(expr.span, expr.operator, change(expr.operand))
        case Binary():
            return Binary(expr.span, expr.operator, expr.operator_span, change(expr.left), change(expr.right))
        case Conditional():
            return Conditional(expr.span, change(expr.test), change(expr.then), change(expr.otherwise))
        case ArrayLiteral():
            return ArrayLiteral(expr.span, tuple(map(change, expr.elements)))
        case ObjectLiteral():
            return ObjectLiteral(expr.span, tuple(replace(m, value=change(m.value)) for m in expr.members))
        case ErrorExpr():
            return ErrorExpr(expr.span, tuple(map(change, expr.parts)))
        case _:
            return expr

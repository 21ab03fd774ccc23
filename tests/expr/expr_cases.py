# SPDX-License-Identifier: Apache-2.0
"""An expression tree in one line: `a.b[1] + f(-c)` is `(+ a.b[1] f((- c)))`; `_` is an unusable part."""

from __future__ import annotations

from roaml.expr.parse import parse
from roaml.expr.tree import (
    ArrayLiteral,
    Binary,
    Boolean,
    Call,
    Conditional,
    ErrorExpr,
    Expr,
    Index,
    Member,
    Name,
    Number,
    ObjectLiteral,
    String,
    Unary,
)
from roaml.text import Decoded


def tree_of(text: str) -> Expr:
    return parse(Decoded(text, 0))[0]


def show(expr: Expr) -> str:
    match expr:
        case Number() | String():
            return repr(expr.value)
        case Boolean():
            return str(expr.value).lower()
        case Name():
            return expr.name
        case Member():
            return f"{show(expr.object)}.{expr.name or '_'}"
        case Index():
            return f"{show(expr.object)}[{show(expr.index)}]"
        case Call():
            return f"{show(expr.function)}({', '.join(map(show, expr.arguments))})"
        case Unary():
            return f"({expr.operator.symbol} {show(expr.operand)})"
        case Binary():
            return f"({expr.operator.symbol} {show(expr.left)} {show(expr.right)})"
        case Conditional():
            return f"(? {show(expr.test)} {show(expr.then)} {show(expr.otherwise)})"
        case ArrayLiteral():
            return f"[{', '.join(map(show, expr.elements))}]"
        case ObjectLiteral():
            return "{" + ", ".join(f"{m.key}: {show(m.value)}" for m in expr.members) + "}"
        case ErrorExpr():
            return f"_<{' '.join(map(show, expr.parts))}>" if expr.parts else "_"

# SPDX-License-Identifier: Apache-2.0
"""Expression tree -> text in one normal form: one space around binary operators, no superfluous parentheses.

Parsing the text gives the same tree, except for spans; a tree with an `ErrorExpr` has no text.
"""

from __future__ import annotations

import json

from roaml.exhaustive import assert_never
from roaml.expr.operators import CONDITIONAL_PRECEDENCE, UNARY_PRECEDENCE, Operator, UnaryOperator
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

_POSTFIX_PRECEDENCE = UNARY_PRECEDENCE + 1


def format_expr(expr: Expr) -> str:
    """The text of `expr`.

    Raises:
        ValueError: `expr` contains an `ErrorExpr`.
    """
    return _text(expr, CONDITIONAL_PRECEDENCE)


def _text(expr: Expr, least: int) -> str:
    """The text of `expr`, in parentheses if it binds less tightly than `least`."""
    match expr:
        case Name():
            return expr.name
        case Number():
            return format_number(expr)
        case Boolean():
            return "true" if expr.value else "false"
        case String():
            return format_string(expr.value)
        case Member():
            return f"{_owner(expr.object)}.{expr.name}"
        case Index():
            return f"{_text(expr.object, _POSTFIX_PRECEDENCE)}[{_text(expr.index, CONDITIONAL_PRECEDENCE)}]"
        case Call():
            return f"{_text(expr.function, _POSTFIX_PRECEDENCE)}({_list(expr.arguments)})"
        case ArrayLiteral():
            return f"[{_list(expr.elements)}]"
        case ObjectLiteral():
            members = (f"{format_string(m.key)}: {_text(m.value, CONDITIONAL_PRECEDENCE)}" for m in expr.members)
            return f"{{{', '.join(members)}}}"
        case Unary():
            text, precedence = _unary(expr), UNARY_PRECEDENCE
        case Binary():
            text, precedence = _binary(expr), expr.operator.precedence
        case Conditional():
            text, precedence = _conditional(expr), CONDITIONAL_PRECEDENCE
        case ErrorExpr():
            raise ValueError("an expression that could not be parsed has no text")
        case _:
            assert_never(expr)
    return f"({text})" if precedence < least else text


def format_number(number: Number) -> str:
    """The text of a number. A real number with a whole value keeps its point: `2.0`."""
    if number.is_real:
        return repr(float(number.value))
    return str(int(number.value))


def format_string(value: str) -> str:
    """A string literal in single quotes."""
    inner = json.dumps(value, ensure_ascii=False)[1:-1].replace('\\"', '"').replace("'", "\\'")
    return f"'{inner}'"


def _owner(expr: Expr) -> str:
    """The text of an object before a dot; `2.x` would be read as the number `2.`."""
    return f"({format_number(expr)})" if isinstance(expr, Number) else _text(expr, _POSTFIX_PRECEDENCE)


def _list(expressions: tuple[Expr, ...]) -> str:
    return ", ".join(_text(expression, CONDITIONAL_PRECEDENCE) for expression in expressions)


def _unary(expr: Unary) -> str:
    operand = _text(expr.operand, UNARY_PRECEDENCE)
    doubled = isinstance(expr.operand, Unary) and expr.operand.operator is expr.operator is not UnaryOperator.NOT
    return f"{expr.operator.symbol}{' ' if doubled else ''}{operand}"


def _binary(expr: Binary) -> str:
    """The text of a binary expression; all operators are left-associative."""
    operator: Operator = expr.operator
    left = _text(expr.left, operator.precedence)
    return f"{left} {operator.symbol} {_text(expr.right, operator.precedence + 1)}"


def _conditional(expr: Conditional) -> str:
    test = _text(expr.test, CONDITIONAL_PRECEDENCE + 1)
    then, otherwise = (_text(part, CONDITIONAL_PRECEDENCE) for part in (expr.then, expr.otherwise))
    return f"{test} ? {then} : {otherwise}"

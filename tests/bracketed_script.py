# SPDX-License-Identifier: Apache-2.0
"""Expressions of the script language as texts that show how they were parsed."""

from roaml.script.tree import (
    Assignment,
    Binary,
    Boolean,
    Comparison,
    Conditional,
    ErrorExpr,
    Expr,
    Name,
    Number,
    String,
    Unary,
)


def with_brackets(expr: Expr) -> str:
    """The text of an expression with brackets around each of its parts."""
    match expr:
        case Number(value=value):
            return repr(value)
        case Boolean(value=value):
            return str(value).lower()
        case String(value=value):
            return f"'{value}'"
        case Name(name=name):
            return name
        case Unary(operator=operator, operand=operand):
            return f"({operator}{with_brackets(operand)})"
        case Binary(operator=operator, left=left, right=right):
            return f"({with_brackets(left)} {operator} {with_brackets(right)})"
        case Comparison(operators=operators, operands=operands):
            rest = (f" {op} {with_brackets(node)}" for op, node in zip(operators, operands[1:], strict=True))
            return f"({with_brackets(operands[0])}{''.join(rest)})"
        case Conditional(test=test, yes=yes, no=no):
            return f"({with_brackets(test)} ? {with_brackets(yes)} : {with_brackets(no)})"
        case Assignment(operator=operator, target=target, value=value):
            return f"({target.name} {operator} {with_brackets(value)})"
        case ErrorExpr():
            return "error"

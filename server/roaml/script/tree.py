# SPDX-License-Identifier: Apache-2.0
"""The syntax tree of a script.

- Every node has a `span` in the source file, in which escapes of the surrounding XML are taken into account.
- A missing or invalid part is an `ErrorExpr`, so the rest of the tree stays usable.
- No tree is deeper than `roaml.script.parse.MAX_DEPTH`: functions over trees may recurse.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from roaml.record import Record
from roaml.text import Span


class Number(Record, frozen=True):
    """An integer or a real number; a real number is written with a point or an exponent."""

    span: Span
    value: int | float


class Boolean(Record, frozen=True):
    """`true` or `false`: the numbers 1.0 and 0.0."""

    span: Span
    value: bool


class String(Record, frozen=True):
    span: Span
    value: str


class Name(Record, frozen=True):
    """An enumeration constant of the program, or an entry; a leading `@` refers to the root blackboard."""

    span: Span
    name: str


class Unary(Record, frozen=True):
    """A unary operation. `operator` is `-`, `~` or `!`."""

    span: Span
    operator: str
    operand: Expr


class Binary(Record, frozen=True):
    """A binary operation whose operator is neither a comparison nor an assignment."""

    span: Span
    operator: str
    operator_span: Span
    left: Expr
    right: Expr


class Comparison(Record, frozen=True):
    """One or more comparisons, such as `a < b == c`. Each of `operators` is between two of `operands`, and all
    comparisons must be true. `operator_span` is the place of the first operator."""

    span: Span
    operators: tuple[str, ...]
    operator_span: Span
    operands: tuple[Expr, ...]


class Conditional(Record, frozen=True):
    """A conditional expression `test ? yes : no`."""

    span: Span
    test: Expr
    yes: Expr
    no: Expr


class Assignment(Record, frozen=True):
    """An assignment such as `target := value`; `operator` is `:=`, `=`, `+=`, `-=`, `*=` or `/=`."""

    span: Span
    operator: str
    operator_span: Span
    target: Name
    value: Expr


class ErrorExpr(Record, frozen=True):
    """An expression that is missing or invalid."""

    span: Span


Expr: TypeAlias = Number | Boolean | String | Name | Unary | Binary | Comparison | Conditional | Assignment | ErrorExpr


class Script(Record, frozen=True):
    """A script. Its value is that of its last statement."""

    span: Span
    statements: tuple[Expr, ...]


def children(expr: Expr) -> tuple[Expr, ...]:
    """The parts of an expression, in the order of the text."""
    match expr:
        case Unary(operand=operand):
            return (operand,)
        case Binary(left=left, right=right):
            return (left, right)
        case Comparison(operands=operands):
            return operands
        case Conditional(test=test, yes=yes, no=no):
            return (test, yes, no)
        case Assignment(target=target, value=value):
            return (target, value)
        case Number() | Boolean() | String() | Name() | ErrorExpr():
            return ()


def walk(script: Script) -> Iterator[Expr]:
    """All expressions of a script, each before its parts, in the order of the text."""
    stack: list[Expr] = list(reversed(script.statements))
    while stack:
        expr = stack.pop()
        yield expr
        stack.extend(reversed(children(expr)))

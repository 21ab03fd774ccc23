# SPDX-License-Identifier: Apache-2.0
"""The syntax tree of an expression.

- Every node has a `span` in the source file, where characters may be written as entities of XML.
- A missing or invalid part is an `ErrorExpr`, so the rest of the tree stays usable.
- No tree is deeper than `roaml.expr.parse.MAX_DEPTH`: functions over trees may recurse.
"""

from __future__ import annotations

from typing import TypeAlias

from roaml.expr.operators import Operator, UnaryOperator
from roaml.record import Record
from roaml.text import Decoded, Span

MAX_INTEGER = (1 << 63) - 1
"""The greatest integer of a translated model."""


class Number(Record, frozen=True):
    """A number. `is_real` is true if it is written with a point or is not a whole number
    (docs/spec/expressions.md#number-literals)."""

    span: Span
    value: int | float
    is_real: bool

    @property
    def is_whole(self) -> bool:
        """Whether the value is an integer that a translated model can have."""
        return self.value == int(self.value) and abs(self.value) <= MAX_INTEGER


class String(Record, frozen=True):
    """A string. `value` has its ECMAScript escapes resolved."""

    span: Span
    value: str


class Boolean(Record, frozen=True):
    span: Span
    value: bool


class Name(Record, frozen=True):
    span: Span
    name: str


class Member(Record, frozen=True):
    """A member access `object.name`. `name` is empty if it has not been typed yet."""

    span: Span
    object: Expr
    name: str
    name_span: Span


class Index(Record, frozen=True):
    """An access `object[index]` to an element of an array or a character of a string."""

    span: Span
    object: Expr
    index: Expr


class Call(Record, frozen=True):
    span: Span
    function: Expr
    arguments: tuple[Expr, ...]


class Unary(Record, frozen=True):
    span: Span
    operator: UnaryOperator
    operand: Expr


class Binary(Record, frozen=True):
    span: Span
    operator: Operator
    operator_span: Span
    left: Expr
    right: Expr


class Conditional(Record, frozen=True):
    """A conditional expression `test ? then : otherwise`."""

    span: Span
    test: Expr
    then: Expr
    otherwise: Expr


class ArrayLiteral(Record, frozen=True):
    span: Span
    elements: tuple[Expr, ...]


class ObjectMember(Record, frozen=True):
    key: str
    key_span: Span
    value: Expr


class ObjectLiteral(Record, frozen=True):
    span: Span
    members: tuple[ObjectMember, ...]


class ErrorExpr(Record, frozen=True):
    """A part that is not valid; a finding contains the reason. `parts` are the expressions in it that could be
    parsed."""

    span: Span
    parts: tuple[Expr, ...] = ()


Expr: TypeAlias = (
    Number
    | String
    | Boolean
    | Name
    | Member
    | Index
    | Call
    | Unary
    | Binary
    | Conditional
    | ArrayLiteral
    | ObjectLiteral
    | ErrorExpr
)


_LEAVES = (Name, Number, String, Boolean)


def children(expr: Expr) -> tuple[Expr, ...]:
    """The direct subexpressions, left to right."""
    match expr:
        case Member():
            return (expr.object,)
        case Index():
            return (expr.object, expr.index)
        case Call():
            return (expr.function, *expr.arguments)
        case Unary():
            return (expr.operand,)
        case Binary():
            return (expr.left, expr.right)
        case Conditional():
            return (expr.test, expr.then, expr.otherwise)
        case ArrayLiteral():
            return expr.elements
        case ObjectLiteral():
            return tuple(member.value for member in expr.members)
        case ErrorExpr():
            return expr.parts
        case _:
            return ()


def walk(expr: Expr) -> list[Expr]:
    """`expr` and all its subexpressions, outer before inner, left to right."""
    if isinstance(expr, _LEAVES):
        return [expr]  # the common case
    nodes: list[Expr] = []
    stack: list[Expr] = [expr]
    while stack:
        node = stack.pop()
        nodes.append(node)
        if not isinstance(node, _LEAVES):
            stack += children(node)[::-1]
    return nodes


def placed(expr: Expr, source: Decoded) -> Expr:
    """`expr` with spans in the file. The spans of `expr` are offsets in the text of `source`."""
    span = source.span(*expr.span)
    match expr:
        case Name():
            return Name(span, expr.name)
        case Number():
            return Number(span, expr.value, expr.is_real)
        case Binary():
            operator_span = source.span(*expr.operator_span)
            return Binary(span, expr.operator, operator_span, placed(expr.left, source), placed(expr.right, source))
        case Member():
            return Member(span, placed(expr.object, source), expr.name, source.span(*expr.name_span))
        case Index():
            return Index(span, placed(expr.object, source), placed(expr.index, source))
        case Call():
            return Call(span, placed(expr.function, source), _all_placed(expr.arguments, source))
        case Unary():
            return Unary(span, expr.operator, placed(expr.operand, source))
        case Boolean():
            return Boolean(span, expr.value)
        case String():
            return String(span, expr.value)
        case Conditional():
            then, otherwise = placed(expr.then, source), placed(expr.otherwise, source)
            return Conditional(span, placed(expr.test, source), then, otherwise)
        case ArrayLiteral():
            return ArrayLiteral(span, _all_placed(expr.elements, source))
        case ObjectLiteral():
            members = (
                ObjectMember(member.key, source.span(*member.key_span), placed(member.value, source))
                for member in expr.members
            )
            return ObjectLiteral(span, tuple(members))
        case ErrorExpr():
            return ErrorExpr(span, _all_placed(expr.parts, source))


def _all_placed(exprs: tuple[Expr, ...], source: Decoded) -> tuple[Expr, ...]:
    return tuple(placed(expr, source) for expr in exprs)


def is_draw(expr: Expr) -> bool:
    """Whether `expr` itself is a call of `Math.random`."""
    match expr:
        case Call(function=Member(object=Name(name="Math"), name="random")):
            return True
    return False


def access_path(expr: Expr) -> tuple[str, ...] | None:
    """`a.b[0].c` as ("a", "b", "c"); `None` if `expr` is not a chain of members and indices that begins with a name."""
    names: list[str] = []
    while True:
        match expr:
            case Member():
                names.append(expr.name)
                expr = expr.object
            case Index():
                expr = expr.object
            case Name():
                return (expr.name, *reversed(names))
            case _:
                return None

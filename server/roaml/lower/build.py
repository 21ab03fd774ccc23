# SPDX-License-Identifier: Apache-2.0
"""Functions that create small expressions for the lowering."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Call, Expr, Index, Member, Name, Number
from roaml.text import NO_SPAN, Span

EVENT_DATA = "_event"


def name(identifier: str, span: Span = NO_SPAN) -> Name:
    return Name(span, identifier)


def integer(value: int, span: Span = NO_SPAN) -> Number:
    return Number(span, value, False)


def event_data(parameter: str, span: Span = NO_SPAN) -> Expr:
    """The expression `_event.data.<parameter>`: a parameter of the event that the transition waits for."""
    return Member(span, Member(span, Name(span, EVENT_DATA), "data", span), parameter, span)


def random_number() -> Expr:
    return math_call("random")


def math_call(function: str, *arguments: Expr) -> Expr:
    return Call(NO_SPAN, Member(NO_SPAN, name("Math"), function, NO_SPAN), arguments)


def floor(value: Expr) -> Expr:
    return math_call("floor", value)


def length(array: Expr, span: Span = NO_SPAN) -> Expr:
    return Member(span, array, "length", span)


def indexed(expr: Expr, indexes: Iterable[Expr], span: Span = NO_SPAN) -> Expr:
    for index in indexes:
        expr = Index(span, expr, index)
    return expr


def binary(left: Expr, operator: Operator, right: Expr, span: Span = NO_SPAN) -> Expr:
    return Binary(span, operator, span, left, right)


def equal(left: Expr, right: Expr, span: Span = NO_SPAN) -> Expr:
    return binary(left, Operator.EQUAL, right, span)


def both(left: Expr | None, right: Expr, span: Span = NO_SPAN) -> Expr:
    """The expression `left && right`; if `left` is `None`, only `right`."""
    return right if left is None else binary(left, Operator.AND, right, span)

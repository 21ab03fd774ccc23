# SPDX-License-Identifier: Apache-2.0
"""Translates assignments of plain SCXML to JANI (docs/spec/jani.md#assignments). The elements of an array and all its
lengths are assigned simultaneously."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr.tree import Expr, Member
from roaml.jani import expressions as jani
from roaml.jani.expressions import Expression, Integer, LValue
from roaml.jani.operators import BinaryOperator
from roaml.scxml.names import length_name
from roaml.to_jani.shapes import ArrayShape
from roaml.to_jani.values import JaniScope, Listed, Stored, at, elements_as, lengths_as

Write = tuple[LValue, Expression]


def assigned(location: Expr, value: Expr, scope: JaniScope) -> list[Write]:
    """The simultaneous assignments for `location := value`."""
    if isinstance(location, Member) and location.name == "length":
        array = scope.stored(location.object)
        if array is not None and array.dimensions > 0:
            return [(_lvalue(array.lengths(1)), scope.scalar(value))]
    target = scope.stored(location)
    if target is None:
        raise AssertionError("a rule reports an assignment to an unknown variable")
    return [*_content(target, value, scope), *_grown(target)]


def stored_in(variable: str, shape: ArrayShape, value: Expr, scope: JaniScope) -> list[Write]:
    """The assignments that store a value in a whole variable."""
    return list(_content(Stored(variable, shape), value, scope))


def _content(target: Stored, value: Expr, scope: JaniScope) -> Iterator[Write]:
    part = ArrayShape(target.shape.base, target.shape.capacities[len(target.indexes) :])
    if target.dimensions == 0:
        yield _lvalue(target.value), scope.scalar(value)
        return
    array = scope.array(value) or Listed(())
    yield _lvalue(target.value), elements_as(array, part)
    for dimension in range(1, target.dimensions + 1):
        yield _lvalue(target.lengths(dimension)), lengths_as(array, part, dimension)


def _grown(target: Stored) -> Iterator[Write]:
    """The assignments that increase the lengths of an array, and of all enclosing arrays, so that they contain the
    element `target`."""
    for depth in reversed(range(len(target.indexes))):
        length = at(jani.Name(length_name(target.variable, depth + 1)), *target.indexes[:depth])
        needed = jani.Binary(BinaryOperator.ADD, target.indexes[depth], Integer(1))
        yield _lvalue(length), jani.Binary(BinaryOperator.MAXIMUM, needed, length)


def _lvalue(expression: Expression) -> LValue:
    assert isinstance(expression, (jani.Name, jani.ArrayAccess))
    return expression

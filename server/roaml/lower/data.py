# SPDX-License-Identifier: Apache-2.0
"""Translates variables of HL-SCXML to plain SCXML: a struct becomes one variable for each leaf
(docs/spec/plain-scxml.md#flattening).

In initial values, `1.0` remains a real number (docs/spec/expressions.md#whole-reals).
"""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr.tree import ArrayLiteral, Expr, Number, ObjectLiteral, Unary
from roaml.expr.types import Array, ScalarKind, Struct, Type, is_kind, leaves, unwrap
from roaml.expr.zero import zero
from roaml.lower.expressions import SEPARATOR, Path
from roaml.record import replace
from roaml.scxml.model import Data
from roaml.text import Location


def lower_data(identifier: str, type_: Type, value: Expr | None, origin: Location) -> Iterator[Data]:
    """The plain variables for one variable. If `value` is `None`, they have the default values of their types."""
    given = {} if value is None else dict(_leaf_values(type_, value))
    for path, leaf in leaves(type_):
        yield Data(SEPARATOR.join((identifier, *path)), leaf, given.get(path) or zero(leaf), origin)


def _leaf_values(type_: Type, value: Expr) -> Iterator[tuple[Path, Expr]]:
    """The paths and initial values of the leaves. A list of objects becomes one list for each leaf."""
    match type_, value:
        case Struct(), ObjectLiteral():
            for member in value.members:
                inner = type_.member(member.key)
                if inner is not None:
                    yield from (((member.key, *path), leaf) for path, leaf in _leaf_values(inner, member.value))
        case Array(), ArrayLiteral() if isinstance(unwrap(type_)[0], Struct):
            elements = [dict(_leaf_values(type_.element, element)) for element in value.elements]
            for path, leaf in leaves(type_.element):
                yield path, ArrayLiteral(value.span, tuple(e.get(path) or zero(leaf) for e in elements))
        case _:
            yield (), as_type(value, unwrap(type_)[0])


def as_type(value: Expr, element: Type) -> Expr:
    """A copy of the literal `value` in which numbers are reals if the type of the elements is real, even if they are
    written without a point (docs/spec/plain-scxml.md#initial-reals)."""
    if not is_kind(element, ScalarKind.REAL):
        return value
    match value:
        case Number():
            return replace(value, is_real=True)
        case Unary():
            return replace(value, operand=as_type(value.operand, element))
        case ArrayLiteral():
            return replace(value, elements=tuple(as_type(item, element) for item in value.elements))
    return value

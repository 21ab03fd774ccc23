# SPDX-License-Identifier: Apache-2.0
"""The neutral value of each type: the initial value of a variable without one, and the value that fixes and completions
write."""

from __future__ import annotations

from roaml.expr.format import format_expr
from roaml.expr.tree import ArrayLiteral, Boolean, Expr, Number, ObjectLiteral, ObjectMember, String
from roaml.expr.types import Array, EmptyArray, ScalarKind, Struct, Type, is_kind
from roaml.text import Span

_NOWHERE = Span(0, 0)


def zero(type_: Type) -> Expr:
    """The neutral value of a type: 0, 0.0, false, '', [], or a struct of these; 0 if the type is unknown. The spans in
    the result have no meaning."""
    if isinstance(type_, Struct):
        members = (ObjectMember(name, _NOWHERE, zero(member)) for name, member in type_.members)
        return ObjectLiteral(_NOWHERE, tuple(members))
    if isinstance(type_, (Array, EmptyArray)):
        return ArrayLiteral(_NOWHERE, ())
    if is_kind(type_, ScalarKind.BOOL):
        return Boolean(_NOWHERE, False)
    if is_kind(type_, ScalarKind.STRING):
        return String(_NOWHERE, "")
    return Number(_NOWHERE, 0, is_kind(type_, ScalarKind.REAL))


def zero_text(type_: Type) -> str:
    """The neutral value of a type, as text."""
    return format_expr(zero(type_))

# SPDX-License-Identifier: Apache-2.0
"""The value that a fix writes where one is missing: 0, or what is like it."""

from __future__ import annotations

from roaml.expr.types import Scalar, Struct, Type

_ZERO = {"int": "0", "real": "0.0", "bool": "false", "string": "''"}


def zero(type_: Type) -> str:
    """0 of a type, as an expression."""
    if isinstance(type_, Struct):
        return "{" + ", ".join(f"'{name}': {zero(member)}" for name, member in type_.members) + "}"
    return _ZERO[type_.kind] if isinstance(type_, Scalar) else "[]"

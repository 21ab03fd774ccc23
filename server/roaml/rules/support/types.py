# SPDX-License-Identifier: Apache-2.0
"""Phrases for types in messages."""

from __future__ import annotations

from roaml.expr.types import Array, EmptyArray, ScalarKind, Struct, Type, Unknown, is_kind


def phrase(type_: Type) -> str:
    """A noun phrase for a type, with its article, such as "an array (`int8[3]`)"."""
    if is_kind(type_, ScalarKind.STRING):
        return "a string"
    if isinstance(type_, EmptyArray):
        return "an array"
    if isinstance(type_, Array):
        return f"an array (`{type_}`)"
    if isinstance(type_, Struct):
        return (
            f"`{type_}`" if type_.name not in ("", "object") else f"an {type_}" if type_.name else f"the {type_.what}"
        )
    if isinstance(type_, Unknown):
        return "this"
    kinds: dict[object, str] = {
        ScalarKind.INT: "an integer",
        ScalarKind.REAL: "a real number",
        ScalarKind.BOOL: "a boolean",
    }
    name = f" (`{type_}`)" if getattr(type_, "name", "") not in ("", "bool") else ""
    return kinds.get(getattr(type_, "kind", None), f"`{type_}`") + name

# SPDX-License-Identifier: Apache-2.0
"""The types of JANI and their compatibility."""

from __future__ import annotations

import enum
from typing import TypeAlias

from roaml.exhaustive import assert_never
from roaml.jani.expressions import Expression
from roaml.record import PartlyCompared, Record


class BasicType(enum.Enum):
    BOOL = "bool"
    INT = "int"
    REAL = "real"
    CLOCK = "clock"
    CONTINUOUS = "continuous"


class BoundedType(Record, frozen=True):
    """A number with bounds. `base` is int or real; a bound that is `None` does not exist."""

    base: BasicType
    lower: Expression | None = None
    upper: Expression | None = None


class ArrayType(PartlyCompared, frozen=True):
    """An array. `is_text` marks the bytes of a string in UTF-8: JANI has no strings, so equality ignores the mark, and
    a JANI file does not contain it."""

    UNCOMPARED = frozenset({"is_text"})

    element: Type
    is_text: bool = False


class DatatypeType(Record, frozen=True):
    """The datatype that the model declares with the name `name`."""

    name: str


class OptionType(Record, frozen=True):
    """An option: a value of type `content`, or no value."""

    content: Type


class UnknownType(Record, frozen=True):
    """The type of an expression with a reported error, or with several possible types. It fits every type."""


Type: TypeAlias = BasicType | BoundedType | ArrayType | DatatypeType | OptionType | UnknownType

BOOL = BasicType.BOOL
INT = BasicType.INT
REAL = BasicType.REAL
UNKNOWN = UnknownType()


def value_type(type_: Type) -> Type:
    """The type of the values of a variable of type `type_`: the type without its bounds; real for clocks and continuous
    variables."""
    if isinstance(type_, BoundedType):
        return type_.base
    return REAL if type_ in (BasicType.CLOCK, BasicType.CONTINUOUS) else type_


def fits(type_: Type, target: Type) -> bool:
    """Whether a value of type `type_` may be stored in a variable of type `target`. An int fits a real; there is no
    other conversion."""
    while type_ is not target:
        type_, target = value_type(type_), value_type(target)
        match type_, target:
            case (UnknownType(), _) | (_, UnknownType()):
                return True
            case ArrayType(inner), ArrayType(inner_target):
                type_, target = inner, inner_target
            case OptionType(inner), OptionType(inner_target):
                type_, target = inner, inner_target
            case BasicType.INT, BasicType.REAL:
                return True
            case _:
                return type_ == target
    return True


def join(left: Type, right: Type) -> Type | None:
    """The smallest type that contains the values of both types; `None` if there is none."""
    if left is right:
        return value_type(left)  # fast path: the elements of long arrays share one type
    left, right = value_type(left), value_type(right)
    if isinstance(left, UnknownType) or isinstance(right, UnknownType):
        return UNKNOWN
    if fits(left, right):
        return right
    return left if fits(right, left) else None


def element_of(type_: Type) -> Type:
    """The type of the elements of an array; `UNKNOWN` for another type."""
    return type_.element if isinstance(type_, ArrayType) else UNKNOWN


def is_text(type_: Type) -> bool:
    """Whether the values of a type are marked as strings."""
    return isinstance(type_, ArrayType) and type_.is_text


def is_number(type_: Type) -> bool:
    return value_type(type_) in (INT, REAL, UNKNOWN)


def describe(type_: Type) -> str:
    """A phrase for the type, with its article: `an int`, `an array of real`."""
    prefix = ""
    while True:
        match type_:
            case ArrayType():
                prefix, type_ = prefix + ("array of " if prefix else "an array of "), type_.element
            case OptionType():
                prefix, type_ = prefix + ("option of " if prefix else "an option of "), type_.content
            case BasicType():
                break
            case BoundedType():
                type_ = type_.base
            case DatatypeType(name):
                return f"{prefix}`{name}`" if prefix else f"a `{name}`"
            case UnknownType():
                return f"{prefix}something"
            case _:
                assert_never(type_)
    if prefix:
        return prefix + type_.value
    return f"an {type_.value}" if type_ is INT else f"a {type_.value}"

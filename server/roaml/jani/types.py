# SPDX-License-Identifier: Apache-2.0
"""The types of JANI and their compatibility."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import TypeAlias

from roaml.exhaustive import assert_never
from roaml.jani.expressions import Expression


class BasicType(enum.Enum):
    BOOL = "bool"
    INT = "int"
    REAL = "real"
    CLOCK = "clock"
    CONTINUOUS = "continuous"


@dataclass(frozen=True, slots=True)
class BoundedType:
    """`base` is int or real; `None` is no bound."""

    base: BasicType
    lower: Expression | None = None
    upper: Expression | None = None


@dataclass(frozen=True, slots=True)
class ArrayType:
    element: Type


@dataclass(frozen=True, slots=True)
class DatatypeType:
    """A datatype that the model declares under this name."""

    name: str


@dataclass(frozen=True, slots=True)
class OptionType:
    """A value of type `content`, or no value."""

    content: Type


@dataclass(frozen=True, slots=True)
class UnknownType:
    """The type of something that is already reported, or that has several types: fits everywhere."""


Type: TypeAlias = BasicType | BoundedType | ArrayType | DatatypeType | OptionType | UnknownType

BOOL = BasicType.BOOL
INT = BasicType.INT
REAL = BasicType.REAL
UNKNOWN = UnknownType()


def value_type(type_: Type) -> Type:
    """The type of the values of a variable of `type_`: without bounds; those of clocks are reals."""
    if isinstance(type_, BoundedType):
        return type_.base
    return REAL if type_ in (BasicType.CLOCK, BasicType.CONTINUOUS) else type_


def fits(type_: Type, target: Type) -> bool:
    """Whether a value of `type_` may be stored where `target` is declared. An int fits a real; nothing else
    converts."""
    while True:
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


def join(left: Type, right: Type) -> Type | None:
    """The smallest type that contains the values of both; `None` if there is none."""
    if left is right:
        return value_type(left)  # the case of elements of long arrays
    left, right = value_type(left), value_type(right)
    if isinstance(left, UnknownType) or isinstance(right, UnknownType):
        return UNKNOWN
    if fits(left, right):
        return right
    return left if fits(right, left) else None


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

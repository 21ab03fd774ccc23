# SPDX-License-Identifier: Apache-2.0
"""The size of the translation of a system, and its largest contributions. `roaml.lower.size` computes it in advance."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from roaml.diagnostics import Symbol
from roaml.expr.types import Array, EmptyArray, ScalarKind, Struct, Type, is_kind

MAX_CELLS = 1_000_000
"""The default maximum number of cells of a system (`max-cells`)."""

MAX_PARTS = 3_000_000
"""The default maximum number of parts of a system (`max-parts`)."""


@dataclass(frozen=True, slots=True)
class Share:
    """The contribution of one part of the models to a size.

    Attributes:
        count: the number of cells or parts.
        words: a phrase for the part.
        path: the file of the part; "" if it is in no file.
        symbol: the declaration of the part, if it has a name.
    """

    count: int
    words: str
    path: str
    symbol: Symbol | None = None


@dataclass(frozen=True, slots=True)
class Size:
    """The size of a translated system.

    Attributes:
        cells: values that its variables hold: one for a number or Boolean, one for each element of an array or
            character of a string, and their lengths.
        parts: edges, destinations, participants of synchronisations and nodes of expressions, except those of initial
            values.
    """

    cells: tuple[Share, ...]
    parts: tuple[Share, ...]


@dataclass(frozen=True, slots=True)
class Limits:
    """The maximum sizes of a system that is translated."""

    cells: int = MAX_CELLS
    parts: int = MAX_PARTS


DEFAULT_LIMITS = Limits()


def cells_of(type_: Type, max_array_size: int, sent: bool = False) -> int:
    """The cells of a variable of a type; see `roaml.to_jani.shapes.shape_of`.

    Args:
        sent: whether it is a parameter of an event, in which all arrays have `max_array_size` elements.
    """
    return _cells(type_, max_array_size, sent, 1, 0)


def _cells(type_: Type, most: int, sent: bool, rows: int, lengths: int) -> int:
    """
    Args:
        rows: the product of the bounds of the enclosing arrays.
        lengths: the cells of the lengths of the enclosing arrays; each leaf has its own lengths.
    """
    while isinstance(type_, Array):
        lengths += rows
        rows *= most if sent or type_.bound is None else type_.bound
        type_ = type_.element
    if isinstance(type_, Struct):
        return sum(_cells(member, most, sent, rows, lengths) for _, member in type_.members)
    if isinstance(type_, EmptyArray) or is_kind(type_, ScalarKind.STRING):
        return lengths + rows + rows * most
    return lengths + rows


def total(shares: Iterable[Share]) -> int:
    return sum(share.count for share in shares)

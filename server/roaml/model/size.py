# SPDX-License-Identifier: Apache-2.0
"""The size of the translation of a system, and the parts of the models that contribute to it. `roaml.lower.size`
computes the size before the translation."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.diagnostics import Symbol
from roaml.expr.types import Array, EmptyArray, ScalarKind, Struct, Type, is_kind
from roaml.record import Record

MAX_CELLS = 1_000_000
"""The default maximum number of cells of a system (`max-cells`)."""

MAX_PARTS = 3_000_000
"""The default maximum number of parts of a system (`max-parts`)."""


class Share(Record, frozen=True):
    """The contribution of one part of the models to a size.

    Attributes:
        count: the number of cells or parts.
        words: a phrase that names the part in a message.
        path: the file of the part; "" if it is not in a file.
        symbol: the declaration of the part; `None` if it has no name.
    """

    count: int
    words: str
    path: str
    symbol: Symbol | None = None


class Size(Record, frozen=True):
    """The size of a translated system.

    Attributes:
        cells: the number of values that its variables store: one for a number or Boolean, one for each element of an
            array, one for each character of a string, and one for each length.
        parts: the number of edges, destinations, participants of synchronisations, and nodes of expressions other than
            initial values.
    """

    cells: tuple[Share, ...]
    parts: tuple[Share, ...]


class Limits(Record, frozen=True):
    """The maximum size of a system that is translated."""

    cells: int = MAX_CELLS
    parts: int = MAX_PARTS


DEFAULT_LIMITS = Limits()


def cells_of(type_: Type, max_array_size: int, sent: bool = False) -> int:
    """The number of cells of a variable of a type; see `roaml.to_jani.shapes.shape_of`.

    Args:
        sent: whether the variable is a parameter of an event: then all its arrays have `max_array_size` elements.
    """
    return _cells(type_, max_array_size, sent, 1, 0)


def _cells(type_: Type, most: int, sent: bool, rows: int, lengths: int) -> int:
    """The number of cells of a type inside arrays.

    Args:
        most: the number of elements of an array without a bound, and of characters of a string.
        rows: the product of the bounds of the enclosing arrays.
        lengths: the number of cells for the lengths of the enclosing arrays; each leaf has its own lengths.
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

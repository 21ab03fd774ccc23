# SPDX-License-Identifier: Apache-2.0
"""The storage of values: scalars unchanged, strings and arrays with fixed capacities and separate lengths.

An array `a` of n dimensions has the companions `a.d1_len`, an int, ..., `a.dn_len`, an array of n - 1 dimensions: its
element i is the length of row i (docs/spec/jani.md#array-storage).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from roaml.expr.types import Array, EmptyArray, Scalar, ScalarKind, Type, is_kind, unwrap
from roaml.jani.expressions import ArrayConstructor, ArrayValue, Boolean, Expression, Integer, Real
from roaml.jani.types import BOOL, INT, REAL, ArrayType, BasicType
from roaml.jani.types import Type as JaniType

_KINDS = {ScalarKind.BOOL: BOOL, ScalarKind.INT: INT, ScalarKind.REAL: REAL, ScalarKind.STRING: INT}
_ZEROS: dict[BasicType, Expression] = {BOOL: Boolean(False), INT: Integer(0), REAL: Real(0.0)}
_ITERATOR = "__array_iterator_dim_"


@dataclass(frozen=True, slots=True)
class ArrayShape:
    """`capacities` are the maximum numbers of elements in each dimension, outermost first; empty for scalars."""

    base: BasicType
    capacities: tuple[int, ...] = ()

    @property
    def dimensions(self) -> int:
        return len(self.capacities)

    @property
    def element(self) -> ArrayShape:
        """The shape of an element of the outermost dimension."""
        return ArrayShape(self.base, self.capacities[1:])

    def lengths(self, array: str) -> Iterator[tuple[str, ArrayShape]]:
        """The companion variables of an array of this shape with their shapes."""
        for k in range(self.dimensions):
            yield length_name(array, k + 1), ArrayShape(INT, self.capacities[:k])


SCALAR_INT = ArrayShape(INT)


def length_name(array: str, dimension: int) -> str:
    return f"{array}.d{dimension}_len"


def shape_of(type_: Type, max_array_size: int, sent: bool = False) -> ArrayShape:
    """The shape of a variable. A parameter of an event has the capacity `max_array_size` in every dimension
    (docs/spec/jani.md#global-variables)."""
    element, bounds = unwrap(type_)
    if isinstance(element, EmptyArray) or is_kind(element, ScalarKind.STRING):
        bounds = (*bounds, None)
    capacities = tuple(max_array_size if sent or bound is None else bound for bound in bounds)
    return ArrayShape(_KINDS[element.kind] if isinstance(element, Scalar) else INT, capacities)


def jani_type(shape: ArrayShape) -> JaniType:
    type_: JaniType = shape.base
    for _ in shape.capacities:
        type_ = ArrayType(type_)
    return type_


def zero(shape: ArrayShape) -> Expression:
    """The value of a variable before anything is stored in it."""
    value = _ZEROS[shape.base]
    for capacity in reversed(shape.capacities):
        value = ArrayValue((value,) * capacity)
    return value


def constructed_zero(shape: ArrayShape) -> Expression:
    """The zero of a shape, written with array constructors, so that its size does not grow with the capacities."""
    value = _ZEROS[shape.base]
    for k in range(shape.dimensions, 0, -1):
        value = ArrayConstructor(f"{_ITERATOR}{k}", Integer(shape.capacities[k - 1]), value)
    return value


def is_array(type_: Type) -> bool:
    return isinstance(type_, (Array, EmptyArray)) or is_kind(type_, ScalarKind.STRING)

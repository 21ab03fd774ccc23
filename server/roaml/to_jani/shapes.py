# SPDX-License-Identifier: Apache-2.0
"""The storage of values in JANI. A scalar is one variable. A string or array has a fixed capacity, and separate
variables for its lengths.

An array `a` of n dimensions has the companion variables `a.d1_len` to `a.dn_len`. `a.d1_len` is an int; `a.dk_len` is
an array of k - 1 dimensions with the lengths of the rows in dimension k (docs/spec/jani.md#array-storage).
"""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr.types import Array, EmptyArray, Scalar, ScalarKind, Type, is_kind, unwrap
from roaml.jani.expressions import ArrayConstructor, ArrayValue, Boolean, Expression, Integer, Real
from roaml.jani.types import BOOL, INT, REAL, ArrayType, BasicType
from roaml.jani.types import Type as JaniType
from roaml.record import Record
from roaml.scxml.names import length_name

_KINDS = {ScalarKind.BOOL: BOOL, ScalarKind.INT: INT, ScalarKind.REAL: REAL, ScalarKind.STRING: INT}
_ZEROS: dict[BasicType, Expression] = {BOOL: Boolean(False), INT: Integer(0), REAL: Real(0.0)}
_ITERATOR = "__array_iterator_dim_"


class ArrayShape(Record, frozen=True):
    """The shape of a variable. `capacities` contains the maximum number of elements in each dimension, the outermost
    first; it is empty for a scalar. `is_text` states whether the innermost dimension contains the bytes of strings."""

    base: BasicType
    capacities: tuple[int, ...] = ()
    is_text: bool = False

    @property
    def dimensions(self) -> int:
        return len(self.capacities)

    @property
    def element(self) -> ArrayShape:
        """The shape of an element of the outermost dimension."""
        return ArrayShape(self.base, self.capacities[1:], self.is_text and self.dimensions > 1)

    def lengths(self, array: str) -> Iterator[tuple[str, ArrayShape]]:
        """The names and shapes of the companion variables of `array`, an array of this shape."""
        for k in range(self.dimensions):
            yield length_name(array, k + 1), ArrayShape(INT, self.capacities[:k])


SCALAR_INT = ArrayShape(INT)


def shape_of(type_: Type, max_array_size: int, sent: bool = False) -> ArrayShape:
    """The shape of a variable of type `type_`. If it is a parameter of an event (`sent`), it has the capacity
    `max_array_size` in every dimension (docs/spec/jani.md#global-variables)."""
    element, bounds = unwrap(type_)
    is_text = is_kind(element, ScalarKind.STRING)
    if is_text or isinstance(element, EmptyArray):
        bounds = (*bounds, None)
    capacities = tuple(max_array_size if sent or bound is None else bound for bound in bounds)
    return ArrayShape(_KINDS[element.kind] if isinstance(element, Scalar) else INT, capacities, is_text)


def jani_type(shape: ArrayShape) -> JaniType:
    type_: JaniType = shape.base
    for dimension in range(shape.dimensions):
        type_ = ArrayType(type_, is_text=shape.is_text and dimension == 0)
    return type_


def zero(shape: ArrayShape) -> Expression:
    """The value that a variable of this shape has before its first assignment."""
    value = _ZEROS[shape.base]
    for capacity in reversed(shape.capacities):
        value = ArrayValue((value,) * capacity)
    return value


def constructed_zero(shape: ArrayShape) -> Expression:
    """The value of `zero`, written with array constructors, so that the size of the expression does not depend on the
    capacities."""
    value = _ZEROS[shape.base]
    for k in range(shape.dimensions, 0, -1):
        value = ArrayConstructor(f"{_ITERATOR}{k}", Integer(shape.capacities[k - 1]), value)
    return value


def is_array(type_: Type) -> bool:
    return isinstance(type_, (Array, EmptyArray)) or is_kind(type_, ScalarKind.STRING)

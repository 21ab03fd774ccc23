# SPDX-License-Identifier: Apache-2.0
"""The kind and the shape of the value of an expression, determined before any code for it is written.

A kind is `bool`, `int` or `real`; the kind of an array is that of its elements. A shape contains the lengths of an
array in all dimensions; it is () for a scalar.
"""

from __future__ import annotations

from roaml.jani.expressions import (
    ArrayAccess,
    ArrayConstructor,
    ArrayValue,
    Binary,
    Boolean,
    Call,
    Conditional,
    Expression,
    Integer,
    Name,
    NamedNumber,
    Real,
    Unary,
)
from roaml.jani.operators import BinaryOperator, Signature
from roaml.jani.semantics import EvaluationError, Value, evaluate
from roaml.jani.types import ArrayType, BasicType, BoundedType, Type
from roaml.smc.fault import FaultError
from roaml.smc.names import Meaning, StorageNames, unsupported
from roaml.smc.registers import BOOL, INT, REAL, Number, Operand, Region

MAX_ELEMENTS = 1_000_000
"""The maximum number of elements that one array constructor creates in its dimension."""
_ARITHMETIC = (
    BinaryOperator.ADD,
    BinaryOperator.SUBTRACT,
    BinaryOperator.MULTIPLY,
    BinaryOperator.MINIMUM,
    BinaryOperator.MAXIMUM,
)


# ------------------------------------------------------------------- expressions


def kind(node: Expression, names: StorageNames) -> str:
    """The kind of a scalar, or of the elements of an array."""
    match node:
        case Integer():
            return INT
        case Boolean():
            return BOOL
        case Real() | NamedNumber():
            return REAL
        case Name():
            return names.meaning(node).kind
        case Unary(op, operand):
            if op.signature is Signature.LOGICAL:
                return BOOL
            if op.signature is Signature.ROUNDING:
                return INT
            return REAL if op.signature is Signature.REAL else kind(operand, names)
        case Binary(op, left, right):
            if op.signature in (Signature.LOGICAL, Signature.EQUALITY, Signature.ORDER):
                return BOOL
            if op.signature is Signature.REAL:
                return REAL
            if op is BinaryOperator.POWER and not (isinstance(right, Integer) and right.value >= 0):
                return REAL
            first: Expression = node
            while isinstance(first, Binary) and first.operator in _ARITHMETIC:
                if kind(first.right, names) == REAL:
                    return REAL
                first = first.left
            if first is not node:
                return REAL if kind(first, names) == REAL else INT
            return REAL if REAL in (kind(left, names), kind(right, names)) else INT
        case Conditional(_, then, otherwise):
            kinds = (kind(then, names), kind(otherwise, names))
            return REAL if REAL in kinds else kinds[0]
        case ArrayAccess(array, _):
            return kind(array, names)
        case ArrayValue(elements):
            inside = {kind(element, names) for element in elements}
            return REAL if REAL in inside else min(inside, default=INT)
        case ArrayConstructor(variable, _, body):
            return kind(body, names.bound({variable: Operand(INT, -1)}))
        case Call():
            return kind_of(names.called(node).type)
        case _:
            raise FaultError(unsupported(node), node.origin)


def shape(node: Expression, names: StorageNames) -> tuple[int, ...]:
    """The lengths of an array in all dimensions; () for a scalar."""
    match node:
        case Name():
            meaning = names.meaning(node)
            return () if isinstance(meaning, Operand) else meaning.shape
        case ArrayAccess(array, _):
            return shape(array, names)[1:]
        case ArrayValue(elements):
            inner: tuple[int, ...] = ()
            for element in elements:
                inner = larger(inner, shape(element, names))
            return (len(elements), *inner)
        case ArrayConstructor(variable, _, body):
            return (length(node, names), *shape(body, names.bound({variable: Operand(INT, -1, 0)})))
        case Conditional(_, then, otherwise):
            return larger(shape(then, names), shape(otherwise, names))
        case Call():
            function = names.called(node)
            if not isinstance(function.type, ArrayType):
                return ()
            bound = {
                parameter.name: _argument(argument, parameter.type, names)
                for parameter, argument in zip(function.parameters, node.arguments, strict=True)
            }
            return shape(function.body, names.inside(function, bound))
        case _:
            return ()


def _argument(node: Expression, type_: Type, names: StorageNames) -> Meaning:
    """A placeholder for an argument, for use where only shapes are needed."""
    if isinstance(type_, ArrayType):
        return Region(kind_of(type_), shape(node, names), -1)
    return Operand(kind_of(type_), -1, known(node, names))


def length(node: ArrayConstructor, names: StorageNames) -> int:
    """The number of elements of an array constructor."""
    try:
        size = evaluate(node.length, names.constants(), names.functions)
    except EvaluationError as error:
        raise FaultError("the length of an array must not depend on the state", error.origin or node.origin) from None
    if not isinstance(size, int) or not 0 <= size <= MAX_ELEMENTS:
        raise FaultError(
            f"an array cannot have {size} elements; from 0 to {MAX_ELEMENTS:,} are supported", node.length.origin
        )
    return size


def known(node: Expression, names: StorageNames) -> Number | None:
    """The value of a literal, or of a name that has a known value; `None` for other expressions."""
    match node:
        case Integer() | Real() | Boolean():
            return node.value
        case NamedNumber():
            return node.constant.number
        case Name(identifier):
            meaning = names.values.get(identifier)
            return meaning.value if isinstance(meaning, Operand) else None
        case _:
            return None


# -------------------------------------------------------------- types and values


def kind_of(type_: Type) -> str:
    """The kind of the values of a type; for an array type, of its elements.

    Raises:
        FaultError: values of this type are not supported.
    """
    while isinstance(type_, ArrayType):
        type_ = type_.element
    if isinstance(type_, BoundedType):
        type_ = type_.base
    kinds = {BasicType.BOOL: BOOL, BasicType.INT: INT, BasicType.REAL: REAL}
    if isinstance(type_, BasicType) and type_ in kinds:
        return kinds[type_]
    raise FaultError("only the types `bool`, `int` and `real`, and arrays of these, are supported")


def shape_of(value: Value) -> tuple[int, ...]:
    """The shape of a value."""
    if not isinstance(value, tuple):
        return ()
    inner: tuple[int, ...] = ()
    for element in value:
        inner = larger(inner, shape_of(element))
    return (len(value), *inner)


def larger(first: tuple[int, ...], second: tuple[int, ...]) -> tuple[int, ...]:
    """The smallest shape that contains both shapes."""
    if len(first) != len(second):
        return first if len(first) > len(second) else second
    return tuple(map(max, first, second))

# SPDX-License-Identifier: Apache-2.0
"""Translates expressions of plain SCXML to JANI (docs/spec/jani.md#values).

- A string is an array of its UTF-8 bytes. An array (`ArrayForm`) is several JANI values: its elements and its lengths.
- `-x` becomes `0 - x`. Expressions are not simplified.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from roaml.expr.operators import Operator, OperatorKind, UnaryOperator
from roaml.expr.tree import (
    ArrayLiteral,
    Binary,
    Boolean,
    Call,
    Conditional,
    Expr,
    Index,
    Member,
    Name,
    Number,
    String,
    Unary,
)
from roaml.jani import expressions as jani
from roaml.jani.expressions import ArrayAccess, ArrayValue, Expression, Integer, Real
from roaml.jani.operators import BinaryOperator, NumberConstant
from roaml.jani.operators import UnaryOperator as JaniUnary
from roaml.jani.types import REAL
from roaml.record import Record
from roaml.scxml.names import length_name
from roaml.to_jani.shapes import SCALAR_INT, ArrayShape, zero

BINARY_OPERATORS = {
    Operator.OR: BinaryOperator.OR,
    Operator.AND: BinaryOperator.AND,
    Operator.EQUAL: BinaryOperator.EQUAL,
    Operator.NOT_EQUAL: BinaryOperator.NOT_EQUAL,
    Operator.LESS: BinaryOperator.LESS,
    Operator.LESS_EQUAL: BinaryOperator.LESS_EQUAL,
    Operator.GREATER: BinaryOperator.GREATER,
    Operator.GREATER_EQUAL: BinaryOperator.GREATER_EQUAL,
    Operator.ADD: BinaryOperator.ADD,
    Operator.SUBTRACT: BinaryOperator.SUBTRACT,
    Operator.MULTIPLY: BinaryOperator.MULTIPLY,
    Operator.DIVIDE: BinaryOperator.DIVIDE,
    Operator.REMAINDER: BinaryOperator.REMAINDER,
}
_UNARY_FUNCTIONS = {
    "abs": JaniUnary.ABS,
    "ceil": JaniUnary.CEIL,
    "cos": JaniUnary.COS,
    "floor": JaniUnary.FLOOR,
    "sin": JaniUnary.SIN,
}
_BINARY_FUNCTIONS = {
    "log": BinaryOperator.LOGARITHM,
    "max": BinaryOperator.MAXIMUM,
    "min": BinaryOperator.MINIMUM,
    "pow": BinaryOperator.POWER,
}

ZERO = Integer(0)
TRUE = jani.Boolean(True)


def both(left: Expression | None, right: Expression) -> Expression:
    return right if left is None else jani.Binary(BinaryOperator.AND, left, right)


_MAX_OPERANDS_IN_A_ROW = 100


def all_of(terms: Sequence[Expression]) -> Expression | None:
    """The conjunction of the terms; `None` if there are none. Many terms are combined as a balanced tree, because
    readers of JSON, including the one of this library, limit the nesting of brackets."""
    if len(terms) > _MAX_OPERANDS_IN_A_ROW:
        middle = len(terms) // 2
        first, second = all_of(terms[:middle]), all_of(terms[middle:])
        assert second is not None
        return both(first, second)
    result: Expression | None = None
    for term in terms:
        result = both(result, term)
    return result


def negated(expression: Expression) -> Expression:
    return jani.Unary(JaniUnary.NOT, expression)


def equal(left: Expression, right: Expression) -> Expression:
    return jani.Binary(BinaryOperator.EQUAL, left, right)


def at(array: Expression, *indexes: Expression) -> Expression:
    for index in indexes:
        array = ArrayAccess(array, index)
    return array


# -------------------------------------------------------------------- arrays


class Stored(Record, frozen=True):
    """An array that is stored in a variable, or the element of it at `indexes`."""

    variable: str
    shape: ArrayShape
    indexes: tuple[Expression, ...] = ()

    @property
    def dimensions(self) -> int:
        return self.shape.dimensions - len(self.indexes)

    @property
    def value(self) -> Expression:
        return at(jani.Name(self.variable), *self.indexes)

    def lengths(self, dimension: int) -> Expression:
        """The length of this array in the dimension `dimension`, which begins at 1."""
        return at(jani.Name(length_name(self.variable, len(self.indexes) + dimension)), *self.indexes)

    def element(self, index: Expression) -> Stored:
        return Stored(self.variable, self.shape, (*self.indexes, index))


class Listed(Record, frozen=True):
    """An array literal. Its elements are scalars or, if it has several dimensions, array literals."""

    elements: tuple[Expression | Listed, ...]


class Chosen(Record, frozen=True):
    """One of two arrays, depending on a condition."""

    test: Expression
    then: ArrayForm
    otherwise: ArrayForm


ArrayForm: TypeAlias = Stored | Listed | Chosen


def length_of(array: ArrayForm) -> Expression:
    match array:
        case Stored():
            return array.lengths(1)
        case Listed():
            return Integer(len(array.elements))
        case Chosen():
            return jani.Conditional(array.test, length_of(array.then), length_of(array.otherwise))


def elements_as(array: ArrayForm, shape: ArrayShape) -> Expression:
    """The elements of an array as a JANI value. Literals are padded with zeros to the capacities of `shape`
    (docs/spec/jani.md#assignments)."""
    match array:
        case Stored():
            return array.value
        case Chosen():
            return jani.Conditional(array.test, elements_as(array.then, shape), elements_as(array.otherwise, shape))
        case Listed():
            inner = shape.element
            elements = [
                elements_as(element, inner) if isinstance(element, Listed) else as_base(element, shape)
                for element in array.elements
            ]
            missing = max(0, shape.capacities[0] - len(elements)) if shape.capacities else 0
            return ArrayValue((*elements, *(zero(inner),) * missing))


def lengths_as(array: ArrayForm, shape: ArrayShape, dimension: int) -> Expression:
    """The lengths of an array as a JANI value: the value of the companion variable `dk_len`, with k = `dimension`, of a
    variable of shape `shape` that stores the array."""
    match array:
        case Stored():
            return array.lengths(dimension)
        case Chosen():
            then, otherwise = (lengths_as(branch, shape, dimension) for branch in (array.then, array.otherwise))
            return jani.Conditional(array.test, then, otherwise)
        case Listed():
            if dimension == 1:
                return Integer(len(array.elements))
            rows = [
                lengths_as(element, shape.element, dimension - 1)
                for element in array.elements
                if isinstance(element, Listed)
            ]
            empty = zero(ArrayShape(SCALAR_INT.base, shape.capacities[1 : dimension - 1]))
            missing = max(0, shape.capacities[0] - len(rows))
            return ArrayValue((*rows, *(empty,) * missing))


def as_base(value: Expression, shape: ArrayShape) -> Expression:
    """A literal in the form in which it is stored: an int literal becomes a real in an array of reals
    (docs/spec/jani.md#values)."""
    if shape.base is not REAL:
        return value
    match value:
        case Integer(number):
            return Real(float(number))
        case jani.Binary(BinaryOperator.SUBTRACT, Integer(0), right):
            return jani.Binary(BinaryOperator.SUBTRACT, Real(0.0), as_base(right, shape))
    return value


# --------------------------------------------------------------- expressions


class JaniScope(Record, frozen=True):
    """The names that expressions in one place can use.

    Attributes:
        variables: name of a variable -> its shape.
        event: the name of the event to which `_event.data` refers; "" if there is none.
        params: parameter of this event -> its shape.
        empty: the parameters of which only `[]` is sent, so that their shape may differ from that of other arrays.
    """

    variables: Mapping[str, ArrayShape]
    event: str
    params: Mapping[str, ArrayShape]
    empty: frozenset[str] = frozenset()

    def stored(self, expr: Expr) -> Stored | None:
        """The variable or parameter to which `expr` refers, with the indexes; `None` for other expressions.

        A parameter that is never sent has no variable.
        """
        indexes: list[Expression] = []
        while isinstance(expr, Index):
            indexes.append(self.scalar(expr.index))
            expr = expr.object
        indexes.reverse()
        match expr:
            case Name(name=name) if name in self.variables:
                return Stored(name, self.variables[name], tuple(indexes))
            case Member(object=Member(object=Name(name="_event"), name="data"), name=param) if param in self.params:
                return Stored(f"{self.event}__{param}", self.params[param], tuple(indexes))
        return None

    def array(self, expr: Expr) -> ArrayForm | None:
        """The array that is the value of `expr`; `None` if the value is a scalar."""
        match expr:
            case String():
                return Listed(tuple(Integer(byte) for byte in expr.value.encode("utf-8", "surrogatepass")))
            case ArrayLiteral():
                return Listed(tuple(self.element(element) for element in expr.elements))
            case Conditional():
                then, otherwise = self.array(expr.then), self.array(expr.otherwise)
                if then is None or otherwise is None:
                    return None
                return Chosen(self.scalar(expr.test), then, otherwise)
            case Member(object=Member(object=Name(name="_event"), name="data"), name=param) if param in self.empty:
                return Listed(())
            case Name() | Member() | Index():
                stored = self.stored(expr)
                if stored is not None and stored.dimensions > 0:
                    return stored
                if stored is None and isinstance(expr, Index):
                    return self.part(expr)
        return None

    def part(self, expr: Index) -> ArrayForm | None:
        """The row of an array literal at a literal index; `None` for other expressions."""
        array = self.array(expr.object)
        if isinstance(array, Listed) and isinstance(expr.index, Number):
            row = array.elements[int(expr.index.value)] if expr.index.value < len(array.elements) else None
            return row if isinstance(row, Listed) else None
        return None

    def element(self, expr: Expr) -> Expression | Listed:
        """The JANI form of `expr`, an element of an array literal. A negative number becomes a negative literal
        (docs/spec/jani.md#values)."""
        array = self.array(expr)
        if isinstance(array, Listed):
            return array
        match expr:
            case Unary(operator=UnaryOperator.NEGATE, operand=Number() as number):
                return Real(-float(number.value)) if number.is_real else Integer(-int(number.value))
        return self.scalar(expr)

    def scalar(self, expr: Expr) -> Expression:
        match expr:
            case Number():
                return Integer(int(expr.value)) if expr.is_whole and not expr.is_real else Real(float(expr.value))
            case Boolean():
                return jani.Boolean(expr.value)
            case Name() | Index():
                return self.read(expr)
            case Member():
                return self.length(expr) if expr.name == "length" else self.read(expr)
            case Binary():
                return self.binary(expr)
            case Unary():
                return self.unary(expr)
            case Conditional():
                test, then, otherwise = (self.scalar(part) for part in (expr.test, expr.then, expr.otherwise))
                return jani.Conditional(test, then, otherwise)
            case Call():
                return self.call(expr)
        raise AssertionError(f"no scalar: {expr!r}")

    def read(self, expr: Expr) -> Expression:
        stored = self.stored(expr)
        if stored is not None:
            return stored.value
        if isinstance(expr, Index):
            array = self.array(expr.object)
            if array is not None:
                return at(elements_as(array, ArrayShape(SCALAR_INT.base)), self.scalar(expr.index))
        return ZERO

    def length(self, expr: Member) -> Expression:
        """The length of an array; for an object that is not an array, the value of its parameter named `length`."""
        array = self.array(expr.object)
        return self.read(expr) if array is None else length_of(array)

    def unary(self, expr: Unary) -> Expression:
        operand = self.scalar(expr.operand)
        match expr.operator:
            case UnaryOperator.NOT:
                return negated(operand)
            case UnaryOperator.NEGATE:
                return jani.Binary(BinaryOperator.SUBTRACT, ZERO, operand)
            case UnaryOperator.PLUS:
                return operand

    def binary(self, expr: Binary) -> Expression:
        if expr.operator.kind is OperatorKind.EQUALITY:
            left, right = self.array(expr.left), self.array(expr.right)
            if left is not None and right is not None:
                same = equal_arrays(left, right)
                return same if expr.operator is Operator.EQUAL else negated(same)
        return jani.Binary(BINARY_OPERATORS[expr.operator], self.scalar(expr.left), self.scalar(expr.right))

    def call(self, expr: Call) -> Expression:
        assert isinstance(expr.function, Member)
        function, arguments = expr.function.name, [self.scalar(argument) for argument in expr.arguments]
        if function in _UNARY_FUNCTIONS:
            return jani.Unary(_UNARY_FUNCTIONS[function], arguments[0])
        if function == "log" and len(arguments) == 1:
            arguments.append(jani.NamedNumber(NumberConstant.E))
        return _joined(_BINARY_FUNCTIONS[function], arguments)


def _joined(operator: BinaryOperator, operands: Sequence[Expression]) -> Expression:
    """The operands of an associative operator of two operands, as a balanced tree like that of `all_of`."""
    if len(operands) == 1:
        return operands[0]
    middle = (len(operands) + 1) // 2
    return jani.Binary(operator, _joined(operator, operands[:middle]), _joined(operator, operands[middle:]))


# --------------------------------------------------------------- comparisons


def equal_arrays(left: ArrayForm, right: ArrayForm) -> Expression:
    """The condition that two arrays have equal lengths and equal elements. It compares elements, because Storm and
    other tools do not support the equality of arrays (docs/spec/jani.md#array-equality)."""
    if isinstance(left, Chosen):
        return jani.Conditional(left.test, equal_arrays(left.then, right), equal_arrays(left.otherwise, right))
    if isinstance(right, Chosen):
        return jani.Conditional(right.test, equal_arrays(left, right.then), equal_arrays(left, right.otherwise))
    if isinstance(left, Listed) and isinstance(right, Listed):
        return _equal_literals(left, right)
    if isinstance(left, Listed):
        return _equals_literal(right, left)
    if isinstance(right, Listed):
        return _equals_literal(left, right)
    return _equal_stored(left, right)


def _equals_literal(stored: ArrayForm, literal: Listed) -> Expression:
    assert isinstance(stored, Stored)
    if len(literal.elements) > stored.shape.capacities[len(stored.indexes)]:
        return jani.Boolean(False)
    same = [equal(stored.lengths(1), Integer(len(literal.elements)))]
    for i, element in enumerate(literal.elements):
        part = stored.element(Integer(i))
        if isinstance(element, Listed):
            same.append(_equals_literal(part, element))
        else:
            same.append(equal(element, part.value))
    return _certain(same)


def _certain(terms: Sequence[Expression]) -> Expression:
    """The conjunction of at least one term."""
    result = all_of(terms)
    assert result is not None
    return result


def _equal_literals(left: Listed, right: Listed) -> Expression:
    same: list[Expression] = [jani.Boolean(len(left.elements) == len(right.elements))]
    for mine, other in zip(left.elements, right.elements, strict=False):
        if isinstance(mine, Listed) and isinstance(other, Listed):
            same.append(_equal_literals(mine, other))
        elif not isinstance(mine, Listed) and not isinstance(other, Listed):
            same.append(equal(mine, other))
    return _certain(same)


def _equal_stored(left: Stored, right: Stored) -> Expression:
    """The condition that two stored arrays are equal. Elements beyond the length are ignored."""
    same = [equal(left.lengths(1), right.lengths(1))]
    depth = len(left.indexes)
    capacity = min(left.shape.capacities[depth], right.shape.capacities[len(right.indexes)])
    for i in range(capacity):
        mine, other = left.element(Integer(i)), right.element(Integer(i))
        unused = jani.Binary(BinaryOperator.LESS_EQUAL, left.lengths(1), Integer(i))
        is_equal = _equal_stored(mine, other) if mine.dimensions > 0 else equal(mine.value, other.value)
        same.append(jani.Binary(BinaryOperator.OR, unused, is_equal))
    return _certain(same)

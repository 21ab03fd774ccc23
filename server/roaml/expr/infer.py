# SPDX-License-Identifier: Apache-2.0
"""The type of an expression, and its type errors (docs/spec/expressions.md#operators).

- The functions are pure: `Scope`, which the caller provides, resolves names.
- Problems are data (`Problem`). The rules create the messages.
- A part with a problem has the type `Unknown`, which causes no further problems.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import TypeAlias

from roaml.exact_number import remainder
from roaml.exhaustive import assert_never
from roaml.expr.operators import FUNCTIONS, FunctionResult, Operator, OperatorKind, UnaryOperator
from roaml.expr.tree import (
    ArrayLiteral,
    Binary,
    Boolean,
    Call,
    Conditional,
    ErrorExpr,
    Expr,
    Index,
    Member,
    Name,
    Number,
    ObjectLiteral,
    String,
    Unary,
)
from roaml.expr.types import (
    BOOL,
    EMPTY_ARRAY,
    INT,
    REAL,
    STRING,
    UNKNOWN,
    Array,
    EmptyArray,
    Scalar,
    ScalarKind,
    Struct,
    Type,
    Unknown,
    fits,
    is_kind,
    is_number,
    join,
    member_type,
    unwrap,
)
from roaml.record import Record
from roaml.text import Span

Scope: TypeAlias = Callable[[str], Type | None]
"""The type of a name that may begin an access path; `None` if there is no such name."""


class UnknownName(Record, frozen=True):
    span: Span
    name: str


class UnknownMember(Record, frozen=True):
    """`owner` has no member `name`; `owner` may be a scalar, which has no members."""

    span: Span
    name: str
    owner: Type


class BadIndex(Record, frozen=True):
    """Either `indexed` is neither an array nor a string, or the index (of type `index`) is not an integer."""

    span: Span
    indexed: Type
    index: Type


class IndexOutOfBounds(Record, frozen=True):
    span: Span
    index: int
    array: Array


class BadOperand(Record, frozen=True):
    """`operator` does not take an operand of type `given`; it takes `required`, BOOL or REAL."""

    span: Span
    operator: str
    given: Type
    required: Type


class BadComparison(Record, frozen=True):
    span: Span
    operator: str
    left: Type
    right: Type


class UnknownFunction(Record, frozen=True):
    """A name that is called or read, but is not a function or constant of the language. `name` is as written, including
    `Math.`; "" if the called expression is not a name."""

    span: Span
    name: str
    called: bool


class WrongArgumentCount(Record, frozen=True):
    span: Span
    function: str
    given: int


class MixedTypes(Record, frozen=True):
    """The elements of an array literal, or both values of `?:`, have no common type."""

    span: Span
    first: Type
    other: Type


class DivisionByZero(Record, frozen=True):
    span: Span


class IntegerDivision(Record, frozen=True):
    """`/` divides two ints. The result is real (docs/spec/expressions.md#operators)."""

    span: Span


class RealEquality(Record, frozen=True):
    """`==` or `!=` compares numbers of which at least one is real. An int and a number such as `2.0` are exact."""

    span: Span
    left: Expr
    right: Expr


class RandomUsed(Record, frozen=True):
    span: Span


class LengthOfStruct(Record, frozen=True):
    """`.length` is read from a struct, which is not an array (docs/spec/types.md#leaves)."""

    span: Span
    struct: Struct


class ObjectUsed(Record, frozen=True):
    """An object literal that is not an initial value (docs/spec/types.md#initial-values)."""

    span: Span


class ElementComputed(Record, frozen=True):
    """An array literal has an element that is not a literal (docs/spec/expressions.md#grammar)."""

    span: Span


Problem: TypeAlias = (
    UnknownName
    | UnknownMember
    | BadIndex
    | IndexOutOfBounds
    | BadOperand
    | BadComparison
    | UnknownFunction
    | WrongArgumentCount
    | MixedTypes
    | DivisionByZero
    | IntegerDivision
    | RealEquality
    | RandomUsed
    | LengthOfStruct
    | ObjectUsed
    | ElementComputed
)

ADVICE = (IntegerDivision, RealEquality)
"""The problems of expressions that can be evaluated."""


def infer(expr: Expr, scope: Scope, *, reprinted: bool = False) -> tuple[Type, tuple[Problem, ...]]:
    """The type of `expr` and its problems, in the order of the text.

    With `reprinted`, the type is that of the translated expression, in which `2.0` is written as `2` and is an int
    (docs/spec/expressions.md#whole-reals).
    """
    if isinstance(expr, Name) and (known := scope(expr.name)) is not None:
        return known, ()  # the common case
    inference = _Inference(scope, reprinted)
    type_ = inference.type_of(expr)
    problems = inference.problems
    if len(problems) > 1:
        problems.sort(key=lambda p: p.span)
    return type_, tuple(problems)


def constant_fraction(expr: Expr) -> Fraction | None:
    """The same as `constant`, as the decimal number that is written."""
    value = constant(expr)
    return None if value is None else Fraction(str(value))


def constant(expr: Expr) -> int | float | None:
    """The value of a numeric expression of literals; `None` for other expressions, and if the value is not finite.
    Division is real division, as in JANI."""
    match expr:
        case Number():
            return expr.value
        case Unary(operator=UnaryOperator.NEGATE):
            value = constant(expr.operand)
            return None if value is None else -value
        case Unary(operator=UnaryOperator.PLUS):
            return constant(expr.operand)
        case Binary() if expr.operator.kind is OperatorKind.ARITHMETIC:
            left, right = constant(expr.left), constant(expr.right)
            if left is None or right is None:
                return None
            return _arithmetic(expr.operator, left, right)
    return None


def _arithmetic(operator: Operator, left: float, right: float) -> int | float | None:
    try:
        match operator:
            case Operator.ADD:
                value = left + right
            case Operator.SUBTRACT:
                value = left - right
            case Operator.MULTIPLY:
                value = left * right
            case Operator.DIVIDE:
                value = left / right
            case Operator.REMAINDER:
                value = remainder(left, right)
            case _:
                return None
        return value if math.isfinite(value) else None
    except (ZeroDivisionError, OverflowError):
        return None


class _Inference:
    def __init__(self, scope: Scope, reprinted: bool) -> None:
        self.scope = scope
        self.reprinted = reprinted
        self.problems: list[Problem] = []

    def type_of(self, expr: Expr) -> Type:
        match expr:
            case Name():
                return self.name(expr)
            case Number():
                return REAL if expr.is_real and not (self.reprinted and expr.is_whole) else INT
            case Member():
                return self.member(expr)
            case Index():
                return self.index(expr)
            case Binary():
                return self.binary(expr)
            case Unary():
                return self.unary(expr)
            case Boolean():
                return BOOL
            case String():
                return STRING
            case Call():
                return self.call(expr)
            case Conditional():
                self.operand(expr.test, "?", BOOL)
                return self.common(self.type_of(expr.then), expr.otherwise)
            case ArrayLiteral():
                return self.array(expr)
            case ObjectLiteral():
                self.problems.append(ObjectUsed(expr.span))
                return UNKNOWN
            case ErrorExpr():
                for part in expr.parts:
                    self.type_of(part)
                return UNKNOWN

    def name(self, expr: Name) -> Type:
        type_ = self.scope(expr.name)
        if type_ is None:
            if expr.name == "Math":
                self.problems.append(UnknownFunction(expr.span, "Math", called=False))
            else:
                self.problems.append(UnknownName(expr.span, expr.name))
            return UNKNOWN
        return type_

    def member(self, expr: Member) -> Type:
        if isinstance(expr.object, Name) and expr.object.name == "Math" and self.scope("Math") is None:
            self.problems.append(UnknownFunction(expr.span, f"Math.{expr.name}", called=False))
            return UNKNOWN
        owner = self.type_of(expr.object)
        inner, bounds = unwrap(owner)
        if not expr.name or (isinstance(inner, Unknown) and not (bounds and expr.name == "length")):
            return UNKNOWN
        if expr.name == "length" and (bounds or not (isinstance(inner, Struct) and inner.member("length"))):
            if bounds or is_kind(owner, ScalarKind.STRING) or isinstance(owner, EmptyArray):
                return INT
            if isinstance(inner, Struct):
                self.problems.append(LengthOfStruct(expr.name_span, inner))
                return INT
        elif isinstance(inner, Struct):
            member = member_type(owner, expr.name)
            if member is not None:
                return member
        self.problems.append(UnknownMember(expr.name_span, expr.name, owner))
        return UNKNOWN

    def index(self, expr: Index) -> Type:
        indexed, index = self.type_of(expr.object), self.type_of(expr.index)
        if isinstance(indexed, Unknown):
            return UNKNOWN
        is_string = is_kind(indexed, ScalarKind.STRING)
        if not (isinstance(indexed, Array) or is_string):
            self.problems.append(BadIndex(expr.span, indexed, index))
            return UNKNOWN
        if not (isinstance(index, Unknown) or is_kind(index, ScalarKind.INT)):
            self.problems.append(BadIndex(expr.index.span, indexed, index))
        elif isinstance(indexed, Array):
            value = constant(expr.index)
            if isinstance(value, int) and (value < 0 or (indexed.bound is not None and value >= indexed.bound)):
                self.problems.append(IndexOutOfBounds(expr.index.span, value, indexed))
        return indexed.element if isinstance(indexed, Array) else INT

    def binary(self, expr: Binary) -> Type:
        operator = expr.operator
        if operator.kind is OperatorKind.LOGICAL:
            self.operand(expr.left, operator.symbol, BOOL)
            self.operand(expr.right, operator.symbol, BOOL)
            return BOOL
        left, right = self.type_of(expr.left), self.type_of(expr.right)
        if operator.kind is OperatorKind.EQUALITY:
            self.equality(expr, left, right)
            return BOOL
        good = True
        for type_, operand in ((left, expr.left), (right, expr.right)):
            if not (isinstance(type_, Unknown) or is_number(type_)):
                self.problems.append(BadOperand(operand.span, operator.symbol, type_, REAL))
                good = False
        if operator.kind is OperatorKind.ORDER:
            return BOOL
        if not good or isinstance(left, Unknown) or isinstance(right, Unknown):
            return UNKNOWN
        return self.arithmetic(expr, left, right)

    def arithmetic(self, expr: Binary, left: Type, right: Type) -> Type:
        both_int = is_kind(left, ScalarKind.INT) and is_kind(right, ScalarKind.INT)
        if expr.operator in (Operator.DIVIDE, Operator.REMAINDER) and constant(expr.right) == 0:
            self.problems.append(DivisionByZero(expr.right.span))
        elif expr.operator is Operator.DIVIDE and both_int:
            self.problems.append(IntegerDivision(expr.operator_span))
        if expr.operator is Operator.DIVIDE:
            return REAL
        return INT if both_int else REAL

    def equality(self, expr: Binary, left: Type, right: Type) -> None:
        comparable = (
            isinstance(left, Unknown)
            or isinstance(right, Unknown)
            or (is_number(left) and is_number(right))
            or (fits(left, right) or fits(right, left))
        )
        if not comparable or isinstance(unwrap(left)[0], Struct) or isinstance(unwrap(right)[0], Struct):
            self.problems.append(BadComparison(expr.span, expr.operator.symbol, left, right))
        elif is_number(left) and is_number(right) and (_is_real(expr.left, left) or _is_real(expr.right, right)):
            self.problems.append(RealEquality(expr.span, expr.left, expr.right))

    def unary(self, expr: Unary) -> Type:
        if expr.operator is UnaryOperator.NOT:
            self.operand(expr.operand, "!", BOOL)
            return BOOL
        type_ = self.type_of(expr.operand)
        if isinstance(type_, Unknown):
            return UNKNOWN
        if not is_number(type_):
            self.problems.append(BadOperand(expr.operand.span, expr.operator.symbol, type_, REAL))
            return UNKNOWN
        return INT if is_kind(type_, ScalarKind.INT) else REAL

    def call(self, expr: Call) -> Type:
        arguments = [self.type_of(argument) for argument in expr.arguments]
        name = _function_name(expr.function)
        if name is None:
            self.type_of(expr.function)
            self.problems.append(UnknownFunction(expr.function.span, "", called=True))
            return UNKNOWN
        function = FUNCTIONS.get(name.removeprefix("Math.")) if name.startswith("Math.") else None
        if function is None:
            self.problems.append(UnknownFunction(expr.function.span, name, called=True))
            return UNKNOWN
        if not function.takes(len(arguments)):
            self.problems.append(WrongArgumentCount(expr.span, function.name, len(arguments)))
        if function.name == "random":
            self.problems.append(RandomUsed(expr.span))
        for type_, argument in zip(arguments, expr.arguments, strict=True):
            if not (isinstance(type_, Unknown) or is_number(type_)):
                self.problems.append(BadOperand(argument.span, f"Math.{function.name}", type_, REAL))
        match function.result:
            case FunctionResult.INT:
                return INT
            case FunctionResult.REAL:
                return REAL
            case FunctionResult.AS_ARGUMENTS:
                if not arguments or not all(map(is_number, arguments)):
                    return UNKNOWN
                return INT if all(is_kind(type_, ScalarKind.INT) for type_ in arguments) else REAL
            case _:
                return assert_never(function.result)

    def array(self, expr: ArrayLiteral) -> Type:
        if not expr.elements:
            return EMPTY_ARRAY
        known = len(self.problems)
        element = self.type_of(expr.elements[0])
        for other in expr.elements[1:]:
            element = self.common(element, other)
        if len(self.problems) == known:
            self.problems += (ElementComputed(element.span) for element in expr.elements if not _is_literal(element))
        return Array(element, len(expr.elements))

    def common(self, first: Type, other: Expr) -> Type:
        """The common type of a value of type `first` and the expression `other`. If there is none, the problem is
        recorded."""
        second = self.type_of(other)
        common = join(first, second)
        if common is None:
            self.problems.append(MixedTypes(other.span, first, second))
            return UNKNOWN
        return common

    def operand(self, expr: Expr, operator: str, required: Type) -> None:
        type_ = self.type_of(expr)
        if not fits(type_, required):
            self.problems.append(BadOperand(expr.span, operator, type_, required))


def _kind(type_: Type) -> ScalarKind | None:
    return type_.kind if isinstance(type_, Scalar) else None


def _is_real(expr: Expr, type_: Type) -> bool:
    """Whether an expression of the type `type_` can have a value that is not an integer."""
    return _kind(type_) is ScalarKind.REAL and not (isinstance(expr, Number) and expr.is_whole)


def _function_name(function: Expr) -> str | None:
    match function:
        case Name():
            return function.name
        case Member(object=Name(name="Math")):
            return f"Math.{function.name}"
        case Member():
            return f".{function.name}"
    return None


def _is_literal(element: Expr) -> bool:
    match element:
        case Unary():
            return isinstance(element.operand, (Number, Boolean))
    return isinstance(element, (Number, Boolean, String, ArrayLiteral, ObjectLiteral))

# SPDX-License-Identifier: Apache-2.0
"""The values of expressions, and what a condition says about variables.

- A `Valuation` maps the places of values to their sets: `level`, `_msg.data`, `pose.x`, `path.length`. A place that it
  does not contain may have any value of its type. Of the elements of arrays, such as `path[]`, it contains only what
  their types say.
- Nothing is remembered about relations between places, so a set may contain values that do not occur together.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from typing import TypeAlias

from roaml.exact_number import remainder
from roaml.expr.operators import MIRRORED, OPPOSITE, Operator, OperatorKind, UnaryOperator
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
    ObjectLiteral,
    String,
    Unary,
    children,
)
from roaml.model.values.domain import (
    ANYTHING,
    BOTH,
    FALSE,
    MAX_LISTED,
    NONE,
    TRUE,
    Constant,
    Origin,
    ValueSet,
    above,
    below,
    between,
    exactly,
    interval,
    is_numeric,
    join,
    listed,
    meet,
    truth,
    without,
)
from roaml.model.values.strides import Stride, aligned
from roaml.record import Record, field
from roaml.text import Span

Valuation: TypeAlias = "dict[str, ValueSet]"

_LENGTH = ValueSet(None, 0, math.inf, Origin.REACHED, Origin.ASSUMED)


def place_of(expr: Expr) -> str | None:
    """The place that an expression reads or writes, with `[]` for indices; `None` if it is not a chain of members and
    indices that begins with a name."""
    match expr:
        case Name():
            return expr.name
        case Member():
            owner = place_of(expr.object)
            return None if owner is None else f"{owner}.{expr.name}"
        case Index():
            owner = place_of(expr.object)
            return None if owner is None else f"{owner}[]"
    return None


def _are_same(left: Expr, right: Expr) -> bool:
    """Whether two expressions read the same value. All elements of an array have one place, but not one value."""
    place = place_of(left)
    return place is not None and "[" not in place and place == place_of(right)


def is_within(place: str, outer: str) -> bool:
    """Whether `place` is a part of `outer`, or `outer` itself."""
    return place.startswith(outer) and (len(place) == len(outer) or place[len(outer)] in ".[")


class Evaluator(Record, eq=False):
    """Evaluates the expressions of one chart.

    Attributes:
        whole: whether the values of a place are integers.
        constants: names that are constants, such as `SUCCESS`.
        types: place of a variable, or of elements in it -> all values of its type. Left out if these have no bounds.
        strides: the variables that change by multiples of a number.
        seen: the places of expressions in the file -> all values that they had, if `records` is true.
        lengths: the places of indices -> all lengths that their arrays had when they were read, as far as known.
    """

    whole: Callable[[str], bool]
    constants: dict[str, Constant] = field(default_factory=dict)
    types: Mapping[str, ValueSet] = field(default_factory=dict)
    strides: Mapping[str, Stride] = field(default_factory=dict)
    records: bool = False
    seen: dict[Span, ValueSet] = field(default_factory=dict)
    lengths: dict[Span, ValueSet] = field(default_factory=dict)

    # ------------------------------------------------------------- values

    def values(self, known: Valuation, expr: Expr) -> ValueSet:
        values = self._values(known, expr)
        if self.records:
            before = self.seen.get(expr.span)
            self.seen[expr.span] = values if before is None else join(before, values)
        return values

    def _values(self, known: Valuation, expr: Expr) -> ValueSet:
        match expr:
            case Name():
                if expr.name in known:
                    return known[expr.name]
                constant = self.constants.get(expr.name)
                return self.types.get(expr.name, ANYTHING) if constant is None else exactly(constant)
            case Number() | String() | Boolean():
                return exactly(expr.value)
            case Member():
                return self._member(known, expr)
            case Index():
                self._inner_indices(known, expr)
                place = place_of(expr)
                return known.get(place) or self.types.get(place, ANYTHING) if place is not None else ANYTHING
            case Unary():
                return self._unary(expr.operator, self.values(known, expr.operand))
            case Binary():
                return self._binary(known, expr)
            case Conditional():
                return self._conditional(known, expr)
            case Call():
                return self._call(known, expr)
            case _:
                for part in children(expr):
                    self.values(known, part)
                return ANYTHING

    def _member(self, known: Valuation, expr: Member) -> ValueSet:
        self._inner_indices(known, expr.object)
        place = place_of(expr)
        if place is not None and place in known:
            return known[place]
        if place is not None and place in self.types:
            return self.types[place]
        return _LENGTH if expr.name == "length" else ANYTHING

    def _inner_indices(self, known: Valuation, expr: Expr) -> None:
        """Record the indices inside a chain of members."""
        while isinstance(expr, Member | Index):
            if isinstance(expr, Index):
                self._index(known, expr)
            expr = expr.object

    def _index(self, known: Valuation, expr: Index) -> None:
        """Record the values of an index, and the lengths of its array."""
        self.values(known, expr.index)
        if self.records:
            length = known.get(f"{place_of(expr.object)}.length", _LENGTH)
            before = self.lengths.get(expr.index.span)
            self.lengths[expr.index.span] = length if before is None else join(before, length)

    def _unary(self, operator: UnaryOperator, values: ValueSet) -> ValueSet:
        match operator:
            case UnaryOperator.NOT:
                return BOTH if values.only is None else truth(not value for value in values.only)
            case UnaryOperator.NEGATE:
                if values.only is not None:
                    return listed(-value for value in values.only if not isinstance(value, str))
                return between(-values.high, -values.low, values.high_from, values.low_from)
            case _:
                return values

    def _binary(self, known: Valuation, expr: Binary) -> ValueSet:
        operator = expr.operator
        if operator.kind is OperatorKind.LOGICAL:
            is_and = operator is Operator.AND
            left = self.values(known, expr.left)
            if left == (FALSE if is_and else TRUE):
                return left
            rest = self.assume(known, expr.left, is_and)
            right = self.values(rest, expr.right) if rest is not None else NONE
            # The right operand is evaluated only if the left one does not decide.
            decided = frozenset((not is_and,)) & (left.only if left.only is not None else frozenset((True, False)))
            return ValueSet(decided | (right.only if right.only is not None else frozenset((True, False))))
        left, right = self.values(known, expr.left), self.values(known, expr.right)
        if left.only == frozenset() or right.only == frozenset():
            return NONE
        if operator is Operator.REMAINDER and self._is_whole(expr.left) and self._is_whole(expr.right):
            return _remainder(left, right)
        if operator.kind is OperatorKind.ARITHMETIC:
            return arithmetic(operator, left, right)
        if _are_same(expr.left, expr.right):
            return TRUE if operator in (Operator.EQUAL, Operator.LESS_EQUAL, Operator.GREATER_EQUAL) else FALSE
        return compared(operator, left, right)

    def _conditional(self, known: Valuation, expr: Conditional) -> ValueSet:
        self.values(known, expr.test)
        result = NONE
        for part, holds in ((expr.then, True), (expr.otherwise, False)):
            tested = self.assume(known, expr.test, holds)
            if tested is not None:
                result = join(result, self.values(tested, part))
        return result

    def _call(self, known: Valuation, expr: Call) -> ValueSet:
        arguments = [self.values(known, argument) for argument in expr.arguments]
        name = expr.function.name if isinstance(expr.function, Member) else ""
        match name, arguments:
            case "random", []:
                return between(0, 1, Origin.REACHED, Origin.ASSUMED)
            case "abs", [value]:
                return _absolute(value)
            case "floor" | "ceil", [value] if is_numeric(value):
                function = math.floor if name == "floor" else math.ceil
                if value.only is not None:
                    return listed(function(v) for v in value.only if not isinstance(v, str))
                low, high = (function(bound) if math.isfinite(bound) else bound for bound in (value.low, value.high))
                return between(low, high, value.low_from, value.high_from)
            case "min" | "max", [first, *others]:
                return functools.reduce(functools.partial(_extreme, name == "min"), others, first)
            case "sin" | "cos", [_]:
                return between(-1, 1, Origin.ASSUMED, Origin.ASSUMED)
        return ANYTHING

    # --------------------------------------------------------- conditions

    def assume(self, known: Valuation, condition: Expr, holds: bool) -> Valuation | None:
        """`known` where `condition` has the value `holds`; `None` if it cannot have it."""
        match condition:
            case Boolean():
                return known if condition.value == holds else None
            case Unary(operator=UnaryOperator.NOT):
                return self.assume(known, condition.operand, not holds)
            case Binary(operator=Operator.AND | Operator.OR):
                if (condition.operator is Operator.AND) == holds:
                    first = self.assume(known, condition.left, holds)
                    return None if first is None else self.assume(first, condition.right, holds)
                first, rest = (self.assume(known, condition.left, value) for value in (holds, not holds))
                second = None if rest is None else self.assume(rest, condition.right, holds)
                return _either(first, second)
            case Conditional():
                yes, no = (self.assume(known, condition.test, value) for value in (True, False))
                first = None if yes is None else self.assume(yes, condition.then, holds)
                second = None if no is None else self.assume(no, condition.otherwise, holds)
                return _either(first, second)
            case Binary() if condition.operator in OPPOSITE:
                operator = condition.operator if holds else OPPOSITE[condition.operator]
                return self._compare(known, operator, condition.left, condition.right)
        if self._quietly(known, condition).only == frozenset((not holds,)):
            return None
        place = place_of(condition)
        return known if place is None else self._with(known, condition, truth((holds,)))

    def _compare(self, known: Valuation, operator: Operator, left: Expr, right: Expr) -> Valuation | None:
        first, second = self._quietly(known, left), self._quietly(known, right)
        same = _are_same(left, right)
        if same or compared(operator, first, second) == FALSE:
            holds = same and operator in (Operator.EQUAL, Operator.LESS_EQUAL, Operator.GREATER_EQUAL)
            return known if holds else None
        narrowed = self._narrowed(known, left, self._related(left, operator, first, second))
        if narrowed is None:
            return None
        return self._narrowed(narrowed, right, self._related(right, MIRRORED[operator], second, first))

    def _quietly(self, known: Valuation, expr: Expr) -> ValueSet:
        """The values of an expression that is recorded elsewhere."""
        before, self.records = self.records, False
        try:
            return self._values(known, expr)
        finally:
            self.records = before

    def _related(self, expr: Expr, operator: Operator, values: ValueSet, other: ValueSet) -> ValueSet:
        """The part of `values`, those of `expr`, for which `OPERATOR other` can hold."""
        is_whole = self._is_whole(expr)
        match operator:
            case Operator.EQUAL:
                return meet(values, other)
            case Operator.NOT_EQUAL:
                return without(values, other, is_whole)
            case Operator.LESS | Operator.LESS_EQUAL if is_numeric(values) and is_numeric(other):
                return below(values, other, is_whole, operator is Operator.LESS)
            case Operator.GREATER | Operator.GREATER_EQUAL if is_numeric(values) and is_numeric(other):
                return above(values, other, is_whole, operator is Operator.GREATER)
        return values

    def _is_whole(self, expr: Expr) -> bool:
        """Whether the values of an expression are integers."""
        match expr:
            case Number():
                return not expr.is_real
            case Unary(operator=UnaryOperator.NEGATE):
                return self._is_whole(expr.operand)
            case Binary(operator=Operator.ADD | Operator.SUBTRACT):
                return self._is_whole(expr.left) and self._is_whole(expr.right)
        place = place_of(expr)
        return place is not None and self.whole(place)

    def _narrowed(self, known: Valuation, expr: Expr, values: ValueSet) -> Valuation | None:
        """`known` where `expr` has one of `values`, which are some of those that it has in `known`. In a sum or a
        difference of integers with a number, such as `level + 5`, the other operand is narrowed; the sums of real
        numbers are rounded."""
        match expr:
            case Unary(operator=UnaryOperator.NEGATE) if self._is_whole(expr):
                return self._narrowed(known, expr.operand, self._unary(UnaryOperator.NEGATE, values))
            case Binary(operator=Operator.ADD | Operator.SUBTRACT) if self._is_whole(expr):
                left, right = self._quietly(known, expr.left), self._quietly(known, expr.right)
                if values.only == frozenset():
                    return None
                if right.value is not None:
                    opposite = Operator.SUBTRACT if expr.operator is Operator.ADD else Operator.ADD
                    return self._narrowed(known, expr.left, arithmetic(opposite, values, right))
                if left.value is not None:
                    rest = (values, left) if expr.operator is Operator.ADD else (left, values)
                    return self._narrowed(known, expr.right, arithmetic(Operator.SUBTRACT, *rest))
        return self._with(known, expr, values)

    def _with(self, known: Valuation, expr: Expr, values: ValueSet) -> Valuation | None:
        if values.only == frozenset():
            return None
        place = place_of(expr)
        # The elements of an array share a place, and a string or a constant has none.
        if place is None or "[" in place or not isinstance(expr, Name | Member) or place in self.constants:
            return known
        if place in self.strides:
            values = aligned(values, self.strides[place])
        if known.get(place, ANYTHING) == values:
            return known
        return None if values.only == frozenset() else {**known, place: values}


def joined_valuations(first: Valuation, second: Valuation) -> Valuation:
    """The values of both; a place that one of them does not contain is left out."""
    if first is second:
        return first
    return {
        place: values if values is other else join(values, other)
        for place, values in first.items()
        if (other := second.get(place)) is not None
    }


def compared(operator: Operator, left: ValueSet, right: ValueSet) -> ValueSet:
    """The possible results of a comparison."""
    if operator in (Operator.EQUAL, Operator.NOT_EQUAL):
        can_equal = meet(left, right).only != frozenset()
        can_differ = left.value is None or right.value is None or left.value != right.value
        results = [True] * can_equal + [False] * can_differ
        return truth(results if operator is Operator.EQUAL else (not result for result in results))
    if not (is_numeric(left) and is_numeric(right)):
        return BOTH
    if operator in (Operator.GREATER, Operator.GREATER_EQUAL):
        left, right, operator = right, left, MIRRORED[operator]
    left, right = interval(left), interval(right)
    strict = operator is Operator.LESS
    can_hold = left.low < right.high or (not strict and left.low == right.high)
    can_fail = left.high > right.low or (strict and left.high == right.low)
    return truth([True] * can_hold + [False] * can_fail)


# ------------------------------------------------------------------ arithmetic


def arithmetic(operator: Operator, left: ValueSet, right: ValueSet) -> ValueSet:
    """The possible results of an arithmetic operation on numbers."""
    if not (is_numeric(left) and is_numeric(right)):
        return ANYTHING
    if left.only is not None and right.only is not None and len(left.only) * len(right.only) <= MAX_LISTED**2:
        return _listed_arithmetic(operator, left.only, right.only)
    first, second = interval(left), interval(right)
    match operator:
        case Operator.ADD:
            return _interval(
                first.low + second.low,
                first.high + second.high,
                max(first.low_from, second.low_from),
                max(first.high_from, second.high_from),
            )
        case Operator.SUBTRACT:
            return _interval(
                first.low - second.high,
                first.high - second.low,
                max(first.low_from, second.high_from),
                max(first.high_from, second.low_from),
            )
        case Operator.MULTIPLY:
            return _corners(first, second, lambda a, b: a * b)
        case Operator.DIVIDE if second.low > 0 or second.high < 0:
            return _corners(first, second, lambda a, b: a / b)
        case Operator.REMAINDER if second.low > 0 and math.isfinite(second.high):
            return between(0, second.high, Origin.ASSUMED, Origin.ASSUMED)
    return ANYTHING


def _remainder(left: ValueSet, right: ValueSet) -> ValueSet:
    """The possible remainders of integers."""
    values = arithmetic(Operator.REMAINDER, left, right)
    if values.only is not None or not math.isfinite(values.high):
        return values
    greatest = values.high - 1
    return between(0, greatest, Origin.ASSUMED, Origin.ASSUMED)


def _listed_arithmetic(operator: Operator, left: frozenset[Constant], right: frozenset[Constant]) -> ValueSet:
    results: list[Constant] = []
    for a, b in itertools.product(left, right):
        if isinstance(a, str) or isinstance(b, str):
            return ANYTHING
        try:
            results.append(_result(operator, a, b))
        except (ZeroDivisionError, OverflowError):
            continue  # the trace ends, or the result is undefined
    return listed(results) if results else ANYTHING


def _result(operator: Operator, a: float, b: float) -> float:
    match operator:
        case Operator.ADD:
            return a + b
        case Operator.SUBTRACT:
            return a - b
        case Operator.MULTIPLY:
            return a * b
        case Operator.REMAINDER:
            return remainder(a, b)
        case _:
            return a / b


def _interval(low: float, high: float, low_from: Origin, high_from: Origin) -> ValueSet:
    low, high = (-math.inf if math.isnan(low) else low), (math.inf if math.isnan(high) else high)
    return between(low, high, low_from, high_from)


def _corners(first: ValueSet, second: ValueSet, operation: Callable[[float, float], float]) -> ValueSet:
    origin = max(first.low_from, first.high_from, second.low_from, second.high_from)
    results = [
        0 if math.isnan(result := operation(a, b)) else result
        for a, b in itertools.product((first.low, first.high), (second.low, second.high))
    ]
    return between(min(results), max(results), origin, origin)


def _either(first: Valuation | None, second: Valuation | None) -> Valuation | None:
    """What is known if one of two cases holds; `None` is a case that cannot hold."""
    return second if first is None else first if second is None else joined_valuations(first, second)


def _absolute(values: ValueSet) -> ValueSet:
    if values.only is not None:
        return listed(abs(value) for value in values.only if not isinstance(value, str))
    if values.low >= 0:
        return values
    low = 0.0 if values.high >= 0 else -values.high
    high, high_from = max((-values.low, -values.low_from), (values.high, -values.high_from))
    return between(low, high, Origin.REACHED if low == 0 else values.high_from, Origin(-high_from))


def _extreme(is_least: bool, first: ValueSet, second: ValueSet) -> ValueSet:
    if first.only is not None and second.only is not None and is_numeric(first) and is_numeric(second):
        choose = min if is_least else max
        return listed(choose(a, b) for a, b in itertools.product(first.only, second.only))
    first, second = interval(first), interval(second)
    if is_least:
        low, low_from = min((first.low, first.low_from), (second.low, second.low_from))
        high, high_from = min((first.high, first.high_from), (second.high, second.high_from))
        return between(low, high, low_from, high_from)
    low, low_top = max((first.low, -first.low_from), (second.low, -second.low_from))
    high, high_top = max((first.high, -first.high_from), (second.high, -second.high_from))
    return between(low, high, Origin(-low_top), Origin(-high_top))


# ------------------------------------------------------------------- literals


def literal(place: str, expr: Expr) -> Iterator[tuple[str, ValueSet]]:
    """The values that a constant gives to `place` and to the places in it. The elements of an array share a place; they
    are left out unless all of them are constants."""
    match expr:
        case ArrayLiteral():
            yield f"{place}.length", exactly(len(expr.elements))
            if expr.elements and all(map(_is_constant, expr.elements)):
                inside: dict[str, ValueSet] = {}
                for element in expr.elements:
                    # An array without elements says nothing about the places of elements in it.
                    for path, values in literal(f"{place}[]", element):
                        inside[path] = join(inside[path], values) if path in inside else values
                yield from inside.items()
        case Number() | String() | Boolean():
            yield place, exactly(expr.value)
        case Unary(operator=UnaryOperator.NEGATE, operand=Number() as number):
            yield place, exactly(-number.value)
        case Unary(operator=UnaryOperator.PLUS, operand=Number() as number):
            yield place, exactly(number.value)
        case ObjectLiteral():
            for member in expr.members:
                yield from literal(f"{place}.{member.key}", member.value)


def _is_constant(expr: Expr) -> bool:
    """Whether an expression contains only constants."""
    match expr:
        case ArrayLiteral():
            return all(map(_is_constant, expr.elements))
        case ObjectLiteral():
            return all(_is_constant(member.value) for member in expr.members)
    return isinstance(expr.operand if isinstance(expr, Unary) else expr, Number | String | Boolean)

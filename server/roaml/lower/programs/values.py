# SPDX-License-Identifier: Apache-2.0
"""Evaluates expressions in the programs of nodes. A value is known during the translation, or it is an expression of
the automaton."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Collection, Mapping, Sequence
from fractions import Fraction
from typing import Any

from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.tree import Boolean, Conditional, Expr, Number, String, Unary
from roaml.libraries.programs.statuses import STATUS_CODES, Known
from roaml.lower.build import binary, equal, floor, integer, math_call, name
from roaml.lower.programs.cases import are_equal
from roaml.lower.programs.code import NodeCode, Value
from roaml.lower.programs.entries import EntryKind
from roaml.record import Record
from roaml.text import NO_SPAN

RESULT = "*result"
"""The name of the known variable that contains the status which the program has returned."""


class ProgramValues(Record, frozen=True, eq=False):
    """Evaluates the expressions of the program of a node. `declared` contains the names of the variables of the
    automaton."""

    code: NodeCode
    declared: Collection[str]

    def number(self, expression: ast.expr, fixed: Mapping[str, Known]) -> float:
        value = self.value(expression, fixed)
        assert isinstance(value, (bool, int, float)), ast.unparse(expression)
        return value

    def value(self, expression: ast.expr, fixed: Mapping[str, Known]) -> Value:
        """The value of an expression of the program: a known value, or an expression of the automaton."""
        match expression:
            case ast.Constant(value=bool() | int() | float() | str() as constant):
                return constant
            case ast.Name(id=identifier):
                return self.name(identifier, fixed)
            case ast.Subscript(value=ast.Name(id=identifier), slice=element):
                return name(f"{identifier}_{self.number(element, fixed)}")
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                value = self.value(operand, fixed)
                return not value if is_known(value) else negated(expr(value))
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.number(operand, fixed)
            case ast.BoolOp(op=operator, values=values):
                return self.logical([self.value(v, fixed) for v in values], isinstance(operator, ast.And))
            case ast.Compare(left=left, ops=[operator], comparators=[right]):
                return compared(self.value(left, fixed), type(operator), self.value(right, fixed))
            case ast.BinOp(left=left, op=operator, right=right):
                return computed(self.value(left, fixed), type(operator), self.value(right, fixed))
            case ast.Call(func=ast.Name(id=function), args=arguments):
                return self.call(function, [self.value(argument, fixed) for argument in arguments])
        raise AssertionError(ast.dump(expression))

    def logical(self, values: Sequence[Value], conjunction: bool) -> Value:
        result: Expr | None = None
        for value in values:
            if isinstance(value, (bool, int, float, str)):
                if bool(value) is not conjunction:
                    return not conjunction
            elif result is None:
                result = value
            else:
                result = binary(result, Operator.AND if conjunction else Operator.OR, value)
        return conjunction if result is None else result

    def name(self, identifier: str, fixed: Mapping[str, Known]) -> Value:
        if identifier in STATUS_CODES:
            return STATUS_CODES[identifier]
        if identifier in fixed:
            return fixed[identifier]
        if identifier in self.declared:
            return name(identifier)
        key = {"otherwise": "else", "result": RESULT}.get(identifier, identifier)
        if key in fixed:
            return fixed[key]
        if key == "COUNT":
            return len(self.code.children)
        if key == "LENGTH":
            return len(self.code.elements)
        if key in self.code.bound:
            value = name(self.code.bound[key].local)
            return floor(value) if key in self.code.whole else value
        return self.code.known[key]

    def call(self, function: str, arguments: Sequence[Value]) -> Value:
        match function, arguments:
            case "ticks", [duration]:
                if isinstance(duration, (bool, int, float)):
                    return ticks_of(Fraction(str(duration)), self.code.rate)
                assert not isinstance(duration, str)
                scaled = binary(duration, Operator.MULTIPLY, expr(float(self.code.rate)))
                return math_call("ceil", binary(scaled, Operator.DIVIDE, integer(1000)))
            case "maximum", [first, second]:
                if isinstance(first, (int, float)) and isinstance(second, (int, float)):
                    return max(first, second)
                return math_call("max", expr(first), expr(second))
            case "matches", [int() as case, bool() as is_whole]:
                return self.matches(case, is_whole)
            case "same", [str() as first, str() as second]:
                return self.same(first, second)
            case "ends", [int() as elapsed]:
                return self.code.known[f"ends_{elapsed}"]
            case "element", [position]:
                return self.element(position)
        raise AssertionError(function)

    def matches(self, case: int, is_whole: bool) -> Value:
        """The condition that the variable of a `Switch` equals the case with the index `case`; `is_whole` as for
        `number_in`."""
        port = f"case_{case + 1}"
        variable, constant = self.name("variable", {}), self.name(port, {})
        if isinstance(variable, str) and isinstance(constant, str):
            return are_equal(variable, constant, is_whole=is_whole)
        if self.is_number("variable") is not self.is_number(port):
            return False
        if not is_whole and not isinstance(variable, float) and not isinstance(constant, float):
            variable, constant = self.truncated("variable", variable), self.truncated(port, constant)
        return compared(variable, ast.Eq, constant)

    def same(self, first: str, second: str) -> Value:
        """The condition that two ports have the same value. A text is not a number."""
        if self.is_number(first) is not self.is_number(second):
            return False
        return compared(self.name(first, {}), ast.Eq, self.name(second, {}))

    def is_number(self, port: str) -> bool:
        """Whether the value of a port is a number, not a text."""
        if port in self.code.bound:
            return self.code.bound[port].kind is not EntryKind.TEXT
        return not isinstance(self.code.known[port], str)

    def truncated(self, port: str, value: Value) -> Value:
        """The value of a port as the integer with which its text begins, such as -2 for -2.7."""
        if port not in self.code.bound or self.code.bound[port].kind is not EntryKind.REAL:
            return value
        number = expr(value)
        is_negative = binary(number, Operator.LESS, integer(0))
        return Conditional(NO_SPAN, is_negative, math_call("ceil", number), floor(number))

    def element(self, position: Value) -> Value:
        """The element of the queue at `position`, which begins at 0."""
        if not self.code.elements:
            return 0  # this value is never read, because the queue is empty
        result = expr(self.code.elements[-1])
        for index in reversed(range(len(self.code.elements) - 1)):
            test = equal(expr(position), integer(index))
            result = Conditional(NO_SPAN, test, expr(self.code.elements[index]), result)
        return result


def ticks_of(milliseconds: Fraction, rate: Fraction) -> int:
    """The number of ticks of the tree in a duration, rounded up (docs/spec/nodes.md#durations). `rate` is in Hz."""
    return math.ceil(milliseconds * rate / 1000)


def is_known(value: Value) -> bool:
    return isinstance(value, (bool, int, float, str))


_COMPARISONS: Mapping[type[ast.cmpop], tuple[Operator, Callable[[Any, Any], bool]]] = {
    ast.Eq: (Operator.EQUAL, operator.eq),
    ast.NotEq: (Operator.NOT_EQUAL, operator.ne),
    ast.Lt: (Operator.LESS, operator.lt),
    ast.LtE: (Operator.LESS_EQUAL, operator.le),
    ast.Gt: (Operator.GREATER, operator.gt),
    ast.GtE: (Operator.GREATER_EQUAL, operator.ge),
}
_ARITHMETIC: Mapping[type[ast.operator], tuple[Operator, Callable[[Any, Any], Any]]] = {
    ast.Add: (Operator.ADD, operator.add),
    ast.Sub: (Operator.SUBTRACT, operator.sub),
    ast.Mult: (Operator.MULTIPLY, operator.mul),
    ast.Div: (Operator.DIVIDE, operator.truediv),
}


def compared(left: Value, kind: type[ast.cmpop], right: Value) -> Value:
    symbol, function = _COMPARISONS[kind]
    if isinstance(left, (bool, int, float, str)) and isinstance(right, (bool, int, float, str)):
        return function(left, right)
    return binary(expr(left), symbol, expr(right))


def computed(left: Value, kind: type[ast.operator], right: Value) -> Value:
    symbol, function = _ARITHMETIC[kind]
    if isinstance(left, (bool, int, float)) and isinstance(right, (bool, int, float)):
        result: Known = function(left, right)
        return result
    return binary(expr(left), symbol, expr(right))


def expr(value: Value) -> Expr:
    match value:
        case bool():
            return Boolean(NO_SPAN, value)
        case int():
            return integer(value) if value >= 0 else Unary(NO_SPAN, UnaryOperator.NEGATE, integer(-value))
        case float():
            return Number(NO_SPAN, value, True)
        case str():
            return String(NO_SPAN, value)
    return value


def negated(condition: Expr) -> Expr:
    return Unary(NO_SPAN, UnaryOperator.NOT, condition)

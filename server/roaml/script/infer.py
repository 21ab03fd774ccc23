# SPDX-License-Identifier: Apache-2.0
"""Types of scripts, and operations that always fail (docs/spec/scripts.md#types).

Unknown types are not checked: an entry without a declared type may have any value.
"""

from __future__ import annotations

import enum
import functools
from collections.abc import Callable, Iterator

from roaml.script.parse import ScriptProblem, parse
from roaml.script.tree import (
    Assignment,
    Binary,
    Boolean,
    Comparison,
    Conditional,
    ErrorExpr,
    Expr,
    Name,
    Number,
    Script,
    String,
    Unary,
    walk,
)
from roaml.text import Decoded


class Type(enum.Enum):
    INTEGER = "an integer"
    REAL = "a number"
    TEXT = "a text"
    UNKNOWN = "anything"


NUMBERS = (Type.INTEGER, Type.REAL)


def type_of(expr: Expr, entry: Callable[[str], Type]) -> Type:
    """The type of an expression; `entry` returns the type of a name."""
    match expr:
        case Number(value=value):
            return Type.INTEGER if isinstance(value, int) else Type.REAL
        case Boolean() | Comparison():
            return Type.REAL
        case String():
            return Type.TEXT
        case Name(name=name):
            return entry(name)
        case Unary(operator="-", operand=operand):
            return type_of(operand, entry)
        case Unary(operator="~"):
            return Type.INTEGER
        case Unary():
            return Type.REAL
        case Binary(operator=operator, left=left, right=right):
            return _of_binary(operator, type_of(left, entry), type_of(right, entry))
        case Conditional(yes=yes, no=no):
            types = {type_of(yes, entry), type_of(no, entry)}
            return types.pop() if len(types) == 1 else Type.REAL if types <= set(NUMBERS) else Type.UNKNOWN
        case Assignment(value=value):
            return type_of(value, entry)
        case ErrorExpr():
            return Type.UNKNOWN


def _of_binary(operator: str, left: Type, right: Type) -> Type:
    if operator == "..":
        return Type.TEXT
    if operator in ("&", "|", "^"):
        return Type.INTEGER
    if operator == "+":
        if Type.TEXT in (left, right):
            return Type.TEXT
        if Type.UNKNOWN in (left, right):
            return Type.UNKNOWN
    return Type.REAL


def check_types(script: Script, entry: Callable[[str], Type]) -> Iterator[ScriptProblem]:
    """The operations of a script that always fail. `entry` returns the type that a name has before the script."""
    known: dict[str, Type] = {}

    def lookup(name: str) -> Type:
        return known.get(name) or entry(name)

    for statement in script.statements:
        for expr in walk(Script(script.span, (statement,))):
            yield from _operation(expr, lookup)
        for expr in walk(Script(script.span, (statement,))):
            if isinstance(expr, Assignment):
                yield from _assignment(expr, lookup)
                if expr.operator == ":=" and lookup(expr.target.name) is Type.UNKNOWN:
                    known[expr.target.name] = type_of(expr.value, lookup)


@functools.lru_cache(maxsize=2048)
def created_in(text: str) -> tuple[tuple[str, Type], ...]:
    """The names that a script creates, each with the type of its value: a text, a number, or unknown."""
    script, problems = parse(Decoded(text, 0))
    if problems:
        return ()
    created = (expr for expr in walk(script) if isinstance(expr, Assignment) and expr.operator == ":=")
    types = ((expr.target.name, type_of(expr.value, lambda _: Type.UNKNOWN)) for expr in created)
    return tuple((name, Type.REAL if type_ is Type.INTEGER else type_) for name, type_ in types)


def check_condition(script: Script, entry: Callable[[str], Type]) -> Iterator[ScriptProblem]:
    """The reason why the value of a script cannot be a condition; empty if it can be one."""
    if script.statements:
        yield from _truth(script.statements[-1], entry)


def assignments_as_conditions(script: Script) -> Iterator[ScriptProblem]:
    """The assignment that is the value of a condition, because a comparison was probably intended; empty if there is
    none."""
    last = script.statements[-1] if script.statements else None
    if isinstance(last, Assignment) and not isinstance(last.value, Comparison):
        compared = "==" if last.operator in ("=", ":=") else ""
        yield ScriptProblem(last.operator_span, f"`{last.operator}` assigns a value; `==` compares", compared)


def statements_without_effect(script: Script, *, has_value: bool) -> Iterator[ScriptProblem]:
    """The statements that assign nothing. Either an operator is missing after them, they compare instead of assigning,
    or they are superfluous. A last statement that is only a name or a constant is a placeholder.

    Args:
        has_value: whether the value of the script is used, which is that of the last statement.
    """
    for index, statement in enumerate(script.statements):
        is_last = index == len(script.statements) - 1
        if is_last and (has_value or isinstance(statement, Name | Number | Boolean | String)):
            continue
        if any(isinstance(expr, Assignment | ErrorExpr) for expr in walk(Script(script.span, (statement,)))):
            continue
        if isinstance(statement, Comparison) and statement.operators == ("==",) and _name(statement.operands[0]):
            message = "this comparison has no effect; `:=` assigns a value"
            yield ScriptProblem(statement.operator_span, message, ":=")
        elif is_last:
            yield ScriptProblem(statement.span, "this statement has no effect, because nothing uses its value")
        else:
            message = "this statement has no effect; add the operator that is missing after it, or remove it"
            yield ScriptProblem(statement.span, message)


def _operation(expr: Expr, entry: Callable[[str], Type]) -> Iterator[ScriptProblem]:
    match expr:
        case Unary(operator="!", operand=operand):
            yield from _truth(operand, entry)
        case Unary(operator=operator, operand=operand) if type_of(operand, entry) is Type.TEXT:
            message = f"`{operator}` needs a number, not a string"
            yield ScriptProblem(operand.span, message, number=_name(operand), operator=operator)
        case Binary(operator="&&" | "||", left=left, right=right):
            yield from _truth(left, entry)
            yield from _truth(right, entry)
        case Binary(operator="..", operator_span=span, left=left, right=right):
            if type_of(left, entry) in NUMBERS and type_of(right, entry) in NUMBERS:
                yield ScriptProblem(span, "`..` joins strings, not two numbers")
        case Binary(operator="+", operator_span=span, left=left, right=right):
            types = {type_of(left, entry), type_of(right, entry)}
            if Type.TEXT in types and types & set(NUMBERS):
                name = _name(left) if type_of(left, entry) is Type.TEXT else _name(right)
                message = "`+` cannot join a string and a number; use `..`"
                yield ScriptProblem(span, message, "..", name, "+")
        case Binary(operator=operator, left=left, right=right):
            for side in (left, right):
                if type_of(side, entry) is Type.TEXT:
                    message = f"`{operator}` needs numbers, not a string"
                    yield ScriptProblem(side.span, message, number=_name(side), operator=operator)
                elif operator in ("&", "|", "^") and isinstance(side, Number) and not float(side.value).is_integer():
                    yield ScriptProblem(side.span, f"`{operator}` needs integers")
        case Conditional(test=test) if type_of(test, entry) is not Type.TEXT:
            yield from _truth(test, entry)


def _name(expr: Expr) -> str:
    return expr.name if isinstance(expr, Name) else ""


def _truth(expr: Expr, entry: Callable[[str], Type]) -> Iterator[ScriptProblem]:
    """Why a value is neither true nor false. A real is false if it is 0 and otherwise true; an integer must be 1 or 0;
    a string is neither true nor false."""
    if type_of(expr, entry) is Type.TEXT:
        yield ScriptProblem(expr.span, "a string is neither true nor false; compare it")
    elif isinstance(expr, Number) and isinstance(expr.value, int) and expr.value not in (0, 1):
        yield ScriptProblem(expr.span, f"the integer {expr.value} is neither true (1) nor false (0); compare it")


def _assignment(expr: Assignment, entry: Callable[[str], Type]) -> Iterator[ScriptProblem]:
    name = expr.target.name
    target, value = entry(name), type_of(expr.value, entry)
    if expr.operator in ("-=", "*=", "/=") and Type.TEXT in (target, value):
        span = expr.target.span if target is Type.TEXT else expr.value.span
        number = name if target is Type.TEXT else _name(expr.value)
        message = f"`{expr.operator}` needs numbers, not a string"
        yield ScriptProblem(span, message, number=number, operator=expr.operator)
    elif target in NUMBERS and value is Type.TEXT:
        if not (isinstance(expr.value, String) and _is_number(expr.value.value)):
            yield ScriptProblem(expr.value.span, f"`{name}` is a number and keeps its type; it cannot become a string")
    elif target is Type.TEXT and value in NUMBERS and expr.operator == "+=":
        message = f"`{name}` is a string, to which `+=` can add only strings"
        yield ScriptProblem(expr.value.span, message, number=name, operator="+=")
    elif target is Type.INTEGER and expr.operator in (":=", "=") and _is_fraction(expr.value):
        yield ScriptProblem(
            expr.value.span, f"`{name}` is an integer and keeps its type; it cannot become a real number"
        )


def _is_fraction(expr: Expr) -> bool:
    return isinstance(expr, Number) and not float(expr.value).is_integer()


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True

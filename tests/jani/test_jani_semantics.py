# SPDX-License-Identifier: Apache-2.0
"""The values of expressions."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from jani_expressions import expression, op
from jani_strategies import EXPRESSIONS

from roaml.jani.expressions import (
    ArrayAccess,
    ArrayConstructor,
    ArrayValue,
    Binary,
    Boolean,
    Conditional,
    Expression,
    Integer,
    Name,
    Real,
    Unary,
)
from roaml.jani.infer import TypeScope
from roaml.jani.model import Function, Parameter
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.jani.semantics import DatatypeInstance, EvaluationError, Some, Value, evaluate
from roaml.jani.typecheck import expression_type
from roaml.jani.types import (
    BOOL,
    INT,
    REAL,
    ArrayType,
    BasicType,
    BoundedType,
    DatatypeType,
    OptionType,
    Type,
    UnknownType,
    fits,
)

STATE: dict[str, Value] = {"n": 3, "r": 2.5, "yes": True, "no": False, "a": (5, 6, 7), "m": ((1, 2), (3, 4))}

VALUES: list[tuple[str, Value]] = [
    ("7", 7),
    ("7.0", 7.0),
    ("{'constant': 'π'}", math.pi),
    ("{'constant': 'e'}", math.e),
    ("'n'", 3),
    (op("+", 1, "'n'"), 4),
    (op("-", 0, "'r'"), -2.5),
    (op("/", 6, 3), 2.0),
    (op("/", 1, 2), 0.5),
    (op("pow", 2, 10), 1024),
    (op("pow", 2, op("-", 0, 1)), 0.5),
    (op("log", 8, 2), 3.0),
    (op("floor", op("-", 0, "'r'")), -3),
    (op("ceil", op("-", 0, "'r'")), -2),
    (op("trc", op("-", 0, "'r'")), -2),
    (op("sgn", op("-", 0, "'r'")), -1),
    (op("abs", op("-", 0, 4)), 4),
    (op("min", 2, 2.5), 2),
    (op("max", 2, 2.5), 2.5),
    (op("sin", 0), 0.0),
    (op("acot", 0), math.pi / 2),
    (op("asec", 2), math.acos(0.5)),
    # The Euclidean remainder; the first three are what Storm computes, too.
    (op("%", 7, 3), 1),
    (op("%", op("-", 0, 7), 3), 2),
    (op("%", 7, op("-", 0, 3)), 1),
    (op("%", op("-", 0, 7), op("-", 0, 3)), 2),
    (op("%", op("-", 0, 7.5), 2), 0.5),
    (op("=", 2, 2.0), True),
    (op("≠", "'yes'", "'no'"), True),
    (op("=", "'a'", "{'op': 'av', 'elements': [5, 6, 7]}"), True),
    (op("≤", "'n'", 3), True),
    (op("⇒", "'no'", "'no'"), True),
    (op("⇒", "'yes'", "'no'"), False),
    (op("¬", "'no'"), True),
    ("{'op': 'ite', 'if': 'yes', 'then': 1, 'else': 2}", 1),
    # What is not needed is not evaluated.
    (op("∧", "'no'", op("=", op("/", 1, 0), 1)), False),
    (op("∨", "'yes'", "'nobody'"), True),
    (op("⇒", "'no'", "'nobody'"), True),
    ("{'op': 'ite', 'if': 'no', 'then': 'nobody', 'else': 2}", 2),
    ("{'op': 'aa', 'exp': 'a', 'index': 2}", 7),
    ("{'op': 'aa', 'exp': {'op': 'aa', 'exp': 'm', 'index': 1}, 'index': 0}", 3),
    ("{'op': 'av', 'elements': []}", ()),
    ("{'op': 'ac', 'var': 'i', 'length': 3, 'exp': " + op("*", "'i'", "'n'") + "}", (0, 3, 6)),
    (
        "{'op': 'ac', 'var': 'n', 'length': 2, 'exp': {'op': 'ac', 'var': 'n', 'length': 'n', 'exp': 'n'}}",
        ((), (0,)),
    ),
    (
        "{'op': 'dv', 'type': 'point', 'values': [{'member': 'x', 'value': 1}]}",
        DatatypeInstance("point", {"x": 1}),
    ),
    (
        "{'op': 'da', 'member': 'x', 'exp': {'op': 'dv', 'type': 'point', 'values': [{'member': 'x', 'value': 1}]}}",
        1,
    ),
    ("{'op': 'ov', 'exp': 1}", Some(1)),
    ("{'op': 'oa', 'exp': {'op': 'ov', 'exp': 1}}", 1),
    ("{'op': 'empty'}", None),
    (op("=", "{'op': 'empty'}", "{'op': 'ov', 'exp': 1}"), False),
    ("{'op': 'call', 'function': 'factorial', 'args': [5]}", 120),
]

FACTORIAL = Function(
    "factorial",
    INT,
    (Parameter("k", INT),),
    Conditional(
        Binary(BinaryOperator.LESS, Name("k"), Integer(1)),
        Integer(1),
        expression(op("*", "'k'", "{'op': 'call', 'function': 'factorial', 'args': [" + op("-", "'k'", 1) + "]}")),
    ),
)
ENDLESS = Function("endless", INT, (), expression("{'op': 'call', 'function': 'endless', 'args': []}"))
FUNCTIONS = {"factorial": FACTORIAL, "endless": ENDLESS}


@pytest.mark.parametrize(("text", "value"), VALUES)
def test_values(text: str, value: Value) -> None:
    result = evaluate(expression(text), STATE, FUNCTIONS)
    assert result == value
    assert type(result) is type(value)


# The part in ⟦ ⟧ is what the error is about.
ERRORS = [
    (op("+", 1, "⟦" + op("/", 1, 0) + "⟧"), "division by zero"),
    ("⟦" + op("%", 1, 0) + "⟧", "division by zero"),
    ("⟦" + op("log", 5, 1) + "⟧", "division by zero"),
    ("⟦" + op("log", 0, 2) + "⟧", "`log` has no value for 0 and 2"),
    ("⟦" + op("pow", 0, op("-", 0, 1)) + "⟧", "`pow` has no value for 0 and -1"),
    ("⟦" + op("asin", 2) + "⟧", "`asin` has no value for 2"),
    ("⟦" + op("pow", 10.0, 400) + "⟧", "the result of `pow` is too large"),
    ("⟦" + op("pow", 10, 10**9) + "⟧", "the result of `pow` is too large"),
    ("{'op': 'aa', 'exp': 'm', 'index': '⟦x⟧'}", "there is no variable `x`"),
    ("⟦{'op': 'aa', 'exp': 'a', 'index': 3}⟧", "index 3 is outside of the array, whose length is 3"),
    ("⟦{'op': 'aa', 'exp': 'a', 'index': " + op("-", 0, 1) + "}⟧", "index -1 is outside of the array"),
    ("{'op': 'aa', 'exp': 'a', 'index': ⟦1.0⟧}", "this must be a whole number, not 1.0"),
    ("{'op': 'aa', 'exp': '⟦n⟧', 'index': 1}", "this is not an array"),
    ("{'op': 'ac', 'var': 'i', 'length': ⟦1e3⟧, 'exp': 1}", "this must be a whole number, not 1000.0"),
    (
        "{'op': 'ac', 'var': 'i', 'length': ⟦10000000000⟧, 'exp': 1}",
        "an array cannot have 10000000000 elements; from 0 to 1,000,000 are supported",
    ),
    ("⟦" + op("+", 1, "'yes'") + "⟧", "`+` cannot be applied to 1 and true"),
    ("⟦" + op("=", 1, "'yes'") + "⟧", "`=` cannot be applied to 1 and true"),
    ("⟦" + op("¬", 1) + "⟧", "`¬` cannot be applied to 1"),
    (op("∧", "'yes'", "⟦1⟧"), "this must be true or false, not 1"),
    ("⟦" + op("<", "'a'", 1) + "⟧", "`<` cannot be applied to an array of 3 elements and 1"),
    ("⟦{'op': 'oa', 'exp': {'op': 'empty'}}⟧", "the option is empty"),
    ("⟦{'op': 'da', 'exp': 'n', 'member': 'x'}⟧", "the value has no member `x`"),
    ("⟦{'op': 'call', 'function': 'f', 'args': []}⟧", "there is no function `f`"),
    (
        "⟦{'op': 'call', 'function': 'factorial', 'args': []}⟧",
        "wrong number of arguments of `factorial`: 0 instead of 1",
    ),
    (
        "{'op': 'call', 'function': 'endless', 'args': []}",
        "more than 10,000 calls of functions are nested, the innermost one of `endless`",
    ),
    ("⟦{'distribution': 'Uniform', 'args': [0, 1]}⟧", "a random value is not known in advance"),
    ("⟦{'op': 'nondet', 'var': 'i', 'exp': true}⟧", "a nondeterministic choice has no single value"),
    ("{'op': 'der', 'var': '⟦n⟧'}", "the derivative of `n` is not known in a state"),
]


@pytest.mark.parametrize(("marked", "message"), ERRORS)
def test_errors(marked: str, message: str) -> None:
    text = marked.replace("⟦", "").replace("⟧", "")
    with pytest.raises(EvaluationError) as error:
        evaluate(expression(text), STATE, FUNCTIONS)
    assert error.value.message.startswith(message)
    origin = error.value.origin
    assert origin is not None
    assert origin.path == "test.jani"
    if "⟦" in marked:
        assert origin.span == (marked.index("⟦"), marked.index("⟧") - 1)


def test_depth() -> None:
    chain: Expression = Boolean(True)
    for _ in range(50_000):
        chain = Binary(BinaryOperator.AND, chain, Unary(UnaryOperator.NOT, Name("no")))
    assert evaluate(chain, STATE) is True


# ---------------------------------------------------------------- Python as a judge


PYTHON = {"∧": "and", "∨": "or", "=": "==", "≠": "!=", "≤": "<=", "≥": ">="}
ARITHMETIC = [
    BinaryOperator.ADD,
    BinaryOperator.SUBTRACT,
    BinaryOperator.MULTIPLY,
    BinaryOperator.REMAINDER,
    BinaryOperator.DIVIDE,
    BinaryOperator.MINIMUM,
    BinaryOperator.MAXIMUM,
]
COMPARISONS = [
    BinaryOperator.EQUAL,
    BinaryOperator.NOT_EQUAL,
    BinaryOperator.LESS,
    BinaryOperator.LESS_EQUAL,
    BinaryOperator.GREATER,
    BinaryOperator.GREATER_EQUAL,
]
LOGIC = [BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLIES]


def in_python(node: Expression) -> str:
    """Python source with the same meaning, for integers and booleans."""
    match node:
        case Name(identifier):
            return identifier
        case Integer(value) | Boolean(value):
            return f"({value})"
        case Unary(operator, operand):
            return f"({'not ' if operator is UnaryOperator.NOT else 'abs'}({in_python(operand)}))"
        case Binary(operator, left, right):
            first, second = in_python(left), in_python(right)
            match operator.symbol:
                case "min" | "max":
                    return f"{operator.symbol}({first}, {second})"
                case "⇒":
                    return f"(not {first} or {second})"
                case "%":
                    return f"({first} % abs({second}))"
                case symbol:
                    return f"({first} {PYTHON.get(symbol, symbol)} {second})"
        case Conditional(test, then, otherwise):
            return f"({in_python(then)} if {in_python(test)} else {in_python(otherwise)})"
        case _:
            raise AssertionError(node)


NUMBERS: st.SearchStrategy[Expression] = st.deferred(
    lambda: st.one_of(
        st.builds(Integer, st.integers(-5, 5)),
        st.builds(Name, st.sampled_from(["n", "k"])),
        st.builds(Unary, st.just(UnaryOperator.ABS), NUMBERS),
        st.builds(Binary, st.sampled_from(ARITHMETIC), NUMBERS, NUMBERS),
        st.builds(Conditional, CONDITIONS, NUMBERS, NUMBERS),
    )
)
CONDITIONS: st.SearchStrategy[Expression] = st.deferred(
    lambda: st.one_of(
        st.builds(Boolean, st.booleans()),
        st.builds(Unary, st.just(UnaryOperator.NOT), CONDITIONS),
        st.builds(Binary, st.sampled_from(COMPARISONS), NUMBERS, NUMBERS),
        st.builds(Binary, st.sampled_from(LOGIC), CONDITIONS, CONDITIONS),
    )
)


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(NUMBERS | CONDITIONS, st.integers(-3, 3), st.integers(-3, 3))
def test_python_agrees(node: Expression, n: int, k: int) -> None:
    try:
        expected: Any = eval(in_python(node), {"n": n, "k": k})
    except ZeroDivisionError:
        with pytest.raises(EvaluationError, match="division by zero"):
            evaluate(node, {"n": n, "k": k})
    else:
        assert evaluate(node, {"n": n, "k": k}) == expected


# ---------------------------------------------------------------- types as a judge


def is_of(value: Value, type_: Type) -> bool:
    match type_:
        case BasicType.BOOL:
            return isinstance(value, bool)
        case BasicType.INT:
            return isinstance(value, int) and not isinstance(value, bool)
        case BasicType():
            return isinstance(value, (int, float)) and not isinstance(value, bool)
        case BoundedType(base):
            return is_of(value, base)
        case ArrayType(element):
            return isinstance(value, tuple) and all(is_of(item, element) for item in value)
        case OptionType(content):
            return value is None or (isinstance(value, Some) and is_of(value.content, content))
        case DatatypeType(name):
            return isinstance(value, DatatypeInstance) and value.datatype == name
        case UnknownType():
            return True


SCOPE = TypeScope(
    {"x": INT, "y": REAL, "seen.valid": BOOL, "e__p": ArrayType(INT), "a.d1_len": ArrayType(ArrayType(BOOL))},
)
SCOPE_STATE: dict[str, Value] = {
    "x": 2,
    "y": -1.5,
    "seen.valid": True,
    "e__p": (3, 1, 2),
    "a.d1_len": ((True,), (False, True)),
}
TYPE_ERRORS = ("cannot be applied", "must be", "not an array", "no member", "no variable", "no function", "arguments")


def blames_types(node: Expression) -> bool:
    """Whether the evaluation of `node` fails for a reason that its types exclude."""
    try:
        evaluate(node, SCOPE_STATE)
    except EvaluationError as error:
        return any(part in error.message for part in TYPE_ERRORS)
    return False


def has_value_of(node: Expression, type_: Type) -> bool:
    """Whether `node` has a value of `type_`, or fails for a reason that types do not exclude."""
    try:
        return is_of(evaluate(node, SCOPE_STATE), type_)
    except EvaluationError:
        return True


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(EXPRESSIONS)
def test_types_foresee_errors(node: Expression) -> None:
    type_, findings = expression_type(node, SCOPE)
    assert findings or (not blames_types(node) and has_value_of(node, type_))


CLOSED = [BinaryOperator.ADD, BinaryOperator.SUBTRACT, BinaryOperator.MULTIPLY, BinaryOperator.REMAINDER]
REAL_ONLY = [BinaryOperator.DIVIDE, BinaryOperator.LOGARITHM, BinaryOperator.POWER]


def either(of: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
    return st.builds(Conditional, TRUTHS, of, of)


WHOLES: st.SearchStrategy[Expression] = st.deferred(
    lambda: st.one_of(
        st.builds(Integer, st.integers(-3, 9)),
        st.just(Name("x")),
        st.builds(Unary, st.just(UnaryOperator.ABS), WHOLES),
        st.builds(Unary, st.sampled_from([UnaryOperator.FLOOR, UnaryOperator.SIGN]), REALS),
        st.builds(Binary, st.sampled_from([*CLOSED, BinaryOperator.MINIMUM]), WHOLES, WHOLES),
        st.builds(Binary, st.just(BinaryOperator.POWER), WHOLES, st.builds(Integer, st.integers(0, 3))),
        st.builds(ArrayAccess, ARRAYS, WHOLES),
        either(WHOLES),
    )
)
REALS: st.SearchStrategy[Expression] = st.deferred(
    lambda: st.one_of(
        WHOLES,
        st.builds(Real, st.floats(-9, 9)),
        st.just(Name("y")),
        st.builds(Unary, st.sampled_from([UnaryOperator.SIN, UnaryOperator.ACOSH, UnaryOperator.ABS]), REALS),
        st.builds(Binary, st.sampled_from([*CLOSED, *REAL_ONLY]), REALS, REALS),
        either(REALS),
    )
)
TRUTHS: st.SearchStrategy[Expression] = st.deferred(
    lambda: st.one_of(
        st.just(Name("seen.valid")),
        st.builds(Binary, st.sampled_from(COMPARISONS), REALS, REALS),
        st.builds(Binary, st.sampled_from(LOGIC), TRUTHS, TRUTHS),
        st.builds(Binary, st.just(BinaryOperator.EQUAL), ARRAYS, ARRAYS),
    )
)
ARRAYS: st.SearchStrategy[Expression] = st.deferred(
    lambda: st.one_of(
        st.just(Name("e__p")),
        st.builds(ArrayValue, st.lists(WHOLES, max_size=3).map(tuple)),
        st.builds(ArrayConstructor, st.just("i"), st.builds(Integer, st.integers(0, 3)), WHOLES | st.just(Name("i"))),
        either(ARRAYS),
    )
)


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(
    st.one_of(
        st.tuples(WHOLES, st.just(INT)),
        st.tuples(REALS, st.just(REAL)),
        st.tuples(TRUTHS, st.just(BOOL)),
        st.tuples(ARRAYS, st.just(ArrayType(INT))),
    )
)
def test_sensible_expressions_have_their_type(typed: tuple[Expression, Type]) -> None:
    node, expected = typed
    type_, findings = expression_type(node, SCOPE)
    assert findings == ()
    assert fits(type_, expected)
    assert has_value_of(node, expected)

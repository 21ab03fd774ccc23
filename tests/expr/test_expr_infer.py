# SPDX-License-Identifier: Apache-2.0
"""Types of expressions, and type errors in them (docs/spec/expressions.md#operators)."""

from __future__ import annotations

import re

import pytest
from expr_cases import tree_of

from roaml.expr.infer import Problem, constant, infer
from roaml.expr.operators import FUNCTIONS
from roaml.expr.types import BASE_TYPES, UNKNOWN, Array, Struct, Type

POINT = Struct("Point", (("x", BASE_TYPES["float64"]), ("label", BASE_TYPES["string"])))
POSE = Struct("Pose", (("at", POINT), ("path", Array(POINT, 5)), ("length", BASE_TYPES["int8"])))
SCOPE: dict[str, Type] = {
    "b": BASE_TYPES["bool"],
    "i": BASE_TYPES["int32"],
    "j": BASE_TYPES["uint8"],
    "f": BASE_TYPES["float64"],
    "s": BASE_TYPES["string"],
    "v": Array(BASE_TYPES["int16"], 3),
    "w": Array(Array(BASE_TYPES["float32"], None), 2),
    "names": Array(BASE_TYPES["string"], None),
    "p": POINT,
    "ps": Array(POINT, 4),
    "pose": POSE,
    "poses": Array(POSE, 2),
    "unknown": UNKNOWN,
}

TYPES = [
    # expression, type
    ("1", "int"),
    ("1e3", "int"),
    ("1.0", "float"),
    ("0.5", "float"),
    ("true", "bool"),
    ("'a'", "string"),
    ("i", "int32"),
    ("f", "float64"),
    ("-i", "int"),
    ("-f", "float"),
    ("+i", "int"),
    ("!b", "bool"),
    ("i + j", "int"),
    ("i - 1.5", "float"),
    ("f * i", "float"),
    ("i % 2", "int"),
    ("f / 2", "float"),
    ("i < f", "bool"),
    ("i == 2.0", "bool"),
    ("b == true", "bool"),
    ("s == 'x'", "bool"),
    ("v == [1, 2]", "bool"),
    ("v == []", "bool"),
    ("b && i > 0 || !b", "bool"),
    ("v", "int16[3]"),
    ("v[0]", "int16"),
    ("v[i + 1]", "int16"),
    ("w", "float32[2][]"),
    ("w[1]", "float32[]"),
    ("w[1][i]", "float32"),
    ("v.length", "int"),
    ("w[0].length", "int"),
    ("s.length", "int"),
    ("s[0]", "int"),
    ("names[2]", "string"),
    ("names[2][0]", "int"),
    ("names.length", "int"),
    ("p", "Point"),
    ("p.x", "float64"),
    ("ps", "Point[4]"),
    ("ps[1]", "Point"),
    ("ps[1].label", "string"),
    ("ps.x", "float64[4]"),
    ("ps.x[2]", "float64"),
    ("ps.length", "int"),
    ("pose.at.x", "float64"),
    ("pose.path[0].label.length", "int"),
    ("pose.length", "int8"),
    ("poses.length", "int"),
    ("[1, 2]", "int[2]"),
    ("[1, 2.5]", "float[2]"),
    ("[[1], [2.5, 3]]", "float[2][2]"),
    ("[[1, 2, 3], [4]]", "int[2][3]"),
    ("[[], [1]]", "int[2][1]"),
    ("[]", "[]"),
    ("[].length", "int"),
    ("['a', 'b']", "string[2]"),
    ("b ? 1 : 2.5", "float"),
    ("b ? v : [1]", "int[3]"),
    ("Math.abs(i)", "int"),
    ("Math.abs(f)", "float"),
    ("Math.max(1, 2)", "int"),
    ("Math.min(1, 2.5)", "float"),
    ("Math.min(1, 2, 3)", "int"),
    ("Math.max(1, 2, 2.5)", "float"),
    ("Math.floor(f)", "int"),
    ("Math.ceil(f)", "int"),
    ("Math.sin(1)", "float"),
    ("Math.cos(1)", "float"),
    ("Math.pow(2, 3)", "float"),
    ("Math.log(2)", "float"),
    ("Math.log(8, 2)", "float"),
    # An unknown type causes no further findings.
    ("unknown", "unknown"),
    ("unknown.x[2].y + 1", "unknown"),
    ("unknown && b", "bool"),
    ("unknown == p", "bool"),
    ("v[unknown]", "int16"),
    ("b ? unknown : 1", "int"),
    ("Math.max(unknown - 5, 0)", "unknown"),
    ("Math.floor(unknown)", "int"),
    ("_msg.", "unknown"),
]


@pytest.mark.parametrize(("text", "type_"), TYPES)
def test_types(text: str, type_: str) -> None:
    scope = {**SCOPE, "_msg": UNKNOWN}
    assert str(infer(tree_of(text), scope.get)[0]) == type_


@pytest.mark.parametrize("text", [text for text, _ in TYPES if "== p" not in text])
def test_no_problems(text: str) -> None:
    scope = {**SCOPE, "_msg": UNKNOWN}
    assert infer(tree_of(text), scope.get)[1] == ()


REPRINTED = [
    # expression, type after the numbers were printed without their `.0` (docs/spec/expressions.md#whole-reals)
    ("1.0", "int"),
    ("1.5", "float"),
    ("-2.0", "int"),
    ("1.0 + i", "int"),
    ("[1.0, 2.0]", "int[2]"),
    ("f * 1.0", "float"),
]


@pytest.mark.parametrize(("text", "type_"), REPRINTED)
def test_reprinted(text: str, type_: str) -> None:
    assert str(infer(tree_of(text), SCOPE.get, reprinted=True)[0]) == type_


PROBLEMS = [
    # expression with the place of each problem in «», the problems
    ("«zz» + 1", "UnknownName(name='zz')"),
    ("«null»", "UnknownName(name='null')"),
    ("p.«z»", "UnknownMember(name='z' owner=Point)"),
    ("i.«x»", "UnknownMember(name='x' owner=int32)"),
    ("i.«length»", "UnknownMember(name='length' owner=int32)"),
    ("v.«x»", "UnknownMember(name='x' owner=int16[3])"),
    ("«i[0]»", "BadIndex(indexed=int32 index=int)"),
    ("«p[0]»", "BadIndex(indexed=Point index=int)"),
    ("«[][0]»", "BadIndex(indexed=[] index=int)"),
    ("v[«1.5»]", "BadIndex(indexed=int16[3] index=float)"),
    ("v[«b»]", "BadIndex(indexed=int16[3] index=bool)"),
    ("s[«'a'»]", "BadIndex(indexed=string index=string)"),
    ("v[«3»]", "IndexOutOfBounds(index=3 array=int16[3])"),
    ("v[«-1»]", "IndexOutOfBounds(index=-1 array=int16[3])"),
    ("v[«1 + 2»]", "IndexOutOfBounds(index=3 array=int16[3])"),
    ("names[«-1»]", "IndexOutOfBounds(index=-1 array=string[])"),
    ("w[0][«-1»]", "IndexOutOfBounds(index=-1 array=float32[])"),
    ("«b» + 1", "BadOperand(operator='+' given=bool required=float)"),
    ("-«b»", "BadOperand(operator='-' given=bool required=float)"),
    ("!«i»", "BadOperand(operator='!' given=int32 required=bool)"),
    ("b && «i»", "BadOperand(operator='&&' given=int32 required=bool)"),
    ("«s» || b", "BadOperand(operator='||' given=string required=bool)"),
    ("i < «b»", "BadOperand(operator='<' given=bool required=float)"),
    ("«v» >= 1", "BadOperand(operator='>=' given=int16[3] required=float)"),
    ("«i» ? 1 : 2", "BadOperand(operator='?' given=int32 required=bool)"),
    ("Math.abs(«b»)", "BadOperand(operator='Math.abs' given=bool required=float)"),
    ("«i == b»", "BadComparison(operator='==' left=int32 right=bool)"),
    ("«s != 1»", "BadComparison(operator='!=' left=string right=int)"),
    ("«p == p»", "BadComparison(operator='==' left=Point right=Point)"),
    ("«ps == []»", "BadComparison(operator='==' left=Point[4] right=[])"),
    ("«Math.PI» * 2", "UnknownFunction(name='Math.PI' called=False)"),
    ("«Math.floor»", "UnknownFunction(name='Math.floor' called=False)"),
    ("«Math»", "UnknownFunction(name='Math' called=False)"),
    ("«Math.sqrt»(2)", "UnknownFunction(name='Math.sqrt' called=True)"),
    ("«f»(2)", "UnknownFunction(name='f' called=True)"),
    ("«v.push»(2)", "UnknownFunction(name='.push' called=True)"),
    ("«v[0]»(2)", "UnknownFunction(name='' called=True)"),
    ("«Math.max(1)»", "WrongArgumentCount(function='max' given=1)"),
    ("«Math.log()»", "WrongArgumentCount(function='log' given=0)"),
    ("«Math.log(1, 2, 3)»", "WrongArgumentCount(function='log' given=3)"),
    ("[1, «true»]", "MixedTypes(first=int other=bool)"),
    ("[[1], «2»]", "MixedTypes(first=int[1] other=int)"),
    ("b ? 1 : «'a'»", "MixedTypes(first=int other=string)"),
    ("i / «0»", "DivisionByZero()"),
    ("i / «0.0»", "DivisionByZero()"),
    ("i «/» 2", "IntegerDivision()"),
    ("«Math.random()» * 2", "RandomUsed()"),
    ("p.«length»", "LengthOfStruct(struct=Point)"),
    ("«{x: 1}»", "ObjectUsed()"),
    ("[1, «i»]", "ElementComputed()"),
    ("[-1, «1 + 1»]", "ElementComputed()"),
    ("[[true], [!true, «!b»]]", "ElementComputed()"),
    ("['a', «s»]", "ElementComputed()"),
    ("[«p»]", "ElementComputed()"),
]


@pytest.mark.parametrize(("marked", "expected"), PROBLEMS)
def test_problems(marked: str, expected: str) -> None:
    text = re.sub("[«»]", "", marked)
    problems = infer(tree_of(text), SCOPE.get)[1]
    assert [description(problem) for problem in problems] == [expected]
    start, end = marked.index("«"), marked.index("»") - 1
    assert problems[0].span == (start, end)


SEVERAL = [
    # expression, its problems in order
    ("'a' + s", ["BadOperand 'a'", "BadOperand s"]),
    ("zz.x + p.y * yy", ["UnknownName zz", "UnknownMember y", "UnknownName yy"]),
    ("Math.random(zz)", ["WrongArgumentCount Math.random(zz)", "RandomUsed Math.random(zz)", "UnknownName zz"]),
    ("f % (1 - 1)", ["DivisionByZero 1 - 1"]),
    ("zz & yy", ["UnknownName zz", "UnknownName yy"]),
    ("v.push(zz)", ["UnknownFunction v.push", "UnknownName zz"]),
    ("[zz, i]", ["UnknownName zz"]),
    ("zz ? zz : b", ["UnknownName zz", "UnknownName zz"]),
]


@pytest.mark.parametrize(("text", "expected"), SEVERAL)
def test_several_problems(text: str, expected: list[str]) -> None:
    problems = infer(tree_of(text), SCOPE.get)[1]
    assert [f"{type(p).__name__} {text[p.span.start : p.span.end]}" for p in problems] == expected


def description(problem: Problem) -> str:
    values = {name: getattr(problem, name) for name in problem.__struct_fields__ if name != "span"}
    shown = (f"{k}={v!r}" if isinstance(v, (str, bool, int)) else f"{k}={v}" for k, v in values.items())
    return f"{type(problem).__name__}({' '.join(shown)})"


CONSTANTS = [
    ("2", 2),
    ("-2", -2),
    ("+2", 2),
    ("1 + 2 * 3", 7),
    ("7 / 2", 3.5),
    ("7 % 4", 3),
    ("1 - 0.5", 0.5),
    ("1 / 0", None),
    ("1 % 0", None),
    ("i + 1", None),
    ("1 < 2", None),
    ("true", None),
    ("1e308 * 10.0", None),
    ("1e308 * 1e308", None),
    ("1e308 / 1e-300", None),
    ("1.5e308 + 1.5e308", None),
]


@pytest.mark.parametrize(("text", "value"), CONSTANTS)
def test_constant(text: str, value: float | None) -> None:
    assert constant(tree_of(text)) == value


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions(name: str) -> None:
    """Each has a signature, and wrong numbers of arguments are reported."""
    function = FUNCTIONS[name]
    assert function.documentation
    for count in range(len(function.parameters) + 2):
        text = f"Math.{name}({', '.join('f' * count)})"
        problems = [type(p).__name__ for p in infer(tree_of(text), SCOPE.get)[1] if type(p).__name__ != "RandomUsed"]
        most = count if name in ("min", "max") else len(function.parameters)
        fits = len(function.parameters) - function.optional <= count <= most
        assert problems == ([] if fits else ["WrongArgumentCount"])


def test_a_variable_may_be_called_math() -> None:
    assert infer(tree_of("Math.x"), {"Math": POINT}.get) == (BASE_TYPES["float64"], ())

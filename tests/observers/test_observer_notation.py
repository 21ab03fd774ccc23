# SPDX-License-Identifier: Apache-2.0
"""Formulas as text."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.observers.build import observer_of
from roaml.observers.notation import MAX_DEPTH, MAX_OPERATORS, read
from roaml.observers.properties import (
    And,
    Atom,
    Constant,
    Formula,
    FormulaProperty,
    Not,
    Or,
    Since,
    Window,
    historically,
    implies,
    once,
)

A, B, C = Atom("a"), Atom("b"), Atom("c")


@pytest.mark.parametrize(
    ("text", "formula"),
    [
        ("{ a }", A),
        ("{a} && {b} || {c}", Or(And(A, B), C)),
        ("{a} || {b} && {c}", Or(A, And(B, C))),
        ("{a} -> {b} -> {c}", implies(A, implies(B, C))),
        ("{a} S {b} S {c}", Since(Since(A, B), C)),
        ("!{a} S[:5] {b} && {c}", And(Since(Not(A), B, Window(0, 5)), C)),
        ("H[2:] ({a} || {b})", historically(Or(A, B), Window(2))),
        ("once [ 1 : 3 ] not {a}", once(Not(A), Window(1, 3))),
        ("historically {a} since {b} and once true", And(Since(historically(A), B), once(Constant(True)))),
        ("O[:]{a}", once(A)),
    ],
)
def test_formula(text: str, formula: Formula) -> None:
    notation = read(text)
    assert notation.problems == ()
    assert notation.formula == formula


def test_spans_of_atoms_and_braces_in_strings() -> None:
    text = "{ name == '}' } -> { a }"
    notation = read(text)
    assert notation.formula == implies(Atom("name == '}'"), A)
    assert [text[span.start : span.end] for span in notation.atoms] == [" name == '}' ", " a "]


@pytest.mark.parametrize(
    ("text", "at", "message"),
    [
        ("", "", "expected a condition in braces: `{ level < 30 }`"),
        ("{a} &&", "", "expected a condition in braces: `{ level < 30 }`"),
        ("level", "level", "expected a condition in braces instead of `level`: `{ level < 30 }`"),
        ("{ }", "{ }", "there is no condition in these braces; write for example `{ level < 30 }`"),
        ("({a}", "", "expected `)`"),
        ("{a} {b}", "{b}", "expected an operator or the end of the formula before `{b}`"),
        ("{a} S[5] {b}", "[5]", "bounds must be whole clock steps: `[1:5]`, `[:5]` or `[1:]`"),
        ("O[-1:2] {b}", "[-1:2]", "bounds must be whole clock steps: `[1:5]`, `[:5]` or `[1:]`"),
        ("O[3:2] {b}", "[3:2]", "the lower bound 3 is greater than the upper bound 2"),
        ("[1:2] {a}", "[1:2]", "bounds are only allowed after `S`, `H` or `O`: `O[:5] { alarm }`"),
        ("{a", "{", "expected a condition in braces instead of `{`: `{ level < 30 }`"),
    ],
)
def test_problem(text: str, at: str, message: str) -> None:
    notation = read(text)
    assert notation.formula is None
    ((span, said),) = notation.problems
    assert (text[span.start : span.end], said) == (at, message)


@pytest.mark.parametrize("text", ["(" * 5000, "!" * 5000 + "{a}", "{a} -> " * 150 + "{b}"])
def test_depth_is_bounded(text: str) -> None:
    ((_, message),) = read(text).problems
    assert message == f"the formula is nested more than {MAX_DEPTH} levels deep"


def test_length_is_bounded() -> None:
    ((_, message),) = read("{a} && " * 5000 + "{b}").problems
    assert message == f"the formula has more than {MAX_OPERATORS} binary operators"
    long = read("{a} && " * MAX_OPERATORS + "{b}").formula
    assert long is not None
    observer_of(FormulaProperty(long))


@given(st.text(alphabet="{}()[]:ab12 SHO!&|->\"'", max_size=30))
def test_parsing_never_raises(text: str) -> None:
    notation = read(text)
    assert (notation.formula is None) == bool(notation.problems)
    assert all(0 <= span.start <= span.end <= len(text) for span, _ in notation.problems)

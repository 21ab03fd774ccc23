# SPDX-License-Identifier: Apache-2.0
"""The script language: what is read as what, and what is said about mistakes (docs/spec/scripts.md)."""

from __future__ import annotations

import pytest

from bracketed_script import with_brackets
from roaml.script.infer import Type, check_condition, check_types, statements_without_effect
from roaml.script.parse import parse
from roaml.script.tree import (
    Assignment,
    ErrorExpr,
)
from roaml.text import Decoded


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("10-3-2", "((10 - 3) - 2)"),
        ("2 + 3 * 4", "(2 + (3 * 4))"),
        ("-a * ~b", "((-a) * (~b))"),
        ("a & b | c ^ d", "(((a & b) | c) ^ d)"),
        ("flags & 1 == 1", "((flags & 1) == 1)"),
        ("a | b == c", "((a | b) == c)"),
        ("a + b & c", "((a + b) & c)"),
        ("a < b < c", "(a < b < c)"),
        ("a == b && c || d && !e", "(((a == b) && c) || (d && (!e)))"),
        ("a ? b : c ? d : e", "(a ? b : (c ? d : e))"),
        ("a := b := 3", "(a := (b := 3))"),
        ("a := b ? 'x' .. 1 : @y", "(a := (b ? ('x' .. 1) : @y))"),
        ("x += 0x1F", "(x += 31)"),
        ("x := 1.5e3", "(x := 1500.0)"),
        ("1..2", "(1 .. 2)"),
        ("(a := 1) + 2", "((a := 1) + 2)"),
        ("true && false", "(true && false)"),
    ],
)
def test_precedence(text: str, tree: str) -> None:
    script, problems = parse(Decoded(text, 0))
    assert [with_brackets(statement) for statement in script.statements] == [tree]
    assert problems == ()


@pytest.mark.parametrize(
    ("text", "count"), [("a:=1; b:=2", 2), ("a:=1 b:=2", 2), ("a:=1;", 1), ("a:=1;;b:=2", 2), ("a:=1\n;\nb:=2;", 2)]
)
def test_statements(text: str, count: int) -> None:
    script, problems = parse(Decoded(text, 0))
    assert (len(script.statements), problems) == (count, ())


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ("", "", "the script is empty"),
        ("  ", "  ", "the script is empty"),
        ("; a := 1", ";", "cannot begin with `;`"),
        ("a := ", "", "ends where a value is expected"),
        ("a = = 3", "=", "`=` needs the name of an entry"),
        ("1 := 3", ":=", "`:=` needs the name of an entry"),
        ("a + b := 3", ":=", "`:=` needs the name of an entry"),
        ("a % 2", "%", "not support remainders"),
        ("a++", "++", "write `+= 1`"),
        ("a === b", "===", "write `==`"),
        ("a << 2", "<<", "not support shifts"),
        ('a := "x"', '"x"', "single quotes"),
        ("a := 'x", "'x", "no closing"),
        ("a := (1 + 2", "(", "is never closed"),
        ("a := 1)", ")", "closes no bracket"),
        ("a ? 1", "", "needs a `:`"),
        ("a : 1", ":", "has no `?`"),
        ("a := .5", ".5", "digits on both sides"),
        ("a := 5.", "5.", "neither a number nor a name"),
        ("a := 3x", "3x", "neither a number nor a name"),
        ("a := @", "@", "followed by the name of an entry"),
        ("a and b", "and", "write `&&`"),
        ("a $ b", "$", "not support `$`"),
        ("a := 99999999999999999999", "99999999999999999999", "64 bits"),
    ],
)
def test_mistakes(text: str, place: str, message: str) -> None:
    _, problems = parse(Decoded(text, 0))
    assert len(problems) == 1, problems
    start, end = problems[0].span
    assert text[start:end] == place
    assert message in problems[0].message


def test_each_statement_has_its_mistake() -> None:
    script, problems = parse(Decoded("a := ; b := 2; c +* 3; d := 4", 0))
    assert [type(statement) for statement in script.statements] == [ErrorExpr, Assignment, ErrorExpr, Assignment]
    assert len(problems) == 2


TYPES = {"number": Type.REAL, "count": Type.INTEGER, "text": Type.TEXT}


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("text - 1", ["text"]),
        ("'a' + 1", ["+"]),
        ("'a' .. 1", []),
        ("1 .. 2", [".."]),
        ("number && text", ["text"]),
        ("!text", ["text"]),
        ("text ? 1 : 2", []),
        ("5 && number", ["5"]),
        ("1.5 & count", ["1.5"]),
        ("count := 'abc'", ["'abc'"]),
        ("count := '3'", []),
        ("count := 1.5", ["1.5"]),
        ("text -= 1", ["text"]),
        ("text += 'a'", []),
        ("text += 1", ["1"]),
        ("x := 3; x = 'a'", ["'a'"]),
        ("x := 'a'; x * 2", ["x"]),
        ("unknown * other + 'a'", ["+"]),
        ("unknown + 'a'", []),
    ],
)
def test_types(text: str, places: list[str]) -> None:
    script, problems = parse(Decoded(text, 0))
    assert not problems
    spans = [problem.span for problem in check_types(script, lambda name: TYPES.get(name, Type.UNKNOWN))]
    assert [text[span.start : span.end] for span in spans] == places


@pytest.mark.parametrize(
    ("text", "fails"), [("text", True), ("2", True), ("1", False), ("a == 2", False), ("a", False)]
)
def test_conditions(text: str, fails: bool) -> None:
    script, _ = parse(Decoded(text, 0))
    assert bool(list(check_condition(script, lambda name: TYPES.get(name, Type.UNKNOWN)))) is fails


@pytest.mark.parametrize(
    ("text", "has_value", "places"),
    [
        ("a b := 1", False, ["a"]),
        ("a := 1 b", False, []),
        ("a == 1; c := 2", True, ["=="]),
        ("a := 1; b", False, []),
        ("a == 1", True, []),
        ("a == 1", False, ["=="]),
        ("a < 1", False, ["a < 1"]),
        ("a := 1; a - 1", False, ["a - 1"]),
        ("b && (a := 1)", False, []),
        ("1", False, []),
    ],
)
def test_statements_without_effect(text: str, has_value: bool, places: list[str]) -> None:
    script, _ = parse(Decoded(text, 0))
    spans = [problem.span for problem in statements_without_effect(script, has_value=has_value)]
    assert [text[span.start : span.end] for span in spans] == places

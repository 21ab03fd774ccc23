# SPDX-License-Identifier: Apache-2.0
"""Checks initial values against declared types (docs/spec/types.md#initial-values). An initial value is a constant, or
an array or object literal of constants."""

from __future__ import annotations

from typing import TypeAlias

from roaml.expr import infer
from roaml.expr.tree import ArrayLiteral, Expr, ObjectLiteral
from roaml.expr.types import Array, ScalarKind, Struct, Type, Unknown, fits, is_kind
from roaml.record import Record
from roaml.text import Span


class MissingMembers(Record, frozen=True):
    """An object literal has no value for the members `names` of the struct."""

    span: Span
    struct: Struct
    names: tuple[str, ...]


class ExtraMember(Record, frozen=True):
    """An object literal has a member that the struct does not have, or that is repeated (`twice`)."""

    span: Span
    struct: Struct
    name: str
    twice: bool


class WrongType(Record, frozen=True):
    span: Span
    given: Type
    required: Type


class TooLong(Record, frozen=True):
    """A literal has more elements than the array can hold."""

    span: Span
    length: int
    array: Array


InitialProblem: TypeAlias = MissingMembers | ExtraMember | WrongType | TooLong | infer.Problem


def check_initial(expr: Expr, target: Type) -> tuple[InitialProblem, ...]:
    """The reasons why `expr` cannot be an initial value of type `target`; empty if it can. Names are not constants."""
    problems: list[InitialProblem] = []
    _check(expr, target, problems)
    return tuple(problems)


def check_bound(expr: Expr, target: Type) -> tuple[InitialProblem, ...]:
    """The reasons why `expr` cannot be a bound of a variable of type `target`; empty if it can. Unlike an initial
    value, a bound of a real variable cannot be an int."""
    problems = check_initial(expr, target)
    given, _ = infer.infer(expr, lambda _: None)
    if not problems and is_kind(target, ScalarKind.REAL) and is_kind(given, ScalarKind.INT):
        return (WrongType(expr.span, given, target),)
    return problems


def _check(expr: Expr, target: Type, problems: list[InitialProblem]) -> None:
    match expr, target:
        case ObjectLiteral(), Struct():
            _check_object(expr, target, problems)
        case ArrayLiteral(), Array():
            if target.bound is not None and len(expr.elements) > target.bound:
                problems.append(TooLong(expr.span, len(expr.elements), target))
            for element in expr.elements:
                _check(element, target.element, problems)
        case ObjectLiteral(), Unknown():
            pass
        case ArrayLiteral(), Unknown():  # the unknown type may be a struct, so the elements may be object literals
            for element in expr.elements:
                _check(element, target, problems)
        case ObjectLiteral(), _:
            problems.append(WrongType(expr.span, Struct("object", ()), target))
        case _:
            type_, type_problems = infer.infer(expr, lambda _: None)
            problems.extend(type_problems)
            if not fits(type_, target):
                problems.append(WrongType(expr.span, type_, target))


def _check_object(expr: ObjectLiteral, target: Struct, problems: list[InitialProblem]) -> None:
    given: set[str] = set()
    for member in expr.members:
        type_ = target.member(member.key)
        if type_ is None or member.key in given:
            problems.append(ExtraMember(member.key_span, target, member.key, member.key in given))
        else:
            _check(member.value, type_, problems)
        given.add(member.key)
    missing = tuple(name for name, _ in target.members if name not in given)
    if missing:
        problems.append(MissingMembers(expr.span, target, missing))

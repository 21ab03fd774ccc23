# SPDX-License-Identifier: Apache-2.0
"""The rule `integer-division`, which integer_division.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.infer import IntegerDivision
from roaml.expr.tree import Binary, Call, Expr, Member, walk
from roaml.expr.types import ScalarKind, is_kind
from roaml.model.syntax import Expression
from roaml.rules.rule import MachineContext, Rule
from roaml.text import Span, TextEdit

WHOLE = ("floor", "ceil")


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        if not isinstance(value.value, Expression) or (
            value.required is not None and is_kind(value.required, ScalarKind.INT)
        ):
            continue  # type-mismatch reports this with more detail
        problems = [problem for problem in value.problems if isinstance(problem, IntegerDivision)]
        rounded = {span for call in _whole(value.value.tree) for span in _divisions(call)} if problems else set()
        for problem in problems:
            if problem.span not in rounded:
                message = "the quotient of integers is a real number (`7 / 2` is 3.5)"
                yield RULE.at(
                    problem.span, f"{message}; for an integer, write `Math.floor(a / b)`", *_fixes(value.value, problem)
                )


def _whole(tree: Expr) -> Iterator[Call]:
    """The calls of `Math.floor` and `Math.ceil` in an expression, which round a quotient to an integer."""
    for node in walk(tree):
        if isinstance(node, Call) and isinstance(node.function, Member) and node.function.name in WHOLE:
            yield node


def _divisions(tree: Expr) -> Iterator[Span]:
    return (node.operator_span for node in walk(tree) if isinstance(node, Binary))


def _fixes(expression: Expression, problem: IntegerDivision) -> Iterator[Fix]:
    for node in walk(expression.tree):
        if isinstance(node, Binary) and node.operator_span == problem.span:
            before, behind = (Span(at, at) for at in (node.span.start, node.span.end))
            edits = (TextEdit(before, "Math.floor("), TextEdit(behind, ")"))
            yield Fix("Round down with `Math.floor`", edits, preferred=False)


RULE = Rule("integer-division", Severity.INFORMATION, "The quotient of two integers is a real number.", machine=check)

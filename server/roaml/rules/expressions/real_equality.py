# SPDX-License-Identifier: Apache-2.0
"""The rule `real-equality`, which real_equality.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.infer import RealEquality
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Call, Expr, Member, Name, is_draw, walk
from roaml.model.syntax import Expression
from roaml.model.value_types import TypedValue
from roaml.model.values.domain import ANYTHING, Origin, ValueSet
from roaml.rules.rule import MachineContext, Rule
from roaml.text import TextEdit

TOLERANCE = "0.001"
_EXACT = ("abs", "ceil", "floor", "max", "min")
"""The functions that do not round a result: they choose one of their arguments, change its sign, or give an integer."""


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, RealEquality) and not _is_exact(context, value, problem):
                left, right = (_text(context, side) for side in (problem.left, problem.right))
                message = (
                    f"real numbers are compared for equality: `{left}` and `{right}`; computed numbers are rounded, so "
                    f"they are rarely equal; compare with a tolerance: `Math.abs({left} - {right}) < {TOLERANCE}`"
                )
                yield RULE.at(problem.span, message, *_fix(context, value, problem))


def _is_exact(context: MachineContext, value: TypedValue, problem: RealEquality) -> bool:
    """Whether both numbers are constants, or some of a few known numbers, which are equal or clearly different, or
    nothing is known about one of them, which may be a number that is only passed on, and the other is an integer."""
    if _is_constant(problem.left) and _is_constant(problem.right):
        return True
    values = context.values.charts.get(value.place.chart.scope)
    if values is None:
        return True
    sides = [values.at(side) for side in (problem.left, problem.right)]
    if any(side is None for side in sides):
        return True
    if all(side is not None and side.only is not None for side in sides):
        return not any(_is_rounded(values.at(side)) for side in (problem.left, problem.right) if _is_computed(side))
    if any(_is_limit(*pair) for pair in (sides, sides[::-1])) and not any(
        map(_is_computed, (problem.left, problem.right))
    ):
        return True
    whole = any(side is not None and isinstance(side.value, int | float) and side.value % 1 == 0 for side in sides)
    passed_on = any(values.at(side) == ANYTHING and not _is_computed(side) for side in (problem.left, problem.right))
    return whole and passed_on


def _is_limit(known: ValueSet | None, limit: ValueSet | None) -> bool:
    """Whether values are limited to a number with which they are compared, as by `Math.min(level, 1.0)`: it is not
    rounded."""
    if known is None or limit is None or not isinstance(limit.value, int | float):
        return False
    return (known.low, known.low_from) == (limit.value, Origin.REACHED) or (known.high, known.high_from) == (
        limit.value,
        Origin.REACHED,
    )


def _is_constant(expr: Expr) -> bool:
    """Whether an expression has the same value each time: it names nothing but functions other than `Math.random`."""
    nodes = list(walk(expr))
    return not any(is_draw(node) or (isinstance(node, Name) and node.name != "Math") for node in nodes)


def _is_computed(expr: Expr) -> bool:
    """Whether a number is the result of an operation that may round it."""
    if isinstance(expr, Call) and isinstance(expr.function, Member) and expr.function.name in _EXACT:
        return any(_is_computed(argument) for argument in expr.arguments)
    return isinstance(expr, Binary | Call)


def _is_rounded(values: ValueSet | None) -> bool:
    """Whether a value is not an integer, so that a computation may have rounded it."""
    return values is not None and any(isinstance(v, float) and not v.is_integer() for v in values.only or ())


def _fix(context: MachineContext, value: TypedValue, problem: RealEquality) -> Iterator[Fix]:
    tree = value.value.tree if isinstance(value.value, Expression) else None
    node = next((n for n in walk(tree) if n.span == problem.span), None) if tree is not None else None
    if not isinstance(node, Binary):
        return
    left, right = (_text(context, side) for side in (problem.left, problem.right))
    subtrahend = f"({right})" if isinstance(problem.right, Binary) else right
    comparison = "&lt;" if node.operator is Operator.EQUAL else "&gt;="
    new = f"Math.abs({left} - {subtrahend}) {comparison} {TOLERANCE}"
    yield Fix(f"Compare with a tolerance of {TOLERANCE}", (TextEdit(problem.span, new),), preferred=False)


def _text(context: MachineContext, expr: Expr) -> str:
    return context.source.text[expr.span.start : expr.span.end]


RULE = Rule("real-equality", Severity.WARNING, "Real numbers are compared for equality.", machine=check, whole=True)

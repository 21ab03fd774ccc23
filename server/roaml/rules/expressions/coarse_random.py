# SPDX-License-Identifier: Apache-2.0
"""The rule `coarse-random`, which coarse_random.md describes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction

from roaml.diagnostics import Finding, Severity
from roaml.expr.infer import constant
from roaml.expr.operators import MIRRORED, Operator, OperatorKind, UnaryOperator
from roaml.expr.tree import Binary, Call, Expr, Member, Name, Unary, children, is_draw, walk
from roaml.model.machine import Assign, Chart
from roaml.model.parameters import DEFAULT_RANDOM_VALUES, MAX_RANDOM_VALUES
from roaml.model.syntax import Expression
from roaml.rules.rule import MachineContext, Rule

ROUNDING = ("floor", "ceil")


def check(context: MachineContext) -> Iterator[Finding]:
    text = context.source.text
    if "random" not in text and "&#" not in text:
        return  # most machines draw no random numbers, and checking all their expressions takes a while
    values = context.system.parameters.random_values if context.system else DEFAULT_RANDOM_VALUES
    drawn = {chart.scope: drawn_variables(chart) for chart in context.machine.charts}
    for value in context.typed.values:
        if isinstance(value.value, Expression):
            yield from _stretched(value.value.tree, values)
            yield from _compared(value.value.tree, drawn[value.place.chart.scope], values)


def _stretched(expr: Expr, values: int) -> Iterator[Finding]:
    """Report random numbers that are multiplied by a constant greater than the number of their values."""
    is_rounded = isinstance(expr, Call) and isinstance(expr.function, Member) and expr.function.name in ROUNDING
    scale = slope(expr.arguments[0] if isinstance(expr, Call) and is_rounded and expr.arguments else expr)
    if scale is None or abs(scale) <= values:
        for part in children(expr):
            yield from _stretched(part, values)
        return
    cells = math.ceil(abs(scale))
    lead = f"`Math.random()` has {values:,} values"
    if is_rounded:
        message = f"{lead}, so at most {values:,} of the {cells:,} whole numbers in this range occur; {_advice(cells)}"
        yield RULE.at(expr.span, message)
    else:
        message = f"{lead}, so the results are {abs(scale) / values:g} apart; {_advice(cells)}"
        yield RULE.at(expr.span, message, severity=Severity.INFORMATION)


def _compared(expr: Expr, drawn: frozenset[str], values: int) -> Iterator[Finding]:
    """Report comparisons of a random number whose probability differs from the one that the constant suggests."""
    for node in walk(expr):
        if not isinstance(node, Binary) or node.operator.kind is not OperatorKind.ORDER:
            continue
        operator, left, right = node.operator, node.left, node.right
        if not isinstance(left, Name):
            operator, left, right = MIRRORED[operator], right, left
        bound = constant(right)
        if not isinstance(left, Name) or left.name not in drawn or bound is None or not 0 < bound < 1:
            continue
        exact = Fraction(str(bound))
        below = math.ceil(exact * values) if operator in _STRICT else math.floor(exact * values) + 1
        if operator in (Operator.LESS, Operator.LESS_EQUAL):
            real, suggested = Fraction(below, values), exact
        else:
            real, suggested = 1 - Fraction(below, values), 1 - exact
        if real != suggested:
            message = (
                f"`{left.name}` is one of {values:,} values of `Math.random()`, so this holds with probability "
                f"{float(real):g}, not {float(suggested):g}; {_comparison_advice(left.name, operator, exact, values)}"
            )
            yield RULE.at(node.span, message, severity=Severity.INFORMATION)


_STRICT = (Operator.LESS, Operator.GREATER_EQUAL)
"""The comparisons that give the same result for a value equal to the bound and for greater values."""


def drawn_variables(chart: Chart) -> frozenset[str]:
    """The variables to which `Math.random()` is assigned, and otherwise only constants."""
    assigned: dict[str, list[Expr | None]] = {}
    for statement in chart.statements:
        if isinstance(statement, Assign) and statement.location and isinstance(statement.location.tree, Name):
            tree = statement.value.tree if isinstance(statement.value, Expression) else None
            assigned.setdefault(statement.location.tree.name, []).append(tree)
    return frozenset(
        name
        for name, trees in assigned.items()
        if any(tree is not None and is_draw(tree) for tree in trees)
        and all(tree is not None and (is_draw(tree) or constant(tree) is not None) for tree in trees)
    )


def slope(expr: Expr) -> float | None:
    """The constant a in an expression of the form a · `Math.random()` + b, where b contains no random numbers. `None`
    if the expression does not have this form."""
    if is_draw(expr):
        return 1.0
    match expr:
        case Unary(operator=UnaryOperator.NEGATE):
            inner = slope(expr.operand)
            return None if inner is None else -inner
        case Binary(operator=Operator.ADD | Operator.SUBTRACT):
            left, right = slope(expr.left), slope(expr.right)
            if left is not None:
                return None if _draws(expr.right) else left
            return None if right is None or _draws(expr.left) else right
        case Binary(operator=Operator.MULTIPLY):
            for side, other in ((expr.left, expr.right), (expr.right, expr.left)):
                factor, inner = constant(side), slope(other)
                if factor is not None and inner is not None:
                    return factor * inner
        case Binary(operator=Operator.DIVIDE):
            divisor, inner = constant(expr.right), slope(expr.left)
            if divisor and inner is not None:
                return inner / divisor
    return None


def _draws(expr: Expr) -> bool:
    return any(map(is_draw, walk(expr)))


def _advice(cells: int) -> str:
    if cells <= MAX_RANDOM_VALUES:
        return f'set `<random_values value="{cells}" />` in the system file'
    return f"`<random_values>` in the system file allows at most {MAX_RANDOM_VALUES:,} values"


def _comparison_advice(name: str, operator: Operator, bound: Fraction, values: int) -> str:
    """Advice on how to make a comparison of the variable `name` hold with probability `bound` or 1 - `bound`."""
    if (bound * values).denominator == 1:
        other = "<" if operator is Operator.LESS_EQUAL else ">="
        return f"write `{name} {other} {float(bound):g}`"
    enough = bound.denominator * math.ceil(DEFAULT_RANDOM_VALUES / bound.denominator)
    return _advice(enough)


RULE = Rule(
    "coarse-random", Severity.WARNING, "A random number has too few values for its use.", machine=check, whole=True
)

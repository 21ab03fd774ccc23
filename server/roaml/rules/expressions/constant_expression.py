# SPDX-License-Identifier: Apache-2.0
"""The rule `constant-expression`, which constant_expression.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.operators import OperatorKind
from roaml.expr.tree import Binary, Call, Expr, Member, Name, is_draw, walk
from roaml.model.syntax import Expression
from roaml.model.value_types import ValueUse
from roaml.model.values.analyse import ChartValues
from roaml.model.values.describe import described
from roaml.model.values.domain import exactly
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext, Rule

_USES = (ValueUse.ASSIGNED, ValueUse.FIELD, ValueUse.PARAMETER, ValueUse.OUTPUT)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report comparisons, and calls of `Math.min` and `Math.max`, with the same value whatever their variables are."""
    for value in context.typed.values:
        chart = context.local_values.charts.get(value.place.chart.scope)
        if chart is None or value.use not in _USES or not isinstance(value.value, Expression) or value.value.broken:
            continue
        reported: list[Expr] = []
        for node in walk(value.value.tree):
            if not (_chooses(node) or _draws(node)) or any(node in walk(outer) for outer in reported):
                continue
            known = chart.at(node)
            if known is None:
                continue
            if _draws(node) and known.only is None and known.low == known.high:
                known = exactly(int(known.low))
            if known.value is not None and (_varies(chart, node) or _is_same(node) or _draws(node)):
                reported.append(node)
                message = f"this is always {described(known)}, because {_why(chart, node)}"
                yield RULE.at(node.span, message)


def _chooses(node: Expr) -> bool:
    """Whether the value of an expression depends on a comparison of its operands."""
    if isinstance(node, Binary):
        return node.operator.kind in (OperatorKind.EQUALITY, OperatorKind.ORDER)
    return isinstance(node, Call) and isinstance(node.function, Member) and node.function.name in ("min", "max")


def _draws(node: Expr) -> bool:
    """Whether an expression rounds a random number."""
    return isinstance(node, Call) and any(is_draw(part) for part in walk(node) if part is not node)


def _is_same(node: Expr) -> bool:
    """Whether a comparison compares a variable with itself."""
    if not isinstance(node, Binary):
        return False
    left, right = place_of(node.left), place_of(node.right)
    return left is not None and left == right


def _varies(chart: ChartValues, node: Expr) -> bool:
    """Whether a variable in an expression has several values."""
    return any(
        (known := chart.at(part)) is not None and known.value is None
        for part in walk(node)
        if isinstance(part, Name | Member) and place_of(part) is not None
    )


def _why(chart: ChartValues, node: Expr) -> str:
    """The values of the operands, as a clause."""
    operands = (node.left, node.right) if isinstance(node, Binary) else node.arguments if isinstance(node, Call) else ()
    known = [(operand, values) for operand in operands if (values := chart.at(operand)) is not None]
    texts = [f"one side is {text}" for _, values in known if (text := described(values))]
    return " and ".join(texts).replace("and one side is", "and the other one is") or "its operands do not decide it"


RULE = Rule(
    "constant-expression",
    Severity.WARNING,
    "A comparison or a limit always has the same value.",
    machine=check,
    whole=True,
)

# SPDX-License-Identifier: Apache-2.0
"""The rule `constant-expression`, which constant_expression.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.operators import Operator, OperatorKind
from roaml.expr.tree import Binary, Call, Expr, Member, Name, is_draw, walk
from roaml.model.behavior.explore import condition_facts
from roaml.model.behavior.knowledge import NOTHING, ConditionFacts, variables_in
from roaml.model.syntax import Expression
from roaml.model.value_types import CONDITIONS, ValueUse
from roaml.model.values.analyse import ChartValues
from roaml.model.values.describe import described
from roaml.model.values.domain import ValueSet, exactly
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext, Rule

_USES = (ValueUse.ASSIGNED, ValueUse.FIELD, ValueUse.PARAMETER, ValueUse.OUTPUT)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report parts of expressions that have the same value whatever their variables are."""
    for chart in context.machine.charts:
        values, facts = context.local_values.charts.get(chart.scope), condition_facts(chart)
        for value in context.typed.values if values is not None else ():
            is_checked = value.place.chart is chart and (value.use in _USES or value.use in CONDITIONS)
            if is_checked and isinstance(value.value, Expression) and not value.value.broken and values is not None:
                yield from _constant(values, facts, value.value, value.use)


def _constant(values: ChartValues, facts: ConditionFacts, expression: Expression, use: ValueUse) -> Iterator[Finding]:
    """The findings in an expression. In conditions, constant-condition reports what is not arithmetic."""
    reported: list[Expr] = []
    for node in walk(expression.tree):
        if any(node in walk(outer) for outer in reported):
            continue
        if use in CONDITIONS and not (isinstance(node, Binary) and node.operator.kind is OperatorKind.ARITHMETIC):
            continue
        constant = _of_itself(node) or _of_draw(node) or _of_logic(facts, node) or _of_values(values, node)
        if constant is not None:
            value, why = constant
            reported.append(node)
            yield RULE.at(node.span, f"this is always {described(value)}, because {why}")


_SAME = {
    **dict.fromkeys((Operator.EQUAL, Operator.LESS_EQUAL, Operator.GREATER_EQUAL), True),
    **dict.fromkeys((Operator.NOT_EQUAL, Operator.LESS, Operator.GREATER), False),
    **dict.fromkeys((Operator.SUBTRACT, Operator.REMAINDER), 0),
    Operator.DIVIDE: 1,
}
"""Operator -> its result if both operands are the same variable."""


def _of_itself(node: Expr) -> tuple[ValueSet, str] | None:
    """The value of an operation on a variable and itself, with the reason."""
    if not isinstance(node, Binary) or node.operator not in _SAME:
        return None
    place = place_of(node.left)
    if place is None or "[" in place or place != place_of(node.right):
        return None
    return exactly(_SAME[node.operator]), f"both sides are `{place}`"


def _of_draw(node: Expr) -> tuple[ValueSet, str] | None:
    """The value of a random number that is rounded down before anything else is done with it."""
    if not isinstance(node, Call) or not isinstance(node.function, Member) or node.function.name != "floor":
        return None
    if len(node.arguments) != 1 or not is_draw(node.arguments[0]):
        return None
    return exactly(0), "`Math.random()` is less than 1; multiply it before you round it"


def _of_logic(facts: ConditionFacts, node: Expr) -> tuple[ValueSet, str] | None:
    """The value of a combination of conditions that contradict or complete each other, with the reason."""
    if not isinstance(node, Binary) or node.operator.kind is not OperatorKind.LOGICAL:
        return None
    for result in (True, False):
        if not any(facts.assume(NOTHING, node, not result)) and variables_in((node,)):
            return exactly(result), "its parts cover all values" if result else "its parts contradict each other"
    return None


def _of_values(values: ChartValues, node: Expr) -> tuple[ValueSet, str] | None:
    """The value of a comparison, a limit or a rounded random number, with the values of its operands as the reason."""
    known = values.at(node)
    if known is None or not (_chooses(node) or _draws(node)):
        return None
    if _draws(node) and known.only is None and known.low == known.high:
        known = exactly(int(known.low))
    if known.value is None or not (_draws(node) or _varies(values, node)):
        return None
    return known, _why(values, node)


def _chooses(node: Expr) -> bool:
    """Whether the value of an expression depends on a comparison of its operands."""
    if isinstance(node, Binary):
        return node.operator.kind in (OperatorKind.EQUALITY, OperatorKind.ORDER)
    return isinstance(node, Call) and isinstance(node.function, Member) and node.function.name in ("min", "max")


def _draws(node: Expr) -> bool:
    """Whether an expression rounds a random number."""
    return isinstance(node, Call) and any(is_draw(part) for part in walk(node) if part is not node)


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
    part = "side" if len(operands) == 2 else "argument"
    texts = [f"one {part} is {text}" for _, values in known if (text := described(values))]
    return " and ".join(texts).replace("and one side is", "and the other one is") or "its operands do not decide it"


RULE = Rule(
    "constant-expression",
    Severity.WARNING,
    "A comparison or a limit always has the same value.",
    machine=check,
    whole=True,
)

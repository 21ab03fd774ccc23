# SPDX-License-Identifier: Apache-2.0
"""The rule `division-by-zero`, which division_by_zero.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.infer import DivisionByZero, constant
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, walk
from roaml.model.syntax import Expression
from roaml.model.value_types import TypedValue
from roaml.model.values.domain import Origin, ValueSet
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, DivisionByZero):
                yield RULE.at(problem.span, "division by zero: the result is undefined")
        yield from _possible(context, value)


def _possible(context: MachineContext, value: TypedValue) -> Iterator[Finding]:
    """Report divisors that are not constant and can be 0."""
    values = context.values.charts.get(value.place.chart.scope)
    if values is None or not isinstance(value.value, Expression):
        return
    for node in walk(value.value.tree):
        if isinstance(node, Binary) and node.operator in (Operator.DIVIDE, Operator.REMAINDER):
            divisor = values.at(node.right)
            if divisor is not None and constant(node.right) is None and _reaches_zero(divisor):
                text = context.source.text[slice(*node.right.span)]
                verb = "is always" if divisor.value is not None else "can be"
                message = f"division by zero: `{text}` {verb} 0 here, and the result is undefined; test it first"
                yield RULE.at(node.right.span, message)


def _reaches_zero(divisor: ValueSet) -> bool:
    """Whether 0 is known to be a value. A set that merely contains 0, such as all values of a type, is not enough."""
    if divisor.only is not None:
        return 0 in divisor.only
    return (divisor.low, divisor.low_from) == (0, Origin.REACHED) or (divisor.high, divisor.high_from) == (
        0,
        Origin.REACHED,
    )


RULE = Rule(
    "division-by-zero", Severity.WARNING, "The divisor of a division is or can be zero.", machine=check, whole=True
)

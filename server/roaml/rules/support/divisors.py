# SPDX-License-Identifier: Apache-2.0
"""Finds divisors that are or can be zero."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr.infer import constant
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Expr, walk
from roaml.model.syntax import Expression
from roaml.model.value_types import TypedValue
from roaml.model.values.domain import Origin, ValueSet
from roaml.rules.rule import MachineContext


def possible_zeros(context: MachineContext, value: TypedValue) -> Iterator[tuple[Expr, ValueSet]]:
    """The divisors of a value that are not constant and can be 0, each with its values."""
    chart = context.values.charts.get(value.place.chart.scope)
    if chart is None or not isinstance(value.value, Expression):
        return
    for node in walk(value.value.tree):
        if isinstance(node, Binary) and node.operator in (Operator.DIVIDE, Operator.REMAINDER):
            divisor = chart.at(node.right)
            if divisor is not None and constant(node.right) is None and _reaches_zero(divisor):
                yield node.right, divisor


def _reaches_zero(divisor: ValueSet) -> bool:
    """Whether 0 is known to be a value. A set that merely contains 0, such as all values of a type, is not enough."""
    if divisor.only is not None:
        return 0 in divisor.only
    return (divisor.low, divisor.low_from) == (0, Origin.REACHED) or (divisor.high, divisor.high_from) == (
        0,
        Origin.REACHED,
    )

# SPDX-License-Identifier: Apache-2.0
"""The parts of conditions that are known to hold, or not to hold, at a place."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.tree import Binary, Expr, Unary
from roaml.model.syntax import Expression

Conditions = list[tuple[Expression, bool]]
"""Conditions, each with the value that it is known to have."""


def conjuncts(tree: Expr, holds: bool) -> Iterator[tuple[Expr, bool]]:
    """The parts of a condition that certainly have a value if the condition has the value `holds`."""
    match tree:
        case Unary(operator=UnaryOperator.NOT):
            yield from conjuncts(tree.operand, not holds)
        case Binary(operator=Operator.AND | Operator.OR) if (tree.operator is Operator.AND) is holds:
            yield from conjuncts(tree.left, holds)
            yield from conjuncts(tree.right, holds)
        case _:
            yield tree, holds

# SPDX-License-Identifier: Apache-2.0
"""Boolean values that an assignment before them decides."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Related
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Boolean, Expr, walk
from roaml.model.machine import Assign, If, bodies, values_of
from roaml.model.syntax import Expression
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext
from roaml.rules.support.constant_conditions import ConstantPart


def decided_values(context: MachineContext) -> Iterator[ConstantPart]:
    """The parts of Boolean values joined with `&&` or `||` that decide the value, because an assignment before them, in
    the same content, gives the variable a constant that it does not have elsewhere."""
    for chart in context.machine.charts:
        for _, _, body in bodies(chart):
            assigned: dict[str, Assign] = {}
            for statement in body:
                for value in values_of(statement):
                    yield from _decided(value, assigned)
                if isinstance(statement, If):
                    assigned.clear()
                elif isinstance(statement, Assign) and statement.location is not None:
                    place = place_of(statement.location.tree)
                    assigned |= {place: statement} if place is not None else {}


def _decided(value: Expression, assigned: Mapping[str, Assign]) -> Iterator[ConstantPart]:
    """The parts of `value` that a variable in `assigned` decides, with its last assignment."""
    for node, part in _junctions(value.tree):
        name = place_of(part)
        before = assigned.get(name) if name is not None else None
        last = before.value.tree if before is not None and isinstance(before.value, Expression) else None
        if before is not None and isinstance(last, Boolean) and last.value is (node.operator is Operator.OR):
            word = "true" if last.value else "false"
            message = f"this is always {word}, because `{name}` has just become {word}; use it before that assignment"
            yield ConstantPart(node.span, message, related=(Related(before.element.name_span, f"becomes {word}"),))
            return


def _junctions(tree: Expr) -> Iterator[tuple[Binary, Expr]]:
    """The `&&` and `||` in `tree`, each with one of its parts."""
    for node in walk(tree):
        if isinstance(node, Binary) and node.operator in (Operator.AND, Operator.OR):
            yield node, node.left
            yield node, node.right

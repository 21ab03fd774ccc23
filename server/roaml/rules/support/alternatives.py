# SPDX-License-Identifier: Apache-2.0
"""The conditions of a machine: what they are alternatives of, and what is executed only if they hold."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Expr
from roaml.model.machine import Chart, Handler, If, Machine, State, Statement
from roaml.model.syntax import Expression
from roaml.model.triggers import Trigger, trigger


def alternatives(machine: Machine, chart: Chart) -> Iterator[Sequence[Expr]]:
    """The conditions of the handlers of one event in a state, and of the branches of an `<if>`; then the parts that
    each of these joins with `&&` or `||`."""
    groups: list[list[Expr]] = []
    for state in chart.states:
        groups += [_trees([handler.cond for handler in group]) for group in handlers_by_trigger(machine, state)]
    for statement in chart.statements:
        if isinstance(statement, If):
            groups.append(_trees([branch.cond for branch in statement.branches]))
    for group in groups:
        parts = [joined(tree, operator) for tree in group for operator in (Operator.AND, Operator.OR)]
        yield from (group, *(part for part in parts if len(part) > 1))


def handlers_by_trigger(machine: Machine, state: State) -> Iterator[Sequence[Handler]]:
    groups: dict[Trigger, list[Handler]] = {}
    for handler in state.handlers:
        key = trigger(machine, handler) if handler.effective else None
        if key is not None:
            groups.setdefault(key, []).append(handler)
    yield from groups.values()


def guarded_statements(chart: Chart) -> Iterator[tuple[Expression, Sequence[Statement]]]:
    """The conditions, each with the statements that are executed only if it holds."""
    for handler in (handler for state in chart.states for handler in state.handlers):
        if handler.cond is not None:
            yield handler.cond, [statement for target in handler.targets for statement in target.body]
    for statement in chart.statements:
        for branch in statement.branches if isinstance(statement, If) else ():
            if branch.cond is not None:
                yield branch.cond, branch.body


def joined(tree: Expr, operator: Operator) -> list[Expr]:
    """What `tree` joins with `operator`, without what parentheses join."""
    if isinstance(tree, Binary) and tree.operator is operator:
        return [*joined(tree.left, operator), tree.right]
    return [tree]


def _trees(conditions: Sequence[Expression | None]) -> list[Expr]:
    return [cond.tree for cond in conditions if cond is not None and not cond.broken]

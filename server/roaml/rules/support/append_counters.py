# SPDX-License-Identifier: Apache-2.0
"""Counters that keep an array from growing beyond its capacity, judged by all assignments to both."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr.infer import constant
from roaml.expr.operators import MIRRORED, OPPOSITE, Operator
from roaml.expr.tree import Binary, Expr, Index, Name
from roaml.model.machine import Assign, Chart, Statement
from roaml.model.syntax import Expression
from roaml.model.values.analyse import ChartValues
from roaml.model.values.domain import Origin, interval
from roaml.model.values.evaluate import place_of
from roaml.rules.support.blocks import Block, blocks, counts, sets, target
from roaml.rules.support.known_parts import Conditions, conjuncts


def ends_in_time(chart: Chart, values: ChartValues, append: Index, holding: Conditions, room: int) -> bool:
    """Whether a counter keeps `append`, the location `v[v.length]`, from being assigned more than `room` times: each
    assignment is in a block that also counts, and what sets the counter empties the array."""
    array = place_of(append.object)
    all_blocks = list(blocks(chart))
    adding = [b for b in all_blocks if any(_appends(s, array) for s in b.statements)]
    if array is None or not adding:
        return False
    compared = (_steps(values, *part) for condition, holds in holding for part in conjuncts(condition.tree, holds))
    for counter, steps in (*compared, *_counted(values, adding[0])):
        if counter is None or steps is None or steps[1] > room:
            continue
        counting = [b for b in all_blocks if any(counts(s, counter, steps[0]) for s in b.assigned(counter))]
        setting = [b for b in all_blocks if b.assigned(counter) and b not in counting]
        if all(b in counting for b in adding) and all(sets(b.statements, array) for b in setting):
            return True
    return False


def _counted(values: ChartValues, block: Block) -> Iterator[tuple[str, tuple[int, float]]]:
    """The variables that a block counts, whose values conditions of other states limit: each with its step, and with
    the number of values that it has before it is counted."""
    for statement in block.statements:
        if not isinstance(statement, Assign) or not isinstance(statement.value, Expression):
            continue
        counter, tree = target(statement), statement.value.tree
        if counter is None or not isinstance(tree, Binary):
            continue
        known = [
            interval(at) for side in (tree.left, tree.right) if place_of(side) == counter and (at := values.at(side))
        ]
        for bounds in known:
            if max(bounds.low_from, bounds.high_from) is Origin.REACHED:
                yield counter, (1 if counts(statement, counter, 1) else -1, bounds.high - bounds.low + 1)


def _appends(statement: Statement, array: str | None) -> bool:
    tree = statement.location.tree if isinstance(statement, Assign) and statement.location else None
    return isinstance(tree, Index) and place_of(tree.object) == array and constant(tree.index) is None


def _steps(values: ChartValues, tree: Expr, holds: bool) -> tuple[str | None, tuple[int, float] | None]:
    """The variable that a comparison limits, and how: the step of 1 or -1 in which it is counted, and the number of
    steps after which the comparison ends."""
    if not isinstance(tree, Binary) or tree.operator not in OPPOSITE:
        return None, None
    operator, counter, limit = tree.operator, tree.left, constant(tree.right)
    if limit is None:
        operator, counter, limit = MIRRORED.get(operator, operator), tree.right, constant(tree.left)
    operator = operator if holds else OPPOSITE[operator]
    known = values.at(counter)
    if limit is None or known is None or not isinstance(counter, Name):
        return None, None
    match operator:
        case Operator.GREATER | Operator.GREATER_EQUAL:
            return counter.name, (-1, interval(known).high - limit + (operator is Operator.GREATER_EQUAL))
        case Operator.LESS | Operator.LESS_EQUAL:
            return counter.name, (1, limit - interval(known).low + (operator is Operator.LESS_EQUAL))
    return None, None

# SPDX-License-Identifier: Apache-2.0
"""Boolean variables that are only true while an index is inside its array.

The analysis of values follows each variable by itself. The assignments of a machine show what a flag and an index have
to do with each other.
"""

from __future__ import annotations

from collections.abc import Iterator

from roaml.expr.infer import constant
from roaml.expr.tree import Boolean, Expr, Name, walk
from roaml.model.behavior.explore import condition_facts
from roaml.model.behavior.knowledge import NOTHING
from roaml.model.machine import Assign, Chart, statements
from roaml.model.syntax import Expression
from roaml.model.value_types import ValuePlace
from roaml.model.values.analyse import ChartValues
from roaml.model.values.domain import interval
from roaml.rules.support.blocks import Block, blocks, target
from roaml.rules.support.known_parts import Conditions, conjuncts
from roaml.text import Span


def is_guarded(
    chart: Chart, values: ChartValues, place: ValuePlace, index: Name, holding: Conditions, room: int
) -> bool:
    """Whether a Boolean variable, whose value is known at a place, has this value only while the variable `index` is at
    least 0 and less than `room`.

    Args:
        holding: the conditions that are known at the place.
    """
    for condition, holds in holding:
        if _changes(place, (index.name,), condition.span, index.span):
            continue
        for flag, value in _flags(condition.tree, holds):
            if _implies(chart, values, flag, value, index.name, room):
                return True
    return False


def _changes(place: ValuePlace, names: tuple[str, ...], after: Span, before: Span) -> bool:
    """Whether the handler of a place assigns one of some variables between two places."""
    if place.handler is None:
        return False
    done = (s for each in place.handler.targets for s in statements(each.body))
    spans = [s.element.span for s in done if isinstance(s, Assign) and target(s) in names]
    return any(after.end <= span.start and span.end <= before.start for span in spans)


def _flags(tree: Expr, holds: bool) -> Iterator[tuple[str, bool]]:
    for part, value in conjuncts(tree, holds):
        if isinstance(part, Name):
            yield part.name, value


def _implies(chart: Chart, values: ChartValues, flag: str, holds: bool, index: str, room: int) -> bool:
    """Whether `flag` has the value `holds` only while `index` is inside, judged by all assignments to both."""
    initial = {data.id.value: data.value for data in chart.data if data.id is not None}
    if flag not in initial or index not in initial:
        return False
    first = initial[index]
    number = constant(first.tree) if isinstance(first, Expression) else 0
    if not _is_literal(initial[flag], not holds) and (number is None or not 0 <= number < room):
        return False

    def is_inside(statement: Assign) -> bool:
        known = values.at(statement.value.tree) if isinstance(statement.value, Expression) else None
        return known is not None and interval(known).low >= 0 and interval(known).high < room

    all_blocks = list(blocks(chart))
    for block in all_blocks:
        for statement in block.assigned(flag):
            if _is_literal(statement.value, not holds):
                continue
            inner = [b for b in all_blocks if block in b.outer and not b.assigned(flag)]
            own = [s for b in (block, *inner) for s in b.assigned(index)]
            inside = bool(own) and all(is_inside(s) for s in own)
            if not inside and not _tests(chart, statement, holds, index, own, room):
                return False
        if not all(is_inside(s) for s in block.assigned(index)) and not _judged(block, all_blocks, flag, index):
            return False
    return True


def _judged(block: Block, all_blocks: list[Block], flag: str, index: str) -> bool:
    """Whether the flag is assigned together with an index that is assigned in a block."""
    tested = (b for b in all_blocks if block in b.outer and b.cond is not None and _names(b.cond.tree, index))
    return any(b.assigned(flag) for b in (block, *block.outer, *tested))


def _names(tree: Expr, name: str) -> bool:
    return any(isinstance(node, Name) and node.name == name for node in walk(tree))


def _is_literal(value: object, which: bool) -> bool:
    tree = value.tree if isinstance(value, Expression) else None
    return isinstance(tree, Boolean) and tree.value is which


def _tests(chart: Chart, statement: Assign, holds: bool, index: str, own: list[Assign], room: int) -> bool:
    """Whether an assignment gives a flag the value `holds` only if the index, or the value that the block gives it, is
    inside."""
    if not isinstance(statement.value, Expression) or isinstance(statement.value.tree, Boolean | Name):
        return False
    trees: list[Expr] = [Name(statement.value.span, index)]
    trees += [s.value.tree for s in own if isinstance(s.value, Expression)]
    facts = condition_facts(chart)
    ways = facts.assume(NOTHING, statement.value.tree, holds)
    known = [[facts.values(way, tree) for way in ways] for tree in trees]
    return any(all(v.low >= 0 and (v.high < room or (v.high_open and v.high <= room)) for v in each) for each in known)

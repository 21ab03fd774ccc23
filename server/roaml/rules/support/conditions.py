# SPDX-License-Identifier: Apache-2.0
"""Finds conditions that have no effect. Conditions are tested in order, and the first that holds selects
the handler or branch. So a condition has no effect if an earlier one holds whenever it holds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.expr.operators import OperatorKind
from roaml.expr.tree import Binary, Expr, is_draw, walk
from roaml.model.behavior.knowledge import MAX_CONJUNCTIONS, NOTHING, ConditionFacts, Knowledge
from roaml.model.syntax import Expression
from roaml.record import Record

MAX_CONDITIONS = 2000
"""The maximum number of conditions in a row that are compared with each other."""


class Covered(Record, frozen=True):
    """A condition that holds only where an earlier one holds.

    Attributes:
        number: the index of the condition, from 0.
        by: the indices of the earlier conditions each of which holds wherever this one holds; empty if only several of
            them together do.
        same: whether one of the conditions in `by` is equivalent to this one.
    """

    number: int
    by: tuple[int, ...]
    same: bool


def covered(facts: ConditionFacts, conditions: Sequence[Expression | None]) -> Iterator[Covered]:
    """The conditions that have no effect because of earlier ones, in the order of `conditions`.

    A condition that can never hold by itself is left out. `None`, a condition that cannot be read, and a condition that
    draws a random number do not cover other conditions. The search ends when the knowledge about the earlier conditions
    has more than `MAX_CONJUNCTIONS` cases, or after `MAX_CONDITIONS` conditions, because the time grows with the
    square of their number.
    """
    left: tuple[Knowledge, ...] = (NOTHING,)
    for number, condition in enumerate(conditions[:MAX_CONDITIONS]):
        if condition is None or condition.broken or any(is_draw(node) for node in walk(condition.tree)):
            continue
        tree = condition.tree
        if number and not any(facts.assume(known, tree) for known in left):
            if any(facts.assume(NOTHING, tree)):
                earlier = [(n, c.tree) for n, c in enumerate(conditions[:number]) if c is not None and not c.broken]
                by = [(n, other) for n, other in earlier if not _beside(facts, other, tree)]
                same = any(not _beside(facts, tree, other) for _, other in by)
                yield Covered(number, tuple(n for n, _ in by), same)
            continue
        left = tuple(rest for known in left for rest in facts.assume(known, tree, False))
        if len(left) > MAX_CONJUNCTIONS:
            return


def exhausting_order(facts: ConditionFacts, conditions: Sequence[Expression | None]) -> Expression | None:
    """The last condition, if it compares an order, as `x >= 0` does, and always holds where the earlier ones do not.
    Equalities are not judged: listing all cases and providing for others is usual."""
    last = conditions[-1] if len(conditions) > 1 else None
    if len(conditions) > MAX_CONDITIONS or last is None or last.broken:
        return None
    if not isinstance(last.tree, Binary) or last.tree.operator.kind is not OperatorKind.ORDER:
        return None
    left: tuple[Knowledge, ...] = (NOTHING,)
    for number, condition in enumerate(conditions):
        if condition is None or condition.broken or any(is_draw(node) for node in walk(condition.tree)):
            return None
        if number == len(conditions) - 1 and not any(facts.assume(known, condition.tree) for known in left):
            return None  # the last condition never holds, which is reported
        left = tuple(rest for known in left for rest in facts.assume(known, condition.tree, False))
        if not left:
            return last if number == len(conditions) - 1 else None
        if len(left) > MAX_CONJUNCTIONS:
            return None
    return None


def _beside(facts: ConditionFacts, first: Expr, other: Expr) -> bool:
    """Whether `other` may hold where `first` does not."""
    return any(facts.assume(known, other) for known in facts.assume(NOTHING, first, False))

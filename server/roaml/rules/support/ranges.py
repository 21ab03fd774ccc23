# SPDX-License-Identifier: Apache-2.0
"""Two comparisons of one place with limits, which together test a range."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from roaml.expr.operators import MIRRORED, Operator, OperatorKind
from roaml.expr.tree import Binary, Expr, walk
from roaml.model.machine import Handler, RosSend, statements
from roaml.model.syntax import Expression
from roaml.model.value_types import CONDITIONS
from roaml.model.values.describe import described
from roaml.model.values.domain import TRUE
from roaml.model.values.evaluate import compared, place_of
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext
from roaml.rules.support.alternatives import joined
from roaml.rules.support.compared_numbers import reached
from roaml.rules.support.constant_conditions import ConstantPart
from roaml.text import Span

_ABOVE = (Operator.GREATER, Operator.GREATER_EQUAL)


class Limit(Record, frozen=True):
    """A comparison of a place with a limit: the place is above the limit, or below it. `tree` is the limit."""

    node: Binary
    place: str
    is_above: bool
    tree: Expr


def limits_in(node: Expr) -> Iterator[Limit]:
    """How a comparison limits its sides: `x < y` limits both `x` and `y`."""
    if isinstance(node, Binary) and node.operator.kind is OperatorKind.ORDER:
        sides = ((node.left, node.operator, node.right), (node.right, MIRRORED[node.operator], node.left))
        for tested, operator, limit in sides:
            place = place_of(tested)
            if place is not None:
                yield Limit(node, place, operator in _ABOVE, limit)


def pairs(tree: Expr, operator: Operator) -> Iterator[tuple[Limit, Limit]]:
    """The comparisons that `operator` joins with another one of the same place: with a limit that the place is above,
    and with one that it is below."""
    for junction in walk(tree):
        if isinstance(junction, Binary) and junction.operator is operator:
            parts = joined(junction, operator)
            for above in (limit for part in parts for limit in limits_in(part) if limit.is_above):
                # Only pairs that end here: `joined` finds those of the junctions inside as well.
                ends = [parts[-1]] if above.node is not parts[-1] else parts[:-1]
                for below in (limit for part in ends for limit in limits_in(part)):
                    if not below.is_above and below.place == above.place:
                        yield above, below


def is_validation(tree: Expr, node: Binary, handler: Handler | None) -> bool:
    """Whether a comparison with values that arrive only protects against wrong ones: it is a part of the test that a
    value is outside of a range, or the handler rejects the goal."""
    if any(node is limit.node for pair in pairs(tree, Operator.OR) for limit in pair):
        return True
    sent = (statement for target in handler.targets for statement in statements(target.body)) if handler else ()
    return any(isinstance(s, RosSend) and s.part is ProtocolPart.GOAL_REJECTED for s in sent)


def always_within(context: MachineContext, reported: Collection[Span]) -> Iterator[ConstantPart]:
    """The conditions `x > low || x < high` that always hold, because `low` is less than `high`, whose values may be
    those of variables."""
    for value in context.typed.values:
        chart = context.values.charts.get(value.place.chart.scope)
        tree = value.value.tree if isinstance(value.value, Expression) else None
        if chart is None or tree is None or value.use not in CONDITIONS or value.value.span in reported:
            continue
        for above, below in pairs(tree, Operator.OR):
            low, high = (chart.at(limit.tree) for limit in (above, below))
            if low is None or high is None or compared(Operator.LESS, reached(low), reached(high)) != TRUE:
                continue
            first, second = sorted((above.node.span, below.node.span), key=lambda span: span.start)
            message = (
                f"this is always true: `{above.place}` is above {described(low)} or below {described(high)}; "
                "did you mean `&&`?"
            )
            yield ConstantPart(Span(first.start, second.end), message, is_true=True if _is_all(tree) else None)


def _is_all(tree: Expr) -> bool:
    """Whether a condition consists only of the two comparisons."""
    return isinstance(tree, Binary) and len(joined(tree, Operator.OR)) == 2

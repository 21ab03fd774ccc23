# SPDX-License-Identifier: Apache-2.0
"""Counters of a machine that are mixed up with similar ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from roaml.expr.format import format_expr
from roaml.expr.infer import constant
from roaml.expr.operators import Operator, OperatorKind
from roaml.expr.tree import Binary, Name, access_path, walk
from roaml.model.machine import Assign, Chart, If, Statement
from roaml.model.syntax import Expression
from roaml.rules.support.words import difference, words_of
from roaml.text import Span

_RELATIONS = frozenset(("next", "following", "new", "last", "previous", "prev", "old", "current", "first", "end"))
"""Words that relate a value to another one: the next waypoint is the current one + 1."""
_BACK = {Operator.ADD: Operator.SUBTRACT, Operator.SUBTRACT: Operator.ADD}


class Step(NamedTuple):
    """An assignment that adds a constant to the value of a place, or subtracts it."""

    place: str
    read: str
    span: Span
    amount: tuple[Operator, float]


class OtherGuard(NamedTuple):
    """A variable that is counted under a condition for a similar one. `place` is the name that is probably wrong, and
    `meant` the right one."""

    counted: str
    tested: str
    place: Name
    meant: Name


class _Guard(NamedTuple):
    """A condition and the variable that is counted under it. `read` contains the variables whose order it tests."""

    counted: Name
    read: Sequence[Name]


def steps_from_others(chart: Chart) -> Iterator[tuple[Step, Step]]:
    """Counters that are computed from a similar counter, as in `b_count = a_count + 1`, or from another one that is
    counted up and down, as in `y = x - 1` beside `x = x - 1`, `x = x + 1` and `y = y + 1`; each with the step of the
    other one."""
    steps = [step for s in chart.statements if isinstance(s, Assign) and (step := _step(s)) is not None]
    own = {(step.place, step.amount): step for step in steps if step.place == step.read}
    counted = {place for place, _ in own}
    for step in steps:
        other = own.get((step.read, step.amount))
        if other is None or difference(step.place, step.read) is None:
            continue
        if any(_RELATIONS & {*words_of(name)} for name in (step.place, step.read)):
            continue
        back = (_BACK[step.amount[0]], step.amount[1])
        completes = (step.place, step.amount) not in own and all((n, back) in own for n in (step.place, step.read))
        if not completes and (step.place in counted or len(words_of(step.place)) < 2):
            continue
        yield step, other


def _step(assign: Assign) -> Step | None:
    if assign.location is None or not isinstance(assign.value, Expression) or assign.value.broken:
        return None
    tree = assign.value.tree
    if not isinstance(tree, Binary) or tree.operator not in (Operator.ADD, Operator.SUBTRACT):
        return None
    amount = constant(tree.right)
    if amount is None or access_path(assign.location.tree) is None or access_path(tree.left) is None:
        return None
    place, read = format_expr(assign.location.tree), format_expr(tree.left)
    return Step(place, read, tree.left.span, (tree.operator, float(amount)))


def other_guards(chart: Chart) -> Iterator[OtherGuard]:
    """Conditions that test another variable than the one that is counted under them, beside several conditions that
    test the variable that is counted."""
    for statement in chart.statements:
        if isinstance(statement, If):
            yield from _mixed([_guard(branch.cond, branch.body) for branch in statement.branches])
    for state in chart.states:
        single = [handler for handler in state.handlers if len(handler.targets) == 1]
        yield from _mixed([_guard(handler.cond, handler.targets[0].body) for handler in single])


def _mixed(guards: Sequence[_Guard | None]) -> Iterator[OtherGuard]:
    known = [guard for guard in guards if guard is not None]
    right = [guard for guard in known if guard.counted.name in {name.name for name in guard.read}]
    counted = {guard.counted.name for guard in known}
    tested = [name.name for guard in known for name in guard.read]
    if len(known) != len(right) + 1 or len(right) < 2:
        return
    wrong = next(guard for guard in known if guard not in right)
    other = next((name for name in wrong.read if difference(name.name, wrong.counted.name) is not None), None)
    if other is None or other.name not in counted:
        return
    # The one that is used too often is the wrong one.
    times = [guard.counted.name for guard in known].count(wrong.counted.name)
    place, meant = (other, wrong.counted) if times <= tested.count(other.name) else (wrong.counted, other)
    yield OtherGuard(wrong.counted.name, other.name, place, meant)


def _guard(cond: Expression | None, body: Sequence[Statement]) -> _Guard | None:
    """The variable that is counted in a body, if there is exactly one, and what its condition compares."""
    counted = [
        statement.location.tree
        for statement in body
        if isinstance(statement, Assign) and statement.location is not None
        if (step := _step(statement)) is not None and step.place == step.read
        if isinstance(statement.location.tree, Name)
    ]
    if cond is None or cond.broken or len(counted) != 1:
        return None
    comparisons = [n for n in walk(cond.tree) if isinstance(n, Binary) and n.operator.kind is OperatorKind.ORDER]
    read = [side for node in comparisons for side in (node.left, node.right) if isinstance(side, Name)]
    return _Guard(counted[0], read) if read else None

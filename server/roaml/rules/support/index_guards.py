# SPDX-License-Identifier: Apache-2.0
"""What keeps an index inside its array although the values of its variable alone do not.

The analysis of values follows each variable by itself. Here, the assignments of a machine show what two variables have
to do with each other: a Boolean variable is only true while the index is inside, or a counter ends after as many steps
as the array has room for.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.expr.infer import constant
from roaml.expr.operators import MIRRORED, OPPOSITE, Operator, UnaryOperator
from roaml.expr.tree import Binary, Boolean, Expr, Index, Name, Unary, walk
from roaml.model.behavior.explore import condition_facts
from roaml.model.behavior.knowledge import NOTHING
from roaml.model.machine import Assign, Chart, If, Statement, bodies, statements
from roaml.model.syntax import Expression
from roaml.model.value_types import ValuePlace
from roaml.model.values.analyse import ChartValues
from roaml.model.values.domain import interval
from roaml.model.values.evaluate import place_of
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.text import Span

Conditions = list[tuple[Expression, bool]]
"""Conditions, each with the value that it is known to have."""


class _Block(Record, frozen=True):
    """The statements of a body, or of a part of an `<if>`.

    Attributes:
        cond: the condition of the part, if it has one.
        outer: the blocks around it, the nearest one first.
    """

    statements: tuple[Statement, ...]
    cond: Expression | None
    outer: tuple[_Block, ...] = ()

    def assigned(self, name: str) -> list[Assign]:
        return [s for s in self.statements if isinstance(s, Assign) and _target(s) == name]


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


def ends_in_time(
    chart: Chart, values: ChartValues, place: ValuePlace, append: Index, holding: Conditions, room: int
) -> bool:
    """Whether a counter keeps `append`, the location `v[v.length]`, from being assigned more than `room` times: each
    assignment is in a block that also counts, and what sets the counter empties the array."""
    array = place_of(append.object)
    blocks = list(_blocks(chart))
    adding = [b for b in blocks if any(_appends(s, array) for s in b.statements)]
    if array is None or not adding:
        return False
    for condition, holds in holding:
        for comparison, value in _conjuncts(condition.tree, holds):
            counter, steps = _steps(values, comparison, value)
            if counter is None or steps is None or steps[1] > room:
                continue
            counting = [b for b in blocks if any(_counts(s, counter, steps[0]) for s in b.assigned(counter))]
            setting = [b for b in blocks if b.assigned(counter) and b not in counting]
            if all(b in counting for b in adding) and all(sets(b.statements, array) for b in setting):
                return True
    return False


def counts_threads(chart: Chart, name: str) -> bool:
    """Whether a variable, such as the number of free threads, grows only when a thread becomes free."""
    growing = [
        handler
        for _, handler, body in bodies(chart)
        for s in statements(body)
        if isinstance(s, Assign) and _target(s) == name and _counts(s, name, 1)
    ]
    return bool(growing) and all(h is not None and h.trigger is ProtocolPart.THREAD_FREE for h in growing)


def sets(block: Iterable[Statement], array: str) -> bool:
    """Whether statements set a whole array, or its length."""
    return any(isinstance(s, Assign) and _target(s) in (array, f"{array}.length") for s in block)


def is_reset(chart: Chart, statement: Assign, array: str) -> bool:
    """Whether the block of an assignment also sets a whole array, or its length."""
    return any(statement in block.statements and sets(block.statements, array) for block in _blocks(chart))


def _blocks(chart: Chart) -> Iterator[_Block]:
    for _, _, body in bodies(chart):
        yield from _inside(_Block(body, None))


def _inside(block: _Block) -> Iterator[_Block]:
    yield block
    for statement in block.statements:
        for part in statement.parts if isinstance(statement, If) else ():
            yield from _inside(_Block(part.body, part.cond, (block, *block.outer)))


def _target(statement: Assign) -> str | None:
    return place_of(statement.location.tree) if statement.location is not None else None


def _appends(statement: Statement, array: str | None) -> bool:
    tree = statement.location.tree if isinstance(statement, Assign) and statement.location else None
    return isinstance(tree, Index) and place_of(tree.object) == array and constant(tree.index) is None


def _changes(place: ValuePlace, names: tuple[str, ...], after: Span, before: Span) -> bool:
    """Whether the handler of a place assigns one of some variables between two places."""
    if place.handler is None:
        return False
    done = (s for target in place.handler.targets for s in statements(target.body))
    spans = [s.element.span for s in done if isinstance(s, Assign) and _target(s) in names]
    return any(after.end <= span.start and span.end <= before.start for span in spans)


def _conjuncts(tree: Expr, holds: bool) -> Iterator[tuple[Expr, bool]]:
    """The parts of a condition that certainly have a value if the condition has the value `holds`."""
    match tree:
        case Unary(operator=UnaryOperator.NOT):
            yield from _conjuncts(tree.operand, not holds)
        case Binary(operator=Operator.AND | Operator.OR) if (tree.operator is Operator.AND) is holds:
            yield from _conjuncts(tree.left, holds)
            yield from _conjuncts(tree.right, holds)
        case _:
            yield tree, holds


def _flags(tree: Expr, holds: bool) -> Iterator[tuple[str, bool]]:
    for part, value in _conjuncts(tree, holds):
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

    blocks = list(_blocks(chart))
    for block in blocks:
        for statement in block.assigned(flag):
            if _is_literal(statement.value, not holds):
                continue
            inner = [b for b in blocks if block in b.outer and not b.assigned(flag)]
            own = [s for b in (block, *inner) for s in b.assigned(index)]
            inside = bool(own) and all(is_inside(s) for s in own)
            if not inside and not _tests(chart, statement, holds, index, own, room):
                return False
        if not all(is_inside(s) for s in block.assigned(index)) and not _judged(block, blocks, flag, index):
            return False
    return True


def _judged(block: _Block, blocks: list[_Block], flag: str, index: str) -> bool:
    """Whether the flag is assigned together with an index that is assigned in a block."""
    tested = (b for b in blocks if block in b.outer and b.cond is not None and _names(b.cond.tree, index))
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


def _counts(statement: Assign, counter: str, step: int) -> bool:
    tree = statement.value.tree if isinstance(statement.value, Expression) else None
    if not isinstance(tree, Binary) or not isinstance(tree.left, Name) or tree.left.name != counter:
        return False
    sign = {Operator.ADD: 1, Operator.SUBTRACT: -1}.get(tree.operator)
    number = constant(tree.right)
    return sign is not None and number is not None and sign * number * step >= 1

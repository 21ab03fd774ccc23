# SPDX-License-Identifier: Apache-2.0
"""Waits that a machine counts in ticks of a timer: a variable that each tick increases is compared with a limit, which
a port or a number provides."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction

from roaml.expr.infer import constant, constant_fraction
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Expr, Name, walk
from roaml.model.machine import Assign, Chart, If, Machine, ReturnStatus, Statement, statements
from roaml.model.syntax import Expression, PortRead, Value
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.text import Span


class TickCount(Record, frozen=True):
    """A variable that starts at 0 and that a tick of a timer increases by at most `step`."""

    timer: str
    step: Fraction


class CountedWait(Record, frozen=True):
    """A comparison that first holds after some ticks of a timer.

    Attributes:
        span: the comparison.
        variable, timer: the variable that counts the ticks, and the name of the timer.
        port: the port that provides the limit; "" if `limit` is the limit.
        limit: the limit, or 1 if a port provides it.
        ticks_per_unit: the number of ticks for which the limit is 1 greater.
    """

    span: Span
    variable: str
    timer: str
    port: str
    limit: Fraction
    ticks_per_unit: Fraction

    def ticks(self, limit: Fraction) -> Fraction:
        """The number of ticks until the comparison holds, not rounded."""
        return limit * self.ticks_per_unit


class PortWait(Record, frozen=True):
    """A port that sets how long a plugin takes until it can return SUCCESS: `ticks_per_unit` ticks of a timer for 1."""

    port: str
    timer: str
    ticks_per_unit: Fraction


def waits(chart: Chart, expressions: Iterable[Expression]) -> Iterator[CountedWait]:
    """The waits in expressions of a chart."""
    counts = _counts(chart)
    limits = fixed_variables(chart)
    for expression in expressions if counts else ():
        for node in walk(expression.tree):
            if isinstance(node, Binary) and node.operator in _REACHES:
                smaller, greater = (node.right, node.left) if _REACHES[node.operator] else (node.left, node.right)
                yield from _wait(node.span, counts, limits, greater, smaller)


def port_waits(machine: Machine) -> Iterator[PortWait]:
    """The ports that set how long a plugin takes until it can return SUCCESS."""
    chart = machine.chart
    for wait in waits(chart, _conditions(chart)):
        returns = [s for s in chart.executed if isinstance(s, ReturnStatus)]
        early = {s for s in returns if s.status is None or s.status.value == "SUCCESS"} - set(
            _guarded(chart, wait.span)
        )
        if wait.port and returns and not early:
            yield PortWait(wait.port, wait.timer, wait.ticks_per_unit)


_REACHES = {
    Operator.GREATER_EQUAL: True,
    Operator.GREATER: True,
    Operator.EQUAL: True,
    Operator.LESS_EQUAL: False,
    Operator.LESS: False,
}
"""The comparisons that hold when a number that grows has reached a limit -> whether the number is on the left side."""


def _wait(
    span: Span, counts: Mapping[str, TickCount], limits: Mapping[str, PortRead | Fraction], growing: Expr, limit: Expr
) -> Iterator[CountedWait]:
    name, factor = _scaled(growing)
    if name not in counts or factor <= 0:
        return
    known: PortRead | Fraction | None = constant_fraction(limit)
    scale = Fraction(1)
    if known is None:
        other, scale = _scaled(limit)
        known = limits.get(other)
    if known is None or scale <= 0:
        return
    ticks = scale / (factor * counts[name].step)
    port = known.key.value if isinstance(known, PortRead) and known.key else ""
    if port or isinstance(known, Fraction):
        value = known if isinstance(known, Fraction) else Fraction(1)
        yield CountedWait(span, name, counts[name].timer, port, value, ticks)


def _scaled(tree: Expr) -> tuple[str, Fraction]:
    """The variable and the factor of an expression such as `n * 0.1`; ("", 0) for other expressions."""
    if isinstance(tree, Name):
        return tree.name, Fraction(1)
    if isinstance(tree, Binary) and tree.operator in (Operator.MULTIPLY, Operator.DIVIDE):
        for side, other in ((tree.left, tree.right), (tree.right, tree.left)):
            factor = constant_fraction(other)
            if isinstance(side, Name) and factor is not None and factor > 0:
                if tree.operator is Operator.MULTIPLY:
                    return side.name, factor
                if side is tree.left:
                    return side.name, 1 / factor
    return "", Fraction(0)


def _counts(chart: Chart) -> dict[str, TickCount]:
    """The variables that count ticks: all other assignments set them to 0."""
    steps: dict[str, list[TickCount]] = {}
    others: set[str] = set()
    counting: dict[Statement, TickCount] = {}
    for handler in (h for state in chart.states for h in state.handlers):
        for statement in (s for target in handler.targets for s in statements(target.body)):
            step = _step(statement)
            if step is not None and handler.trigger is ProtocolPart.TICK and handler.handle is not None:
                counting[statement] = TickCount(handler.handle.value, step)
    for statement in chart.executed:
        if isinstance(statement, Assign) and statement.location is not None:
            name = statement.location.tree.name if isinstance(statement.location.tree, Name) else ""
            if statement in counting:
                steps.setdefault(name, []).append(counting[statement])
            elif not _is_zero(statement.value):
                others.add(name)
    others |= {data.id.value for data in chart.data if data.id and not _is_zero(data.value)}
    return {
        name: TickCount(counts[0].timer, sum((count.step for count in counts), Fraction(0)))
        for name, counts in steps.items()
        if name not in others and len({count.timer for count in counts}) == 1
    }


def _step(statement: Statement) -> Fraction | None:
    """The number by which an assignment increases its variable."""
    if not isinstance(statement, Assign) or statement.location is None or not isinstance(statement.value, Expression):
        return None
    location, tree = statement.location.tree, statement.value.tree
    if not isinstance(location, Name) or not isinstance(tree, Binary) or tree.operator is not Operator.ADD:
        return None
    for side, other in ((tree.left, tree.right), (tree.right, tree.left)):
        step: Fraction | None = constant_fraction(other)
        if isinstance(side, Name) and side.name == location.name and step is not None and step > 0:
            return step
    return None


def _is_zero(value: Value | None) -> bool:
    return isinstance(value, Expression) and constant(value.tree) == 0


def fixed_variables(chart: Chart) -> dict[str, PortRead | Fraction]:
    """The variables that hold the value of one port, or the same number all the time."""
    values: dict[str, list[Value | None]] = {}
    for statement in chart.executed:
        if isinstance(statement, Assign) and statement.location is not None:
            location = statement.location.tree
            values.setdefault(location.name if isinstance(location, Name) else "", []).append(statement.value)
    result: dict[str, PortRead | Fraction] = {}
    for data in chart.data:
        if data.id is None:
            continue
        assigned = values.get(data.id.value, [data.value])
        ports = {value.key.value: value for value in assigned if isinstance(value, PortRead) and value.key}
        number = constant_fraction(data.value.tree) if isinstance(data.value, Expression) else None
        if len(ports) == 1 and all(isinstance(value, PortRead) for value in assigned):
            (result[data.id.value],) = ports.values()
        elif data.id.value not in values and number is not None:
            result[data.id.value] = number
    return result


def _conditions(chart: Chart) -> Iterator[Expression]:
    for handler in (h for state in chart.states for h in state.handlers):
        if handler.cond is not None:
            yield handler.cond
    for statement in chart.executed:
        if isinstance(statement, If):
            yield from (branch.cond for branch in statement.branches if branch.cond is not None)


def _guarded(chart: Chart, comparison: Span) -> Iterator[Statement]:
    """The statements that are executed only if a comparison, which is a whole condition, holds."""
    for handler in (h for state in chart.states for h in state.handlers):
        if handler.cond is not None and handler.cond.tree.span == comparison:
            yield from (s for target in handler.targets for s in statements(target.body))
    for statement in chart.executed:
        for branch in statement.branches if isinstance(statement, If) else ():
            if branch.cond is not None and branch.cond.tree.span == comparison:
                yield from statements(branch.body)

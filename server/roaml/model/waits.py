# SPDX-License-Identifier: Apache-2.0
"""Waits that a machine counts in ticks of a timer: a variable that each tick increases is compared with a limit, which
a port or a number provides."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction

from roaml.expr.infer import constant, constant_fraction
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Expr, Name, walk
from roaml.model.machine import Assign, Chart, Handler, If, Machine, ReturnStatus, Statement, statements
from roaml.model.syntax import Expression, PortRead, Value
from roaml.model.triggers import trigger
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.text import Span


class TickCount(Record, frozen=True):
    """A variable that starts at 0 and that a tick of a timer increases by at most `step`: in its handler, or in the
    `<onentry>` of a state that only its ticks enter."""

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
    counts = tick_counts(chart)
    limits = fixed_variables(chart)
    for expression in expressions if counts else ():
        for node in walk(expression.tree):
            if isinstance(node, Binary) and node.operator in _REACHES:
                smaller, greater = (node.right, node.left) if _REACHES[node.operator] else (node.left, node.right)
                yield from _wait(node.span, counts, limits, greater, smaller)


def ending_waits(machine: Machine, chart: Chart) -> Iterator[CountedWait]:
    """The conditions that hold until a counter has reached a limit, such as `n < 5`, where something else is done from
    then on: the next handler for the same trigger, or another branch."""
    counts = tick_counts(chart)
    limits = fixed_variables(chart)
    for cond in _alternating(machine, chart) if counts else ():
        tree = cond.tree
        if isinstance(tree, Binary) and tree.operator in _ENDS:
            smaller, greater = (tree.left, tree.right) if _ENDS[tree.operator] else (tree.right, tree.left)
            yield from _wait(tree.span, counts, limits, smaller, greater)


def _alternating(machine: Machine, chart: Chart) -> Iterator[Expression]:
    """The conditions without which another handler or branch is executed."""
    for state in chart.states:
        for number, handler in enumerate(state.handlers):
            own, later = trigger(machine, handler), state.handlers[number + 1 :]
            if handler.cond is not None and own is not None and own in (trigger(machine, h) for h in later):
                yield handler.cond
    for statement in chart.executed:
        if isinstance(statement, If):
            alternatives = (*statement.branches[1:], statement.otherwise)
            for branch, following in zip(statement.branches, alternatives, strict=True):
                if branch.cond is not None and following is not None:
                    yield branch.cond


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

_ENDS = {
    Operator.LESS: True,
    Operator.LESS_EQUAL: True,
    Operator.NOT_EQUAL: True,
    Operator.GREATER_EQUAL: False,
    Operator.GREATER: False,
}
"""The comparisons that hold until a number that grows has reached a limit -> whether the number is on the left side."""


def _wait(
    span: Span, counts: Mapping[str, TickCount], limits: Mapping[str, PortRead | Fraction], growing: Expr, limit: Expr
) -> Iterator[CountedWait]:
    name, factor = scaled(growing)
    if name not in counts or factor <= 0:
        return
    known: PortRead | Fraction | None = constant_fraction(limit)
    scale = Fraction(1)
    if known is None:
        other, scale = scaled(limit)
        known = limits.get(other)
    if known is None or scale <= 0:
        return
    ticks = scale / (factor * counts[name].step)
    port = known.key.value if isinstance(known, PortRead) and known.key else ""
    if port or isinstance(known, Fraction):
        value = known if isinstance(known, Fraction) else Fraction(1)
        yield CountedWait(span, name, counts[name].timer, port, value, ticks)


def scaled(tree: Expr) -> tuple[str, Fraction]:
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


def tick_counts(chart: Chart) -> dict[str, TickCount]:
    """The variables that count ticks: all other assignments set them to 0."""
    steps: dict[str, dict[str, _Steps]] = {}
    counting: set[Statement] = set()
    for timer, is_entry, body in _at_ticks(chart):
        counted: dict[str, Fraction] = {}
        for statement in statements(body):
            step = _step(statement)
            if step is not None:
                counting.add(statement)
                counted[step[0]] = counted.get(step[0], Fraction(0)) + step[1]
        for name, step_ in counted.items():
            most = steps.setdefault(name, {}).setdefault(timer, _Steps())
            steps[name][timer] = most.with_body(step_, is_entry)
    others: set[str] = set()
    for statement in chart.executed:
        is_other = isinstance(statement, Assign) and statement not in counting and not _is_zero(statement.value)
        if is_other and isinstance(statement, Assign) and statement.location is not None:
            others.add(statement.location.tree.name if isinstance(statement.location.tree, Name) else "")
    others |= {data.id.value for data in chart.data if data.id and not _is_zero(data.value)}
    return {
        name: TickCount(timer, most.of_handler + most.of_entry)
        for name, by_timer in steps.items()
        if name not in others and len(by_timer) == 1
        for timer, most in by_timer.items()
    }


class _Steps(Record, frozen=True):
    """The most by which a target of a handler and an `<onentry>` increase a variable; a tick executes one of each."""

    of_handler: Fraction = Fraction(0)
    of_entry: Fraction = Fraction(0)

    def with_body(self, step: Fraction, is_entry: bool) -> _Steps:
        return _Steps(
            self.of_handler if is_entry else max(self.of_handler, step),
            max(self.of_entry, step) if is_entry else self.of_entry,
        )


def _at_ticks(chart: Chart) -> Iterator[tuple[str, bool, tuple[Statement, ...]]]:
    """The bodies that a machine executes at most once for each tick of a timer, each with the name of the timer and
    whether it is an `<onentry>`."""
    entering: dict[str, set[str]] = {}
    for handler in (h for state in chart.states for h in state.handlers):
        timer = _timer(handler)
        for target in handler.targets:
            if target.state is not None:
                entering.setdefault(target.state.value, set()).add(timer)
            if timer:
                yield timer, False, target.body
    initial = chart.initial.value if chart.initial is not None else ""
    for state in chart.states:
        if state.entry is not None and state.id is not None and state.id.value != initial:
            timers = entering.get(state.id.value, set())
            if len(timers) == 1 and "" not in timers:
                (timer,) = timers
                yield timer, True, state.entry.statements


def _timer(handler: Handler) -> str:
    """The timer for whose tick a handler waits; "" for other handlers."""
    return handler.handle.value if handler.trigger is ProtocolPart.TICK and handler.handle is not None else ""


def _step(statement: Statement) -> tuple[str, Fraction] | None:
    """The variable that an assignment increases, and the number by which it does."""
    if not isinstance(statement, Assign) or statement.location is None or not isinstance(statement.value, Expression):
        return None
    location, tree = statement.location.tree, statement.value.tree
    if not isinstance(location, Name) or not isinstance(tree, Binary) or tree.operator is not Operator.ADD:
        return None
    for side, other in ((tree.left, tree.right), (tree.right, tree.left)):
        step: Fraction | None = constant_fraction(other)
        if isinstance(side, Name) and side.name == location.name and step is not None and step > 0:
            return location.name, step
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

# SPDX-License-Identifier: Apache-2.0
"""The rule `overwritten-value`, which overwritten_value.md describes."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.infer import constant
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Index, Name, walk
from roaml.model.behavior.knowledge import variables_in
from roaml.model.machine import (
    Assign,
    CallChild,
    Chart,
    If,
    NoEffect,
    ReturnStatus,
    RosSend,
    Send,
    SetOutput,
    Statement,
    bodies,
    statements,
)
from roaml.model.syntax import Expression, Value
from roaml.model.values.domain import Origin, interval
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.steps import step_of


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        declared = context.typed.variables.get(chart.scope, {})
        initial = {
            data.id.value: data.value.text.strip()
            for data in chart.data
            if data.id is not None and isinstance(data.value, Expression)
        }
        for _, _, body in bodies(chart):
            yield from _of_body(body, declared, initial)
            yield from _full(context, chart, body)


def _full(context: MachineContext, chart: Chart, body: tuple[Statement, ...]) -> Iterator[Finding]:
    """Report the assignment that adds an element to a queue in a ring, as `calls[(first + waiting) % 5]`, if the queue
    may be full, so that the oldest element is replaced."""
    values = context.local_values.charts.get(chart.scope)
    assigned = [s for s in statements(body) if isinstance(s, Assign) and s.location is not None]
    counted = {
        s.location.tree.name
        for s in assigned
        if s.location is not None and isinstance(s.location.tree, Name) and isinstance(s.value, Expression)
        if step_of(s.value.tree, s.location.tree.name) > 0
    }
    for statement in assigned if values is not None else ():
        tree = statement.location.tree if statement.location is not None else None
        index = tree.index if isinstance(tree, Index) else None
        if not isinstance(index, Binary) or index.operator is not Operator.REMAINDER or values is None:
            continue
        size = constant(index.right)
        names = [part for part in walk(index.left) if isinstance(part, Name)]
        if not isinstance(index.left, Binary) or index.left.operator is not Operator.ADD or size is None:
            continue
        for name in names:
            known = values.at(name)
            bounds = interval(known) if known is not None and name.name in counted else None
            if bounds is None or bounds.high < size or bounds.high_from is Origin.ASSUMED:
                continue
            if bounds.high_from is Origin.REACHED:
                message = (
                    f"`{name.name}` can be {bounds.high:g} here, and {size:g} elements fill the queue: the next one "
                    "replaces the oldest, which has not been read; add none when the queue is full"
                )
                yield RULE.at(index.span, message)
            else:
                message = f"no condition limits `{name.name}` to {size - 1:g} here; another element replaces the oldest"
                yield RULE.at(index.span, message, severity=Severity.INFORMATION)


def _of_body(body: Sequence[Statement], declared: Container[str], initial: Mapping[str, str]) -> Iterator[Finding]:
    """Report the assignments to a declared variable to which an earlier statement of the same body assigns a value that
    nothing between them reads. The severity is information if this is the initial value, followed by another one: often
    everything is reset, and some of it set."""
    unread: dict[str, Assign] = {}
    for statement in body:
        if isinstance(statement, NoEffect):
            unread.clear()  # a `<log>` shows values
        for name in _read(statement):
            unread = {place: assign for place, assign in unread.items() if place.split(".")[0] != name}
        if isinstance(statement, If):
            for branch in statement.parts:
                yield from _of_body(branch.body, declared, initial)
        if not isinstance(statement, Assign) or statement.location is None or statement.location.broken:
            continue
        place = place_of(statement.location.tree)
        if place is None or "[" in place or place.split(".")[0] not in declared:
            continue
        earlier = unread.pop(place, None)
        if earlier is not None:
            message = (
                f"this replaces the value that `{place}` got before, and nothing reads that value; "
                "remove one of the assignments, or change its `location`"
            )
            related = [Related(earlier.element.name_span, "the value that is never read")]
            was = earlier.value
            is_reset = isinstance(was, Expression) and was.text.strip() == initial.get(place)
            again = statement.value
            is_repeated = isinstance(was, Expression) and isinstance(again, Expression) and was.text == again.text
            severity = Severity.INFORMATION if is_reset and not is_repeated else None
            yield RULE.at(statement.location.span, message, severity=severity, related=related)
        unread[place] = statement


def _read(statement: Statement) -> frozenset[str]:
    """The variables that a statement reads, and those that it may read or change inside an `<if>`."""
    match statement:
        case Assign(location=location, value=value):
            is_plain = location is None or "[" not in (place_of(location.tree) or "[]")
            inside = () if is_plain else _names(location)
            return frozenset((*_names(value), *inside))
        case Send(params=values) | RosSend(fields=values):
            named = [name for param in values for name in _names(param.value)]
            ids = (statement.goal_id, statement.thread_id) if isinstance(statement, RosSend) else ()
            return frozenset((*named, *(name for value in ids for name in _names(value))))
        case SetOutput(value=value):
            return frozenset(_names(value))
        case If():
            parts = statement.parts
            names = {name for part in parts for name in _names(part.cond)}
            for part in parts:
                for inner in part.body:
                    names |= _read(inner) | _changed(inner)
            return frozenset(names)
        case ReturnStatus(status=name) | CallChild(child=name):
            return frozenset((name.value,)) if name is not None else frozenset()
    return frozenset()


def _changed(statement: Statement) -> frozenset[str]:
    if isinstance(statement, Assign) and statement.location is not None:
        return frozenset(variables_in((statement.location.tree,)))
    return frozenset()


def _names(value: Value | None) -> Iterator[str]:
    if isinstance(value, Expression):
        yield from variables_in((value.tree,))


RULE = Rule(
    "overwritten-value",
    Severity.WARNING,
    "A value is assigned to a variable and replaced before anything reads it.",
    machine=check,
    whole=True,
)

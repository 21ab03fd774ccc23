# SPDX-License-Identifier: Apache-2.0
"""The rule `never-reset`, which never_reset.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Boolean, Expr, Name
from roaml.model.machine import Assign, Chart, Data, Handler, If, Machine, State, Statement, bodies, statements
from roaml.model.syntax import Expression
from roaml.model.triggers import trigger
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.steps import step_of
from roaml.rules.support.words import words_of

_REACHED = {
    1: (Operator.EQUAL, Operator.GREATER_EQUAL, Operator.GREATER),
    -1: (Operator.EQUAL, Operator.LESS_EQUAL, Operator.LESS),
}
"""The sign of a step -> the comparisons that hold once the counter has reached the limit."""


def check(context: MachineContext) -> Iterator[Finding]:
    if context.system is None:
        return
    for chart in context.machine.charts:
        assigned = _assigned(chart)
        yield from _counters(chart, assigned)
        yield from _flags(context.machine, chart, assigned)


class _Assigned(NamedTuple):
    """An assignment to a variable, with its state, its handler and its value."""

    state: State
    handler: Handler | None
    statement: Assign
    value: Expr | None


def _assigned(chart: Chart) -> dict[str, list[_Assigned]]:
    """Variable -> all assignments to it or to a part of it."""
    result: dict[str, list[_Assigned]] = {}
    for state, handler, body in bodies(chart):
        for statement in statements(body):
            if isinstance(statement, Assign) and statement.location is not None:
                tree, value = statement.location.tree, statement.value
                expr = value.tree if isinstance(value, Expression) and not value.broken else None
                if isinstance(tree, Name):
                    result.setdefault(tree.name, []).append(_Assigned(state, handler, statement, expr))
    return result


# ---------------------------------------------------------------- counters


def _counters(chart: Chart, assigned: Mapping[str, Sequence[_Assigned]]) -> Iterator[Finding]:
    """Report a limit up to which a machine counts in a state, if it can leave the state and enter it again, and nothing
    resets the counter: the second time, it does not wait."""
    for name, steps in assigned.items():
        signs = {step_of(step.value, name) if step.value is not None else 0 for step in steps}
        states = {id(step.state) for step in steps}
        if len(states) != 1 or len(signs) != 1 or 0 in signs:
            continue
        state, (sign,) = steps[0].state, signs
        for cond, following in _tests(state, [step.statement for step in steps]):
            if _is_limit(cond.tree, name, sign) and _returns(chart, state, following):
                message = (
                    f"nothing resets `{name}` when it has reached this limit, so it is still there when the machine "
                    "enters the state again; assign the initial value"
                )
                related = [Related(step.statement.element.name_span, "counted here") for step in steps]
                yield RULE.at(cond.span, message, related=related, severity=_severity(name, _POSITIONS))


def _is_limit(tree: Expr, name: str, sign: int) -> bool:
    return (
        isinstance(tree, Binary)
        and isinstance(tree.left, Name)
        and tree.left.name == name
        and tree.operator in _REACHED[sign]
    )


def _tests(state: State, steps: Sequence[Assign]) -> Iterator[tuple[Expression, Sequence[str]]]:
    """The conditions under which the machine does not count: those of transitions that leave the state, and those of an
    `<if>` that counts in another branch. Each has the states that follow."""
    own = state.id.value if state.id is not None else ""
    for handler in state.handlers:
        targets = [target.state.value if target.state else "" for target in handler.targets]
        counts = any(step in statements(target.body) for target in handler.targets for step in steps)
        if handler.cond is not None and own not in targets and not counts:
            yield handler.cond, targets
    following = [name for name in _next(state) if name != own]
    for body in _bodies_of(state):
        for statement in statements(body):
            if isinstance(statement, If):
                parts = [part for part in (*statement.branches, statement.otherwise) if part is not None]
                counting = [part for part in parts if any(inner in steps for inner in statements(part.body))]
                for branch in statement.branches if counting else ():
                    if branch.cond is not None and branch not in counting:
                        yield branch.cond, following


def _bodies_of(state: State) -> Iterator[tuple[Statement, ...]]:
    if state.entry is not None:
        yield state.entry.statements
    for handler in state.handlers:
        for target in handler.targets:
            yield target.body


def _returns(chart: Chart, state: State, following: Sequence[str]) -> bool:
    """Whether a machine can enter `state` again from one of the states `following`."""
    states = {other.id.value: other for other in chart.states if other.id is not None}
    own = state.id.value if state.id is not None else ""
    todo = list(following)
    seen: set[str] = set()
    while todo:
        name = todo.pop()
        if name == own:
            return True
        if name not in seen and name in states:
            seen.add(name)
            todo += _next(states[name])
    return False


def _next(state: State) -> list[str]:
    return [t.state.value for handler in state.handlers if handler.effective for t in handler.targets if t.state]


# ------------------------------------------------------------------- flags


_RECORDS = frozenset(
    [
        "any",
        "ever",
        "failed",
        "had",
        "happened",
        "has",
        "initialized",
        "known",
        "received",
        "seen",
        "violated",
        "visited",
        "was",
    ]
)
_POSITIONS = frozenset(["altitude", "angle", "floor", "height", "pos", "position", "x", "y", "z"])
"""Words in the names of flags that record what has happened, and of what stays where it is."""


def _severity(name: str, words: frozenset[str]) -> Severity | None:
    return None if words.isdisjoint(words_of(name)) else Severity.INFORMATION


def _flags(machine: Machine, chart: Chart, assigned: Mapping[str, Sequence[_Assigned]]) -> Iterator[Finding]:
    """Report a flag that several handlers set and none clears. One that is set in one place, or by one event in several
    states, may record that something has happened."""
    for data in chart.data:
        if data.id is None or not isinstance(data.value, Expression) or not isinstance(data.value.tree, Boolean):
            continue
        values = assigned.get(data.id.value, [])
        constants = {value.value.value if isinstance(value.value, Boolean) else None for value in values}
        places = {id(value.handler or value.state) for value in values}
        events = {trigger(machine, v.handler) if v.handler is not None else None for v in values}
        states = {id(v.state) for v in values}
        is_known = len(events) == 1 and None not in events and len(states) == len(places)
        if len(places) > 1 and not is_known and constants == {not data.value.tree.value}:
            yield _flag(data, data.id.value, not data.value.tree.value, values)


def _flag(data: Data, name: str, value: bool, values: Sequence[_Assigned]) -> Finding:
    assert data.id is not None
    word = "true" if value else "false"
    message = f"all assignments to `{name}` assign {word}, so it never changes back; change one of them, or reset it"
    related = [Related(other.statement.element.name_span, f"becomes {word}") for other in values]
    return RULE.at(data.id.span, message, related=related, severity=_severity(name, _RECORDS))


RULE = Rule(
    "never-reset",
    Severity.WARNING,
    "A counter or flag is not reset.",
    machine=check,
    whole=True,
)

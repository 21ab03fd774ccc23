# SPDX-License-Identifier: Apache-2.0
"""Conditions that a machine makes true or false for ever, because no assignment changes a variable back."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from roaml.diagnostics import Related
from roaml.expr.infer import constant
from roaml.expr.operators import Operator, OperatorKind
from roaml.expr.tree import Binary, Boolean, Expr, Name, walk
from roaml.model.machine import Assign, Chart, Data, Handler, State, bodies, statements
from roaml.model.syntax import Expression
from roaml.model.values.analyse import ChartValues
from roaml.model.values.evaluate import is_within, place_of
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext
from roaml.rules.support.alternatives import joined
from roaml.rules.support.known_parts import conjuncts
from roaml.rules.support.steps import step_of
from roaml.text import Span


class OneWay(NamedTuple):
    """A condition that stays as it is for ever.

    Attributes:
        span: the place of the condition.
        message: why it stays so.
        related: the assignments.
    """

    span: Span
    message: str
    related: tuple[Related, ...]


class _Write(NamedTuple):
    handler: Handler | None
    statement: Assign
    value: Expr


REACHED = {
    1: (Operator.EQUAL, Operator.GREATER_EQUAL, Operator.GREATER),
    -1: (Operator.EQUAL, Operator.LESS_EQUAL, Operator.LESS),
}
"""The sign of a step -> the comparisons that hold once the counter has reached the limit."""


def one_way_values(context: MachineContext, chart: Chart) -> Iterator[OneWay]:
    writes = _writes(chart)
    if writes is None:
        return
    yield from _limits(chart, writes)
    values = context.values.charts.get(chart.scope)
    if values is not None:
        yield from _locks(chart, values, writes)


def _writes(chart: Chart) -> Mapping[str, Sequence[_Write]] | None:
    """Place -> all assignments to it; `None` if one of them cannot be read."""
    result: dict[str, list[_Write]] = {}
    for _, handler, body in bodies(chart):
        for statement in statements(body):
            if not isinstance(statement, Assign):
                continue
            place = place_of(statement.location.tree) if statement.location is not None else None
            if place is None or not isinstance(statement.value, Expression) or statement.value.broken:
                return None
            result.setdefault(place, []).append(_Write(handler, statement, statement.value.tree))
    return result


# ------------------------------------------------------------------ limits


def _limits(chart: Chart, writes: Mapping[str, Sequence[_Write]]) -> Iterator[OneWay]:
    """The limits of counters behind which a machine comes back to the same condition by itself: it repeats what it does
    there for ever."""
    for place, steps in writes.items():
        signs = {step_of(step.value, place) for step in steps}
        others = [other for other in writes if other != place and (is_within(place, other) or is_within(other, place))]
        if len(signs) != 1 or 0 in signs or others:
            continue
        (sign,) = signs
        for state in chart.states:
            for handler in state.handlers:
                cond = handler.cond
                if cond is None or cond.broken or not handler.effective or not _comes_back(chart, state, handler):
                    continue
                if any(_is_limit(part, place, sign) for part in joined(cond.tree, Operator.OR)):
                    location = steps[0].statement.location
                    name = location.text.strip() if location is not None else place
                    message = (
                        f"nothing resets `{name}`, so when it has reached this limit, the machine comes back here for "
                        "ever; assign the initial value"
                    )
                    related = tuple(Related(step.statement.element.name_span, "counted here") for step in steps)
                    yield OneWay(cond.span, message, related)


def _is_limit(tree: Expr, place: str, sign: int) -> bool:
    return isinstance(tree, Binary) and place_of(tree.left) == place and tree.operator in REACHED[sign]


_BY_ITSELF = (None, ProtocolPart.RESPONSE, ProtocolPart.GOAL_RESPONSE, ProtocolPart.RESULT, ProtocolPart.FEEDBACK)
"""What a machine handles without anything that another machine begins, and without a timer."""


def _comes_back(chart: Chart, state: State, handler: Handler) -> bool:
    """Whether a handler leaves a state, and all that the machine can do then is to come back to it by itself."""
    states = {other.id.value: other for other in chart.states if other.id is not None}
    own = state.id.value if state.id is not None else ""
    open_, seen = [t.state.value for t in handler.targets if t.state is not None], {own}
    if handler.trigger is not None or own in open_ or not open_:
        return False
    while open_:
        name = open_.pop()
        if name in seen:
            continue
        seen.add(name)
        following = [h for h in states[name].handlers if h.effective] if name in states else []
        if not following or any(other.trigger not in _BY_ITSELF for other in following):
            return False
        open_ += [t.state.value for other in following for t in other.targets if t.state is not None]
    return True


# ------------------------------------------------------------------- locks


def _locks(chart: Chart, values: ChartValues, writes: Mapping[str, Sequence[_Write]]) -> Iterator[OneWay]:
    """The conditions that need the initial value of a variable and are the reason why it changes, such as
    `inside == 0`, if other assignments change it as well, but none of them back."""
    for data in chart.data:
        name = data.id.value if data.id is not None else ""
        begin = _initial(data)
        own = writes.get(name, ())
        known = [values.at(write.value) for write in own]
        if begin is None or len(own) < 2 or any(v is None or v.includes(begin) for v in known):
            continue
        is_external = any(write.handler is None or write.handler.trigger is not None for write in own)
        if _is_phase(chart, name, begin) or (isinstance(begin, bool) and is_external):
            continue  # `never-reset` judges the flags that messages and requests set as well
        for state in chart.states:
            for handler in state.handlers:
                inside = [write for write in own if write.handler is handler]
                tests = () if handler.cond is None or handler.cond.broken else conjuncts(handler.cond.tree, True)
                is_needed = any(_needs(part, holds, name, begin) for part, holds in tests)
                if handler.cond is not None and inside and len(inside) < len(own) and is_needed:
                    shown = str(begin).lower() if isinstance(begin, bool) else f"{begin:g}"
                    message = (
                        f"`{name}` is {shown} only at first: no assignment makes it {shown} again, so this condition "
                        f"holds only once; assign {shown} where this should end"
                    )
                    related = tuple(Related(w.statement.element.name_span, "changed here") for w in own)
                    yield OneWay(handler.cond.span, message, related)


def _initial(data: Data) -> float | None:
    if not isinstance(data.value, Expression) or data.value.broken:
        return None
    return data.value.tree.value if isinstance(data.value.tree, Boolean) else constant(data.value.tree)


def _needs(part: Expr, holds: bool, name: str, begin: float) -> bool:
    """Whether a part of a condition holds only for the initial value of a variable."""
    match part:
        case Name():
            return part.name == name and holds is begin
        case Binary(operator=Operator.EQUAL, left=Name() as left) if holds and left.name == name:
            return constant(part.right) == begin
    return False


def _is_phase(chart: Chart, name: str, begin: float) -> bool:
    """Whether conditions compare a variable with other constants, as one that says how far a machine has come."""
    conditions = [h.cond for state in chart.states for h in state.handlers if h.cond is not None and not h.cond.broken]
    return any(
        isinstance(node, Binary)
        and node.operator.kind in (OperatorKind.EQUALITY, OperatorKind.ORDER)
        and any(isinstance(side, Name) and side.name == name for side in (node.left, node.right))
        and any((number := constant(side)) is not None and number != begin for side in (node.left, node.right))
        for cond in conditions
        for node in walk(cond.tree)
    )

# SPDX-License-Identifier: Apache-2.0
"""The rule `late-event-data`, which late_event_data.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.tree import Expr, Name, walk
from roaml.model.behavior.instants import can_arrive_again
from roaml.model.behavior.phases import ProtocolEvent
from roaml.model.machine import CallChild, Handler, RosSend, Send, Statement, statements
from roaml.model.syntax import Expression
from roaml.model.value_types import TypedValue, ValuePlace, ValueUse, find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.event_data import known_here

_ANSWERS = {
    ProtocolPart.REQUEST: (ProtocolPart.RESPONSE,),
    ProtocolPart.RESPONSE: (ProtocolPart.REQUEST,),
    ProtocolPart.GOAL: (ProtocolPart.GOAL_ACCEPTED, ProtocolPart.GOAL_REJECTED),
    ProtocolPart.RESULT: (ProtocolPart.GOAL,),
    ProtocolPart.GOAL_RESPONSE: (ProtocolPart.GOAL,),
    ProtocolPart.CHILD_STATUS: (ProtocolPart.CHILD_TICK, ProtocolPart.CHILD_HALT),
    ProtocolPart.CHILD_HALTED: (ProtocolPart.CHILD_TICK, ProtocolPart.CHILD_HALT),
    ProtocolPart.BT_TICK: (ProtocolPart.BT_STATUS,),
    ProtocolPart.BT_HALT: (ProtocolPart.BT_HALTED,),
}
"""The kind of an event -> the events of which a machine must send one before the next event of this kind can arrive."""


def check(context: MachineContext) -> Iterator[Finding]:
    """Report event data that may be overwritten before they are read: they are shared variables, read when the step is
    executed (docs/spec/machines.md#event-data-lifetime)."""
    branches: dict[Handler, list[tuple[TypedValue, Name]]] = {}
    for value in context.typed.values:
        if not value.place.late or not isinstance(value.value, Expression):
            continue
        known = known_here(value.place)
        name = next((n for n in _names(value.value.tree) if n.name in known), None) if known else None
        if name is not None and _may_be_newer(context, value.place, name.span.start):
            if value.use is ValueUse.BRANCH and value.place.handler is not None:
                branches.setdefault(value.place.handler, []).append((value, name))
            else:
                yield RULE.at(name.span, _message(value, name.name), severity=_severity(value))
    for (value, name), *others in branches.values():
        related = [Related(other.span, "also in this condition") for _, other in others]
        yield RULE.at(name.span, _message(value, name.name), severity=_severity(value), related=related)


def _may_be_newer(context: MachineContext, place: ValuePlace, at: int) -> bool:
    """Whether the event of a handler may be sent again before its data are read at an offset of the file."""
    handler = place.handler
    assert handler is not None
    sent = frozenset(_sent_before(context, place, handler, at))
    event = _event(context, handler)
    if handler.trigger in _ANSWERS:
        return any(ProtocolEvent(part, event.name) in sent for part in _ANSWERS[handler.trigger])
    if context.system is None or not context.automata:
        return True
    chart = context.machine.charts.index(place.chart)
    return any(can_arrive_again(context.system, automaton, chart, event, sent) for automaton in context.automata)


def _event(context: MachineContext, user: Handler | RosSend) -> ProtocolEvent:
    """The event that a handler receives, or that an element sends."""
    part = user.trigger if isinstance(user, Handler) else user.part
    assert part is not None
    if isinstance(user, Handler) and user.trigger is ProtocolPart.EVENT:
        return ProtocolEvent(part, user.event.value if user.event else "")
    declaration = find_handle(context.machine, user)
    return ProtocolEvent(part, declaration.handle.value if declaration and declaration.handle else "")


def _sent_before(context: MachineContext, place: ValuePlace, handler: Handler, at: int) -> Iterator[ProtocolEvent]:
    leave = place.state.exit.statements if place.state and place.state.exit else ()
    executed: list[Statement] = [*statements(leave)]
    for target in handler.targets:
        executed += [s for s in statements(target.body) if s.element.span.start < at]
    for statement in executed:
        match statement:
            case Send(event=event) if event is not None:
                yield ProtocolEvent(ProtocolPart.EVENT, event.value)
            case CallChild():
                yield ProtocolEvent(ProtocolPart.CHILD_HALT if statement.halts else ProtocolPart.CHILD_TICK, "")
            case RosSend() if not statement.element.span.end > at:
                yield _event(context, statement)


def _names(tree: Expr) -> Iterator[Name]:
    return (node for node in walk(tree) if isinstance(node, Name))


def _message(value: TypedValue, name: str) -> str:
    newer = f"when `{name}` may already hold the data of a newer event"
    advice = f"store the needed data of `{name}` in variables at the beginning of the body"
    match value.use:
        case ValueUse.BRANCH:
            return f"this condition is evaluated in a later step, {newer}; {advice}"
        case ValueUse.ASSIGNED | ValueUse.LOCATION:
            return f"this is read after a send or a test, {newer}; {advice}"
    return f"this value is read in a later step, {newer}; {advice}"


def _severity(value: TypedValue) -> Severity | None:
    """The severity of a finding: hint if the data are unlikely to be overwritten, otherwise `None` (the default). Data
    of the tree protocol cannot be overwritten, because a node answers once per tick. Data that the machine only
    forwards, in an event, as an id or to a port, are seldom overwritten."""
    handler = value.place.handler
    if handler is not None and handler.trigger in (
        ProtocolPart.CHILD_STATUS,
        ProtocolPart.CHILD_HALTED,
        ProtocolPart.BT_TICK,
        ProtocolPart.BT_HALT,
    ):
        return Severity.HINT
    return (
        Severity.HINT if value.use in (ValueUse.PARAMETER, ValueUse.FIELD, ValueUse.ARGUMENT, ValueUse.OUTPUT) else None
    )


RULE = Rule(
    "late-event-data",
    Severity.WARNING,
    "Event data are read in a step in which they may belong to a newer event.",
    machine=check,
    whole=True,
)

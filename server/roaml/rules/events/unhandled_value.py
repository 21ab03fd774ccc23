# SPDX-License-Identifier: Apache-2.0
"""The rule `unhandled-value`, which unhandled_value.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.tree import Expr, Member, walk
from roaml.model.machine import Chart, Handler, State
from roaml.model.syntax import Expression
from roaml.model.value_types import find_handle
from roaml.model.values.analyse import DataChannel, data_place
from roaml.model.values.describe import described
from roaml.model.values.domain import FALSE, ValueSet, exactly
from roaml.model.values.evaluate import Evaluator, place_of
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule

_PARTS = (ProtocolPart.MESSAGE, ProtocolPart.EVENT)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report conditions that two states repeat, if machines send values with which no state handles the message."""
    if context.system is None:
        return
    for chart in context.machine.charts:
        for channel, handlers in _handlers(context, chart).items():
            conditions = [(state, h.cond) for state, h in handlers if h.cond is not None and not h.cond.broken]
            field = _only_field(channel.part, [cond.tree for _, cond in conditions])
            if field is None or len(conditions) < len(handlers):
                continue
            place, path = field
            sent = context.values.arriving.get(channel, {}).get(path)
            unhandled = _unhandled(place, [cond.tree for _, cond in conditions], sent)
            if unhandled is not None:
                yield from _repeated(conditions, place, unhandled)


def _handlers(context: MachineContext, chart: Chart) -> dict[DataChannel, list[tuple[State, Handler]]]:
    """What arrives -> the handlers for it, with their states."""
    result: dict[DataChannel, list[tuple[State, Handler]]] = {}
    for state in chart.states:
        for handler in state.handlers:
            if handler.effective and handler.trigger in _PARTS:
                declaration = find_handle(context.machine, handler)
                name = declaration.handle if declaration is not None else handler.event
                if name is not None:
                    result.setdefault(DataChannel(handler.trigger, name.value), []).append((state, handler))
    return result


def _only_field(part: ProtocolPart, trees: Sequence[Expr]) -> tuple[str, str] | None:
    """The place and the path of the field that all conditions read, if they read nothing else."""
    prefix = f"{data_place(part)}."
    fields: set[str | None] = set()
    for tree in trees:
        inner = {id(node.object) for node in walk(tree) if isinstance(node, Member)}
        places = {place_of(node) for node in walk(tree) if id(node) not in inner} - {None}
        fields |= places or {None}
    place = fields.pop() if len(fields) == 1 else None
    return (place, place.removeprefix(prefix)) if place is not None and place.startswith(prefix) else None


def _unhandled(place: str, trees: Sequence[Expr], sent: ValueSet | None) -> ValueSet | None:
    """The value of `sent` with which no condition holds, if there is exactly one other value. Of several values, as
    those of a topic for commands, a machine often handles only some."""
    if sent is None or sent.only is None or len(sent.only) != 2:
        return None
    evaluator = Evaluator(lambda _: False)
    left = frozenset(
        value for value in sent.only if all(evaluator.values({place: exactly(value)}, tree) == FALSE for tree in trees)
    )
    return ValueSet(left) if left and left != sent.only else None


def _repeated(conditions: Sequence[tuple[State, Expression]], place: str, unhandled: ValueSet) -> Iterator[Finding]:
    for state, cond in conditions:
        others = [(s, c) for s, c in conditions if s is not state and c.text.split() == cond.text.split()]
        if not others:
            continue
        other = others[0][0].id
        name = other.value if other is not None else ""
        message = (
            f"the state `{name}` tests the same, so no state handles that `{place}` is {described(unhandled)}, which "
            "machines send; unless this is intended, change one of the conditions, or handle this value"
        )
        yield RULE.at(cond.span, message, related=[Related(c.span, "the same condition") for _, c in others])


RULE = Rule(
    "unhandled-value",
    Severity.INFORMATION,
    "Two states test the same value of a message, and another value that is sent is never handled.",
    machine=check,
    whole=True,
)

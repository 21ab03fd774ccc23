# SPDX-License-Identifier: Apache-2.0
"""removed-bt-event: see removed_bt_event.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.model.machine import Handler, Machine, Send
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.elements import removal
from roaml.text import TextEdit

REMOVED = {
    "bt_success": '<bt_return_status status="SUCCESS"/>',
    "bt_failure": '<bt_return_status status="FAILURE"/>',
    "bt_running": '<bt_return_status status="RUNNING"/>',
    "bt_halted": "<bt_return_halted/>",
}


def check(context: MachineContext) -> Iterator[Finding]:
    if context.listed_as == {"node_models"}:
        return  # to a node these are events like any other
    yield from (_handler(handler, context.source.text) for handler in _handlers(context.machine))
    yield from map(_send, _sends(context.machine))


def is_used(machine: Machine) -> bool:
    """Whether a plugin talks to the tree by events, so that it cannot be said what else is wrong with its answers."""
    return any(_handlers(machine)) or any(_sends(machine))


def _handlers(machine: Machine) -> Iterator[Handler]:
    for chart in machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                if handler.event is not None and handler.event.value in ("bt_tick", "bt_halt"):
                    yield handler


def _sends(machine: Machine) -> Iterator[Send]:
    for chart in machine.charts:
        for statement in chart.statements:
            if isinstance(statement, Send) and statement.event and statement.event.value in REMOVED:
                yield statement


def _send(send: Send) -> Finding:
    assert send.event is not None
    new = REMOVED[send.event.value]
    fix = Fix(f"Change to `{new}`", (TextEdit(send.element.span, new.replace("/>", " />")),))
    return RULE.at(send.event.span, f"the tree is no longer answered by events: write `{new}`", fix)


def _handler(handler: Handler, text: str) -> Finding:
    event, element = handler.event, handler.element
    assert event is not None
    attribute = element.get("event")
    assert attribute is not None
    edits = [TextEdit(element.name_span, event.value), removal(text, attribute.span)]
    if element.close_name_span is not None:
        edits.append(TextEdit(element.close_name_span, event.value))
    new = f"<{event.value}>"
    fix = Fix(f"Change to `{new}`", tuple(edits))
    return RULE.at(event.span, f"the tree no longer sends the event `{event.value}`: write `{new}`", fix)


RULE = Rule(
    "removed-bt-event",
    Severity.ERROR,
    "The behavior tree is talked to by events, which is no longer possible.",
    machine=check,
)

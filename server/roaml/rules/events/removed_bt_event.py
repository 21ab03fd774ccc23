# SPDX-License-Identifier: Apache-2.0
"""The rule `removed-bt-event`, which removed_bt_event.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal
from roaml.model.machine import Handler, Send
from roaml.model.system_file import SystemSection
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.removed_events import REMOVED_EVENTS, removed_handlers, removed_sends
from roaml.text import Edit, TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    if context.listed_as == {SystemSection.NODE_MODELS}:
        return  # in a node these are ordinary events
    yield from (_handler(handler, context.source.text) for handler in removed_handlers(context.machine))
    yield from map(_send, removed_sends(context.machine))


def _send(send: Send) -> Finding:
    assert send.event is not None
    new = REMOVED_EVENTS[send.event.value]
    fix = Fix(f"Change to `{new}`", (TextEdit(send.element.span, new.replace("/>", " />")),))
    return RULE.at(
        send.event.span, f"the tree no longer reacts to the event `{send.event.value}`; write `{new}` instead", fix
    )


def _handler(handler: Handler, text: str) -> Finding:
    event, element = handler.event, handler.element
    assert event is not None
    attribute = element.get("event")
    assert attribute is not None
    edits: list[Edit] = [TextEdit(element.name_span, event.value), removal(text, attribute.span)]
    if element.close_name_span is not None:
        edits.append(TextEdit(element.close_name_span, event.value))
    new = f"<{event.value}>"
    fix = Fix(f"Change to `{new}`", tuple(edits))
    return RULE.at(event.span, f"the tree no longer sends the event `{event.value}`; write `{new}` instead", fix)


RULE = Rule(
    "removed-bt-event",
    Severity.ERROR,
    "Plain events can no longer tick or halt a plugin, or answer the tree.",
    machine=check,
)

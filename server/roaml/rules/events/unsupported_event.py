# SPDX-License-Identifier: Apache-2.0
"""The rule `unsupported-event`, which unsupported_event.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import indent_of, removal
from roaml.model.syntax import Name
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule, listing
from roaml.text import TextEdit
from roaml.xml_syntax import Attribute, Element


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                attribute = handler.element.get("event")
                if handler.trigger is ProtocolPart.EVENT and attribute is not None and attribute.has_value:
                    yield from _check(handler.element, attribute, handler.event, context.source.text)


def _check(element: Element, attribute: Attribute, event: Name | None, text: str) -> Iterator[Finding]:
    if event is None:
        remove = Fix("Remove `event`", (removal(text, attribute.span),))
        yield RULE.at(
            attribute.span, "the name of the event is empty; for a transition without an event, remove `event`", remove
        )
    elif len(event.value.split()) > 1:
        names = listing(event.value.split())
        # The copy for a wildcard is still reported, so the fix is not preferred then.
        split = Fix("Write one transition for each event", (_copies(element, event, text),), preferred="*" not in names)
        yield RULE.at(
            event.span, f"a transition waits for exactly one event; write one transition for each of {names}", split
        )
    elif "*" in event.value:
        yield RULE.at(event.span, "wildcards are not supported; write one transition for each event")


def _copies(element: Element, event: Name, text: str) -> TextEdit:
    start, end = element.span
    copies = [
        f"{text[start : event.span.start]}{name}{text[event.span.end : end]}"
        for name in dict.fromkeys(event.value.split())
    ]
    return TextEdit(element.span, f"\n{indent_of(text, element)}".join(copies))


RULE = Rule("unsupported-event", Severity.ERROR, "A transition does not wait for exactly one event.", machine=check)

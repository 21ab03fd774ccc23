# SPDX-License-Identifier: Apache-2.0
"""The rule `event-never-received`, which event_never_received.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.gaps import GapAct
from roaml.model.machine import Send
from roaml.model.name_forms import EVENT
from roaml.model.system_file import SystemSection
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements
from roaml.rules.support.removed_events import REMOVED_EVENTS


def check(context: MachineContext) -> Iterator[Finding]:
    system = context.system
    if system is None:
        return
    awaited = [e.name for e in system.events.values() if e.receivers and not e.senders and EVENT.match(e.name)]
    known = () if context.listed_as == {SystemSection.NODE_MODELS} else REMOVED_EVENTS  # reported by removed-bt-event
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, Send) and statement.event and statement.event.value not in known:
                event = system.events.get(statement.event.value)
                if event is None or event.receivers or system.is_observed(event.name):
                    continue
                if not system.may(GapAct.RECEIVES, event.name):
                    close = close_names(event.name, awaited)
                    message = f"no machine has a transition for the event `{event.name}`, so it has no effect"
                    message += did_you_mean(close)
                    severity = None if close else Severity.WARNING  # event-never-sent reports the pair of names
                    fixes = replacements(statement.event.span, close)
                    yield RULE.at(statement.event.span, message, *fixes, severity=severity)


RULE = Rule(
    "event-never-received", Severity.HINT, "No machine receives an event that is sent.", machine=check, whole=True
)
